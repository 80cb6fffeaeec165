#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "aras_visual_servo_camera/segmentation/segmentation.hpp"
#include "segmentation/components.hpp"

namespace aras_visual_servo_camera {

/** Coverage weights of one component: which pixels lie wholly inside, and how much of each edge pixel it covers.
 *
 *  Edge pixels are those within two pixels (chessboard distance) of the half-coverage contour, on either side: enough
 *  for the corners of an anti-aliased polygon and for the blur of a lens; noise further away counts on neither side.
 *  Those next to the contour have their weight as it is, below 0 or above 1 where noise says so: to clip it there would
 *  move the edge, by an amount that depends on where in its pixel it runs. The others are wholly inside or outside in
 *  most images, and count as that when noise alone could tell them from it. */
class EdgeWeights {
 public:
  /** Appends to mask->spans and mask->edge, sorted by row, and sets mask->grey_step.
   *  @param levels  those that are estimated are taken anew from the pixels beside the contour, since light falls off
   *  towards the border of most images */
  void process(const std::uint8_t* grey, std::size_t step, int width, int height, const ComponentFinder& finder,
               int chosen, GreyLevels levels, ObjectMask* mask);

 private:
  /** Rows of bits, a column each; the first and the last word of a row are empty, so that windows may reach out. */
  using Bits = std::vector<std::uint64_t>;

  void paint(const ComponentFinder& finder, int chosen);
  void replicateAtImageBorder(int width, int height);
  /** Windows of three and five columns over every row of own_. */
  void widen();
  /** Windows of rows: sets inside_, edge_ and next_ for one row. */
  void classify(int row);
  /** @param rows  the row and those above and below it, at the border of the image the row itself in their place */
  void emitRow(const std::array<const std::uint8_t*, 3>& rows, int v, const double* weight_of_grey, ObjectMask* mask);
  void forgetNoiseAwayFromContour(ObjectMask* mask);
  /** The mean greys of the pixels wholly inside and of those two pixels outside the contour, in place of the levels
   * that are estimated. */
  GreyLevels besideContour(const std::uint8_t* grey, std::size_t step, int width, int height, GreyLevels levels);

  std::uint64_t* at(Bits& bits, int row) const { return bits.data() + static_cast<std::ptrdiff_t>(row) * words_; }
  const std::uint64_t* at(const Bits& bits, int row) const {
    return bits.data() + static_cast<std::ptrdiff_t>(row) * words_;
  }

  // The component's box, widened by two margins: rows_ rows of stride_ columns, words_ words each.
  int u0_ = 0, v0_ = 0, rows_ = 0, stride_ = 0, words_ = 0;
  bool others_in_box_ = false;
  std::vector<std::size_t> away_;  // places in mask->edge of the pixels that are not next to the contour
  std::vector<double> faint_;      // how far the weights of such pixels are from 0 or 1, where they are
  std::size_t sure_ = 0;           // number of such pixels whose weight is 0 or 1
  Bits own_, other_;
  Bits any3_, all3_, any5_, all5_;  // whether any, or all, of a window along the row are own
  Bits inside_, edge_, next_;       // of one row: wholly inside; of the edge; next to the contour
};

/** A point of a pixel, from its centre, -1/2 to 1/2 [px]. */
struct PixelPoint {
  double u = 0.0, v = 0.0;
};

/** Centroid of the part of a pixel that an object covers, where its edge is a straight line through the pixel (T63).
 *
 *  The line lies across the gradient of the coverage, where the covered area is the pixel's weight.
 *  @param weight  covered area, 0 to 1 [px^2]
 *  @param gradient_u, gradient_v  direction in which the coverage grows, of any length
 *  @return the centre of the pixel where the weight is 0 or 1 or there is no gradient */
PixelPoint centroidOfCoveredPart(double weight, double gradient_u, double gradient_v);

}  // namespace aras_visual_servo_camera
