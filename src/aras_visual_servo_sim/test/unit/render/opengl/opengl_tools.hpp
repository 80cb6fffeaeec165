#pragma once

#include <algorithm>
#include <cstdlib>
#include <string>

#include "aras_visual_servo_sim/render/opengl_renderer.hpp"
#include "tools/render_tools.hpp"

namespace aras_visual_servo_sim::testing {

/** One for all tests: a context and its shaders take longer than an image. */
inline OpenGlRenderer& sharedOpenGl() {
  static const std::string opened = OpenGlRenderer().description();  // the library first: it must outlive the renderer
  static OpenGlRenderer renderer;
  return renderer;
}

inline Image renderOpenGl(const CameraModel& camera, const Pose& X_WC, const Scene& scene) {
  Image image;
  sharedOpenGl().render(camera, X_WC, scene, image);
  return image;
}

inline Body solid(const std::string& name, const MeshPtr& mesh, const Rgb& color, const Eigen::Vector3d& p,
                  const Eigen::Vector3d& rpy = Eigen::Vector3d::Zero()) {
  Body body;
  body.name = name;
  body.shapes.push_back({Pose{}, mesh, color, Material{}});
  body.X_WB = {p, quaternionFromRpy(rpy)};
  return body;
}

/** Boxes, cylinders and balls of all colours before a floor, without shadows. */
inline Scene colourfulScene() {
  Scene scene;
  scene.background = {230, 230, 230};
  scene.lighting.shadows = false;
  scene.bodies.push_back(solid("floor", makeBox({0.8, 0.6, 0.02}), {180, 170, 160}, {0.0, 0.0, -0.05}));
  for (int i = 0; i < 8; ++i) {
    const MeshPtr mesh = i % 3 == 0   ? makeBox({0.05, 0.03, 0.04})
                         : i % 3 == 1 ? makeCylinder(0.015, 0.09, 64)
                                      : makeSphere(0.025, 64);
    const Rgb color{static_cast<std::uint8_t>(250 - 30 * i), static_cast<std::uint8_t>(40 + 25 * i), 90};
    scene.bodies.push_back(solid(std::to_string(i), mesh, color,
                                 {0.07 * (i % 4) - 0.1, 0.09 * (i / 4) - 0.05, 0.02 * (i % 3)}, {0.3 * i, 0.2 * i, 0}));
  }
  return scene;
}

/** How far two images of one size are from each other. */
struct Difference {
  int inside = 0;     ///< greatest where the first has no edge within a pixel
  int apart = 0;      ///< pixels that differ by more than half of what the first varies by about them, and 32
  double mean = 0.0;  ///< of the signed differences
};

inline Difference differenceOf(const Image& a, const Image& b) {
  constexpr int kEdge = 12;  // grey levels between neighbours
  Difference result;
  for (int v = 1; v + 1 < a.height; ++v) {
    for (int u = 1; u + 1 < a.width; ++u) {
      for (int c = 0; c < a.channels(); ++c) {
        int low = 255, high = 0;
        for (int k = 0; k < 9; ++k) {
          const int value = a.pixel(u + k % 3 - 1, v + k / 3 - 1)[c];
          low = std::min(low, value);
          high = std::max(high, value);
        }
        const int difference = int(b.pixel(u, v)[c]) - int(a.pixel(u, v)[c]);
        result.mean += difference;
        if (high - low < kEdge) result.inside = std::max(result.inside, std::abs(difference));
        if (b.pixel(u, v)[c] < low - 32 || b.pixel(u, v)[c] > high + 32) ++result.apart;
      }
    }
  }
  result.mean /= double(a.data.size());
  return result;
}

}  // namespace aras_visual_servo_sim::testing
