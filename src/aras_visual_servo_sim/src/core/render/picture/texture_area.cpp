#include "texture_area.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "picture_window.hpp"
#include "render/view/pixel_box.hpp"

namespace aras_visual_servo_sim {
namespace {

using Points = std::vector<Eigen::Vector2d>;

double areaOf(const Points& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d a = polygon[j] - polygon[0], b = polygon[i] - polygon[0];
    twice += a.x() * b.y() - b.x() * a.y();
  }
  return 0.5 * twice;
}

/** Integrals of the running sums along edges within one level; all points lie on the picture. */
class RunningSums {
 public:
  RunningSums(const Texture::Level& level, int width) : level_(level), width_(width) {}

  /** Integral over dy, from a to b; y in rows of the level. */
  Eigen::Vector3d along(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
    const bool downwards = a.y() < b.y();
    const Eigen::Vector2d &from = downwards ? a : b, &to = downwards ? b : a;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    if (!(to.y() > from.y())) return sum;
    const double slope = (to.x() - from.x()) / (to.y() - from.y());
    double y0 = from.y(), x0 = from.x();
    for (int row = std::min(static_cast<int>(y0), level_.rows - 1); y0 < to.y(); ++row) {
      const double y1 = row + 1 >= level_.rows ? to.y() : std::min(to.y(), row + 1.0);
      const double x1 = from.x() + (y1 - from.y()) * slope;
      sum += (y1 - y0) * meanOf(row, std::min(x0, x1), std::max(x0, x1));
      y0 = y1;
      x0 = x1;
    }
    return downwards ? sum : Eigen::Vector3d(-sum);
  }

 private:
  /** Of the sums of a row over x0 .. x1: linear between texel edges, so the middle of each piece gives its mean. */
  Eigen::Vector3d meanOf(int row, double x0, double x1) const {
    constexpr int kMostPieces = 4;  // exact below, sampled above
    const int first = static_cast<int>(x0), last = static_cast<int>(x1);
    if (first == last) return at(row, 0.5 * (x0 + x1));
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    if (last - first >= kMostPieces) {
      for (int k = 0; k < kMostPieces; ++k) sum += at(row, x0 + (k + 0.5) / kMostPieces * (x1 - x0));
      return sum / kMostPieces;
    }
    double left = x0;
    for (int edge = first + 1; edge <= last; ++edge) {
      sum += (edge - left) * at(row, 0.5 * (left + edge));
      left = edge;
    }
    sum += (x1 - left) * at(row, 0.5 * (left + x1));
    return sum / (x1 - x0);
  }

  Eigen::Vector3d at(int row, double x) const {
    const int i = std::clamp(static_cast<int>(x), 0, width_ - 1);
    const std::int32_t* sum = level_.sums.data() + (std::size_t(row) * (width_ + 1) + i) * 3;
    const double part = x - i;
    return {sum[0] + part * (sum[3] - sum[0]), sum[1] + part * (sum[4] - sum[1]), sum[2] + part * (sum[5] - sum[2])};
  }

  const Texture::Level& level_;
  int width_;
};

/** Mean over a polygon that lies on the picture. */
Eigen::Vector3d meanInside(const Texture& texture, const Points& polygon, double area, int least_rows) {
  double low = polygon[0].y(), high = low;
  for (const Eigen::Vector2d& point : polygon) {
    low = std::min(low, point.y());
    high = std::max(high, point.y());
  }
  const std::vector<Texture::Level>& levels = texture.levels(3);
  std::size_t k = 0;
  while (k + 1 < levels.size() && high - low >= 2.0 * least_rows * double(1 << k)) ++k;
  const double merged = double(1 << k);
  const RunningSums sums(levels[k], texture.width());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const auto row = [merged](const Eigen::Vector2d& point) { return Eigen::Vector2d(point.x(), point.y() / merged); };
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    sum += sums.along(row(polygon[j]), row(polygon[i]));
  }
  return (sum / area).cwiseMax(0.0).cwiseMin(255.0);  // sums cover `merged` rows each, and so does a unit of y
}

}  // namespace

void TextureArea::clip(Points& polygon, const Eigen::Vector2d& normal, double limit) {
  scratch_.clear();
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const double before = normal.dot(polygon[j]) - limit, here = normal.dot(polygon[i]) - limit;
    if ((before >= 0.0) != (here >= 0.0)) {
      scratch_.push_back(polygon[j] + before / (before - here) * (polygon[i] - polygon[j]));
    }
    if (here >= 0.0) scratch_.push_back(polygon[i]);
  }
  polygon.swap(scratch_);
}

/** Keeps what lies between the limits of cell `index` of first .. last along an axis; the outer cells have no end. */
void TextureArea::keepCell(Points& polygon, int axis, double size, int index, int first, int last) {
  const Eigen::Vector2d normal = Eigen::Vector2d::Unit(axis);
  if (index > first) clip(polygon, normal, index * size);
  if (index < last) clip(polygon, -normal, -(index + 1) * size);
}

Eigen::Vector3d TextureArea::at(const MeshPicture& picture, const Eigen::Vector2d& point) {
  const std::uint8_t* rgb = picture.texture->texel(wrapped(picture.wrap_s, point.x(), picture.texture->width()),
                                                   wrapped(picture.wrap_t, point.y(), picture.texture->height()));
  return {double(rgb[0]), double(rgb[1]), double(rgb[2])};
}

Eigen::Vector3d TextureArea::mean(const MeshPicture& picture, std::vector<Eigen::Vector2d>& polygon) {
  const Texture& texture = *picture.texture;
  const Eigen::Array2d size(texture.width(), texture.height());
  const std::array<Wrap, 2> wraps{picture.wrap_s, picture.wrap_t};
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  Eigen::Array2d low = polygon[0], high = polygon[0];
  for (const Eigen::Vector2d& point : polygon) {
    middle += point / double(polygon.size());
    low = low.min(point.array());
    high = high.max(point.array());
  }
  const double area = areaOf(polygon);
  constexpr double kSliver = 1e-9;  // [texels^2]
  if (!(std::abs(area) > kSliver)) return at(picture, middle);
  // Cells of repetitions that the polygon touches; where the picture is held at its edge there are three: before, on
  // and after it.
  Eigen::Array2i first, last;
  for (int axis = 0; axis < 2; ++axis) {
    const bool clamp = wraps[axis] == Wrap::kClamp;
    constexpr double kFar = 1e6;
    const auto cell = [&](double x) {
      return static_cast<int>(held(std::floor(x / size[axis]), clamp ? -1.0 : -kFar, clamp ? 1.0 : kFar));
    };
    first[axis] = cell(low[axis]);
    last[axis] = std::max(first[axis], cell(high[axis]));
  }
  if (std::int64_t(last[0] - first[0] + 1) * (last[1] - first[1] + 1) > kMostCells) {
    const Rgb mean = texture.meanColor();
    return {double(mean.r), double(mean.g), double(mean.b)};
  }
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double covered = 0.0;
  for (int i = first[0]; i <= last[0]; ++i) {
    column_ = polygon;
    keepCell(column_, 0, size[0], i, first[0], last[0]);
    if (column_.size() < 3) continue;
    for (int j = first[1]; j <= last[1]; ++j) {
      cell_ = column_;
      keepCell(cell_, 1, size[1], j, first[1], last[1]);
      if (cell_.size() < 3) continue;
      const double share = areaOf(cell_);
      if (!(std::abs(share) > kSliver)) continue;
      covered += std::abs(share);
      sum += std::abs(share) * meanOfCell(picture, share, {i, j});
    }
  }
  return covered > 0.0 ? Eigen::Vector3d(sum / covered) : at(picture, middle);
}

/** Mean over cell_, which lies in one repetition of the picture. */
Eigen::Vector3d TextureArea::meanOfCell(const MeshPicture& picture, double area, const Eigen::Array2i& index) {
  const std::array<int, 2> size{picture.texture->width(), picture.texture->height()};
  const std::array<Wrap, 2> wraps{picture.wrap_s, picture.wrap_t};
  for (int axis = 0; axis < 2; ++axis) {
    if (wraps[axis] == Wrap::kClamp && index[axis] != 0) {  // texels of the edge, drawn out
      Eigen::Vector2d middle = Eigen::Vector2d::Zero();
      for (const Eigen::Vector2d& point : cell_) middle += point / double(cell_.size());
      return at(picture, middle);
    }
  }
  double turned = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    const bool mirrored = wraps[axis] == Wrap::kMirror && index[axis] % 2 != 0;
    if (mirrored) turned = -turned;
    for (Eigen::Vector2d& point : cell_) {
      double x = point[axis] - double(index[axis]) * size[axis];
      if (mirrored) x = size[axis] - x;
      point[axis] = held(x, 0.0, double(size[axis]));
    }
  }
  return meanInside(*picture.texture, cell_, turned * area, kRows);
}

}  // namespace aras_visual_servo_sim
