#include "parameters.hpp"

#include <aras_visual_servo_common/ros/yaml_from_xmlrpc.hpp>

#include "aras_visual_servo_camera/config/errors.hpp"

namespace aras_visual_servo_camera {

VisionConfig readParameters(const ros::NodeHandle& node, const ros::NodeHandle& private_node) {
  XmlRpc::XmlRpcValue value;
  if (private_node.getParam("vision", value) || private_node.getParam("scenario/vision", value) ||
      node.getParam("scenario/vision", value))
    return readVisionConfig(aras_visual_servo_common::yamlFromXmlRpc(value));
  throw ParameterError("vision: found nothing, allowed a mapping in " + private_node.resolveName("vision") + ", " +
                       private_node.resolveName("scenario/vision") + " or " + node.resolveName("scenario/vision"));
}

}  // namespace aras_visual_servo_camera
