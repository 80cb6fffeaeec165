#include <sstream>

#include "aras_visual_servo_sim/config/section.hpp"
#include "robot/gazebo/gazebo_tags.hpp"
#include "robot/urdf_check.hpp"

namespace aras_visual_servo_sim {

using tinyxml2::XMLElement;

namespace {

Pose readPose(const UrdfSource& source, const XMLElement* element) {
  Pose pose;
  if (!element) return pose;
  std::istringstream text(textOf(element));
  Eigen::Vector3d rpy;
  std::string rest;
  if (!(text >> pose.p.x() >> pose.p.y() >> pose.p.z() >> rpy.x() >> rpy.y() >> rpy.z()) || text >> rest) {
    source.fail(*element, "value is '" + textOf(element) + "', must be six finite numbers x y z roll pitch yaw");
  }
  pose.q = quaternionFromRpy(rpy);
  return pose;
}

/** Pixels along one side of the image; 0 where the tag says nothing. */
int readPixels(const UrdfSource& source, const XMLElement* image, const char* side) {
  if (!image || !image->FirstChildElement(side)) return 0;
  const double pixels = childNumber(source, image, side);
  const auto& allowed = sectionOf("camera").properties.at(side)->range;
  if (!allowed.contains(pixels)) {
    source.fail(*image->FirstChildElement(side), "value is " + childText(image, side) + ", must be " + allowed.text());
  }
  return static_cast<int>(pixels);
}

void readNoise(const UrdfSource& source, const XMLElement* noise, CameraTag& tag) {
  if (!noise) return;
  const std::string type = childText(noise, "type");
  if (type != "none" && type != "gaussian" && !type.empty()) {
    source.warn(*noise, "type '" + type + "' is ignored, there is gaussian");
    return;
  }
  if (type == "none") return;
  tag.noise_mean = childNumber(source, noise, "mean");
  tag.noise_stddev = childNumber(source, noise, "stddev");
  warnOfOthers(source, noise, {"type", "mean", "stddev"});
}

void readLens(const UrdfSource& source, const XMLElement* distortion, CameraTag& tag) {
  if (!distortion) return;
  for (const char* key : {"k1", "k2", "p1", "p2", "k3"}) {
    tag.sensor_distortion.push_back(childNumber(source, distortion, key));
  }
  const XMLElement* center = distortion->FirstChildElement("center");
  std::istringstream text(textOf(center));
  double u = 0.5, v = 0.5;
  if (center && (!(text >> u >> v) || u != 0.5 || v != 0.5)) {
    source.warn(*center, "is ignored: the lens is centred on the principal point");
  }
  warnOfOthers(source, distortion, {"k1", "k2", "k3", "p1", "p2", "center"});
}

void readWideLens(const UrdfSource& source, const XMLElement* lens, CameraTag& tag) {
  constexpr double kDefaultCutoff = 1.5707;  // SDF's
  if (!lens) return;
  tag.fisheye = true;
  const double cutoff = childNumber(source, lens, "cutoff_angle");
  tag.cutoff_angle_rad = cutoff > 0.0 ? cutoff : kDefaultCutoff;
  if (!childFlag(source, lens, "scale_to_hfov", true)) {
    source.warn(*lens->FirstChildElement("scale_to_hfov"), "false is ignored: the image's width is the horizontal_fov");
  }
  if (const XMLElement* polynomial = lens->FirstChildElement("polynomial")) {
    tag.sensor_distortion.assign(4, 0.0);
    std::istringstream text(textOf(polynomial));
    std::string rest;
    for (double& k : tag.sensor_distortion) text >> k;
    if (!text || text >> rest) {
      source.fail(*polynomial, "value is '" + textOf(polynomial) + "', must be four finite numbers k1 k2 k3 k4");
    }
  }
  // The size of Gazebo's cube of textures has no meaning here: there is none.
  warnOfOthers(source, lens, {"type", "scale_to_hfov", "cutoff_angle", "env_texture_size", "polynomial"});
}

void readPlugin(const UrdfSource& source, const XMLElement& plugin, CameraTag& tag) {
  const char* file = plugin.Attribute("filename");
  tag.triggered = file && std::string(file).find("triggered_camera") != std::string::npos;
  tag.camera_name = childText(&plugin, "cameraName");
  tag.image_topic = childText(&plugin, "imageTopicName");
  tag.camera_info_topic = childText(&plugin, "cameraInfoTopicName");
  tag.trigger_topic = childText(&plugin, "triggerTopicName");
  if (plugin.FirstChildElement("robotNamespace")) tag.robot_namespace = childText(&plugin, "robotNamespace");
  tag.frame = childText(&plugin, "frameName");
  tag.cx = childNumber(source, &plugin, "Cx");
  tag.cy = childNumber(source, &plugin, "Cy");
  tag.focal_length = childNumber(source, &plugin, "focalLength");
  tag.baseline = childNumber(source, &plugin, "hackBaseline");
  tag.auto_distortion = childFlag(source, &plugin, "autoDistortion", false);
  const XMLElement* crop = plugin.FirstChildElement("borderCrop");
  if (childFlag(source, &plugin, "borderCrop", false)) {
    source.warn(*crop, "is ignored: images are never scaled up to hide a lens's dark border, so the coefficients hold");
  }
  const XMLElement* rate = plugin.FirstChildElement("updateRate");
  const double info_rate = childNumber(source, &plugin, "updateRate");
  if (info_rate > 0.0 && info_rate < tag.update_rate_hz) {
    source.warn(*rate, "is ignored: camera_info comes with every image, at the sensor's update_rate");
  }
  const auto given = [&plugin](const char* key) { return plugin.FirstChildElement(key) != nullptr; };
  if (given("distortionK1") || given("distortionK2") || given("distortionK3") || given("distortionT1") ||
      given("distortionT2")) {
    for (const char* key : {"distortionK1", "distortionK2", "distortionT1", "distortionT2", "distortionK3"}) {
      tag.distortion.push_back(childNumber(source, &plugin, key));
    }
  }
  // CxPrime is read by Gazebo's plugin and used nowhere.
  warnOfOthers(
      source, &plugin,
      {"robotNamespace",   "alwaysOn",       "updateRate", "cameraName",   "imageTopicName", "cameraInfoTopicName",
       "triggerTopicName", "frameName",      "Cx",         "Cy",           "CxPrime",        "focalLength",
       "hackBaseline",     "autoDistortion", "borderCrop", "distortionK1", "distortionK2",   "distortionK3",
       "distortionT1",     "distortionT2"});
}

}  // namespace

bool hasEquidistantLens(const UrdfSource& source, const XMLElement& sensor) {
  const XMLElement* camera = sensor.FirstChildElement("camera");
  const XMLElement* lens = camera ? camera->FirstChildElement("lens") : nullptr;
  const std::string type = lens ? childText(lens, "type") : "";
  if (type == "equidistant") return true;
  source.warn(sensor, "of type wideanglecamera is ignored: its <lens> is '" + type + "', there is equidistant");
  return false;
}

CameraTag readCameraSensor(const UrdfSource& source, const XMLElement& sensor, const std::string& link) {
  CameraTag tag;
  tag.link = link;
  tag.sensor_name = sensor.Attribute("name") ? sensor.Attribute("name") : "";
  tag.update_rate_hz = childNumber(source, &sensor, "update_rate");
  tag.X_link_sensor = readPose(source, sensor.FirstChildElement("pose"));
  warnOfOthers(source, &sensor, {"update_rate", "camera", "plugin", "pose", "always_on", "visualize"});
  if (const XMLElement* camera = sensor.FirstChildElement("camera")) {
    const XMLElement* image = camera->FirstChildElement("image");
    const XMLElement* clip = camera->FirstChildElement("clip");
    tag.X_link_sensor = tag.X_link_sensor * readPose(source, camera->FirstChildElement("pose"));
    tag.horizontal_fov_rad = childNumber(source, camera, "horizontal_fov");
    tag.width = readPixels(source, image, "width");
    tag.height = readPixels(source, image, "height");
    tag.format = childText(image, "format");
    tag.near_m = childNumber(source, clip, "near");
    tag.far_m = childNumber(source, clip, "far");
    readNoise(source, camera->FirstChildElement("noise"), tag);
    readLens(source, camera->FirstChildElement("distortion"), tag);
    const XMLElement* lens = camera->FirstChildElement("lens");
    const char* type = sensor.Attribute("type");
    if (type && std::string(type) == "wideanglecamera") {
      readWideLens(source, lens, tag);
    } else if (lens) {
      source.warn(*lens, "in <camera>: ignored");
    }
    warnOfOthers(source, camera, {"horizontal_fov", "image", "clip", "noise", "distortion", "lens", "pose", "save"});
    warnOfOthers(source, image, {"width", "height", "format"});
    warnOfOthers(source, clip, {"near", "far"});
  }
  if (const XMLElement* plugin = sensor.FirstChildElement("plugin")) readPlugin(source, *plugin, tag);
  return tag;
}

}  // namespace aras_visual_servo_sim
