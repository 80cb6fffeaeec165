#include "texture_sampler.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "aras_visual_servo_sim/image/pixel_color.hpp"
#include "render/view/pixel_box.hpp"
#include "tile_integrals.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Rounds means to pixels. */
template <typename Value>
void writeRow(const float* means, int count, bool, Value* out) {
  constexpr float kUnits = kUnitsOf<Value>, kMost = 255 * kUnitsOf<Value>;
  for (int i = 0; i < count; ++i) out[i] = static_cast<Value>(std::clamp(means[i] * kUnits + 0.5f, 0.0f, kMost));
}
template <typename Value>
void writeRow(const SumLanes<3>::Value* means, int count, bool bgr, Value* out) {
  constexpr float kUnits = kUnitsOf<Value>, kMost = 255 * kUnitsOf<Value>;
  for (int i = 0; i < count; ++i, out += 3) {
    SumLanes<3>::Value mean = means[i] * kUnits + 0.5f;
    mean = mean > 0.0f ? mean : SumLanes<3>::Value{};
    mean = mean < kMost ? mean : SumLanes<3>::Value{} + kMost;
    const SumLanes<3>::Sums whole = __builtin_convertvector(mean, SumLanes<3>::Sums);
    const SumLanes<3>::Sums rounded = bgr ? __builtin_shufflevector(whole, whole, 2, 1, 0, 3) : whole;
    for (int c = 0; c < 3; ++c) out[c] = static_cast<Value>(rounded[c]);
  }
}

}  // namespace

template <typename Value>
void TextureSampler::sample(const CameraModel& camera, const Pose& X_CM, const PlanarModel::Picture& picture,
                            const PixelBox& box, ImageOf<Value>& out) {
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
  pixels_ = T_ * raysOfPixels(camera);
  if (camera.sampling() == CameraModel::Sampling::kCenter) {
    for (int v = box.v0; v < box.v1; ++v) {
      for (int u = box.u0; u < box.u1; ++u) sampleCenter(u, v, out);
    }
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

template <typename Value>
void TextureSampler::write(const double* rgb, Value* pixel, Encoding encoding) const {
  constexpr double kUnits = kUnitsOf<Value>;
  const auto value = [](double x) { return static_cast<Value>(std::clamp(x * kUnits + 0.5, 0.0, 255.0 * kUnits)); };
  pixel[0] = value(rgb[encoding == Encoding::kBgr8 ? 2 : 0]);
  if (encoding == Encoding::kMono8) return;
  pixel[1] = value(rgb[1]);
  pixel[2] = value(rgb[encoding == Encoding::kBgr8 ? 0 : 2]);
}

/** Texel nearest to what the centre of a pixel sees. */
template <typename Value>
void TextureSampler::sampleCenter(int u, int v, ImageOf<Value>& out) const {
  const Eigen::Vector3d m = onPicture(u, v);
  const Eigen::Array2d st = m.head<2>().array() / std::max(m.z(), 1e-300);
  const int i = static_cast<int>(held(st.x(), 0.0, texture_->width() - 1.0));
  const int j = static_cast<int>(held(st.y(), 0.0, texture_->height() - 1.0));
  const std::uint8_t* rgb = texture_->texel(i, j);
  const auto pixel = pixelOf<Value>({rgb[0], rgb[1], rgb[2]}, out.encoding);
  std::copy(pixel.begin(), pixel.begin() + out.channels(), out.pixel(u, v));
}

template <typename Value>
void TextureSampler::sampleTile(const PixelBox& box, ImageOf<Value>& out) {
  if (!corners_.project(*camera_, T_, pixels_, box)) {
    sampleRays(box, out);
    return;
  }
  constexpr double kSmall = 0.125;  // [texels] a whole tile: single precision would show
  const Eigen::Array2d size(texture_->width(), texture_->height()), &low = corners_.low(), &high = corners_.high();
  if (!((high >= 0.0).all() && (low <= size).all())) return;
  const bool border = !((low >= 0.0).all() && (high <= size).all() && (high - low).maxCoeff() >= kSmall);
  if (out.channels() == 3) {
    border ? integrateBorder<3>(box, out) : integrateInside(box, color_means_, out);
  } else {
    border ? integrateBorder<1>(box, out) : integrateInside(box, grey_means_, out);
  }
}

template <int channels, typename Value>
void TextureSampler::integrateInside(const PixelBox& box, PictureMeans<channels, kTile>& means, ImageOf<Value>& out) {
  if (!means.integrate(corners_, *texture_, Wrap::kClamp, Wrap::kClamp)) {
    integrateMany<channels>(box, out);
    return;
  }
  for (int j = 0; j < corners_.rows(); ++j) {
    writeRow(means.means() + j * kTile, corners_.columns(), out.encoding == Encoding::kBgr8,
             out.pixel(box.u0, box.v0 + j));
  }
}

/** The level of which the largest pixel covers kRows rows at least; `merged` rows of the picture are one of it. */
const Texture::Level& TextureSampler::levelOf(int channels, double& merged) const {
  const std::vector<Texture::Level>& levels = texture_->levels(channels);
  std::size_t k = 0;
  while (k + 1 < levels.size() && corners_.longest()[1] >= 2.0 * kRows * double(1 << k)) ++k;
  merged = double(1 << k);
  return levels[k];
}

/** Of pixels that see many texels, row by row: each shares its upper edges with the row before. */
template <int channels, typename Value>
void TextureSampler::integrateMany(const PixelBox& box, ImageOf<Value>& out) const {
  using Integrals = TileIntegrals<channels>;
  double merged = 1.0;
  const Texture::Level& level = levelOf(channels, merged);
  const int columns = box.u1 - box.u0, rows = box.v1 - box.v0;
  const int column = static_cast<int>(corners_.low().x()), row = static_cast<int>(corners_.low().y() / merged);
  Integrals integrals(level, texture_->width(), column, row);
  std::array<float, Integrals::kMostEdges + 1> x[2]{}, y[2]{};
  typename Integrals::Values across[2], down;
  for (int j = 0; j <= rows; ++j) {
    auto &x1 = x[j % 2], &y1 = y[j % 2], &x0 = x[1 - j % 2], &y0 = y[1 - j % 2];
    for (int i = 0; i <= columns; ++i) {
      x1[i] = static_cast<float>(corners_.s(i, j) - column);
      y1[i] = static_cast<float>(corners_.t(i, j) / merged - row);
    }
    integrals.along(x1.data(), y1.data(), x1.data() + 1, y1.data() + 1, columns, across[j % 2]);
    if (j == 0) continue;
    integrals.along(x0.data(), y0.data(), x1.data(), y1.data(), columns + 1, down);
    Value* pixel = out.pixel(box.u0, box.v0 + j - 1);
    for (int i = 0; i < columns; ++i, pixel += channels) {
      const auto sum = across[1 - j % 2][i] + down[i + 1] - across[j % 2][i] - down[i];
      const float area = 0.5f * ((x1[i + 1] - x0[i]) * (y1[i] - y0[i + 1]) - (y1[i + 1] - y0[i]) * (x1[i] - x0[i + 1]));
      // Sums cover `merged` rows each, and so does a unit of y.
      const float scale = 1.0f / (area * static_cast<float>(merged));
      double mean[3] = {};
      for (int c = 0; c < channels; ++c) mean[c] = SumLanes<channels>::at(sum, c) * scale;
      write(mean, pixel, out.encoding);
    }
  }
}

/** Means of 8 x 8 rays a pixel, where the plane's horizon is near. */
template <typename Value>
void TextureSampler::sampleRays(const PixelBox& box, ImageOf<Value>& out) const {
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
      if (out.channels() == 1) sum[0] = luma(sum[0], sum[1], sum[2]);
      write(sum, out.pixel(u, v), out.encoding);
    }
  }
}

/** At the picture's border a pixel gets the mean of the part that sees it. */
template <int channels, typename Value>
void TextureSampler::integrateBorder(const PixelBox& box, ImageOf<Value>& out) {
  double merged = 1.0;
  const Texture::Level& level = levelOf(channels, merged);
  const int columns = box.u1 - box.u0, rows = box.v1 - box.v0;
  constexpr double kFarthest = 1e8;  // [texels] so that rows and columns are numbers
  const auto corner = [&](int i, int j) {
    return Eigen::Vector2d(held(corners_.s(i, j), -kFarthest, kFarthest),
                           held(corners_.t(i, j) / merged, -kFarthest, kFarthest));
  };
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const Eigen::Vector2d here = corner(i, j);
      const int at = 4 * (j * kStride + i);
      if (i < columns) integrateEdge<channels>(level, texture_->width(), here, corner(i + 1, j), &across_[at]);
      if (j < rows) integrateEdge<channels>(level, texture_->width(), here, corner(i, j + 1), &down_[at]);
    }
  }
  for (int j = 0; j < rows; ++j) {
    Value* pixel = out.pixel(box.u0, box.v0 + j);
    for (int i = 0; i < columns; ++i, pixel += channels) {
      const int at = 4 * (j * kStride + i), below = at + 4 * kStride, right = at + 4;
      double sum[4];
      for (int c = 0; c <= channels; ++c)
        sum[c] = across_[at + c] + down_[right + c] - across_[below + c] - down_[at + c];
      const Eigen::Vector2d d1 = corner(i + 1, j + 1) - corner(i, j), d2 = corner(i, j + 1) - corner(i + 1, j);
      const double area = 0.5 * (d1.x() * d2.y() - d1.y() * d2.x());
      constexpr double kSliver = 1e-6;  // of a pixel's area: changes no 8-bit value
      if (std::abs(sum[channels]) <= kSliver * std::abs(area)) {
        sampleCenter(box.u0 + i, box.v0 + j, out);
        continue;
      }
      const double scale = 1.0 / (sum[channels] * merged);  // sums cover `merged` rows each, and so does a unit of y
      double mean[3] = {};
      for (int c = 0; c < channels; ++c) mean[c] = sum[c] * scale;
      write(mean, pixel, out.encoding);
    }
  }
}

template void TextureSampler::sample(const CameraModel&, const Pose&, const PlanarModel::Picture&, const PixelBox&,
                                     Image&);
template void TextureSampler::sample(const CameraModel&, const Pose&, const PlanarModel::Picture&, const PixelBox&,
                                     FineImage&);

}  // namespace aras_visual_servo_sim
