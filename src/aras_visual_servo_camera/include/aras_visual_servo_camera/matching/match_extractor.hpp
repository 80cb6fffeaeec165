#pragma once

#include <functional>
#include <memory>

#include "aras_visual_servo_camera/config/vision_config.hpp"
#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "aras_visual_servo_camera/image/image_view.hpp"
#include "aras_visual_servo_camera/image/last_views.hpp"
#include "aras_visual_servo_camera/matching/match_features.hpp"

namespace aras_visual_servo_camera {

/** Keypoints of an image matched to those of the goal image: four points of a textured plane, and its homography.
 *
 *  With MatchingConfig::depth the scene may have any shape: the keypoints have depths, and the motion of the camera is
 *  found in space. The four points then lie in a plane parallel to the goal image, at the median depth of its
 * keypoints.
 *
 *  What is followed are four points of the goal's plane, which the homography puts into each image, so that a point
 * keeps its number whichever keypoints are found. No state is carried from image to image: a view is matched as well
 * after an outage as before. Not thread-safe; same images, same bits, with any number of cores: see KeypointFinder.
 *
 *  References: D. Lowe, IJCV 60(2), 2004 (SIFT and the ratio test); E. Rublee et al., ICCV 2011 (ORB); P. Alcantarilla,
 *  J. Nuevo, A. Bartoli, BMVC 2013 (AKAZE); M. Fischler, R. Bolles, CACM 24(6), 1981 (RANSAC). */
class MatchExtractor {
 public:
  MatchExtractor(const CameraIntrinsics& intrinsics, const MatchingConfig& config);
  ~MatchExtractor();

  /** @param stamp_ns  of the image; with one it can be taught while it is among the last (LastViews)
   *  @param depth  depth image of the same stamp, for MatchingConfig::depth; null: there is none
   *  @throws ShapeError if the image is not the size of the intrinsics */
  const MatchFeatures& process(const ImageView& image, std::int64_t stamp_ns = kNoStamp,
                               const DepthView* depth = nullptr);

  /** Make the image of this stamp the goal, its optical axis meeting the target's plane at depth z_star_m.
   *  @throws ParameterError if it is not among the last images; else as setReference() */
  void teach(std::int64_t stamp_ns, double z_star_m);

  /** Make an image the goal. When this throws the goal is what it was.
   *  @throws DegenerateFeature if it has fewer keypoints than MatchingConfig::min_matches; ParameterError unless
   * z_star_m is finite and > 0; ShapeError as process() */
  void setReference(const ImageView& image, double z_star_m, const DepthView* depth = nullptr);
  void clearReference();

  /** Returns a function that makes the present goal, or none, the goal again. It must not outlive this. */
  std::function<void()> undo();

  /** Take a camera with another lens, zoom or size. The goal stays: its keypoints are in normalised coordinates. */
  void setIntrinsics(const CameraIntrinsics& intrinsics);
  const CameraIntrinsics& intrinsics() const;

  /** Features of the last image. Before the first image nothing is in view. */
  const MatchFeatures& features() const { return features_; }

 private:
  struct Goal;
  struct Work;
  void match(MatchFeatures* features) const;
  void matchInSpace(MatchFeatures* features) const;

  MatchingConfig config_;
  std::unique_ptr<Work> work_;
  MatchFeatures features_;
};

}  // namespace aras_visual_servo_camera
