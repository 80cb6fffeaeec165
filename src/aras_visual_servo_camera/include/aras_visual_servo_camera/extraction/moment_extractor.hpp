#pragma once

#include <memory>

#include "aras_visual_servo_camera/image/image_view.hpp"
#include "aras_visual_servo_camera/image/last_views.hpp"
#include "aras_visual_servo_camera/image/pixel_map.hpp"
#include "aras_visual_servo_camera/moments/moment_features.hpp"
#include "aras_visual_servo_camera/moments/moments.hpp"
#include "aras_visual_servo_camera/segmentation/segmentation.hpp"

namespace aras_visual_servo_camera {

class DepthReader;
class EdgeStep;
class KernelProjection;
class PointFeatures;

/** Computes the features of an image: segmentation, moments, features. Not thread-safe. The same images give the same
 * bits. */
class MomentExtractor {
 public:
  MomentExtractor(const CameraIntrinsics& intrinsics, const VisionConfig& config);
  ~MomentExtractor();

  /** @param stamp_ns  of the image; with one it can be taught while it is among the last (LastViews)
   *  @param depth  depth image of the same stamp, for VisionConfig::depth; null: there is none
   *  @throws ShapeError if the image is not the size of the intrinsics */
  const MomentFeatures& process(const ImageView& image, std::int64_t stamp_ns = kNoStamp,
                                const DepthView* depth = nullptr);

  /** Features of the last image. Before the first image the target is not visible. */
  const MomentFeatures& features() const { return features_; }
  const ObjectMask& mask() const { return *mask_; }
  /** Value of 16 bits that counts as white in the last image of such values; 0 before there was one. It is the largest
   * value of 8, 10, 12, 14 or 16 bits, whichever are enough for the images so far. */
  int white() const { return segmentation_.white(); }

  /** Make the image of this stamp the reference, seen from depth z_star_m.
   *  @throws ParameterError if it is not among the last images; else as setReference() */
  void teach(std::int64_t stamp_ns, double z_star_m);
  /** See FeatureBuilder. Points keep the order of the view. A reference that is given as numbers has no points.
   *  @throws ShapeError if the view does not have the configured number of points */
  void setReference(double z_star_m, const MomentFeatures& features);
  void setReference(double z_star_m, double area_star, double alpha_star);
  void clearReference();
  const std::optional<Reference>& reference() const { return builder_.reference(); }

  /** Take a camera with another lens, zoom or size. The reference stays, and with the same size what is followed. */
  void setIntrinsics(const CameraIntrinsics& intrinsics);
  const CameraIntrinsics& intrinsics() const { return map_->intrinsics(); }

  /** Call this when time was set back or images are missing: earlier images are forgotten, the reference stays. */
  void forgetPrevious();

 private:
  void followAnew();

  VisionConfig config_;
  std::unique_ptr<PixelMap> map_;
  std::unique_ptr<MomentAccumulator> accumulator_;
  Segmentation segmentation_;
  FeatureBuilder builder_;
  std::unique_ptr<KernelProjection> kernel_;
  std::unique_ptr<PointFeatures> points_;  // null when no points are asked for
  std::unique_ptr<DepthReader> depths_;    // null when no depths are
  std::unique_ptr<EdgeStep> edge_step_;
  MomentFeatures features_;
  LastViews<MomentFeatures> last_views_;
  std::int64_t reference_stamp_ns_ = kNoStamp;
  ObjectMask nothing_;
  const ObjectMask* mask_;
};

}  // namespace aras_visual_servo_camera
