#pragma once

#include <cmath>
#include <vector>

#include "opengl_tools.hpp"

namespace aras_visual_servo_sim::testing {

constexpr double kRounding = 1.0;  // grey levels: of the formula and of the picture

inline CameraConfig rgbConfig() {
  CameraConfig config = cameraConfig();
  config.encoding = "rgb8";
  return config;
}

/** A white floor at z = 0, and lights of its own. */
inline Scene floorUnder(const std::vector<Light>& lights) {
  Scene scene;
  scene.background = {0, 0, 0};
  scene.bodies.push_back(solid("floor", makeBox({4.0, 4.0, 0.02}), {255, 255, 255}, {0.0, 0.0, -0.01}));
  scene.bodies.back().casts_shadows = false;
  scene.lighting.ambient.setConstant(0.1);
  scene.lighting.lights = lights;
  return scene;
}

inline Light lamp(Light::Type type, double grey) {
  Light light;
  light.type = type;
  light.diffuse.setConstant(grey);
  return light;
}

inline const Pose kAbove = lookingDown({0.0, 0.0, 1.0});

/** Grey of the floor's point (x, y), seen from above. */
inline int greyAt(const Scene& scene, double x, double y, const Pose& X_WC = kAbove) {
  const CameraModel camera(rgbConfig());
  const Image image = renderOpenGl(camera, X_WC, scene);
  const Eigen::Vector2d px = *camera.project(X_WC.inverse() * Eigen::Vector3d(x, y, 0.0));
  return image.pixel(int(std::lround(px.x())), int(std::lround(px.y())))[0];
}

/** Red of what a camera at p_W sees that looks at a point, in the middle of its image. */
inline int greySeen(const Scene& scene, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), to - from);
  return renderOpenGl(CameraModel(rgbConfig()), {from, q}, scene).pixel(160, 120)[0];
}

}  // namespace aras_visual_servo_sim::testing
