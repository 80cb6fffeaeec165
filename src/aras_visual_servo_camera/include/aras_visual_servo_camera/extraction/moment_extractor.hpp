#pragma once

#include <memory>

#include "aras_visual_servo_camera/image/image_view.hpp"
#include "aras_visual_servo_camera/image/pixel_map.hpp"
#include "aras_visual_servo_camera/moments/moment_features.hpp"
#include "aras_visual_servo_camera/moments/moments.hpp"
#include "aras_visual_servo_camera/segmentation/segmentation.hpp"

namespace aras_visual_servo_camera {

class KernelProjection;
class PointFeatures;

/** Image in, features out: segmentation, moments, features. Not thread-safe; same images, same bits. */
class MomentExtractor {
 public:
  MomentExtractor(const CameraIntrinsics& intrinsics, const VisionConfig& config);
  ~MomentExtractor();

  /** @throws ShapeError if the image is not the size of the intrinsics */
  const MomentFeatures& process(const ImageView& image);

  /** Of the last image; not visible before the first one. */
  const MomentFeatures& features() const { return features_; }
  const ObjectMask& mask() const { return *mask_; }

  /** See FeatureBuilder. Points keep the order of the view; numbers alone say nothing of points.
   *  @throws ShapeError if the view does not have the configured number of points */
  void setReference(double z_star_m, const MomentFeatures& features);
  void setReference(double z_star_m, double area_star, double alpha_star);
  void clearReference();
  const std::optional<Reference>& reference() const { return builder_.reference(); }

  /** Another lens, zoom or size; the reference stays. */
  void setIntrinsics(const CameraIntrinsics& intrinsics);
  const CameraIntrinsics& intrinsics() const { return map_->intrinsics(); }

  /** Time was set back or images are missing: nothing of earlier images is used any more, the reference stays. */
  void forgetPrevious();

  /** Features of the last image, made anew with the reference as it is now. */
  MomentFeatures rebuildFeatures();

 private:
  VisionConfig config_;
  std::unique_ptr<PixelMap> map_;
  std::unique_ptr<MomentAccumulator> accumulator_;
  Segmentation segmentation_;
  FeatureBuilder builder_;
  std::unique_ptr<KernelProjection> kernel_;
  std::unique_ptr<PointFeatures> points_;  // none: nothing is spent on points
  MomentFeatures features_;
  ObjectMask nothing_;
  const ObjectMask* mask_;
};

}  // namespace aras_visual_servo_camera
