#include "tile_texture.hpp"

#include "render/picture/texture_area.hpp"
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
  plain_ = means_.isPlain();
  return true;
}

bool TileTexture::lookAtCenters(const CameraModel& camera, const MeshPicture& picture, const PixelBox& tile) {
  const bool straight = camera.lens() == CameraModel::Lens::kNone;
  for (int v = tile.v0; v < tile.v1; ++v) {
    for (int u = tile.u0; u < tile.u1; ++u) {
      const Eigen::Vector3d m =
          straight ? pixels_ * Eigen::Vector3d(u, v, 1.0) : T_ * PixelRays::of(camera, u, v).middle;
      if (!(m.z() > least_)) return false;
      const Eigen::Vector3d rgb = TextureArea::at(picture, m.head<2>() / m.z());
      texels_[(v - tile.v0) * kTile + u - tile.u0] = Color{float(rgb[0]), float(rgb[1]), float(rgb[2]), 0.0f};
    }
  }
  colors_ = texels_.data();
  plain_ = false;
  return true;
}

}  // namespace aras_visual_servo_sim
