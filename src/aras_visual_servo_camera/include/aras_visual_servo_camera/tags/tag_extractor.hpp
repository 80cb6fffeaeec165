#pragma once

#include <functional>
#include <memory>

#include "aras_visual_servo_camera/config/vision_config.hpp"
#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "aras_visual_servo_camera/image/image_view.hpp"
#include "aras_visual_servo_camera/image/last_views.hpp"
#include "aras_visual_servo_camera/tags/tag_features.hpp"

namespace aras_visual_servo_camera {

/** Finds one AprilTag in an image: its corners, its homography from the goal image and, if its size is known, its pose.
 *
 *  No state is carried from image to image. A tag that is not wholly in view, is seen from behind or is too small is
 * not found, which is a value with a reason. Not thread-safe; same images, same bits.
 *
 *  References: J. Wang, E. Olson, "AprilTag 2: Efficient and robust fiducial detection", IROS 2016; the detector is
 * that of ViSP. T. Collins, A. Bartoli, "Infinitesimal plane-based pose estimation", IJCV 109(3), 2014 (OpenCV's). */
class TagExtractor {
 public:
  TagExtractor(const CameraIntrinsics& intrinsics, const TagConfig& config);
  ~TagExtractor();

  /** @param stamp_ns  of the image; with one it can be taught while it is among the last (LastViews)
   *  @throws ShapeError if the image is not the size of the intrinsics */
  const TagFeatures& process(const ImageView& image, std::int64_t stamp_ns = kNoStamp);

  /** Make the image of this stamp the goal, its optical axis meeting the tag's plane at depth z_star_m.
   *  @throws ParameterError if it is not among the last images; else as setReference() */
  void teach(std::int64_t stamp_ns, double z_star_m);

  /** Make an image the goal. When this throws the goal is what it was.
   *  @throws DegenerateFeature if the tag is not found in it; ParameterError unless z_star_m is finite and > 0;
   *          ShapeError as process() */
  void setReference(const ImageView& image, double z_star_m);
  void clearReference();

  /** Returns a function that makes the present goal, or none, the goal again. It must not outlive this. */
  std::function<void()> undo();

  /** Take a camera with another lens, zoom or size. The goal stays: its corners are in normalised coordinates. */
  void setIntrinsics(const CameraIntrinsics& intrinsics);
  const CameraIntrinsics& intrinsics() const;

  /** Features of the last image. Before the first image nothing is in view. */
  const TagFeatures& features() const { return features_; }

 private:
  struct Work;

  TagConfig config_;
  std::unique_ptr<Work> work_;
  TagFeatures features_;
};

}  // namespace aras_visual_servo_camera
