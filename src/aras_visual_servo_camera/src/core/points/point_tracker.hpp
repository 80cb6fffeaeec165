#pragma once

#include <optional>
#include <vector>

namespace aras_visual_servo_camera {

/** A point in normalised image coordinates [-]. */
struct ImagePoint {
  double x, y;
};

/** Finds out which point is which: keeps points in the order of the reference view, from image to image.
 *
 *  A point is the one next to where it was in the last image, as long as no point has moved more than half the distance
 *  between two of them. Otherwise, and in the first image, the points are laid over the reference's by rotation,
 *  scale and shift, and the best fit is taken. Where several fits are equally good (a symmetric pattern), the one whose
 *  rotation is nearest to `expected_turn_rad` is taken; where two are equally near, none is (docs/theory.md T37). */
class PointTracker {
 public:
  /** @param cyclic  the points come in their order around an outline, clockwise: only the first one is unknown */
  PointTracker(int count, bool cyclic) : count_(static_cast<std::size_t>(count)), cyclic_(cyclic) {}

  /** @param found  points of one image; more than `count` if not cyclic, when there is a reference
   *  @param expected_turn_rad  rotation from the reference view to this one, as far as it is known
   *  @return indices into `found`, in the order of the reference; without a reference clockwise on the screen from the
   *      top left one; empty where it is not clear which is which */
  std::vector<int> match(const std::vector<ImagePoint>& found, double expected_turn_rad);

  /** Points of the reference view in the order that later ones keep; none: there is none. They count as last seen. */
  void setReference(const std::vector<ImagePoint>& points);
  bool hasReference() const { return !reference_.empty(); }
  void forgetPrevious() { previous_.clear(); }

 private:
  struct Fit {
    std::vector<int> indices;
    double residual, turn_rad;
  };

  std::vector<int> firstOrder(const std::vector<ImagePoint>& found) const;
  std::vector<int> nearestToPrevious(const std::vector<ImagePoint>& found) const;
  std::vector<Fit> cyclicFits(const std::vector<ImagePoint>& found) const;
  std::vector<Fit> patternFits(const std::vector<ImagePoint>& found) const;
  Fit fit(const std::vector<ImagePoint>& found, std::vector<int> indices) const;
  std::vector<int> best(const std::vector<Fit>& fits, double expected_turn_rad) const;

  std::size_t count_;
  bool cyclic_;
  std::vector<ImagePoint> reference_, previous_;
};

}  // namespace aras_visual_servo_camera
