#pragma once

#include <Eigen/Core>
#include <vector>

#include "aras_visual_servo_sim/scene/mesh_loader.hpp"

namespace aras_visual_servo_sim {

/** Means of a mesh's picture over polygons.
 *
 *  A texel is a square of one colour. The integral of the texels over a polygon is, by Green's theorem, that of their
 *  running sums along its edges. Where the polygon covers many rows of texels, rows are merged first (Texture::Level)
 * so that at least kRows remain. Beyond the picture's edges the polygon is cut into the pictures that repeat it. */
class TextureArea {
 public:
  /** Mean colour, 0 .. 255.
   *  @param polygon  convex, in texels: s to the right, t down, the picture reaching from 0 to its width and height;
   *                  changed */
  Eigen::Vector3d mean(const MeshPicture& picture, std::vector<Eigen::Vector2d>& polygon);

  /** Keeps the part of a polygon where normal . point >= limit. */
  void clip(std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& normal, double limit);

  /** Colour of the texel at a point. */
  static Eigen::Vector3d at(const MeshPicture& picture, const Eigen::Vector2d& point);

 private:
  static constexpr int kRows = 4;
  static constexpr int kMostCells = 64;  ///< repetitions of the picture in one polygon; beyond: the picture's mean

  void keepCell(std::vector<Eigen::Vector2d>& polygon, int axis, double size, int index, int first, int last);
  Eigen::Vector3d meanOfCell(const MeshPicture& picture, double area, const Eigen::Array2i& index);

  std::vector<Eigen::Vector2d> column_, cell_, scratch_;
};

}  // namespace aras_visual_servo_sim
