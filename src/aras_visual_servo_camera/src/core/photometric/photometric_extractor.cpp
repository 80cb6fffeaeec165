#include "aras_visual_servo_camera/photometric/photometric_extractor.hpp"

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

struct PhotometricExtractor::Work {
  Work(const CameraIntrinsics& camera, const PhotometricConfig& config) : intrinsics(camera) {
    for (int k = 0; k < config.levels; ++k) levels.emplace_back(camera, k, config);
    pyramid.resize(levels.size());
  }

  CameraIntrinsics intrinsics;
  std::vector<PhotometricLevel> levels;  // from fine to coarse
  cv::Mat buffer, grey, reference;       // grey: of the image looked at; reference: CV_32F
  std::vector<cv::Mat> pyramid;          // CV_32F
  LastViews<cv::Mat> last_views;         // grey
  double contrast = 0.0;                 // standard deviation of the grey levels
  std::uint64_t reference_hash = 0;
  std::int64_t reference_stamp_ns = kNoStamp;
  double z_star_m = PhotometricFeatures::kNone;

  void look(const ImageView& image);
};

void PhotometricExtractor::Work::look(const ImageView& image) {
  requireSize(image, intrinsics);
  grey = greyOf(image, &buffer);
  cv::Scalar mean, deviation;
  cv::meanStdDev(grey, mean, deviation);
  contrast = deviation[0];
  grey.convertTo(pyramid[0], CV_32F);
  for (std::size_t k = 1; k < pyramid.size(); ++k) cv::pyrDown(pyramid[k - 1], pyramid[k]);
}

PhotometricExtractor::PhotometricExtractor(const CameraIntrinsics& intrinsics, const PhotometricConfig& config)
    : config_(config) {
  setIntrinsics(intrinsics);
}

PhotometricExtractor::~PhotometricExtractor() = default;

const CameraIntrinsics& PhotometricExtractor::intrinsics() const { return work_->intrinsics; }

void PhotometricExtractor::setIntrinsics(const CameraIntrinsics& intrinsics) {
  work_ = std::make_unique<Work>(intrinsics, config_);
  features_ = PhotometricFeatures();
  features_.levels = config_.levels;
  features_.interaction = kNames[static_cast<int>(config_.interaction)];
}

void PhotometricExtractor::clearReference() {
  Work& w = *work_;
  w.reference.release();
  w.reference_hash = 0;
  w.reference_stamp_ns = kNoStamp;
  w.z_star_m = PhotometricFeatures::kNone;
}

void PhotometricExtractor::setReference(const ImageView& image, double z_star_m) {
  setReference(image, planeAt(z_star_m, config_.target_normal_C));
}

void PhotometricExtractor::setReference(const ImageView& image, const Plane& plane) {
  Work& w = *work_;
  clearReference();
  w.look(image);
  if (w.contrast < config_.min_contrast)
    throw DegenerateFeature("photometric reference: found grey levels with a standard deviation of " +
                            std::to_string(w.contrast) + ", allowed at least min_contrast, " +
                            std::to_string(config_.min_contrast));
  for (std::size_t k = 0; k < w.levels.size(); ++k) {
    w.levels[k].setPlane(plane);
    w.levels[k].setReference(w.pyramid[k]);
  }
  for (PhotometricLevel& level : w.levels) {  // the finest has to do; the others are left out where they do not
    const bool solvable = solve(level.ofReference(), level.pixels(), kSmallestChange).solvable;
    if (!solvable && &level == &w.levels.front())
      throw DegenerateFeature(
          "photometric reference: found an image in which six motions look alike, allowed a texture");
  }
  w.pyramid[0].copyTo(w.reference);
  w.reference_hash = hashOf(w.grey);
  w.z_star_m = 1.0 / plane.C;
}

void PhotometricExtractor::teach(std::int64_t stamp_ns, double z_star_m) {
  const cv::Mat& grey = work_->last_views.at(stamp_ns);
  setReference({grey.data, grey.cols, grey.rows, grey.step, PixelFormat::kMono8}, z_star_m);
  work_->reference_stamp_ns = stamp_ns;
}

const PhotometricFeatures& PhotometricExtractor::process(const ImageView& image, std::int64_t stamp_ns) {
  Work& w = *work_;
  PhotometricFeatures next;
  next.levels = config_.levels;
  next.interaction = kNames[static_cast<int>(config_.interaction)];
  next.has_reference = !w.reference.empty();
  next.reference_hash = w.reference_hash;
  next.reference_stamp_ns = w.reference_stamp_ns;
  next.z_star_m = w.z_star_m;
  w.look(image);
  if (stamp_ns != kNoStamp) w.grey.copyTo(w.last_views.add(stamp_ns));
  next.target_visible = next.valid = w.contrast >= config_.min_contrast;
  if (!next.target_visible) next.fault = "the image has no contrast";
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
