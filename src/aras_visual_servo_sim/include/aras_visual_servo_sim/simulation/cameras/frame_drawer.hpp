#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/render/geometry_image.hpp"
#include "aras_visual_servo_sim/render/opengl_renderer.hpp"
#include "aras_visual_servo_sim/simulation/cameras/camera.hpp"

namespace aras_visual_servo_sim {

/** Draws what a camera sees: the present, or, of a camera with latency, a frame as it was when it was exposed. */
class FrameDrawer {
 public:
  FrameDrawer();

  /** The image, with its noise.
   *  @param now    the present tick: at a scheduled frame's, the mean over the exposure that ends there
   *  @param scene  as it is now, and so again afterwards @throws RenderError */
  const Image& draw(Camera& camera, std::int64_t now, const Pose& X_WC, Scene& scene);
  /** What drew by OpenGL so far, and its version: OpenGlRenderer::description; empty if nothing did. */
  std::string openGl() const;
  /** Depth and ids of the same view, without blur. */
  const GeometryImage& drawGeometry(Camera& camera, const Pose& X_WC, const Scene& scene, Distance distance);

 private:
  template <typename Value>
  void drawOn(ImageOf<Value>& image, const Camera& camera, std::int64_t now, const Pose& X_WC, Scene& scene);
  template <typename Value>
  void drawOnce(ImageOf<Value>& image, const CameraModel& camera, const Pose& X_WC, const Scene& scene);
  template <typename Value>
  void drawMoments(ImageOf<Value>& image, const Camera& camera, const std::vector<Exposure::Sample>& moments,
                   Scene& scene);
  template <typename Value>
  void drawRows(ImageOf<Value>& image, const Camera& camera, const std::vector<Exposure::Sample>& moments,
                Scene& scene);
  template <typename Value>
  void drawLate(ImageOf<Value>& image, const Camera& camera, const ExposedFrame& frame, const Scene& now);

  void drawGeometry(const Camera& camera, const Pose& X_WC, const Scene& now, Distance distance, GeometryImage& out);
  OpenGlRenderer& openGlFor(const CameraConfig& camera);

  std::unique_ptr<Renderer> coverage_;
  std::shared_ptr<OpenGlRenderer> osmesa_, egl_;  // null until the first camera wants them; other simulations have them
  GeometryRenderer geometry_renderer_;
  GeometryImage depth_;  // of the frame that a lens with a depth of field blurs
};

}  // namespace aras_visual_servo_sim
