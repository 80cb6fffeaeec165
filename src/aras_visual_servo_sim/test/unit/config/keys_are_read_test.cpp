// Every key that a section describes is read by somebody. To see it, a key is taken out of its section and a document
// is read: whoever reads the key then complains that it is not described, and if nobody does, nobody reads it.
#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/physics/joint_controller.hpp"
#include "aras_visual_servo_sim/physics/joint_state_config.hpp"
#include "aras_visual_servo_sim/physics/managed/controller.hpp"
#include "aras_visual_servo_sim/robot/joint_limits_reader.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation_config.hpp"
#include "aras_visual_servo_sim/simulation/time/time_config.hpp"
#include "schema_sections.hpp"
#include "tools/two_joints.hpp"

namespace aras_visual_servo_sim {
namespace {

/** The section `node` is read by the ROS node, which cannot be made without a master. */
const std::set<std::string> kReadElsewhere = {"node"};

/** Keys of joint_limits_interface that are accepted and have no effect. */
const std::set<std::string> kIgnored = {"joint_limits/angle_wraparound"};

const char* const kSim = R"(
contacts: {ground_plane: {}, free_bodies: {box: 1.0}}
base_pose: {}
cameras: [{name: c, frame: f, width: 4, height: 3, horizontal_fov_rad: 1.0,
           sensor: {auto_exposure: {}, auto_white_balance: {},
                    depth_of_field: {focus_distance_m: 1, focal_length_m: 0.01, f_number: 2}}}]
scene:
  lighting: {lights: [{name: lamp, type: point}], fog: {density_per_m: 1}, zenith_rgb: [1, 2, 3]}
  models:
    - {name: a, outlines_m: &square [[[0, 0], [1, 0], [1, 1]]], motion: &straight {type: constant_velocity}}
    - {name: b, board: {size_m: [1, 1]}, motion: &circle {type: circle, radius_m: 1, angular_speed_rad_per_s: 1}}
    - {name: c, image: {file: x.png, size_m: [1, 1]}, motion: &walk {type: random_walk, interval_s: 1}}
    - {name: d, file: x.yaml, motion: &way {type: waypoints, waypoints: [{time_s: 1, position_m: [0, 0, 0]}]}}
  solids:
    - {name: box, box_m: [1, 1, 1], motion: *straight}
    - {name: cylinder, cylinder_m: [1, 1], motion: *circle}
    - {name: cone, cone_m: [1, 1]}
    - {name: sphere, sphere_m: 1, motion: *walk}
    - {name: mesh, mesh: x.stl, motion: *way}
    - {name: urdf, urdf: x.urdf}
)";

const char* const kControllers = R"(
states: {type: joint_state_controller/JointStateController, extra_joints: [{name: extra}]}
c0: {type: effort_controllers/JointPositionController, joint: j0, pid: {p: 1}}
c1: {type: effort_controllers/JointVelocityController, joint: j1, pid: {p: 1}}
c2: {type: effort_controllers/JointEffortController, joint: j2}
c3: {type: position_controllers/JointPositionController, joint: j3}
c4: {type: velocity_controllers/JointVelocityController, joint: j4}
)";

const char* const kTrajectory = R"(
{type: effort_controllers/JointTrajectoryController, joints: [a], gains: {a: {p: 1}}, velocity_ff: {a: 1},
 constraints: {a: {goal: 1}}}
)";

const char* const kGroup = "{type: effort_controllers/JointGroupPositionController, joints: [a], a: {pid: {p: 1}}}";

const char* const kGripper = "{type: effort_controllers/GripperActionController, joint: a, gains: {a: {p: 1}}}";

const char* const kTarget = R"(
{name: t, outlines_m: [[[0, 0], [1, 0], [1, 1]]], board: {size_m: [1, 1]}, image: {file: no_such.png, size_m: [1, 1]}}
)";

/** A row of links with five revolute joints j0 .. j4. */
RobotModel robot() {
  const std::string inertial =
      "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
  std::string urdf = "<robot name='r'><link name='l0'>" + inertial + "</link>";
  for (int k = 0; k < 5; ++k) {
    const std::string joint = std::to_string(k), child = std::to_string(k + 1);
    urdf += "<link name='l" + child + "'>" + inertial + "</link><joint name='j" + joint +
            "' type='revolute'><parent link='l" + joint + "'/><child link='l" + child +
            "'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>";
  }
  return loadRobotModel(urdf + "</robot>", "r.urdf");
}

/** A section, and what reads a document that it describes, with every part that the section knows. */
struct Root {
  const char* section;
  std::function<void()> read;
};

std::vector<Root> roots() {
  const auto joint_limits = [] {
    RobotModel model = robot();
    applyJointLimits(YAML::Load("{joint_limits: {j0: {}}}"), model);
  };
  const auto controllers = [] {
    const RobotModel model = robot();
    parseControllers(YAML::Load(kControllers), model);
    parseJointStates(YAML::Load(kControllers), model);
  };
  const auto target = [] {
    try {
      planarModelFromYaml(YAML::Load(kTarget), "t", PackagePaths());
    } catch (const ModelError&) {  // all keys are read, and then there is no picture of this name
    }
  };
  const auto managed = [](const char* yaml) {
    return [yaml] {
      std::vector<std::string> warnings;
      makeController("c", YAML::Load(yaml), twoJoints(), warnings);
    };
  };
  return {{"trajectory_controller", managed(kTrajectory)},
          {"group_controller", managed("{type: effort_controllers/JointGroupEffortController, joints: [a]}")},
          {"group_pid_controller", managed(kGroup)},
          {"gripper_controller", managed(kGripper)},
          {"sim", [] { SimulationConfig::fromYaml(YAML::Load(kSim)); }},
          {"time", [] { TimeConfig::fromYaml(YAML::Load("{render: always}")); }},
          {"target", target},
          {"controller", controllers},
          {"joint_limits", joint_limits}};
}

/** Every map in a schema, each once; alternatives of a map count as part of it. */
void findMaps(const Schema& schema, std::set<const Schema*>& maps, std::set<std::string>& names) {
  names.insert(schema.name);
  std::vector<const Schema*> parts = {&schema};
  for (const auto& alternatives : {schema.any_of, schema.one_of})
    for (const auto& each : alternatives) parts.push_back(each.get());
  for (const Schema* part : parts) {
    if (!part->properties.empty()) maps.insert(&schema);
    for (const auto& property : part->properties) findMaps(*property.second, maps, names);
    if (part->additional) findMaps(*part->additional, maps, names);
    if (part->items) findMaps(*part->items, maps, names);
  }
}

using Properties = std::map<std::string, aras_visual_servo_common::SchemaPtr>;

/** The properties of a map and of its alternatives. The parser makes schemas as mutable objects. */
std::vector<Properties*> propertiesOf(const Schema& map) {
  std::vector<Properties*> all = {&const_cast<Schema&>(map).properties};
  for (const auto& alternatives : {map.any_of, map.one_of})
    for (const auto& each : alternatives) all.push_back(&const_cast<Schema&>(*each).properties);
  return all;
}

/** What reading says, "" if there is no fault. */
std::string faultsOf(const std::function<void()>& read) {
  try {
    read();
  } catch (const ArasError& error) {
    return error.what();
  }
  return "";
}

/** Whether somebody reads a key: without its description, a reader or the default of a member complains. */
bool isRead(const Schema& map, const std::string& key, const std::function<void()>& read) {
  std::vector<std::pair<Properties*, Properties>> kept;
  for (Properties* properties : propertiesOf(map)) {
    kept.emplace_back(properties, *properties);
    properties->erase(key);
  }
  const std::string faults = faultsOf(read);
  for (auto& [properties, before] : kept) properties->swap(before);
  // Without its description a key is, for some sections, one of the other names, which are maps.
  return faults.find(key + ": is read, but not described") != std::string::npos ||
         faults.find(key + ": is read as") != std::string::npos ||
         faults.find(key + ": has no default") != std::string::npos;
}

TEST(Keys, ThatASectionDescribesAreRead) {
  std::set<std::string> names;
  for (const Root& root : roots()) {
    EXPECT_EQ(faultsOf(root.read), "") << root.section;
    std::set<const Schema*> maps;
    findMaps(sectionOf(root.section), maps, names);
    for (const Schema* map : maps) {
      std::set<std::string> keys;
      for (const Properties* properties : propertiesOf(*map))
        for (const auto& property : *properties) keys.insert(property.first);
      for (const std::string& key : keys) {
        const std::string name = map->name + "/" + key;
        EXPECT_EQ(isRead(*map, key, root.read), kIgnored.count(name) == 0) << name << " in section " << root.section;
      }
    }
  }
  for (const std::string& section : schemaSections().names())
    EXPECT_EQ(names.count(section), 1 - kReadElsewhere.count(section)) << section << " is not looked at here";
}

}  // namespace
}  // namespace aras_visual_servo_sim
