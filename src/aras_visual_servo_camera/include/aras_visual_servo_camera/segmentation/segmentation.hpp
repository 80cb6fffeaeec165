#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "aras_visual_servo_camera/config/vision_config.hpp"
#include "aras_visual_servo_camera/image/image_view.hpp"
#include "aras_visual_servo_camera/image/object_mask.hpp"
#include "aras_visual_servo_camera/image/pixel_map.hpp"

namespace aras_visual_servo_camera {

/** Finds the object in an image.
 *
 *  One scan classifies pixels as runs, a union of touching runs (8 neighbours) gives the components. With coverage
 *  weighting, pixels further than two from the edge weigh 1, pixels within two of it weigh
 *  (background - grey) / (background - object) clipped to [0, 1], all others and those of other objects weigh 0.
 *  Deterministic: integer arithmetic up to the weights, no threads. Buffers are kept between calls. */
class Segmentation {
 public:
  explicit Segmentation(const VisionConfig& config);
  ~Segmentation();

  /** @return the object; valid until the next call. @throws ShapeError if the view has no pixels */
  const ObjectMask& process(const ImageView& image);

  /** Pixels without a ray in the map belong neither to an object nor to the background. Until this is called all have
   * one.
   *  @pre images of the map's size from now on */
  void setMap(const PixelMap& map);

  /** Value of 16 bits that counts as white in the last image of such values; 0 before there was one. */
  int white() const;

  /** With points = blobs: every object of the last image that passes the area filter, from the top left; else empty. */
  const std::vector<ObjectMask>& objects() const;

  /** Forget the followed object: the next image is treated as the first one. The reference's shape stays. */
  void forgetPrevious();

  /** Shape that `most_similar` looks for: area and centred moments to order 3 of the reference view. */
  void setReferenceShape(double m00, const std::vector<double>& mu);
  /** Until there is a reference shape, `most_similar` chooses the largest object. */
  void clearReferenceShape();

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

/** Counts the pixels of each grey. @param grey  rows of width_px bytes, each step_bytes after the one before */
std::array<int, 256> countGreys(const std::uint8_t* grey, int width_px, int height_px, std::size_t step_bytes);

/** Grey levels of object and background. */
struct GreyLevels {
  double object, background;
  bool object_estimated = false, background_estimated = false;  ///< from the image, else given
};

/** The two levels of an image of one object before one background, whatever their share of the image.
 *
 *  The robust extremes (leaving out min_area_px / 2 pixels at each end) start a two-class split at their middle; the
 *  level of a class is the mean around its most frequent value, the split is repeated until it stands still.
 *  @return nothing if the levels are closer than min_contrast or the classes are one noisy level */
std::optional<GreyLevels> estimateGreyLevels(const std::array<int, 256>& histogram, ObjectShade object, int min_area_px,
                                             double min_contrast);

/** Otsu's threshold: pixels <= the result are the dark class. @return nothing for an image of one level */
std::optional<int> otsuThreshold(const std::array<int, 256>& histogram);

}  // namespace aras_visual_servo_camera
