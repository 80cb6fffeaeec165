#include "aras_visual_servo_sim/errors.hpp"
#include "aras_visual_servo_sim/simulation.hpp"

namespace aras_visual_servo_sim {
namespace {

std::string encodingOf(const CameraTag& tag) {
  if (tag.format.empty() || tag.format == "R8G8B8" || tag.format == "RGB_INT8") return "rgb8";
  if (tag.format == "B8G8R8" || tag.format == "BGR_INT8") return "bgr8";
  if (tag.format == "L8" || tag.format == "L_INT8") return "mono8";
  throw ModelError("camera '" + tag.camera_name + "': <format> is " + tag.format + ", allowed R8G8B8, B8G8R8, L8");
}

}  // namespace

std::vector<CameraConfig> camerasFromTags(const RobotModel& model) {
  std::vector<CameraConfig> cameras;
  for (const CameraTag& tag : model.cameras) {
    CameraConfig camera;
    camera.name = !tag.camera_name.empty() ? tag.camera_name : tag.sensor_name;
    while (!camera.name.empty() && camera.name.front() == '/') camera.name.erase(0, 1);
    camera.frame = !tag.frame.empty() ? tag.frame : tag.link;
    camera.width = tag.width;
    camera.height = tag.height;
    camera.encoding = encodingOf(tag);
    if (tag.horizontal_fov_rad > 0.0) camera.horizontal_fov_rad = tag.horizontal_fov_rad;
    if (tag.update_rate_hz > 0.0) camera.rate_hz = tag.update_rate_hz;
    if (tag.near_m > 0.0) camera.near_m = tag.near_m;
    if (tag.far_m > 0.0) camera.far_m = tag.far_m;
    if (!tag.distortion.empty()) {
      camera.distortion_model = "plumb_bob";
      camera.distortion = tag.distortion;
    }
    cameras.push_back(camera);
  }
  return cameras;
}

}  // namespace aras_visual_servo_sim
