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
  /** Appends to mask->spans and mask->edge, sorted by row. */
  void process(const std::uint8_t* grey, std::size_t step, int width, int height, const ComponentFinder& finder,
               int chosen, const GreyLevels& levels, ObjectMask* mask);

 private:
  void paint(const ComponentFinder& finder, int chosen);
  void replicateAtImageBorder(int width, int height);
  void growAndShrink();
  bool belongsToAnother(int row, int col) const;
  bool isNextToContour(int row, int col) const;
  /** @param rows  the row and those above and below it, at the border of the image the row itself in their place */
  void emitRow(const std::array<const std::uint8_t*, 3>& rows, int v, const double* weight_of_grey, ObjectMask* mask);
  void forgetNoiseAwayFromContour(ObjectMask* mask);

  std::uint8_t* at(std::vector<std::uint8_t>& buffer, int row) const { return buffer.data() + row * stride_; }
  const std::uint8_t* at(const std::vector<std::uint8_t>& buffer, int row) const {
    return buffer.data() + row * stride_;
  }

  // Buffers cover the component's box, widened by two margins; rows_ x stride_ bytes of 0 or 1.
  int u0_ = 0, v0_ = 0, rows_ = 0, stride_ = 0;
  bool others_in_box_ = false;
  std::vector<std::size_t> away_;  // places in mask->edge of the pixels that are not next to the contour
  std::vector<double> faint_;      // how far their weights are from 0 or 1
  std::vector<std::uint8_t> own_, other_, row_or_, row_and_, inside_, edge_;
};

}  // namespace aras_visual_servo_camera
