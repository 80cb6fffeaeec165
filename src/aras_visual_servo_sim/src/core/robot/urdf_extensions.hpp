#pragma once

#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "urdf_check.hpp"

namespace aras_visual_servo_sim {

/** Fills Joint::hardware_interfaces from <transmission>. @throws ModelError for an unknown joint. */
void readTransmissions(const UrdfSource& source, const tinyxml2::XMLElement& robot, RobotModel& model);

/** Fills Joint::mimic, chains resolved, and narrows the limits of the joints followed by those of their followers.
 *  @throws ModelError for an unknown or fixed joint, a loop, limits that leave nothing. */
void readMimics(const UrdfSource& source, const tinyxml2::XMLElement& robot, RobotModel& model);

/** Fills Joint::stribeck from `static_friction` and `stribeck_velocity` of <dynamics>, which checkUrdf has checked. */
void readStribeck(const UrdfSource& source, const tinyxml2::XMLElement& robot, RobotModel& model);

/** Fills RobotModel::cameras from <gazebo reference=...><sensor type="camera">, RobotModel::lights from <light>, and
 * paints links with Gazebo's plain <material>s; other content becomes warnings.
 *  @throws ModelError for an unknown link or a malformed number. */
void readGazeboTags(const UrdfSource& source, const tinyxml2::XMLElement& robot, RobotModel& model);

}  // namespace aras_visual_servo_sim
