#include "tile_texture.hpp"

#include <algorithm>
#include <limits>

#include "render/picture/picture_window.hpp"
#include "render/view/pixel_rays.hpp"

namespace aras_visual_servo_sim {

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
