#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"

namespace aras_visual_servo_sim {

/** How far away the centre of each pixel sees something, and which model or body that is. Row-major, top row first. */
struct GeometryImage {
  static constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

  int width = 0;
  int height = 0;
  /** Z of the point in the camera's frame [m], or its distance if asked for; kNothing where there is none. A fisheye
   *  sees points with Z <= 0 too: their depth is kNothing, because every number in a depth image stands for a point
   *  in front of the camera (REP 118). */
  std::vector<float> depth_m;
  std::vector<std::uint16_t> ids;  ///< segmentationIds(); 0 where there is nothing

  std::size_t at(int u, int v) const { return std::size_t(v) * width + u; }
};

/** Numbers in GeometryImage::ids: planar models from 1 on in the order of the scene, then bodies (links and solids). */
std::map<std::string, std::uint16_t> segmentationIds(const Scene& scene);

/** What the depth of a GeometryImage is: Z along the optical axis, or the distance from the camera. */
enum class Distance { kDepth, kRange };

/** Draws depth and ids without any graphics library.
 *
 *  Outlines are projected, depth comes from the equation of the plane, of a planar model or of a body's triangle, along
 *  the ray through a pixel's centre. Things nearer than near_m or, for bodies, farther than far_m are not seen, as in
 *  images. Front faces of bodies only. Not thread-safe. */
class GeometryRenderer {
 public:
  GeometryRenderer();
  ~GeometryRenderer();

  /** @param X_WC  pose of the camera @throws NotFiniteError */
  void render(const CameraModel& camera, const Pose& X_WC, const Scene& scene, GeometryImage& out,
              Distance distance = Distance::kDepth);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace aras_visual_servo_sim
