#include "aras_visual_servo_sim/scene/planar_model.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "polygon.hpp"

namespace aras_visual_servo_sim {
namespace {

Polygon rectangle(const Eigen::Vector2d& size_m) {
  const Eigen::Vector2d half = 0.5 * size_m;
  return {{-half.x(), -half.y()}, {half.x(), -half.y()}, {half.x(), half.y()}, {-half.x(), half.y()}};
}

}  // namespace

PlanarModel::PlanarModel(std::string name, std::vector<Polygon> outlines, Rgb color, std::optional<Board> board,
                         std::optional<Picture> picture)
    : name_(std::move(name)),
      outlines_(std::move(outlines)),
      color_(color),
      board_(std::move(board)),
      picture_(std::move(picture)) {
  const auto fail = [this](const std::string& what) { throw ModelError("model '" + name_ + "': " + what); };
  if (outlines_.empty() && !board_ && !picture_) fail("found no outlines, board or image, needs one of them");
  for (std::size_t k = 0; k < outlines_.size(); ++k) {
    Polygon& outline = outlines_[k];
    const std::string which = "outline " + std::to_string(k) + ": ";
    if (outline.size() < 3) fail(which + "found " + std::to_string(outline.size()) + " corners, allowed 3 or more");
    for (const Eigen::Vector2d& corner : outline) {
      if (!corner.allFinite()) fail(which + "a corner is not finite");
      radius_ = std::max(radius_, corner.norm());
    }
    if (crossesItself(outline)) fail(which + "edges cross or touch, allowed simple polygons");
    const double area = signedArea(outline);
    if (area == 0.0) fail(which + "covers no area");
    if (area < 0.0) std::reverse(outline.begin(), outline.end());
    triangles_.push_back(triangulate(outline));
  }
  const auto addRectangle = [&](const char* which, const Eigen::Vector2d& size_m, Polygon& corners) {
    if (!size_m.allFinite() || !(size_m.minCoeff() > 0.0)) {
      fail(which + (": found size " + std::to_string(size_m.x()) + " x " + std::to_string(size_m.y())) +
           " m, allowed > 0");
    }
    radius_ = std::max(radius_, 0.5 * size_m.norm());
    corners = rectangle(size_m);
  };
  if (board_) addRectangle("board", board_->size_m, board_corners_);
  if (picture_) addRectangle("image", picture_->size_m, picture_corners_);
}

}  // namespace aras_visual_servo_sim
