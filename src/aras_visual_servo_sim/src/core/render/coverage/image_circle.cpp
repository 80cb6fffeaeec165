#include "image_circle.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {

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
