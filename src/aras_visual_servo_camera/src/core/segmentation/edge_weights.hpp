#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "aras_visual_servo_camera/segmentation/segmentation.hpp"
#include "segmentation/components.hpp"

namespace aras_visual_servo_camera {

/** Coverage weights of one component: which pixels lie wholly inside, and how much of each edge pixel it covers.
 *
 *  Edge pixels are those within two pixels (chessboard distance) of the half-coverage contour, on either side: enough
 * for the corners of an anti-aliased polygon and for the blur of a lens; noise further away counts on neither side. */
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
  void emitRow(const std::uint8_t* grey_row, int v, const double* weight_of_grey, ObjectMask* mask) const;

  std::uint8_t* at(std::vector<std::uint8_t>& buffer, int row) const { return buffer.data() + row * stride_; }
  const std::uint8_t* at(const std::vector<std::uint8_t>& buffer, int row) const {
    return buffer.data() + row * stride_;
  }

  // Buffers cover the component's box, widened by two margins; rows_ x stride_ bytes of 0 or 1.
  int u0_ = 0, v0_ = 0, rows_ = 0, stride_ = 0;
  bool others_in_box_ = false;
  std::vector<std::uint8_t> own_, other_, row_or_, row_and_, inside_, edge_;
};

}  // namespace aras_visual_servo_camera
