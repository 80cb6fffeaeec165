#include "urdf_extensions.hpp"

#include "robot/gazebo/gazebo_tags.hpp"
#include "urdf_text.hpp"

namespace aras_visual_servo_sim {

using tinyxml2::XMLElement;

namespace {

bool hasLink(const RobotModel& model, const std::string& name) {
  for (const auto& link : model.links) {
    if (link.name == name) return true;
  }
  return false;
}

/** Gives every visual of a link one of Gazebo's materials. @return false if there is none of that name */
bool paintLink(const std::string& material, const std::string& link, RobotModel& model) {
  const std::optional<GazeboMaterial> found = gazeboMaterial(material);
  if (!found || !hasLink(model, link)) return false;
  for (Visual& visual : model.links[model.linkIndex(link)].visuals) paint(*found, visual);
  return true;
}

std::string printed(const XMLElement& element) {
  tinyxml2::XMLPrinter printer;
  element.Accept(&printer);
  return printer.CStr();
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
    const std::string reduction = childText(actuator, "mechanicalReduction");
    if (!reduction.empty() && std::strtod(reduction.c_str(), nullptr) != 1.0) {
      source.warn(*transmission, "mechanicalReduction '" + reduction + "' is ignored");
    }
  }
}

void readGazeboTags(const UrdfSource& source, const XMLElement& robot, RobotModel& model) {
  for (const XMLElement* gazebo = robot.FirstChildElement("gazebo"); gazebo;
       gazebo = gazebo->NextSiblingElement("gazebo")) {
    const std::string reference = gazebo->Attribute("reference") ? gazebo->Attribute("reference") : "";
    for (const XMLElement* child = gazebo->FirstChildElement(); child; child = child->NextSiblingElement()) {
      const std::string tag = child->Name();
      const char* type = child->Attribute("type");
      const std::string sensor = tag == "sensor" && type ? type : "";
      if (sensor == "camera" || (sensor == "wideanglecamera" && hasEquidistantLens(source, *child))) {
        if (!hasLink(model, reference)) {
          source.fail(*gazebo, "reference is '" + reference + "', must be a <link> of this file");
        }
        model.cameras.push_back(readCameraSensor(source, *child, reference));
        continue;
      }
      if (sensor == "wideanglecamera") continue;  // warned of
      if (tag == "light") {
        if (!hasLink(model, reference)) {
          source.fail(*gazebo, "reference is '" + reference + "', must be a <link> of this file");
        }
        model.lights.push_back({reference, printed(*child)});
        continue;
      }
      if (tag == "visual" && hasLink(model, reference)) {
        readVisualTag(source, *child, robot, model.links[model.linkIndex(reference)]);
        continue;
      }
      const std::string material = tag == "material" ? textOf(child) : "";
      if (!material.empty() && paintLink(material, reference, model)) continue;
      const std::string why = material.empty() ? "" : "material '" + material + "' is not a plain colour of Gazebo's: ";
      source.warn(*child, "in <gazebo reference='" + reference + "'>: " + why + "ignored");
    }
  }
}

}  // namespace aras_visual_servo_sim
