#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "image/depth_reader.hpp"
#include "image/grey_image.hpp"
#include "points/point_features.hpp"
#include "segmentation/edge_step.hpp"

namespace aras_visual_servo_camera {

/** Projections of an object onto the kernels X^-p and Y^-q, with X = x - x0, Y = y - y0 from a corner outside the
 * image.
 *
 *  kernel_x holds p, x0, and the integrals over the object of X^-(p - 1 + k) y^j dA at [2 + 2 k + j], k = 0, 1, 2 and
 *  j = 0, 1; kernel_y the same of Y^-(q - 1 + k) x^j. The projections themselves are those of k = 1, j = 0; the others
 *  make their interaction rows exact (docs/theory.md T47). Each weight counts at the centre of its pixel. */
class KernelProjection {
 public:
  /** @param map  must outlive this. @param p, q  exponents, > 0 */
  KernelProjection(const PixelMap& map, double p, double q);

  /** Puts both into the features of this mask; empty where there is no target. */
  void write(const ObjectMask& mask, MomentFeatures* features) const;

 private:
  struct Powers {
    double x, y;  // X^-(p + 1), Y^-(q + 1)
  };

  const PixelMap& map_;
  double p_, q_, x0_ = 0.0, y0_ = 0.0;
  std::vector<Powers> powers_;  // of each pixel, row-major
};

KernelProjection::KernelProjection(const PixelMap& map, double p, double q) : map_(map), p_(p), q_(q) {
  // One pixel outside the rays of the image's border, whatever the lens.
  for (int v = 0; v < map.height(); ++v) {
    for (int u = 0; u < map.width(); ++u) {
      const PixelMap::Pixel pixel = map.at(u, v);
      x0_ = std::min(x0_, pixel.x - 1.0 / map.intrinsics().fx());
      y0_ = std::min(y0_, pixel.y - 1.0 / map.intrinsics().fy());
    }
  }
  powers_.reserve(static_cast<std::size_t>(map.width()) * map.height());
  for (int v = 0; v < map.height(); ++v) {
    for (int u = 0; u < map.width(); ++u) {
      const PixelMap::Pixel pixel = map.at(u, v);
      powers_.push_back({std::pow(pixel.x - x0_, -p - 1.0), std::pow(pixel.y - y0_, -q - 1.0)});
    }
  }
}

void KernelProjection::write(const ObjectMask& mask, MomentFeatures* features) const {
  features->kernel_x.clear();
  features->kernel_y.clear();
  if (!features->target_visible) return;
  std::array<double, 6> sums_x{}, sums_y{};
  const auto add = [&](int u, int v, double weight) {
    const PixelMap::Pixel pixel = map_.at(u, v);
    const Powers& powers = powers_[static_cast<std::size_t>(v) * map_.width() + u];
    double a = weight * pixel.area * powers.x, b = weight * pixel.area * powers.y;
    for (int k = 2; k >= 0; --k, a *= pixel.x - x0_, b *= pixel.y - y0_) {
      sums_x[2 * k] += a;
      sums_x[2 * k + 1] += a * pixel.y;
      sums_y[2 * k] += b;
      sums_y[2 * k + 1] += b * pixel.x;
    }
  };
  for (const Span& s : mask.spans)
    for (int u = s.u_begin; u < s.u_end; ++u) add(u, s.v, 1.0);
  for (const EdgePixel& e : mask.edge) add(e.u, e.v, e.weight);
  features->kernel_x = {p_, x0_};
  features->kernel_y = {q_, y0_};
  features->kernel_x.insert(features->kernel_x.end(), sums_x.begin(), sums_x.end());
  features->kernel_y.insert(features->kernel_y.end(), sums_y.begin(), sums_y.end());
}

MomentExtractor::MomentExtractor(const CameraIntrinsics& intrinsics, const VisionConfig& config)
    : config_(config),
      segmentation_(config),
      builder_(config.order, config.asymmetry_threshold, config.orientation_threshold),
      edge_step_(std::make_unique<EdgeStep>()),
      mask_(&nothing_) {
  setIntrinsics(intrinsics);
}

MomentExtractor::~MomentExtractor() = default;

void MomentExtractor::setIntrinsics(const CameraIntrinsics& intrinsics) {
  const bool same_size = map_ && map_->width() == intrinsics.width() && map_->height() == intrinsics.height();
  map_ = std::make_unique<PixelMap>(intrinsics, config_.rays);
  segmentation_.setMap(*map_);
  accumulator_ = std::make_unique<MomentAccumulator>(*map_, config_.order);
  if (config_.kernel) kernel_ = std::make_unique<KernelProjection>(*map_, config_.kernel->p, config_.kernel->q);
  if (config_.depth) depths_ = std::make_unique<DepthReader>(*map_, *config_.depth);
  if (config_.points != PointSource::kNone) {
    auto points = std::make_unique<PointFeatures>(config_, *map_);
    if (points_) points->takeReference(*points_);
    points_ = std::move(points);
  }
  // Features of the last images are in normalised coordinates; what is followed by its pixels is not.
  if (!same_size) followAnew();
  mask_ = &nothing_;
  nothing_.width_px = intrinsics.width();
  nothing_.height_px = intrinsics.height();
  features_ = builder_.build({false, false, 0}, {});
}

const MomentFeatures& MomentExtractor::process(const ImageView& image, std::int64_t stamp_ns, const DepthView* depth) {
  requireSize(image, map_->intrinsics());
  mask_ = &segmentation_.process(image);
  if (points_) mask_ = &points_->find(*mask_, segmentation_.objects());
  const std::vector<double>& m = accumulator_->process(*mask_);
  const bool cut = mask_->touches_border || accumulator_->leftTheLens();
  const int hard_area_px = mask_->soft_edges ? 0 : mask_->area_px;
  const bool beyond = config_.rays && accumulator_->leftTheLens();  // no moments, but the points may have rays
  features_ = builder_.build({mask_->visible && !beyond, cut, mask_->components, mask_->ambiguous, hard_area_px}, m);
  if (beyond) {
    features_.target_visible = mask_->visible;
    features_.touches_border = mask_->touches_border;
  }
  if (points_) points_->write(builder_.reference(), &features_);
  if (depths_) {
    features_.depth_fault = depths_->fault(depth);
    for (std::size_t k = 0; features_.depth_fault.empty() && k < features_.point_x.size(); ++k)
      features_.point_z.push_back(depths_->at(*depth, features_.point_x[k], features_.point_y[k], mask_));
  }
  if (kernel_) kernel_->write(*mask_, &features_);
  const int objects = config_.points == PointSource::kBlobs ? static_cast<int>(segmentation_.objects().size()) : 1;
  features_.edge_stddev = edge_step_->process(*mask_, objects) / map_->intrinsics().fx();
  features_.reference_stamp_ns = reference_stamp_ns_;
  if (stamp_ns != kNoStamp) last_views_.add(stamp_ns) = features_;
  return features_;
}

void MomentExtractor::teach(std::int64_t stamp_ns, double z_star_m) {
  setReference(z_star_m, last_views_.at(stamp_ns));
  reference_stamp_ns_ = stamp_ns;
}

void MomentExtractor::setReference(double z_star_m, const MomentFeatures& features) {
  if (points_ && features.valid) points_->check(features);
  if (features.valid && config_.rays && !(features.area > 0.0)) {
    builder_.setReference(Reference{z_star_m, 1.0, 0.0});  // of a view that has no moments
    segmentation_.clearReferenceShape();
  } else {
    builder_.setReference(z_star_m, features);
    segmentation_.setReferenceShape(features.area, features.mu);
  }
  reference_stamp_ns_ = kNoStamp;
  if (points_) points_->setReference(features);
}

void MomentExtractor::setReference(double z_star_m, double area_star, double alpha_star) {
  builder_.setReference({z_star_m, area_star, alpha_star});
  reference_stamp_ns_ = kNoStamp;
  segmentation_.clearReferenceShape();
  if (points_) points_->clearReference();
}

void MomentExtractor::clearReference() {
  builder_.clearReference();
  reference_stamp_ns_ = kNoStamp;
  segmentation_.clearReferenceShape();
  if (points_) points_->clearReference();
}

void MomentExtractor::forgetPrevious() {
  edge_step_->forget();
  followAnew();
  last_views_.clear();
}

void MomentExtractor::followAnew() {
  segmentation_.forgetPrevious();
  builder_.forgetPrevious();
  if (points_) points_->forgetPrevious();
}

}  // namespace aras_visual_servo_camera
