#include "aras_visual_servo_camera/tags/tag_extractor.hpp"

#include <dlfcn.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "image/grey_image.hpp"
#include "tags/tag_finder.hpp"
#include "tags/tag_sides.hpp"

namespace aras_visual_servo_camera {
namespace {

using Corners = std::array<cv::Point2d, 4>;

// A tag has at most so many modules from edge to edge. The edge of a side is looked for within a part of one, since
// the white margin may be one module wide, and the code begins one module within.
constexpr double kMostModules = 8.0, kReach = 0.4, kMostReach_px = 3.0;

double shortestSide(const Corners& corners) {
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 4; ++i) shortest = std::min(shortest, cv::norm(corners[(i + 1) % 4] - corners[i]));
  return shortest;
}

/** From the goal image to this one, scaled by its middle singular value as R + t n^T / d is. */
cv::Matx33d homographyOf(const Corners& goal, const Corners& here) {
  const auto single = [](const Corners& corners) { return std::vector<cv::Point2f>(corners.begin(), corners.end()); };
  const cv::Mat found = cv::getPerspectiveTransform(single(goal), single(here));
  cv::Matx33d H(found);
  cv::Vec3d sigmas;
  cv::SVD::compute(H, sigmas, cv::noArray(), cv::noArray());
  return H * ((cv::determinant(H) > 0.0 ? 1.0 : -1.0) / sigmas[1]);
}

/** Pose of the tag's frame in the camera: origin in its middle, x to the right and y up on it, z out of its face. */
void addPose(const Corners& corners, double size_m, TagFeatures* features) {
  const double half = 0.5 * size_m;
  const std::vector<cv::Point3d> object = {{-half, half, 0}, {half, half, 0}, {half, -half, 0}, {-half, -half, 0}};
  const std::vector<cv::Point2d> image(corners.begin(), corners.end());
  std::vector<cv::Mat> rotations, translations;
  std::vector<double> errors;
  cv::solvePnPGeneric(object, image, cv::Matx33d::eye(), cv::noArray(), rotations, translations, false,
                      cv::SOLVEPNP_IPPE_SQUARE, cv::noArray(), cv::noArray(), errors);
  if (rotations.empty() || !cv::checkRange(rotations[0]) || !cv::checkRange(translations[0])) return;
  cv::Matx33d R;
  cv::Rodrigues(rotations[0], R);
  const Eigen::Quaterniond q(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.val));
  features->position_m.assign(translations[0].ptr<double>(), translations[0].ptr<double>() + 3);
  features->orientation = {q.x(), q.y(), q.z(), q.w()};
  features->pose_error = errors[0];
  if (errors.size() > 1) features->other_pose_error = errors[1];
}

/** The file beside the one that holds this function. */
std::string installedLibrary() {
  Dl_info here;
  if (dladdr(reinterpret_cast<void*>(&installedLibrary), &here) == 0) return kAprilTagLibrary;
  const std::string file = here.dli_fname;
  return file.substr(0, file.rfind('/') + 1) + kAprilTagLibrary;
}

}  // namespace

std::unique_ptr<TagFinder> openTagFinder(const std::string& family, const std::string& library) {
  const std::string file = library.empty() ? installedLibrary() : library;
  void* handle = dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);  // the same one each time, never closed
  void* function = handle ? dlsym(handle, kNewAprilTagFinder) : nullptr;
  if (!function) throw ArasError("tag: the library that finds AprilTags cannot be used: " + std::string(dlerror()));
  return std::unique_ptr<TagFinder>(reinterpret_cast<NewAprilTagFinder*>(function)(family.c_str()));
}

struct TagExtractor::Work {
  Work(const CameraIntrinsics& camera, const TagConfig& config)
      : intrinsics(camera), finder(openTagFinder(config.family)) {}

  /** What one image shows of the tag: its corners, normalised, if there is no fault. */
  struct View {
    std::string fault = "no image has come yet";
    int tags = 0;
    double side_px = TagFeatures::kNone;
    Corners corners;
  };

  struct Goal : View {
    std::int64_t stamp_ns = kNoStamp;
    double z_star_m = TagFeatures::kNone;  // NaN: no goal
  };

  CameraIntrinsics intrinsics;
  std::unique_ptr<TagFinder> finder;
  GreyReader reader;
  View seen;
  Goal goal;
  LastViews<View> last_views;

  void look(const ImageView& image, const TagConfig& config);
  void adopt(const View& view, double z_m, std::int64_t stamp_ns);  // as the goal
};

void TagExtractor::Work::look(const ImageView& image, const TagConfig& config) {
  requireSize(image, intrinsics);
  seen = View();
  const cv::Mat grey = reader.read(image);
  const std::string name = "tag " + std::to_string(config.id) + " of " + config.family;
  std::string others;
  const SeenTag* found = nullptr;
  const std::vector<SeenTag> all = finder->find(grey);
  for (const SeenTag& tag : all) {
    if (tag.id == config.id) {
      ++seen.tags;
      found = &tag;
    } else {
      others += (others.empty() ? "" : ", ") + std::to_string(tag.id);
    }
  }
  if (seen.tags != 1) {
    seen.fault = seen.tags > 1    ? "the image shows " + std::to_string(seen.tags) + " times " + name
                 : others.empty() ? "the image does not show " + name
                                  : "the image does not show " + name + ", but " + others;
    return;
  }
  seen.side_px = shortestSide(found->corners_px);
  if (!(seen.side_px >= config.min_side_px)) {
    seen.fault = name + " is too small: a side is " + std::to_string(seen.side_px) + " px long, needed at least " +
                 std::to_string(config.min_side_px);
    return;
  }
  const double module_px = seen.side_px / kMostModules;
  if (const auto corners =
          cornersOfSides(grey, found->corners_px, std::clamp(kReach * module_px, 1.0, kMostReach_px), intrinsics)) {
    seen.corners = *corners;
    seen.fault.clear();
    return;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const auto ray = intrinsics.undistort(found->corners_px[i].x, found->corners_px[i].y);
    if (!ray.valid) {
      seen.fault = name + " lies where the lens shows nothing";
      return;
    }
    seen.corners[i] = {ray.x, ray.y};
  }
  seen.fault.clear();
}

TagExtractor::TagExtractor(const CameraIntrinsics& intrinsics, const TagConfig& config) : config_(config) {
  setIntrinsics(intrinsics);
}

TagExtractor::~TagExtractor() = default;

const CameraIntrinsics& TagExtractor::intrinsics() const { return work_->intrinsics; }

void TagExtractor::setIntrinsics(const CameraIntrinsics& intrinsics) {
  if (work_) {
    work_->intrinsics = intrinsics;
  } else {
    work_ = std::make_unique<Work>(intrinsics, config_);
  }
  features_ = TagFeatures();
  features_.family = config_.family;
  features_.id = config_.id;
}

void TagExtractor::clearReference() { work_->goal = Work::Goal(); }

std::function<void()> TagExtractor::undo() {
  return [this, goal = work_->goal] { work_->goal = goal; };
}

void TagExtractor::setReference(const ImageView& image, double z_star_m) {
  work_->look(image, config_);
  work_->adopt(work_->seen, z_star_m, kNoStamp);
}

void TagExtractor::teach(std::int64_t stamp_ns, double z_star_m) {
  work_->adopt(work_->last_views.at(stamp_ns), z_star_m, stamp_ns);
}

void TagExtractor::Work::adopt(const View& view, double z_m, std::int64_t stamp_ns) {
  requireDepth(z_m);
  if (!view.fault.empty()) throw DegenerateFeature("tag reference: " + view.fault);
  static_cast<View&>(goal) = view;
  goal.stamp_ns = stamp_ns;
  goal.z_star_m = z_m;
}

const TagFeatures& TagExtractor::process(const ImageView& image, std::int64_t stamp_ns) {
  Work& w = *work_;
  w.look(image, config_);
  if (stamp_ns != kNoStamp) w.last_views.add(stamp_ns) = w.seen;
  TagFeatures next;
  next.family = config_.family;
  next.id = config_.id;
  next.tags = w.seen.tags;
  next.side_px = w.seen.side_px;
  next.fault = w.seen.fault;
  next.target_visible = next.valid = next.fault.empty();
  next.has_reference = w.goal.fault.empty();
  next.z_star_m = w.goal.z_star_m;
  next.reference_stamp_ns = w.goal.stamp_ns;
  if (next.valid) {
    for (const cv::Point2d& p : w.seen.corners) {
      next.point_x.push_back(p.x);
      next.point_y.push_back(p.y);
    }
    next.xg = 0.25 * (next.point_x[0] + next.point_x[1] + next.point_x[2] + next.point_x[3]);
    next.yg = 0.25 * (next.point_y[0] + next.point_y[1] + next.point_y[2] + next.point_y[3]);
    if (next.has_reference) {
      const cv::Matx33d H = homographyOf(w.goal.corners, w.seen.corners);
      next.homography.assign(H.val, H.val + 9);
    }
    if (config_.size_m) addPose(w.seen.corners, *config_.size_m, &next);
  }
  features_ = std::move(next);
  return features_;
}

}  // namespace aras_visual_servo_camera
