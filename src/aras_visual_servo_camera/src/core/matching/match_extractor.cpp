#include "aras_visual_servo_camera/matching/match_extractor.hpp"

#include <cmath>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "image/grey_image.hpp"
#include "matching/keypoints.hpp"
#include "matching/plane_homography.hpp"

namespace aras_visual_servo_camera {
namespace {

const char* const kNames[] = {"orb", "akaze", "sift"};

}  // namespace

struct MatchExtractor::Work {
  Work(const CameraIntrinsics& camera, const MatchingConfig& config) : intrinsics(camera), finder(config) {}

  CameraIntrinsics intrinsics;
  KeypointFinder finder;
  cv::Mat buffer;
  Keypoints seen, goal;
  LastViews<Keypoints> last_views;
  std::int64_t reference_stamp_ns = kNoStamp;
  double z_star_m = MatchFeatures::kNone;  // NaN: no reference

  void look(const ImageView& image);
  void adopt(const Keypoints& view, double z_m, int least);  // as the goal
};

void MatchExtractor::Work::look(const ImageView& image) {
  if (image.width_px != intrinsics.width() || image.height_px != intrinsics.height())
    throw ShapeError("image: found " + std::to_string(image.width_px) + " x " + std::to_string(image.height_px) +
                     ", allowed " + std::to_string(intrinsics.width()) + " x " + std::to_string(intrinsics.height()) +
                     ", the size in camera_info");
  finder.find(greyOf(image, &buffer), intrinsics, &seen);
}

MatchExtractor::MatchExtractor(const CameraIntrinsics& intrinsics, const MatchingConfig& config) : config_(config) {
  setIntrinsics(intrinsics);
}

MatchExtractor::~MatchExtractor() = default;

const CameraIntrinsics& MatchExtractor::intrinsics() const { return work_->intrinsics; }

void MatchExtractor::setIntrinsics(const CameraIntrinsics& intrinsics) {
  work_ = std::make_unique<Work>(intrinsics, config_);
  features_ = MatchFeatures();
  features_.detector = kNames[static_cast<int>(config_.detector)];
}

void MatchExtractor::clearReference() {
  work_->goal = Keypoints();
  work_->reference_stamp_ns = kNoStamp;
  work_->z_star_m = MatchFeatures::kNone;
}

void MatchExtractor::setReference(const ImageView& image, double z_star_m) {
  clearReference();
  work_->look(image);
  work_->adopt(work_->seen, z_star_m, config_.min_matches);
}

void MatchExtractor::teach(std::int64_t stamp_ns, double z_star_m) {
  const Keypoints& goal = work_->last_views.at(stamp_ns);
  clearReference();
  work_->adopt(goal, z_star_m, config_.min_matches);
  work_->reference_stamp_ns = stamp_ns;
}

void MatchExtractor::Work::adopt(const Keypoints& view, double z_m, int least) {
  if (!(z_m > 0.0) || !std::isfinite(z_m))
    throw ParameterError("reference/z_star_m: found " + std::to_string(z_m) + ", allowed > 0");
  if (view.count() < least)
    throw DegenerateFeature("matches reference: found an image with " + std::to_string(view.count()) +
                            " keypoints, allowed at least min_matches, " + std::to_string(least));
  goal.xy = view.xy;
  goal.descriptors = view.descriptors.clone();
  z_star_m = z_m;
}

const MatchFeatures& MatchExtractor::process(const ImageView& image, std::int64_t stamp_ns) {
  Work& w = *work_;
  w.look(image);
  if (stamp_ns != kNoStamp) {
    Keypoints& kept = w.last_views.add(stamp_ns);
    kept.xy = w.seen.xy;
    w.seen.descriptors.copyTo(kept.descriptors);
  }
  MatchFeatures next;
  next.detector = kNames[static_cast<int>(config_.detector)];
  next.has_reference = w.goal.count() > 0;
  next.keypoints = w.seen.count();
  next.goal_keypoints = w.goal.count();
  next.z_star_m = w.z_star_m;
  next.reference_stamp_ns = w.reference_stamp_ns;
  if (w.seen.count() >= config_.min_matches) {
    for (const cv::Point2d& p : w.seen.box()) {
      next.as_goal_x.push_back(p.x);
      next.as_goal_y.push_back(p.y);
    }
    next.target_visible = next.valid = true;
    if (next.has_reference) match(&next);
  } else {
    next.fault = "the image has " + std::to_string(next.keypoints) + " keypoints, needed at least " +
                 std::to_string(config_.min_matches);
  }
  features_ = std::move(next);
  return features_;
}

void MatchExtractor::match(MatchFeatures* features) const {
  const Work& w = *work_;
  std::vector<cv::Point2d> here, there;
  for (const auto& [mine, goals] : w.finder.match(w.seen, w.goal)) {
    here.push_back(w.seen.xy[static_cast<std::size_t>(mine)]);
    there.push_back(w.goal.xy[static_cast<std::size_t>(goals)]);
  }
  features->matches = static_cast<int>(here.size());
  std::optional<PlaneHomography> plane;
  if (w.seen == w.goal) {  // the goal image itself: the goal's features are exact, not only to rounding
    plane = PlaneHomography{cv::Matx33d::eye(), {}, 0.0};
    for (int i = 0; i < features->matches; ++i) plane->inliers.push_back(i);
  } else {
    plane = findHomography(there, here, std::sqrt(w.intrinsics.fx() * w.intrinsics.fy()), config_);
  }
  features->target_visible = features->valid = plane.has_value();
  if (!plane) {
    features->fault = "of " + std::to_string(features->matches) + " matches fewer than " +
                      std::to_string(config_.min_matches) + " agree on where the target is";
    return;
  }
  features->inliers = static_cast<int>(plane->inliers.size());
  features->rms_px = plane->rms_px;
  for (int i : plane->inliers) {
    const auto k = static_cast<std::size_t>(i);
    features->match_x.push_back(here[k].x);
    features->match_y.push_back(here[k].y);
    features->match_goal_x.push_back(there[k].x);
    features->match_goal_y.push_back(there[k].y);
  }
  cv::Point2d middle;
  for (const cv::Point2d& p : w.goal.box()) {
    const cv::Point2d q = plane->apply(p);
    features->point_x.push_back(q.x);
    features->point_y.push_back(q.y);
    middle += 0.25 * p;
  }
  middle = plane->apply(middle);
  features->xg = middle.x;
  features->yg = middle.y;
  features->homography.assign(plane->H.val, plane->H.val + 9);
}

}  // namespace aras_visual_servo_camera
