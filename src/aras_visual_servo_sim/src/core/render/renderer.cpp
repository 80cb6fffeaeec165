#include "aras_visual_servo_sim/render/renderer.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

void requireFinite(const Pose& pose, const char* kind, const std::string& name) {
  if (!pose.p.allFinite() || !pose.q.coeffs().allFinite()) {
    throw NotFiniteError(std::string("render: pose of ") + kind + " '" + name + "' is not finite");
  }
}

void requireFinite(const CameraModel& camera, const Pose& X_WC, const Scene& scene) {
  requireFinite(X_WC, "camera", camera.config().name);
  for (const PlanarModel& model : scene.models) requireFinite(model.X_WM, "model", model.name());
  for (const Body& body : scene.bodies) requireFinite(body.X_WB, "body", body.name);
}

}  // namespace

void Renderer::draw(const CameraModel& camera, const Pose& X_WC, const Scene& scene, const Out& out) {
  requireFinite(camera, X_WC, scene);
  std::visit([&](auto* image) { image->resize(camera.width(), camera.height(), camera.drawnEncoding()); }, out);
  doRender(camera, X_WC, scene, out);
}

}  // namespace aras_visual_servo_sim
