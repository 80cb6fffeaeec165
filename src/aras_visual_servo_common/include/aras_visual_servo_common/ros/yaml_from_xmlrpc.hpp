#pragma once

#include <XmlRpcValue.h>
#include <yaml-cpp/yaml.h>

#include <string>

#include "aras_visual_servo_common/yaml_value.hpp"

namespace aras_visual_servo_common {

/** A value of the parameter server as YAML. Strings stay strings ("1" does not become 1), numbers keep every bit. What
 *  YAML does not have (dates, binary) is null. */
inline YAML::Node yamlFromXmlRpc(XmlRpc::XmlRpcValue value) {
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return YAML::Node(static_cast<bool>(value) ? "true" : "false");
    case XmlRpc::XmlRpcValue::TypeInt:
      return YAML::Node(std::to_string(static_cast<int>(value)));
    case XmlRpc::XmlRpcValue::TypeDouble:
      return exactNumber(static_cast<double>(value));
    case XmlRpc::XmlRpcValue::TypeString:
      return quotedText(static_cast<std::string>(value));
    case XmlRpc::XmlRpcValue::TypeArray: {
      YAML::Node node(YAML::NodeType::Sequence);
      for (int k = 0; k < value.size(); ++k) node.push_back(yamlFromXmlRpc(value[k]));
      return node;
    }
    case XmlRpc::XmlRpcValue::TypeStruct: {
      YAML::Node node(YAML::NodeType::Map);
      for (auto& member : value) node.force_insert(member.first, yamlFromXmlRpc(member.second));
      return node;
    }
    default:
      return YAML::Node();
  }
}

}  // namespace aras_visual_servo_common
