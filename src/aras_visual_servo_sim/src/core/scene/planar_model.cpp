#include "aras_visual_servo_sim/scene/planar_model.hpp"

#include <algorithm>
#include <numeric>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

using Point = Eigen::Vector2d;

/** Twice the area of triangle abc, positive when counter-clockwise. */
double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/** Whether c, known to be on the line through a and b, lies between them. */
bool between(const Point& a, const Point& b, const Point& c) { return (c - a).dot(c - b) <= 0.0; }

bool segmentsMeet(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (((abc > 0) != (abd > 0)) && ((cda > 0) != (cdb > 0)) && abc != 0 && abd != 0 && cda != 0 && cdb != 0) return true;
  return (abc == 0 && between(a, b, c)) || (abd == 0 && between(a, b, d)) || (cda == 0 && between(c, d, a)) ||
         (cdb == 0 && between(c, d, b));
}

bool inside(const Point& a, const Point& b, const Point& c, const Point& p) {
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

/** Area of a closed polygon, positive when counter-clockwise (x right, y up). */
double signedArea(const std::vector<Point>& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    twice += polygon[j].x() * polygon[i].y() - polygon[i].x() * polygon[j].y();
  }
  return 0.5 * twice;
}

/** Whether two edges that are not neighbours meet. */
bool crossesItself(const std::vector<Point>& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours
      if (segmentsMeet(polygon[i], polygon[i + 1], polygon[j], polygon[(j + 1) % n])) return true;
    }
  }
  return false;
}

/** Cuts a simple counter-clockwise polygon into triangles by clipping ears; corners on a straight edge are allowed. */
std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<Point>& polygon) {
  std::vector<std::uint32_t> rest(polygon.size());
  std::iota(rest.begin(), rest.end(), 0u);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto isEar = [&](std::size_t i) {
    const std::size_t n = rest.size();
    const std::uint32_t a = rest[(i + n - 1) % n], b = rest[i], c = rest[(i + 1) % n];
    if (turn(polygon[a], polygon[b], polygon[c]) <= 0.0) return false;
    return std::none_of(rest.begin(), rest.end(), [&](std::uint32_t k) {
      return k != a && k != b && k != c && inside(polygon[a], polygon[b], polygon[c], polygon[k]);
    });
  };
  while (rest.size() > 3) {
    const std::size_t n = rest.size();
    std::size_t ear = 0;
    while (ear < n && !isEar(ear)) ++ear;
    if (ear == n) {  // only corners on straight edges are left: drop the flattest, it covers nothing
      const auto flatness = [&](std::size_t i) {
        return std::abs(turn(polygon[rest[(i + n - 1) % n]], polygon[rest[i]], polygon[rest[(i + 1) % n]]));
      };
      ear = 0;
      for (std::size_t i = 1; i < n; ++i) {
        if (flatness(i) < flatness(ear)) ear = i;
      }
    }
    triangles.push_back({rest[(ear + n - 1) % n], rest[ear], rest[(ear + 1) % n]});
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  triangles.push_back({rest[0], rest[1], rest[2]});
  return triangles;
}

}  // namespace

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
