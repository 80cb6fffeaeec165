#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"

#include "aras_visual_servo_camera/config/errors.hpp"
#include "image/depth_reader.hpp"
#include "image/grey_image.hpp"
#include "moments/kernel_projection.hpp"
#include "points/point_features.hpp"

namespace aras_visual_servo_camera {

MomentExtractor::MomentExtractor(const CameraIntrinsics& intrinsics, const VisionConfig& config)
    : config_(config),
      segmentation_(config),
      builder_(config.order, config.asymmetry_threshold, config.orientation_threshold),
      mask_(&nothing_) {
  setIntrinsics(intrinsics);
}

MomentExtractor::~MomentExtractor() = default;

void MomentExtractor::setIntrinsics(const CameraIntrinsics& intrinsics) {
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
  forgetPrevious();
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
  segmentation_.forgetPrevious();
  builder_.forgetPrevious();
  if (points_) points_->forgetPrevious();
  last_views_.clear();
}

}  // namespace aras_visual_servo_camera
