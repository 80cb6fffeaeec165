#include "tile_curved.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {
namespace {

/** Whether some ray of a pixel may meet the unbounded surface: an upper bound of d^T form d over its square. */
bool meets(const CurvedPatch& patch, const PixelRays& rays) {
  const Eigen::Vector3d turned = patch.form * rays.middle;
  const Eigen::Vector3d across = patch.form * rays.across, down = patch.form * rays.down;
  return rays.middle.dot(turned) + std::abs(turned.dot(rays.across)) + std::abs(turned.dot(rays.down)) +
             0.25 * std::max(0.0, across.dot(rays.across)) + 0.25 * std::max(0.0, down.dot(rays.down)) +
             0.5 * std::abs(across.dot(rays.down)) >=
         0.0;
}

}  // namespace

double nearnessAt(const CameraModel& camera, const CurvedPatch& patch, const Eigen::Vector3d& ray) {
  const CurvedPatch::Hit hit = patch.hit(ray);
  if (hit.within < 0.0 || !patch.isWithinBounds(ray, hit.nearness)) return 0.0;
  const double ahead = aheadOf(camera, ray);
  return hit.nearness * camera.nearM() <= ahead && hit.nearness * camera.farM() >= ahead ? hit.nearness : 0.0;
}

PixelSamples::Curved samplesOf(const CameraModel& camera, const CurvedPatch& patch, const PixelRays& rays) {
  const Eigen::Vector3d turned = patch.form * rays.middle;
  const double near_m = camera.nearM(), ahead = aheadOf(camera, rays.middle);
  // Scaled so that single precision holds it: the root is taken of near_m^2 root^2 d^T form d.
  const double scale = near_m * near_m * patch.root * patch.root;
  const double form_scale = scale > 0.0 ? scale : 1.0 / std::max(patch.form.norm(), 1e-300);
  const auto value = [](double x) { return static_cast<float>(x); };
  PixelSamples::Curved curved;
  curved.within = {value(form_scale * rays.middle.dot(turned)),
                   value(form_scale * 2.0 * turned.dot(rays.across)),
                   value(form_scale * 2.0 * turned.dot(rays.down)),
                   value(form_scale * rays.across.dot(patch.form * rays.across)),
                   value(form_scale * 2.0 * rays.across.dot(patch.form * rays.down)),
                   value(form_scale * rays.down.dot(patch.form * rays.down))};
  curved.z = {value(near_m * patch.linear.dot(rays.middle)), value(near_m * patch.linear.dot(rays.across)),
              value(near_m * patch.linear.dot(rays.down))};
  curved.root = patch.root > 0.0 ? 1.0f : patch.root < 0.0 ? -1.0f : 0.0f;
  for (int k = 0; k < 2; ++k) {
    const CurvedPatch::Bound& bound = patch.bounds[k];
    curved.bounds[k] = {value(near_m * bound.ray.dot(rays.middle)), value(near_m * bound.ray.dot(rays.across)),
                        value(near_m * bound.ray.dot(rays.down)), value(bound.nearness)};
  }
  curved.least = value(ahead * near_m / camera.farM());
  curved.most = value(ahead);
  return curved;
}

/** Corners first: if all four of a pixel are seen, so is all between them, and nothing there is farther. */
bool TileCurved::set(const CameraModel& camera, const CurvedPatch& patch, std::uint32_t index, const PixelBox& tile,
                     const PixelRays* rays) {
  entry = index;
  const double near_m = camera.nearM();
  constexpr int kTile = TileBins::kTile;
  const int columns = tile.u1 - tile.u0, rows = tile.v1 - tile.v0;
  std::array<double, (kTile + 1) * (kTile + 1)> corners;  // near_m / Z; 0: not seen
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const PixelRays& pixel = rays[std::size_t(std::min(j, rows - 1)) * kTile + std::min(i, columns - 1)];
      const Eigen::Vector3d ray = pixel.at(i < columns ? -0.5 : 0.5, j < rows ? -0.5 : 0.5);
      corners[j * (kTile + 1) + i] = near_m * nearnessAt(camera, patch, ray);
    }
  }
  bool any = false;
  PixelSamples samples;
  cover.fill(Cover::kNone);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const PixelRays& pixel = rays[std::size_t(j) * kTile + i];
      const double* c = &corners[j * (kTile + 1) + i];
      const double least = std::min({c[0], c[1], c[kTile + 1], c[kTile + 2]});
      const int p = j * kTile + i;
      Eigen::Vector3d touched = pixel.middle;
      if (least > 0.0) {
        cover[p] = Cover::kWhole;
      } else {
        if (!meets(patch, pixel)) continue;
        samples.clear(1);
        samples.see(samplesOf(camera, patch, pixel), 0);
        const PixelSamples::Share share = samples.shareOf(0);
        if (share.count == 0) continue;
        cover[p] = Cover::kPart;
        touched = pixel.at(share.x, share.y);
      }
      any = true;
      const Eigen::Vector3d plane = near_m * patch.plane(touched, patch.hit(touched));
      nearest[p] = static_cast<float>(plane.dot(pixel.middle) +
                                      0.5 * (std::abs(plane.dot(pixel.across)) + std::abs(plane.dot(pixel.down))));
      farthest[p] = static_cast<float>(least);
    }
  }
  return any;
}

}  // namespace aras_visual_servo_sim
