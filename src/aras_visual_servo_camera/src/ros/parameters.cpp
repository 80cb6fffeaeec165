#include "parameters.hpp"

#include <XmlRpcValue.h>
#include <yaml-cpp/yaml.h>

#include <cstdio>
#include <string>

#include "aras_visual_servo_camera/errors.hpp"

namespace aras_visual_servo_camera {
namespace {

YAML::Node toYaml(XmlRpc::XmlRpcValue& value) {
  YAML::Node node;
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return YAML::Node(static_cast<bool>(value) ? "true" : "false");
    case XmlRpc::XmlRpcValue::TypeInt:
      return YAML::Node(std::to_string(static_cast<int>(value)));
    case XmlRpc::XmlRpcValue::TypeDouble: {
      char text[40];
      std::snprintf(text, sizeof text, "%.17g", static_cast<double>(value));
      return YAML::Node(std::string(text));
    }
    case XmlRpc::XmlRpcValue::TypeString:
      node = YAML::Node(static_cast<std::string>(value));
      node.SetTag("!");  // as quoted text: never taken for a number
      return node;
    case XmlRpc::XmlRpcValue::TypeArray:
      node = YAML::Node(YAML::NodeType::Sequence);
      for (int k = 0; k < value.size(); ++k) node.push_back(toYaml(value[k]));
      return node;
    case XmlRpc::XmlRpcValue::TypeStruct:
      node = YAML::Node(YAML::NodeType::Map);
      for (auto& entry : value) node.force_insert(entry.first, toYaml(entry.second));
      return node;
    default:
      return YAML::Node(YAML::NodeType::Null);
  }
}

}  // namespace

VisionConfig readParameters(const ros::NodeHandle& node, const ros::NodeHandle& private_node) {
  XmlRpc::XmlRpcValue value;
  if (private_node.getParam("vision", value) || private_node.getParam("scenario/vision", value) ||
      node.getParam("scenario/vision", value))
    return readVisionConfig(toYaml(value));
  throw ParameterError("vision: found nothing, allowed a mapping in " + private_node.resolveName("vision") + ", " +
                       private_node.resolveName("scenario/vision") + " or " + node.resolveName("scenario/vision"));
}

}  // namespace aras_visual_servo_camera
