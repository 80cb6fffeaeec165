#include "coverage_rasterizer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "render/view/pixel_box.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kFarthest = 1e7;  // [px] corners beyond are drawn there

/** Coverage that changes no value of an image. */
template <typename Value>
constexpr float kNothing = 0.5f / 256.0f / static_cast<float>(kUnitsOf<Value>);

/** Blends colour over count pixels of channels values, with one coverage for all of them. */
template <int channels, typename Value>
void blendRun(Value* pixel, int count, float coverage, const std::array<Value, 3>& color) {
  if (coverage < kNothing<Value>) return;
  if (coverage > 1.0f - kNothing<Value>) {
    if (channels == 1 || (color[0] == color[1] && color[1] == color[2])) {
      std::fill_n(pixel, static_cast<std::size_t>(count) * channels, color[0]);
      return;
    }
    // The first pixel, then what is there already, twice as much each time.
    const std::size_t size = static_cast<std::size_t>(count) * channels;
    std::copy_n(color.data(), channels, pixel);
    for (std::size_t done = channels; done < size; done *= 2) {
      std::copy_n(pixel, std::min(done, size - done), pixel + done);
    }
    return;
  }
  for (int i = 0; i < count * channels; i += channels) {
    for (int c = 0; c < channels; ++c) {
      const float below = pixel[i + c];
      pixel[i + c] = static_cast<Value>(below + coverage * (color[c] - below) + 0.5f);
    }
  }
}

/** The same with a colour for each pixel. */
template <int channels, typename Value>
void blendRun(Value* pixel, int count, float coverage, const Value* colors) {
  if (coverage < kNothing<Value>) return;
  if (coverage > 1.0f - kNothing<Value>) {
    std::copy_n(colors, static_cast<std::size_t>(count) * channels, pixel);
    return;
  }
  for (int i = 0; i < count * channels; ++i) {
    const float below = pixel[i];
    pixel[i] = static_cast<Value>(below + coverage * (colors[i] - below) + 0.5f);
  }
}

/** Zeros at the beginning of count values; looks at four at a time. */
int zerosOf(const float* values, int count) {
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    std::uint64_t bits[2];
    std::memcpy(bits, values + i, sizeof bits);
    if ((bits[0] | bits[1]) != 0) break;
  }
  while (i < count && values[i] == 0.0f) ++i;
  return i;
}

/** @param colorsFrom  colour or colours of a run that begins at a pixel of the row */
template <int channels, typename Value, typename Colors>
void blendRow(float* accumulator, int count, Value* pixel, const Colors& colorsFrom) {
  float sum = 0.0f;
  for (int i = 0; i < count;) {
    const int j = i + zerosOf(accumulator + i, count - i);  // inside and outside: nothing changes
    if (j > i) {
      blendRun<channels>(pixel + i * channels, j - i, std::min(std::abs(sum), 1.0f), colorsFrom(i));
      i = j;
      continue;
    }
    sum += accumulator[i];
    accumulator[i] = 0.0f;
    blendRun<channels>(pixel + i * channels, 1, std::min(std::abs(sum), 1.0f), colorsFrom(i));
    ++i;
  }
  accumulator[count] = 0.0f;  // what lies beyond the last column
  accumulator[count + 1] = 0.0f;
}

}  // namespace

void CoverageRasterizer::begin(int width, int height, Rule rule) {
  width_ = width;
  height_ = height;
  rule_ = rule;
  edges_.clear();
  x_min_ = y_min_ = std::numeric_limits<double>::infinity();
  x_max_ = y_max_ = -std::numeric_limits<double>::infinity();
}

void CoverageRasterizer::addEdge(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const auto place = [](double x) { return held(x + 0.5, -kFarthest, kFarthest); };
  const Edge edge{place(from.x()), place(from.y()), place(to.x()), place(to.y())};
  x_min_ = std::min({x_min_, edge.x0, edge.x1});
  x_max_ = std::max({x_max_, edge.x0, edge.x1});
  y_min_ = std::min({y_min_, edge.y0, edge.y1});
  y_max_ = std::max({y_max_, edge.y0, edge.y1});
  edges_.push_back(edge);
}

PixelBox CoverageRasterizer::bounds() const {
  if (edges_.empty()) return {};
  return {static_cast<int>(std::clamp(std::floor(x_min_), 0.0, double(width_))),
          static_cast<int>(std::clamp(std::floor(y_min_), 0.0, double(height_))),
          static_cast<int>(std::clamp(std::ceil(x_max_), 0.0, double(width_))),
          static_cast<int>(std::clamp(std::ceil(y_max_), 0.0, double(height_)))};
}

template <typename Value>
void CoverageRasterizer::blend(const std::array<Value, 3>& color, ImageOf<Value>& image) {
  const auto same = [&color](int) -> const std::array<Value, 3>& { return color; };
  fill([&](float* row, int count, int u, int v) {
    if (image.channels() == 3) {
      blendRow<3>(row, count, image.pixel(u, v), same);
    } else {
      blendRow<1>(row, count, image.pixel(u, v), same);
    }
  });
}

template <typename Value>
void CoverageRasterizer::blend(const ImageOf<Value>& colors, ImageOf<Value>& image) {
  fill([&](float* row, int count, int u, int v) {
    const Value* first = colors.pixel(u, v);
    if (image.channels() == 3) {
      blendRow<3>(row, count, image.pixel(u, v), [first](int i) { return first + 3 * i; });
    } else {
      blendRow<1>(row, count, image.pixel(u, v), [first](int i) { return first + i; });
    }
  });
}

template void CoverageRasterizer::blend(const std::array<std::uint8_t, 3>& color, Image& image);
template void CoverageRasterizer::blend(const Image& colors, Image& image);
template void CoverageRasterizer::blend(const std::array<std::uint16_t, 3>& color, FineImage& image);
template void CoverageRasterizer::blend(const FineImage& colors, FineImage& image);

void CoverageRasterizer::forEachRun(const std::function<void(int, int, int)>& visit) {
  fill([&](float* row, int count, int u, int v) {
    float sum = 0.0f;
    int begin = -1;
    for (int i = 0; i <= count; ++i) {
      if (i < count) sum += row[i];
      const bool covered = i < count && std::abs(sum) >= 0.5f;
      if (covered && begin < 0) begin = i;
      if (!covered && begin >= 0) {
        visit(u + begin, u + i, v);
        begin = -1;
      }
    }
    std::fill(row, row + count + 2, 0.0f);
  });
}

/** Accumulates the edges and hands out rows: running sums are to be taken, and zeroed. */
template <typename BlendRow>
void CoverageRasterizer::fill(const BlendRow& blend_row) {
  const PixelBox box = bounds();
  if (!box.empty()) {
    const int count = box.u1 - box.u0;
    const std::size_t stride = count + 2;
    accumulator_.resize(std::max(accumulator_.size(), stride * (box.v1 - box.v0)), 0.0f);
    for (const Edge& edge : edges_) {
      if (rule_ == Rule::kCoverage) {
        accumulate(edge, box, stride);
      } else {
        accumulateCenters(edge, box, stride);
      }
    }
    for (int v = box.v0; v < box.v1; ++v) {
      blend_row(accumulator_.data() + stride * (v - box.v0), count, box.u0, v);
    }
  }
  edges_.clear();
}

void CoverageRasterizer::accumulate(const Edge& edge, const PixelBox& box, std::size_t stride) {
  if (edge.y0 == edge.y1) return;
  const double sign = edge.y0 < edge.y1 ? 1.0 : -1.0;
  const double x_top = sign > 0 ? edge.x0 : edge.x1, y_top = std::min(edge.y0, edge.y1);
  const double x_bottom = sign > 0 ? edge.x1 : edge.x0, y_bottom = std::max(edge.y0, edge.y1);
  const double slope = (x_bottom - x_top) / (y_bottom - y_top);
  const int v_begin = std::max(box.v0, static_cast<int>(std::floor(std::max(y_top, double(box.v0)))));
  const int v_end = std::min<double>(box.v1, std::ceil(y_bottom));
  const double columns = box.u1 - box.u0;
  for (int v = v_begin; v < v_end; ++v) {
    const double y0 = std::max(y_top, double(v)), y1 = std::min(y_bottom, double(v + 1));
    if (y1 <= y0) continue;
    const double x0 = (y0 == y_top ? x_top : x_top + (y0 - y_top) * slope) - box.u0;
    const double x1 = (y1 == y_bottom ? x_bottom : x_top + (y1 - y_top) * slope) - box.u0;
    accumulateRow(accumulator_.data() + stride * (v - box.v0), columns, x0, x1, sign * (y1 - y0));
  }
}

/** The piece of an edge inside one row of pixels runs from column x0 to x1 and covers signed height dy. Adds to row
 *  what makes the running sum up to column i the area of pixel i that lies to the right of the piece. */
void CoverageRasterizer::accumulateRow(float* row, double columns, double x0, double x1, double dy) {
  x0 = held(x0, -kFarthest, kFarthest);  // an edge of next to no height may have a slope without a number
  x1 = held(x1, -kFarthest, kFarthest);
  if (x0 > x1) std::swap(x0, x1);
  if (x1 <= 0.0) {  // left of the box: full height from the first column on
    row[0] += static_cast<float>(dy);
    return;
  }
  if (x0 >= columns) return;
  if (x0 < 0.0) {
    const double part = dy * (-x0) / (x1 - x0);
    row[0] += static_cast<float>(part);
    dy -= part;
    x0 = 0.0;
  }
  if (x1 > columns) {  // beyond the last column nothing is covered
    dy *= (columns - x0) / (x1 - x0);
    x1 = columns;
  }
  const int first = static_cast<int>(x0), last = static_cast<int>(x1);
  if (first == last) {
    const double right = first + 1 - 0.5 * (x0 + x1);  // mean share of the pixel to the right
    row[first] += static_cast<float>(dy * right);
    row[first + 1] += static_cast<float>(dy * (1.0 - right));
    return;
  }
  const double height = dy / (x1 - x0);  // signed height for each column crossed
  double carried = 0.0;                  // area of the previous pixel, to take differences
  double crossed = 0.0;                  // height of the piece so far
  for (int i = first; i <= last; ++i) {
    const double left = std::max(x0, double(i)), right = std::min(x1, double(i + 1));
    const double here = height * (right - left);
    const double area = crossed + here * (i + 1 - 0.5 * (left + right));
    row[i] += static_cast<float>(area - carried);
    carried = area;
    crossed += here;
  }
  row[last + 1] += static_cast<float>(dy - carried);
}

void CoverageRasterizer::accumulateCenters(const Edge& edge, const PixelBox& box, std::size_t stride) {
  const double y_top = std::min(edge.y0, edge.y1), y_bottom = std::max(edge.y0, edge.y1);
  const int v_begin = std::max<double>(box.v0, std::ceil(y_top - 0.5));
  const int v_end = std::min<double>(box.v1, std::ceil(y_bottom - 0.5));
  const float sign = edge.y0 < edge.y1 ? 1.0f : -1.0f;
  for (int v = v_begin; v < v_end; ++v) {
    const double x = edge.x0 + (v + 0.5 - edge.y0) / (edge.y1 - edge.y0) * (edge.x1 - edge.x0);
    const double u = held(std::ceil(x - 0.5), double(box.u0), double(box.u1));  // first centre at or right of x
    accumulator_[stride * (v - box.v0) + static_cast<std::size_t>(u) - box.u0] += sign;
  }
}

template <typename Value>
void blackenBeyondLens(const CameraModel& camera, CoverageRasterizer& rasterizer, ImageOf<Value>& image) {
  constexpr double kChord = 1e-3;  // [px] the circle may stray from its chords
  const double angle = camera.lensAngle();
  const auto onCircle = [&](double azimuth) {
    return camera.toPixel(
        Eigen::Vector3d(std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle)));
  };
  const Eigen::Vector2d center(camera.cx(), camera.cy());
  const double radius = std::max((onCircle(0.0) - center).norm(), (onCircle(0.5 * M_PI) - center).norm());
  // A chord over an angle a strays radius (1 - cos(a / 2)), about radius a^2 / 8.
  const int sides = static_cast<int>(std::ceil(2.0 * M_PI * std::sqrt(radius / (8.0 * kChord)))) + 3;
  const Eigen::Vector2d low(-1.0, -1.0), high(image.width, image.height);
  rasterizer.begin(image.width, image.height, ruleOf(camera));
  const Eigen::Vector2d corners[] = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  for (int i = 0; i < 4; ++i) rasterizer.addEdge(corners[i], corners[(i + 1) % 4]);
  Eigen::Vector2d before = onCircle(0.0);
  const Eigen::Vector2d first = before;
  for (int i = 1; i <= sides; ++i) {  // the other way round: a hole
    const Eigen::Vector2d here = i < sides ? onCircle(-2.0 * M_PI * i / sides) : first;
    rasterizer.addEdge(before, here);
    before = here;
  }
  rasterizer.blend(std::array<Value, 3>{0, 0, 0}, image);
}

template void blackenBeyondLens(const CameraModel& camera, CoverageRasterizer& rasterizer, Image& image);
template void blackenBeyondLens(const CameraModel& camera, CoverageRasterizer& rasterizer, FineImage& image);

}  // namespace aras_visual_servo_sim
