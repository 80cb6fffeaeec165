#pragma once

#include <string>

#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

/** Reads and checks a URDF.
 *  @param urdf_xml     the document itself
 *  @param source_name  file name used in messages
 *  @throws ModelError naming file, line, element, joint or link, the value found and the value allowed. Planar joints
 * and floating joints other than the root's are refused; unknown tags are ignored with a line in `warnings`. */
RobotModel loadRobotModel(const std::string& urdf_xml, const std::string& source_name);

/** As above, from a file. @throws ModelError if it cannot be read. */
RobotModel loadRobotModelFile(const std::string& path);

}  // namespace aras_visual_servo_sim
