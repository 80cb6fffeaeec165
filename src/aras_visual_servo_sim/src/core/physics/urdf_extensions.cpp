#include "urdf_extensions.hpp"

#include <cmath>
#include <cstdlib>

namespace aras_visual_servo_sim {

using tinyxml2::XMLElement;

namespace {

std::string textOf(const XMLElement* element) {
  const char* text = element ? element->GetText() : nullptr;
  if (!text) return "";
  const std::string all = text;
  const auto first = all.find_first_not_of(" \t\r\n");
  return first == std::string::npos ? "" : all.substr(first, all.find_last_not_of(" \t\r\n") - first + 1);
}

std::string childText(const XMLElement* parent, const char* tag) {
  return parent ? textOf(parent->FirstChildElement(tag)) : "";
}

/** Number in the text of a child element, 0 when there is no such child. */
double childNumber(const UrdfSource& source, const XMLElement* parent, const char* tag) {
  const XMLElement* child = parent ? parent->FirstChildElement(tag) : nullptr;
  if (!child) return 0.0;
  const std::string text = textOf(child);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value)) {
    source.fail(*child, "value is '" + text + "', must be a finite number");
  }
  return value;
}

bool hasLink(const RobotModel& model, const std::string& name) {
  for (const auto& link : model.links) {
    if (link.name == name) return true;
  }
  return false;
}

void readPlugin(const UrdfSource& source, const XMLElement& plugin, CameraTag& tag) {
  tag.camera_name = childText(&plugin, "cameraName");
  tag.image_topic = childText(&plugin, "imageTopicName");
  tag.camera_info_topic = childText(&plugin, "cameraInfoTopicName");
  tag.frame = childText(&plugin, "frameName");
  if (!plugin.FirstChildElement("distortionK1")) return;
  for (const char* key : {"distortionK1", "distortionK2", "distortionT1", "distortionT2", "distortionK3"}) {
    tag.distortion.push_back(childNumber(source, &plugin, key));
  }
}

CameraTag readCamera(const UrdfSource& source, const XMLElement& sensor, const std::string& link) {
  CameraTag tag;
  tag.link = link;
  tag.sensor_name = sensor.Attribute("name") ? sensor.Attribute("name") : "";
  tag.update_rate_hz = childNumber(source, &sensor, "update_rate");
  if (const XMLElement* camera = sensor.FirstChildElement("camera")) {
    const XMLElement* image = camera->FirstChildElement("image");
    const XMLElement* clip = camera->FirstChildElement("clip");
    tag.horizontal_fov_rad = childNumber(source, camera, "horizontal_fov");
    tag.width = static_cast<int>(childNumber(source, image, "width"));
    tag.height = static_cast<int>(childNumber(source, image, "height"));
    tag.format = childText(image, "format");
    tag.near_m = childNumber(source, clip, "near");
    tag.far_m = childNumber(source, clip, "far");
  }
  if (const XMLElement* plugin = sensor.FirstChildElement("plugin")) readPlugin(source, *plugin, tag);
  return tag;
}

}  // namespace

void readTransmissions(const UrdfSource& source, const XMLElement& robot, RobotModel& model) {
  for (const XMLElement* transmission = robot.FirstChildElement("transmission"); transmission;
       transmission = transmission->NextSiblingElement("transmission")) {
    const XMLElement* actuator = transmission->FirstChildElement("actuator");
    for (const XMLElement* end = transmission->FirstChildElement("joint"); end;
         end = end->NextSiblingElement("joint")) {
      const std::string name = end->Attribute("name") ? end->Attribute("name") : "";
      Joint* joint = nullptr;
      for (auto& each : model.joints) {
        if (each.name == name) joint = &each;
      }
      if (!joint) source.fail(*end, "transmission acts on joint '" + name + "', must be a <joint> of this file");
      // Older files have it in the actuator.
      const XMLElement* holder = end->FirstChildElement("hardwareInterface") ? end : actuator;
      for (const XMLElement* interface = holder ? holder->FirstChildElement("hardwareInterface") : nullptr; interface;
           interface = interface->NextSiblingElement("hardwareInterface")) {
        const std::string text = textOf(interface);
        const auto slash = text.rfind('/');
        joint->hardware_interfaces.push_back(slash == std::string::npos ? text : text.substr(slash + 1));
      }
    }
    const double reduction = actuator ? childNumber(source, actuator, "mechanicalReduction") : 0.0;
    if (reduction != 0.0 && reduction != 1.0) source.warn(*transmission, "mechanicalReduction is ignored");
  }
}

void readGazeboTags(const UrdfSource& source, const XMLElement& robot, RobotModel& model) {
  for (const XMLElement* gazebo = robot.FirstChildElement("gazebo"); gazebo;
       gazebo = gazebo->NextSiblingElement("gazebo")) {
    const std::string reference = gazebo->Attribute("reference") ? gazebo->Attribute("reference") : "";
    for (const XMLElement* child = gazebo->FirstChildElement(); child; child = child->NextSiblingElement()) {
      const std::string tag = child->Name();
      const char* type = child->Attribute("type");
      if (tag == "sensor" && type && std::string(type) == "camera") {
        if (!hasLink(model, reference)) {
          source.fail(*gazebo, "reference is '" + reference + "', must be a <link> of this file");
        }
        model.cameras.push_back(readCamera(source, *child, reference));
      } else {
        source.warn(*child, "in <gazebo reference='" + reference + "'>: ignored");
      }
    }
  }
}

}  // namespace aras_visual_servo_sim
