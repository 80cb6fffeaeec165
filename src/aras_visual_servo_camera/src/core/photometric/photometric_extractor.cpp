#include "aras_visual_servo_camera/photometric/photometric_extractor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "image/grey_image.hpp"
#include "photometric/photometric_level.hpp"

namespace aras_visual_servo_camera {
namespace {

const char* const kNames[] = {"desired", "current", "mean"};
// A motion whose rms effect on the pixels is less than this per 1 m or 1 rad cannot be seen in 8 bits.
constexpr double kSmallestChange = 1e-2;
// The goal's image is drawn for other intrinsics as long as its pixels are not much larger or smaller than theirs.
constexpr double kMostZoom = 1.25;

/** A value between pixels by cubic convolution, as exact in its place as doubles are; cv::remap rounds places to 1/32.
 */
float interpolated(const cv::Mat& image, double u, double v) {
  const auto weights = [](double t) {  // R. Keys, IEEE Trans. ASSP 29(6), 1981, a = -1/2
    return std::array<double, 4>{t * (-0.5 + t * (1.0 - 0.5 * t)), 1.0 + t * t * (-2.5 + 1.5 * t),
                                 t * (0.5 + t * (2.0 - 1.5 * t)), t * t * (-0.5 + 0.5 * t)};
  };
  u = std::clamp(u, 0.0, image.cols - 1.0);
  v = std::clamp(v, 0.0, image.rows - 1.0);
  const int left = static_cast<int>(u), top = static_cast<int>(v);
  const auto across = weights(u - left), down = weights(v - top);
  double sum = 0.0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      sum += down[i] * across[j] *
             image.at<float>(std::clamp(top + i - 1, 0, image.rows - 1), std::clamp(left + j - 1, 0, image.cols - 1));
  return static_cast<float>(sum);
}

std::uint64_t hashOf(const cv::Mat& grey) {  // FNV-1a
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (int v = 0; v < grey.rows; ++v)
    for (int u = 0; u < grey.cols; ++u) hash = (hash ^ grey.at<std::uint8_t>(v, u)) * 0x100000001b3u;
  return hash == 0 ? 1 : hash;
}

}  // namespace

Plane planeAt(double z_star_m, const Eigen::Vector3d& n) {
  requireDepth(z_star_m);
  return {n[0] / (n[2] * z_star_m), n[1] / (n[2] * z_star_m), 1.0 / z_star_m};
}

struct PhotometricExtractor::View {
  std::shared_ptr<const CameraIntrinsics> camera;
  cv::Mat grey;
  int white = 0;  // of its image
};

struct PhotometricExtractor::Goal {
  View view;
  Plane plane;
  std::int64_t stamp_ns;
  std::uint64_t hash;
};

struct PhotometricExtractor::Work {
  Work(const CameraIntrinsics& intrinsics, const PhotometricConfig& config)
      : camera(std::make_shared<const CameraIntrinsics>(intrinsics)) {
    for (int k = 0; k < config.levels; ++k) levels.emplace_back(intrinsics, k, config);
    pyramid.resize(levels.size());
  }

  std::shared_ptr<const CameraIntrinsics> camera;
  std::vector<PhotometricLevel> levels;  // from fine to coarse
  GreyReader reader;
  cv::Mat grey, reference;       // grey: of the image looked at; reference: CV_32F
  std::vector<cv::Mat> pyramid;  // CV_32F
  LastViews<View> last_views;
  double contrast = 0.0;             // standard deviation of the grey levels
  std::shared_ptr<const Goal> goal;  // as it was taught
  std::string goal_fault;            // why there is no reference although there is a goal

  void look(const ImageView& image, const PhotometricConfig& config);
  void makePyramid(const cv::Mat& image);
  /** The image of a view as this camera sees it. @throws DegenerateFeature where it shows too little */
  cv::Mat imageOf(const View& view, const PhotometricConfig& config) const;
  /** Makes the goal's image the reference of the levels, drawn for this camera. */
  void compareWith(const Goal& goal, const PhotometricConfig& config);
  /** The same with a goal that was taught before, or none. A goal that this camera cannot use is kept. */
  void restore(std::shared_ptr<const Goal> goal, const PhotometricConfig& config);
};

void PhotometricExtractor::Work::look(const ImageView& image, const PhotometricConfig& config) {
  requireSize(image, *camera);
  const int white = reader.white();
  grey = reader.read(image);
  if (white != reader.white() && goal) restore(goal, config);  // its greys count for less now
  cv::Scalar mean, deviation;
  cv::meanStdDev(grey, mean, deviation);
  contrast = deviation[0];
  makePyramid(grey);
}

void PhotometricExtractor::Work::makePyramid(const cv::Mat& image) {
  image.convertTo(pyramid[0], CV_32F);
  for (std::size_t k = 1; k < pyramid.size(); ++k) cv::pyrDown(pyramid[k - 1], pyramid[k]);
}

cv::Mat PhotometricExtractor::Work::imageOf(const View& view, const PhotometricConfig& config) const {
  cv::Mat floats, image;
  view.grey.convertTo(floats, CV_32F, view.white > 0 ? double(view.white) / reader.white() : 1.0);
  if (*camera == *view.camera) return floats;
  const double zoom = std::sqrt(camera->fx() * camera->fy() / (view.camera->fx() * view.camera->fy()));
  // Pixels of the rim are only smoothed over.
  const int rim = std::max(0, config.border_px - static_cast<int>(std::ceil(3.0 * config.smoothing_px)));
  image = cv::Mat::zeros(camera->height(), camera->width(), CV_32F);
  bool covered = zoom <= kMostZoom && zoom >= 1.0 / kMostZoom;
  for (int v = 0; covered && v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const CameraIntrinsics::Undistorted ray = camera->undistort(u, v);
      if (!ray.valid) continue;  // nor is this pixel used
      const bool used = u >= rim && v >= rim && u < image.cols - rim && v < image.rows - rim;
      const bool drawn = view.camera->isWithinFold(ray.x, ray.y);
      const std::array<double, 2> p = view.camera->project(ray.x, ray.y);
      if (drawn) image.at<float>(v, u) = interpolated(floats, p[0], p[1]);
      const bool inside =
          drawn && p[0] >= 0.0 && p[1] >= 0.0 && p[0] <= view.grey.cols - 1 && p[1] <= view.grey.rows - 1;
      covered = covered && (inside || !used);
    }
  }
  if (!covered)
    throw DegenerateFeature(
        "the goal's image cannot be compared since the camera's intrinsics changed: teach it again");
  return image;
}

PhotometricExtractor::PhotometricExtractor(const CameraIntrinsics& intrinsics, const PhotometricConfig& config)
    : config_(config) {
  setIntrinsics(intrinsics);
}

PhotometricExtractor::~PhotometricExtractor() = default;

const CameraIntrinsics& PhotometricExtractor::intrinsics() const { return *work_->camera; }

void PhotometricExtractor::setIntrinsics(const CameraIntrinsics& intrinsics) {
  auto next = std::make_unique<Work>(intrinsics, config_);
  if (work_) {
    next->last_views = std::move(work_->last_views);
    next->reader = std::move(work_->reader);
    next->restore(work_->goal, config_);
  }
  work_ = std::move(next);
  features_ = PhotometricFeatures();
  features_.levels = config_.levels;
  features_.interaction = kNames[static_cast<int>(config_.interaction)];
}

void PhotometricExtractor::clearReference() { work_->restore(nullptr, config_); }

std::function<void()> PhotometricExtractor::undo() {
  return [this, goal = work_->goal] { work_->restore(goal, config_); };
}

void PhotometricExtractor::setReference(const ImageView& image, double z_star_m) {
  setReference(image, planeAt(z_star_m, config_.target_normal_C));
}

void PhotometricExtractor::setReference(const ImageView& image, const Plane& plane) {
  work_->look(image, config_);
  setGoal({work_->camera, work_->grey.clone(), work_->reader.white()}, plane, kNoStamp);
}

void PhotometricExtractor::teach(std::int64_t stamp_ns, double z_star_m) {
  const View& view = work_->last_views.at(stamp_ns);
  setGoal({view.camera, view.grey.clone(), view.white}, planeAt(z_star_m, config_.target_normal_C), stamp_ns);
}

void PhotometricExtractor::setGoal(const View& view, const Plane& plane, std::int64_t stamp_ns) {
  const std::shared_ptr<const Goal> before = work_->goal;
  const auto goal = std::make_shared<const Goal>(Goal{view, plane, stamp_ns, hashOf(view.grey)});
  try {
    work_->compareWith(*goal, config_);
    work_->goal = goal;
    work_->goal_fault.clear();
  } catch (const ArasError&) {
    work_->restore(before, config_);
    throw;
  }
}

void PhotometricExtractor::Work::compareWith(const Goal& next, const PhotometricConfig& config) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(next.view.grey, mean, deviation);
  if (deviation[0] < config.min_contrast)
    throw DegenerateFeature("photometric reference: found grey levels with a standard deviation of " +
                            std::to_string(deviation[0]) + ", allowed at least min_contrast, " +
                            std::to_string(config.min_contrast));
  makePyramid(imageOf(next.view, config));
  for (std::size_t k = 0; k < levels.size(); ++k) {
    levels[k].setPlane(next.plane);
    levels[k].setReference(pyramid[k]);
  }
  for (PhotometricLevel& level : levels) {  // the finest has to do; the others are left out where they do not
    const bool solvable = solve(level.ofReference(), level.pixels(), kSmallestChange).solvable;
    if (!solvable && &level == &levels.front())
      throw DegenerateFeature(
          "photometric reference: found an image in which six motions look alike, allowed a texture");
  }
  pyramid[0].copyTo(reference);
}

void PhotometricExtractor::Work::restore(std::shared_ptr<const Goal> before, const PhotometricConfig& config) {
  goal = std::move(before);
  goal_fault.clear();
  reference.release();
  if (!goal) return;
  try {
    compareWith(*goal, config);
  } catch (const ArasError& error) {
    goal_fault = error.what();
  }
}

const PhotometricFeatures& PhotometricExtractor::process(const ImageView& image, std::int64_t stamp_ns) {
  Work& w = *work_;
  PhotometricFeatures next;
  next.levels = config_.levels;
  next.interaction = kNames[static_cast<int>(config_.interaction)];
  w.look(image, config_);
  next.has_reference = !w.reference.empty();
  if (next.has_reference) {
    next.reference_hash = w.goal->hash;
    next.reference_stamp_ns = w.goal->stamp_ns;
    next.z_star_m = 1.0 / w.goal->plane.C;
  }
  if (stamp_ns != kNoStamp) {
    View& kept = w.last_views.add(stamp_ns);
    kept.camera = w.camera;
    kept.white = w.reader.white();
    w.grey.copyTo(kept.grey);
  }
  next.target_visible = w.contrast >= config_.min_contrast;
  next.fault = next.target_visible ? w.goal_fault : "the image has no contrast";
  next.valid = next.fault.empty();
  if (next.has_reference && next.valid) {
    next.rms = w.levels.front().rms(w.pyramid[0], w.reference);
    NormalEquations equations;
    GaussNewton newton;
    bool far = false;
    for (int k = config_.levels - 1; k >= 0 && !far; --k) {
      PhotometricLevel& level = w.levels[k];
      level.look(w.pyramid[k]);
      next.level = k;
      next.pixels = level.pixels();
      for (int stage = level.stages() - 1; stage >= 0 && !far; --stage) {
        equations = level.equations(stage);
        newton = solve(equations, level.pixels(), kSmallestChange);
        next.motion_px = newton.solvable ? level.motion(newton.step, stage) : PhotometricFeatures::kNone;
        far = newton.solvable && next.motion_px >= config_.switch_px;
      }
    }
    next.cost = equations.cost;
    next.condition = newton.condition;
    next.b.assign(equations.b.begin(), equations.b.end());
    for (int i = 0; i < 6; ++i)
      for (int j = i; j < 6; ++j) next.H.push_back(equations.H(i, j));
    next.valid = newton.solvable;
    if (!next.valid) next.fault = "six motions look alike in this image";
  }
  features_ = std::move(next);
  return features_;
}

}  // namespace aras_visual_servo_camera
