#pragma once

#include <optional>
#include <vector>

#include "aras_visual_servo_camera/config/vision_config.hpp"
#include "aras_visual_servo_camera/image/object_mask.hpp"
#include "aras_visual_servo_camera/image/pixel_map.hpp"
#include "aras_visual_servo_camera/moments/moment_features.hpp"
#include "aras_visual_servo_camera/moments/moments.hpp"
#include "points/corners.hpp"
#include "points/point_tracker.hpp"

namespace aras_visual_servo_camera {

/** Points of each image in the order of the reference view: corners of one object, or centroids of several. */
class PointFeatures {
 public:
  /** @param config  with points other than kNone. @param map  must outlive this */
  PointFeatures(const VisionConfig& config, const PixelMap& map);

  /** Finds the points of one image.
   *  @param objects  all that pass the area filter
   *  @return what the moments are of: the chosen object, or the objects followed, as one; then not visible unless every
   *      one was found */
  const ObjectMask& find(const ObjectMask& chosen, const std::vector<ObjectMask>& objects);

  /** Puts the points found, in their order, into the features of this image, which are valid only with them. */
  void write(const std::optional<Reference>& reference, MomentFeatures* features);

  /** @throws ShapeError, ParameterError: not `point_count` points, or not finite ones */
  void check(const MomentFeatures& features) const;
  /** Take the reference of a view that was checked before. */
  void setReference(const MomentFeatures& features);
  /** Take over the reference of another camera; points in normalised coordinates do not depend on lens and zoom. */
  void takeReference(const PointFeatures& other) { tracker_ = other.tracker_; }
  void clearReference() { tracker_.setReference({}); }
  void forgetPrevious() { tracker_.forgetPrevious(); }

 private:
  std::optional<CameraIntrinsics::Ray> middleRay(const ObjectMask& object) const;
  void findBlobs(const std::vector<ObjectMask>& objects);
  void unite(const ObjectMask& chosen, const std::vector<ObjectMask>& objects);

  const PixelMap& map_;
  bool with_rays_;
  PointSource source_;
  std::size_t count_;
  CornerFinder corners_;
  MomentAccumulator centroids_;
  PointTracker tracker_;
  std::vector<ImagePoint> found_;  // with rays: their places in the chart
  std::vector<CameraIntrinsics::Ray> rays_;
  std::vector<std::size_t> object_of_;  // blobs: which object each point is the centroid of
  ObjectMask together_;
};

}  // namespace aras_visual_servo_camera
