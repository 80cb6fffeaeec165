#include "texture_sampler.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pixel_color.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kMostPieces = 4;  // of an edge within one row: exact below, sampled above

/** The running sums of one row of a level. Positions x are 0 .. width, where border is said anything. */
template <int channels, bool border>
class Row {
 public:
  Row(const Texture::Level& level, int width, int row)
      : sums_(level.sums.data() + std::size_t(row) * (width + 1) * channels), width_(width) {}

  /** Adds dy times the mean of the sums over x0 .. x1, and of min(max(x, 0), width) if border. */
  void add(double x0, double x1, double dy, double* integral) const {
    if (x0 > x1) std::swap(x0, x1);
    const int first = floor(x0), last = floor(x1);
    // Linear between texel edges, so the middle of each piece gives its mean.
    if (first == last) {
      addAt(0.5 * (x0 + x1), dy, integral);
    } else if (last - first < kMostPieces) {
      const double share = dy / (x1 - x0);
      double left = x0;
      for (int edge = first + 1; edge <= last; ++edge) {
        addAt(0.5 * (left + edge), share * (edge - left), integral);
        left = edge;
      }
      addAt(0.5 * (left + x1), share * (x1 - left), integral);
    } else {
      const double step = (x1 - x0) / kMostPieces;
      for (int k = 0; k < kMostPieces; ++k) addAt(x0 + (k + 0.5) * step, dy / kMostPieces, integral);
    }
  }

 private:
  static int floor(double x) {
    const int i = static_cast<int>(x);
    return border && x < i ? i - 1 : i;
  }
  void addAt(double x, double weight, double* integral) const {
    if (border) {
      x = std::clamp(x, 0.0, double(width_));
      integral[channels] += weight * x;
    }
    const int i = std::min(static_cast<int>(x), width_ - 1);
    const double part = x - i;
    const std::int32_t* sum = sums_ + i * channels;
    for (int c = 0; c < channels; ++c) integral[c] += weight * (sum[c] + part * (sum[c + channels] - sum[c]));
  }

  const std::int32_t* sums_;
  int width_;
};

/** Integral of the running sum over dy along a straight edge; y in rows of the level, and nothing beyond its rows. */
template <int channels, bool border>
void integrateEdge(const Texture::Level& level, int width, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                   double* integral) {
  std::fill(integral, integral + channels + (border ? 1 : 0), 0.0);
  const bool downwards = a.y() < b.y();
  const Eigen::Vector2d &from = downwards ? a : b, &to = downwards ? b : a;
  const double sign = downwards ? 1.0 : -1.0;
  const double top = border ? std::max(from.y(), 0.0) : from.y();
  const double bottom = border ? std::min(to.y(), double(level.rows)) : to.y();
  if (!(bottom > top)) return;
  int row = std::min(static_cast<int>(top), level.rows - 1);
  if (!border && bottom <= row + 1.0) {
    Row<channels, border>(level, width, row).add(from.x(), to.x(), sign * (bottom - top), integral);
    return;
  }
  const double slope = (to.x() - from.x()) / (to.y() - from.y());
  double y0 = top, x0 = from.x() + (top - from.y()) * slope;
  for (; y0 < bottom; ++row) {
    const double y1 = row + 1 >= level.rows ? bottom : std::min(bottom, row + 1.0);
    const double x1 = from.x() + (y1 - from.y()) * slope;
    Row<channels, border>(level, width, row).add(x0, x1, sign * (y1 - y0), integral);
    y0 = y1;
    x0 = x1;
  }
}

}  // namespace

void TextureSampler::sample(const CameraModel& camera, const Pose& X_CM, const PlanarModel::Picture& picture,
                            const PixelBox& box, Image& out) {
  camera_ = &camera;
  texture_ = picture.texture.get();
  const double width = texture_->width(), height = texture_->height();
  // A point (X, Y) of the model's plane lies on the ray (R.col(0), R.col(1), p) (X, Y, 1): its inverse takes rays to
  // points. Then from metres to texels, t growing downwards.
  Eigen::Matrix3d plane = X_CM.q.toRotationMatrix();
  plane.col(2) = X_CM.p;
  Eigen::Matrix3d texels;
  texels << width / picture.size_m.x(), 0.0, 0.5 * width, 0.0, -height / picture.size_m.y(), 0.5 * height, 0.0, 0.0,
      1.0;
  bool visible = false;
  Eigen::Matrix3d inverse;
  plane.computeInverseWithCheck(inverse, visible, 1e-9);  // else seen from its own plane: it covers nothing
  if (!visible) return;
  T_ = texels * inverse;
  if (camera.sampling() == CameraModel::Sampling::kCenter) {
    sampleCenters(box, out);
    return;
  }
  for (int v = box.v0; v < box.v1; v += kTile) {
    for (int u = box.u0; u < box.u1; u += kTile) {
      sampleTile({u, v, std::min(u + kTile, box.u1), std::min(v + kTile, box.v1)}, out);
    }
  }
}

/** Ray through pixel coordinates; through a lens, bilinear between those through the corners of the pixel. */
Eigen::Vector3d TextureSampler::ray(double u, double v) const {
  if (camera_->lens() == CameraModel::Lens::kNone) {
    return {(u - camera_->cx()) / camera_->fx(), (v - camera_->cy()) / camera_->fy(), 1.0};
  }
  const int i = std::clamp(static_cast<int>(u + 0.5), 0, camera_->width() - 1);
  const int j = std::clamp(static_cast<int>(v + 0.5), 0, camera_->height() - 1);
  const double a = u + 0.5 - i, b = v + 0.5 - j;
  const Eigen::Vector3d* top = camera_->cornerRays().data() + std::size_t(j) * (camera_->width() + 1) + i;
  if (a == 0.0 && b == 0.0) return *top;
  const Eigen::Vector3d* bottom = top + camera_->width() + 1;
  return (1.0 - b) * ((1.0 - a) * top[0] + a * top[1]) + b * ((1.0 - a) * bottom[0] + a * bottom[1]);
}

void TextureSampler::write(const double* rgb, std::uint8_t* pixel, Encoding encoding) const {
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::clamp(x + 0.5, 0.0, 255.0)); };
  pixel[0] = byte(rgb[encoding == Encoding::kBgr8 ? 2 : 0]);
  if (encoding == Encoding::kMono8) return;
  pixel[1] = byte(rgb[1]);
  pixel[2] = byte(rgb[encoding == Encoding::kBgr8 ? 0 : 2]);
}

void TextureSampler::sampleCenters(const PixelBox& box, Image& out) const {
  for (int v = box.v0; v < box.v1; ++v) {
    for (int u = box.u0; u < box.u1; ++u) sampleCenter(u, v, out);
  }
}

/** Texel nearest to what the centre of a pixel sees. */
void TextureSampler::sampleCenter(int u, int v, Image& out) const {
  const Eigen::Vector3d m = onPicture(u, v);
  const Eigen::Array2d st = m.head<2>().array() / std::max(m.z(), 1e-300);
  const int i = static_cast<int>(std::clamp(st.x(), 0.0, texture_->width() - 1.0));
  const int j = static_cast<int>(std::clamp(st.y(), 0.0, texture_->height() - 1.0));
  const std::uint8_t* rgb = texture_->texel(i, j);
  const auto pixel = pixelOf({rgb[0], rgb[1], rgb[2]}, out.encoding);
  std::copy(pixel.begin(), pixel.begin() + out.channels(), out.pixel(u, v));
}

void TextureSampler::sampleTile(const PixelBox& box, Image& out) {
  const Tile tile = findCorners(box);
  if (!tile.seen) return;
  if (!tile.regular) {
    sampleRays(box, out);
  } else if (out.channels() == 3) {
    tile.border ? integrateTile<3, true>(tile, out) : integrateTile<3, false>(tile, out);
  } else {
    tile.border ? integrateTile<1, true>(tile, out) : integrateTile<1, false>(tile, out);
  }
}

TextureSampler::Tile TextureSampler::findCorners(const PixelBox& box) {
  Tile tile;
  tile.box = box;
  const int columns = box.u1 - box.u0 + 1, rows = box.v1 - box.v0 + 1;
  Eigen::Array2d low(1e300, 1e300), high(-1e300, -1e300);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const Eigen::Vector3d m = onPicture(box.u0 + i - 0.5, box.v0 + j - 0.5);
      if (m.z() <= 0.0) {
        tile.regular = false;
        return tile;
      }
      const Eigen::Vector2d corner = m.head<2>() / m.z();
      corners_[j * (kTile + 1) + i] = corner;
      low = low.min(corner.array());
      high = high.max(corner.array());
      if (i > 0) tile.rows = std::max(tile.rows, std::abs(corner.y() - corners_[j * (kTile + 1) + i - 1].y()));
      if (j > 0) tile.rows = std::max(tile.rows, std::abs(corner.y() - corners_[(j - 1) * (kTile + 1) + i].y()));
    }
  }
  const Eigen::Array2d size(texture_->width(), texture_->height());
  tile.border = (low < 0.0).any() || (high > size).any();
  tile.seen = !((high < 0.0).any() || (low > size).any());
  return tile;
}

template <int channels, bool border>
void TextureSampler::integrateTile(const Tile& tile, Image& out) {
  constexpr int kStride = kTile + 1;
  const std::vector<Texture::Level>& levels = texture_->levels(channels);
  std::size_t k = 0;
  while (k + 1 < levels.size() && tile.rows >= 2.0 * kRows * double(1 << k)) ++k;
  const double merged = double(1 << k);
  for (Eigen::Vector2d& corner : corners_) corner.y() /= merged;
  const int columns = tile.box.u1 - tile.box.u0, rows = tile.box.v1 - tile.box.v0;
  const auto corner = [&](int i, int j) -> const Eigen::Vector2d& { return corners_[j * kStride + i]; };
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const Eigen::Vector2d here = corner(i, j);
      const int at = 4 * (j * kStride + i);
      if (i < columns)
        integrateEdge<channels, border>(levels[k], texture_->width(), here, corner(i + 1, j), &across_[at]);
      if (j < rows) integrateEdge<channels, border>(levels[k], texture_->width(), here, corner(i, j + 1), &down_[at]);
    }
  }
  for (int j = 0; j < rows; ++j) {
    std::uint8_t* pixel = out.pixel(tile.box.u0, tile.box.v0 + j);
    for (int i = 0; i < columns; ++i, pixel += channels) {
      const int at = 4 * (j * kStride + i), below = at + 4 * kStride, right = at + 4;
      double sum[4];
      for (int c = 0; c < channels + (border ? 1 : 0); ++c) {
        sum[c] = across_[at + c] + down_[right + c] - across_[below + c] - down_[at + c];
      }
      const Eigen::Vector2d d1 = corner(i + 1, j + 1) - corner(i, j), d2 = corner(i, j + 1) - corner(i + 1, j);
      const double area = 0.5 * (d1.x() * d2.y() - d1.y() * d2.x());
      // Sums cover `merged` rows each, and so does a unit of y.
      double weight = area;
      if (border) {
        constexpr double kSliver = 1e-6;  // of a pixel's area: changes no 8-bit value
        if (std::abs(sum[channels]) <= kSliver * std::abs(area)) {
          sampleCenter(tile.box.u0 + i, tile.box.v0 + j, out);
          continue;
        }
        weight = sum[channels];
      }
      const double scale = 1.0 / (weight * merged);
      double mean[3];
      for (int c = 0; c < channels; ++c) mean[c] = sum[c] * scale;
      write(mean, pixel, out.encoding);
    }
  }
}

/** Means of 8 x 8 rays a pixel, where the plane's horizon is near. */
void TextureSampler::sampleRays(const PixelBox& box, Image& out) const {
  constexpr int kRays = 8;
  for (int v = box.v0; v < box.v1; ++v) {
    for (int u = box.u0; u < box.u1; ++u) {
      double sum[3] = {0.0, 0.0, 0.0};
      int count = 0;
      for (int k = 0; k < kRays * kRays; ++k) {
        const Eigen::Vector3d m =
            onPicture(u - 0.5 + (k % kRays + 0.5) / kRays, v - 0.5 + (k / kRays + 0.5) / kRays);  // NOLINT
        const double s = m.x() / m.z(), t = m.y() / m.z();
        if (!(m.z() > 0.0 && s >= 0.0 && t >= 0.0 && s < texture_->width() && t < texture_->height())) continue;
        const std::uint8_t* rgb = texture_->texel(static_cast<int>(s), static_cast<int>(t));
        for (int c = 0; c < 3; ++c) sum[c] += rgb[c];
        ++count;
      }
      if (count == 0) {
        sampleCenter(u, v, out);
        continue;
      }
      for (double& value : sum) value /= count;
      if (out.channels() == 1) sum[0] = greyOf(sum[0], sum[1], sum[2]);
      write(sum, out.pixel(u, v), out.encoding);
    }
  }
}

}  // namespace aras_visual_servo_sim
