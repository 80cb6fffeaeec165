#pragma once

#include <memory>
#include <string>

#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim::fuzz {

/** Two joints, a prismatic `slide` and a revolute `turn`, with every hardware interface. */
inline RobotModel smallArm() {
  std::string urdf = "<robot name='small'>";
  for (const char* link : {"base", "mid", "tip"}) {
    urdf += "<link name='" + std::string(link) +
            "'><inertial><mass value='1'/><inertia ixx='.01' iyy='.01' izz='.01' ixy='0' ixz='0' iyz='0'/></inertial>"
            "<collision><geometry><sphere radius='.05'/></geometry></collision></link>";
  }
  const auto joint = [&](const std::string& name, const std::string& type, const char* parent, const char* child) {
    urdf += "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child +
            "'/><origin xyz='0 0 .2'/><axis xyz='1 0 0'/><limit lower='-2' upper='2' effort='50' velocity='3'/>"
            "<dynamics damping='.5' friction='.1'/></joint><transmission name='of_" +
            name + "'><joint name='" + name +
            "'><hardwareInterface>EffortJointInterface</hardwareInterface><hardwareInterface>PositionJointInterface"
            "</hardwareInterface><hardwareInterface>VelocityJointInterface</hardwareInterface></joint></transmission>";
  };
  joint("slide", "prismatic", "base", "mid");
  joint("turn", "revolute", "mid", "tip");
  return loadRobotModel(urdf + "</robot>", "small.urdf");
}

/** That arm over a floor with a crate on it, a target that circles, a lamp, and a camera with an exposure, latency and
 *  a sensor that sets itself: every part that a saved state has. */
inline std::unique_ptr<Simulation> smallSimulation() {
  const YAML::Node sim = YAML::Load(R"(
contacts: {ground_plane: {z_m: -0.3, friction: 0.5}, pairs: [[robot, crate]]}
cameras:
  - {name: camera, frame: tip, width: 16, height: 12, horizontal_fov_rad: 1.2, rate_hz: 200, noise_stddev: 1,
     exposure_s: 0.002, exposure_samples: 2, latency_s: 0.002, drop_probability: 0.1}
scene:
  lighting: {lights: [{name: lamp, type: point, position_m: [0, 0, 2]}]}
  models:
    - {name: target, color_rgb: [20, 20, 20], outlines_m: [[[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05]]],
       position_m: [0, 0, 0.9], motion: {type: circle, radius_m: 0.1, angular_speed_rad_per_s: 1.0}}
  solids:
    - {name: crate, box_m: [0.1, 0.1, 0.1], mass_kg: 0.5, touches: all, position_m: [0.1, 0, -0.2]}
)");
  const YAML::Node controllers = YAML::Load(R"(
slide: {type: effort_controllers/JointPositionController, joint: slide, pid: {p: 100, i: 1, d: 20, i_clamp: 5}}
turn: {type: velocity_controllers/JointVelocityController, joint: turn}
)");
  return std::make_unique<Simulation>(smallArm(), SimulationConfig::fromYaml(sim), controllers);
}

/** Whether the joints and the crate are somewhere. */
inline bool finite(const Simulation& simulation) {
  const MultibodyWorld& world = simulation.body();
  return world.jointPositions().allFinite() && world.jointVelocities().allFinite() &&
         world.obstaclePose("crate").p.allFinite() && world.obstacleTwist("crate").allFinite();
}

}  // namespace aras_visual_servo_sim::fuzz
