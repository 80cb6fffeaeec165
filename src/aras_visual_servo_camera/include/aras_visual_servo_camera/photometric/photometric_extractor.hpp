#pragma once

#include <functional>
#include <memory>

#include "aras_visual_servo_camera/config/vision_config.hpp"
#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "aras_visual_servo_camera/image/image_view.hpp"
#include "aras_visual_servo_camera/image/last_views.hpp"
#include "aras_visual_servo_camera/photometric/photometric_features.hpp"

namespace aras_visual_servo_camera {

/** (A, B, C) of a plane 1/Z = A x + B y + C in the camera frame [1/m]. */
struct Plane {
  double A, B, C;
};

/** The plane with this normal (any length, z > 0) that the optical axis meets at depth z_star_m.
 *  @throws ParameterError unless z_star_m is finite and > 0 */
Plane planeAt(double z_star_m, const Eigen::Vector3d& normal_C);

/** The luminance of all pixels as the feature: an image goes in, H and b of the normal equations come out.
 *
 *  With L = -(grad I)^T L_x for each pixel (Collewet and Marchand, IEEE T-RO 27(4), 2011; L_x is that of the point of
 * the plane seen there) and e = I - I*: H = L^T L and b = L^T e, so that the twist -H^-1 b lowers |e|^2 the fastest way
 * to first order, and to second order with the mean of both gradients (Malis, ICRA 2004). The depth is that of the
 * plane in the reference view. Lens distortion enters through the ray of each pixel and its derivative: nothing is
 * resampled.
 *
 *  With several levels an image is looked at from coarse to fine, anew each time: the level that is reported is the
 * first whose step still moves the image by switch_px of its own pixels or more, or else the finest. No state is
 * carried from image to image. Not thread-safe; same images, same bits. */
class PhotometricExtractor {
 public:
  /** @throws ParameterError if no pixel of the coarsest level is left inside the border */
  PhotometricExtractor(const CameraIntrinsics& intrinsics, const PhotometricConfig& config);
  ~PhotometricExtractor();

  /** @param stamp_ns  of the image; with one it can be taught while it is among the last (LastViews), its grey levels
   *      are kept
   *  @throws ShapeError if the image is not the size of the intrinsics */
  const PhotometricFeatures& process(const ImageView& image, std::int64_t stamp_ns = kNoStamp);

  /** Make the image of this stamp the reference, its plane at depth z_star_m.
   *  @throws ParameterError if it is not among the last images; else as setReference() */
  void teach(std::int64_t stamp_ns, double z_star_m);

  /** Make an image of the target's plane the reference. When this throws the reference is what it was.
   *  @throws DegenerateFeature if the image has too little texture to tell six motions apart; ParameterError unless the
   * plane lies in front of every pixel used; ShapeError as process() */
  void setReference(const ImageView& image, const Plane& plane);
  /** The plane with the normal of the configuration at depth z_star_m. */
  void setReference(const ImageView& image, double z_star_m);
  void clearReference();

  /** Returns a function that makes the present reference, or none, the reference again. It must not outlive this. */
  std::function<void()> undo();

  /** Take a camera with another lens, zoom or size. The reference's image is drawn for it. Where it shows too little of
   * what the camera sees, or its pixels are much larger or smaller, features say so and are not valid, until the
   * camera is as before or another reference is taught. */
  void setIntrinsics(const CameraIntrinsics& intrinsics);
  const CameraIntrinsics& intrinsics() const;

  /** Features of the last image. Before the first image nothing is in view. */
  const PhotometricFeatures& features() const { return features_; }

 private:
  struct View;
  struct Goal;
  struct Work;
  void setGoal(const View& view, const Plane& plane, std::int64_t stamp_ns);

  PhotometricConfig config_;
  std::unique_ptr<Work> work_;
  PhotometricFeatures features_;
};

}  // namespace aras_visual_servo_camera
