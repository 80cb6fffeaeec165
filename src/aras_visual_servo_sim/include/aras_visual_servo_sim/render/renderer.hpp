#pragma once

#include <variant>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/image/image.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"

namespace aras_visual_servo_sim {

/** Makes the image a camera sees. Same arguments, same bytes: nothing of earlier frames survives. */
class Renderer {
 public:
  virtual ~Renderer() = default;

  /** Renders one frame.
   *  @param X_WC  pose of the camera's optical frame C (x right, y down, z forward) in the world
   *  @param out   given the camera's size and encoding; memory is reused from frame to frame
   *  @throws NotFiniteError if a pose is not finite, RenderError if the renderer fails */
  void render(const CameraModel& camera, const Pose& X_WC, const Scene& scene, Image& out) {
    draw(camera, X_WC, scene, &out);
  }
  /** The same before it is rounded to bytes. */
  void render(const CameraModel& camera, const Pose& X_WC, const Scene& scene, FineImage& out) {
    draw(camera, X_WC, scene, &out);
  }

 protected:
  /** An image to be drawn, of one kind or the other. */
  using Out = std::variant<Image*, FineImage*>;

 private:
  void draw(const CameraModel& camera, const Pose& X_WC, const Scene& scene, const Out& out);
  /** @param out  has its size and encoding; poses are finite */
  virtual void doRender(const CameraModel& camera, const Pose& X_WC, const Scene& scene, const Out& out) = 0;
};

}  // namespace aras_visual_servo_sim
