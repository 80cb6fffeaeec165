#include "tile_colors.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <limits>

#include "aras_visual_servo_sim/config/wide.hpp"
#include "aras_visual_servo_sim/image/pixel_color.hpp"
#include "render/view/pixel_rays.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kTile = TileColors::kTile, kPixels = TileColors::kPixels;

/** Colours of rows of pixels: (over_x x + over_y y + over) / (under_x x + under_y y + under), each of over_x, over_y
 * and over being three. */
ARAS_WIDE void shadeRows(const double* x, const double* y, const double* over, const double* under, int rows,
                         double* red, double* green, double* blue) {
  for (int v = 0; v < rows; ++v) {
    const double r = over[3] * y[v] + over[6], g = over[4] * y[v] + over[7], b = over[5] * y[v] + over[8];
    const double z = under[1] * y[v] + under[2];
    for (int i = 0; i < kTile; ++i) {
      const int p = v * kTile + i;
      const double scale = 1.0 / (z + under[0] * x[i]);
      red[p] = (r + over[0] * x[i]) * scale;
      green[p] = (g + over[1] * x[i]) * scale;
      blue[p] = (b + over[2] * x[i]) * scale;
    }
  }
}

/** Colours along rays. @param over  3 x 3, column by column */
ARAS_WIDE void shadeRays(const double* x, const double* y, const double* z, const double* over, const double* under,
                         int count, double* red, double* green, double* blue) {
  for (int i = 0; i < count; ++i) {
    const double scale = 1.0 / (under[0] * x[i] + under[1] * y[i] + under[2] * z[i]);
    red[i] = (over[0] * x[i] + over[3] * y[i] + over[6] * z[i]) * scale;
    green[i] = (over[1] * x[i] + over[4] * y[i] + over[7] * z[i]) * scale;
    blue[i] = (over[2] * x[i] + over[5] * y[i] + over[8] * z[i]) * scale;
  }
}

ARAS_WIDE void takeChannel(const double* others, const std::int32_t* facet_of, std::int32_t index, double* mine) {
  for (int p = 0; p < kPixels; ++p) mine[p] = facet_of[p] == index ? others[p] : mine[p];
}

/** Rounded values of all pixels of a channel. */
template <typename Value>
inline __attribute__((always_inline)) void roundAll(const double* parts, Value* values) {
  constexpr double kUnits = kUnitsOf<Value>;
  for (int p = 0; p < kPixels; ++p) {
    values[p] = static_cast<Value>(static_cast<std::int32_t>(parts[p] * kUnits + 0.5));
  }
}
ARAS_WIDE void round(const double* parts, std::uint16_t* values) { roundAll(parts, values); }

/** Three rounded values of each pixel in one word, the first in the lowest byte. */
ARAS_WIDE void roundAndPack(const double* first, const double* second, const double* third, std::uint32_t* words) {
  for (int p = 0; p < kPixels; ++p) {
    const auto value = [p](const double* parts) { return static_cast<std::uint32_t>(std::int32_t(parts[p] + 0.5)); };
    words[p] = (value(first) & 255U) | (value(second) & 255U) << 8 | (value(third) & 255U) << 16;
  }
}

/** Pixels of three values each. */
void writePixels(const double* first, const double* second, const double* third, const PixelBox& tile, Image& image) {
  static_assert(kUnitsOf<std::uint8_t> == 1 && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);
  alignas(32) std::uint32_t words[kPixels];
  roundAndPack(first, second, third, words);
  const int width = tile.u1 - tile.u0;
  for (int v = tile.v0; v < tile.v1; ++v) {
    std::uint8_t* out = image.pixel(tile.u0, v);
    const std::uint32_t* row = words + (v - tile.v0) * kTile;
    // Four bytes at a time, of which the next pixel takes the last; but not beyond the tile.
    for (int i = 0; i < width - 1; ++i, out += 3) std::memcpy(out, row + i, 4);
    std::memcpy(out, row + width - 1, 3);
  }
}
void writePixels(const double* first, const double* second, const double* third, const PixelBox& tile,
                 FineImage& image) {
  alignas(32) std::uint16_t values[3][kPixels];
  round(first, values[0]);
  round(second, values[1]);
  round(third, values[2]);
  for (int v = tile.v0; v < tile.v1; ++v) {
    std::uint16_t* out = image.pixel(tile.u0, v);
    const int row = (v - tile.v0) * kTile;
    for (int p = row; p < row + tile.u1 - tile.u0; ++p, out += 3) {
      for (int c = 0; c < 3; ++c) out[c] = values[c][p];
    }
  }
}

/** With b = areal * ray, colour = rgb * b / sum(b): three linear functions of the ray, these, over a fourth. */
Eigen::Matrix3d overOf(const Facet& facet) {
  Eigen::Matrix3d rgb;
  for (int k = 0; k < 3; ++k) rgb.col(k) = facet.rgb[k].cast<double>();
  return rgb * facet.areal;
}

}  // namespace

void TileColors::shade(const CameraModel& camera, const Facet& facet, const PixelBox& tile) {
  if (facet.one_color) {
    std::fill(std::begin(red_), std::end(red_), double(facet.rgb[0][0]));
    std::fill(std::begin(green_), std::end(green_), double(facet.rgb[0][1]));
    std::fill(std::begin(blue_), std::end(blue_), double(facet.rgb[0][2]));
  } else if (camera.lens() == CameraModel::Lens::kNone) {
    shadeFlat(camera, facet, tile);
  } else {
    shadeBent(camera, facet, tile);
  }
}

void TileColors::shadeFlat(const CameraModel& camera, const Facet& facet, const PixelBox& tile) {
  const Eigen::Matrix3d over = overOf(facet);
  double x[kTile], y[kTile];
  for (int i = 0; i < kTile; ++i) {
    x[i] = (tile.u0 + i - camera.cx()) / camera.fx();
    y[i] = (tile.v0 + i - camera.cy()) / camera.fy();
  }
  shadeRows(x, y, over.data(), facet.plane.data(), tile.v1 - tile.v0, red_, green_, blue_);
}

void TileColors::shadeBent(const CameraModel& camera, const Facet& facet, const PixelBox& tile) {
  const Eigen::Matrix3d over = overOf(facet);
  double x[kPixels] = {}, y[kPixels] = {}, z[kPixels];
  std::fill(std::begin(z), std::end(z), 1.0);
  for (int v = tile.v0; v < tile.v1; ++v) {
    for (int u = tile.u0; u < tile.u1; ++u) {
      const Eigen::Vector3d ray = PixelRays::of(camera, u, v).middle;
      const int p = (v - tile.v0) * kTile + u - tile.u0;
      x[p] = ray.x();
      y[p] = ray.y();
      z[p] = ray.z();
    }
  }
  shadeRays(x, y, z, over.data(), facet.plane.data(), (tile.v1 - tile.v0) * kTile, red_, green_, blue_);
}

void TileColors::multiply(const SumLanes<3>::Value* picture) {
  constexpr double kScale = 1.0 / 255.0;
  for (int p = 0; p < kPixels; ++p) {
    red_[p] *= kScale * double(picture[p][0]);
    green_[p] *= kScale * double(picture[p][1]);
    blue_[p] *= kScale * double(picture[p][2]);
  }
}

void TileColors::take(const TileColors& others, const std::int32_t* facet_of, std::int32_t index) {
  takeChannel(others.red_, facet_of, index, red_);
  takeChannel(others.green_, facet_of, index, green_);
  takeChannel(others.blue_, facet_of, index, blue_);
}

template <typename Value>
void TileColors::write(const PixelBox& tile, ImageOf<Value>& image) const {
  const int width = tile.u1 - tile.u0;
  if (image.encoding == Encoding::kMono8) {
    for (int v = tile.v0; v < tile.v1; ++v) {
      Value* out = image.pixel(tile.u0, v);
      const int row = (v - tile.v0) * kTile;
      for (int p = row; p < row + width; ++p) *out++ = valueOf<Value>(luma(red_[p], green_[p], blue_[p]));
    }
    return;
  }
  const bool bgr = image.encoding == Encoding::kBgr8;
  writePixels(bgr ? blue_ : red_, green_, bgr ? red_ : blue_, tile, image);
}

template <typename Value>
void paintTileWith(const Eigen::Vector3f& rgb, const PixelBox& tile, ImageOf<Value>& image) {
  const auto pixel = pixelOf<Value>(rgb[0], rgb[1], rgb[2], image.encoding);
  const std::size_t channels = image.channels(), width = tile.u1 - tile.u0;
  std::array<Value, 3 * kTile> row;
  for (std::size_t k = 0; k < width * channels; ++k) row[k] = pixel[k % channels];
  for (int v = tile.v0; v < tile.v1; ++v) std::copy_n(row.data(), width * channels, image.pixel(tile.u0, v));
}

template void TileColors::write(const PixelBox& tile, Image& image) const;
template void TileColors::write(const PixelBox& tile, FineImage& image) const;
template void paintTileWith(const Eigen::Vector3f& rgb, const PixelBox& tile, Image& image);
template void paintTileWith(const Eigen::Vector3f& rgb, const PixelBox& tile, FineImage& image);

bool TileTexture::look(const CameraModel& camera, const Facet& facet, const PixelBox& tile) {
  for (int axis = 0; axis < 2; ++axis) {
    T_.row(axis).setZero();
    for (int k = 0; k < 3; ++k) T_.row(axis) += facet.texels[k][axis] * facet.areal.row(k);
  }
  T_.row(2) = facet.plane.transpose();
  if (camera.lens() == CameraModel::Lens::kNone) pixels_ = T_ * raysOfPixels(camera);
  constexpr double kGrazing = 1e-6;  // 1 / Z, of what it is straight ahead: beyond, texture coordinates mean little
  least_ = kGrazing * facet.plane.norm();
  const MeshPicture& picture = *facet.texture;
  if (camera.sampling() == CameraModel::Sampling::kCenter) return lookAtCenters(camera, picture, tile);
  if (!corners_.project(camera, T_, pixels_, tile, least_)) return false;
  if (!means_.integrate(corners_, *picture.texture, picture.wrap_s, picture.wrap_t)) return false;
  colors_ = means_.means();
  return true;
}

bool TileTexture::lookAtCenters(const CameraModel& camera, const MeshPicture& picture, const PixelBox& tile) {
  const bool straight = camera.lens() == CameraModel::Lens::kNone;
  double s[kPixels], t[kPixels];
  constexpr double kFar = std::numeric_limits<double>::max();
  Eigen::Array2d low(kFar, kFar), high(-kFar, -kFar);
  for (int v = tile.v0; v < tile.v1; ++v) {
    const Eigen::Vector3d row = straight ? Eigen::Vector3d(pixels_.col(1) * v + pixels_.col(2)) : Eigen::Vector3d();
    for (int u = tile.u0; u < tile.u1; ++u) {
      const int p = (v - tile.v0) * kTile + u - tile.u0;
      const Eigen::Vector3d m = straight ? Eigen::Vector3d(pixels_.col(0) * u + row)
                                         : Eigen::Vector3d(T_ * PixelRays::of(camera, u, v).middle);
      if (!(m.z() > least_)) return false;
      const double scale = 1.0 / m.z();
      s[p] = m.x() * scale;
      t[p] = m.y() * scale;
      const Eigen::Array2d here(s[p], t[p]);
      low = low.min(here);
      high = high.max(here);
    }
  }
  const Texture& texture = *picture.texture;
  const Eigen::Array2d size(texture.width(), texture.height());
  const Eigen::Array2d turns = (low / size).floor();
  // Most tiles lie within one of the pictures that repeat each other, and not on a mirrored one.
  const bool repeated = picture.wrap_s == Wrap::kRepeat && picture.wrap_t == Wrap::kRepeat;
  const bool within = (turns == (high / size).floor()).all() && (repeated || (turns == 0.0).all());
  const double left = turns[0] * size[0], top = turns[1] * size[1];
  for (int v = 0; v < tile.v1 - tile.v0; ++v) {
    for (int p = v * kTile; p < v * kTile + tile.u1 - tile.u0; ++p) {
      const int column = within ? std::min(static_cast<int>(s[p] - left), texture.width() - 1)
                                : wrapped(picture.wrap_s, s[p], texture.width());
      const int row = within ? std::min(static_cast<int>(t[p] - top), texture.height() - 1)
                             : wrapped(picture.wrap_t, t[p], texture.height());
      const std::uint8_t* rgb = texture.texel(column, row);
      texels_[p] = Color{float(rgb[0]), float(rgb[1]), float(rgb[2]), 0.0f};
    }
  }
  colors_ = texels_.data();
  return true;
}

}  // namespace aras_visual_servo_sim
