#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/image/image.hpp"
#include "aras_visual_servo_sim/image/texture.hpp"

namespace aras_visual_servo_sim {

using Polygon = std::vector<Eigen::Vector2d>;  ///< corners [m] in the plane z = 0 of a model frame

/** Flat polygons of one colour, or a picture, drawn unlit: the pixel values are exactly these colours.
 *
 *  Model frame M: z = 0 is the plane, +z the face meant to be seen, outlines counter-clockwise seen from +z. The
 * picture, if there is one, is a rectangle behind the outlines centred at the origin, its top at +y and its right at
 * +x; the board is a rectangle behind both. Both sides are drawn; from behind the board hides the picture, and the
 * picture the outlines. The shape never changes, the pose may. */
class PlanarModel {
 public:
  struct Board {
    Eigen::Vector2d size_m{0.0, 0.0};
    Rgb color;
  };
  struct Picture {
    TexturePtr texture;  ///< never null
    Eigen::Vector2d size_m{0.0, 0.0};
  };

  /** @param outlines  simple polygons that do not overlap each other; clockwise ones are turned round
   *  @throws ModelError naming the model: no outline, no board and no picture, fewer than three corners, a corner
   *          that is not finite, no area, edges that cross each other, board or picture not > 0 */
  PlanarModel(std::string name, std::vector<Polygon> outlines, Rgb color, std::optional<Board> board = std::nullopt,
              std::optional<Picture> picture = std::nullopt);

  const std::string& name() const { return name_; }
  const std::vector<Polygon>& outlines() const { return outlines_; }
  Rgb color() const { return color_; }
  const std::optional<Board>& board() const { return board_; }
  const std::optional<Picture>& picture() const { return picture_; }
  /** Triangles of outline k, as indices of its corners, counter-clockwise. */
  const std::vector<std::array<std::uint32_t, 3>>& triangles(std::size_t k) const { return triangles_[k]; }
  /** Radius about the origin of M that holds everything [m]. */
  double radius() const { return radius_; }
  /** Corners of the board, counter-clockwise seen from +z. @pre board() */
  const Polygon& boardCorners() const { return board_corners_; }
  /** The same of the picture. @pre picture() */
  const Polygon& pictureCorners() const { return picture_corners_; }

  Pose X_WM;            ///< pose of the model in the world
  std::string carrier;  ///< link of the robot that carries it; empty: none
  Pose X_LM;            ///< where it is on that link
  bool visible = true;

 private:
  std::string name_;
  std::vector<Polygon> outlines_;
  Rgb color_;
  std::optional<Board> board_;
  std::optional<Picture> picture_;
  Polygon board_corners_, picture_corners_;
  std::vector<std::vector<std::array<std::uint32_t, 3>>> triangles_;
  double radius_ = 0.0;
};

}  // namespace aras_visual_servo_sim
