#pragma once

#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim {

/** The slider with a safety controller. */
inline RobotModel softModel() {
  std::string urdf = readUrdf("slider.urdf");
  urdf = replaced(urdf, "lower=\"-100\" upper=\"100\"", "lower=\"-0.25\" upper=\"0.35\"");
  urdf = replaced(urdf, "effort=\"1000\" velocity=\"1000\"", "effort=\"40\" velocity=\"2\"");
  return modelOf(replaced(urdf, "</joint>",
                          "<safety_controller k_position=\"12\" k_velocity=\"25\" soft_lower_limit=\"-0.2\" "
                          "soft_upper_limit=\"0.3\"/></joint>"));
}

}  // namespace aras_visual_servo_sim
