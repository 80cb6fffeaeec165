#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/robot/joint_limits.hpp"

namespace aras_visual_servo_sim {

/** Shape of a visual, in its own frame. Boxes are centred; cylinders and cones are centred with their axis along z, the
 *  tip of a cone at +z. */
struct Geometry {
  enum class Type { kBox, kCylinder, kSphere, kMesh, kCone };
  Type type = Type::kBox;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  ///< box, and the box around a cone: full edge lengths
  double radius_m = 0.0;                             ///< cylinder, sphere, cone
  double length_m = 0.0;                             ///< cylinder, cone
  std::string filename;                              ///< mesh: as written, e.g. package://pkg/meshes/a.stl
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();   ///< mesh
};

/** How a surface answers light, beside its diffuse colour. */
struct Finish {
  std::optional<Rgba> ambient;  ///< nothing: its diffuse colour
  Rgba specular{0.0, 0.0, 0.0, 1.0};
  double shininess = 1.0;
  Rgba emissive{0.0, 0.0, 0.0, 1.0};
  bool unlit = false;  ///< drawn in its own colour, whatever the lights are: <lighting>false</lighting>
};

/** Texture coordinates of a shape to those of its picture, (s', t') = A [s t 1]'. s runs to the right and t downwards,
 *  each from 0 to 1 over the picture, which repeats beyond. */
using TextureTransform = Eigen::Matrix<double, 2, 3>;

/** One <visual> of a link. */
struct Visual {
  std::string link;
  Pose X_link_visual;
  Geometry geometry;
  Rgba color;
  Finish finish;
  bool has_color = false;                             ///< false: the URDF gave no material, `color` is the default grey
  std::string texture;                                ///< picture of the URDF's material, as written; empty: none
  std::optional<TextureTransform> texture_transform;  ///< nothing: the picture lies as on every shape of its kind
};

/** One <collision> of a link. */
struct Collision {
  Geometry geometry;
  Pose X_link_collision;
};

/** kFloating: only as the one joint of the root link, whose child is then the robot's free base. */
enum class JointType { kFixed, kRevolute, kContinuous, kPrismatic, kFloating };

/** <mimic>: q = multiplier * q of another joint + offset. Chains are resolved: that joint is no mimic joint itself. */
struct Mimic {
  int joint = -1;  ///< index into RobotModel::joints of the joint it follows, -1: it follows none
  double multiplier = 1.0, offset = 0.0;
};

/** What static friction adds to Coulomb friction: `excess` exp(-(v / `velocity`)^2). */
struct Stribeck {
  double excess = 0.0;    ///< static minus Coulomb friction, [N] or [N m]
  double velocity = 1.0;  ///< [m/s] or [rad/s]
};

struct Joint {
  std::string name;
  JointType type = JointType::kFixed;
  int parent_link = -1;  ///< index into RobotModel::links
  int child_link = -1;
  Pose X_PJ;                                        ///< child link's frame in the parent link's, at q = 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit, in the child link's frame
  JointLimits limits;    ///< stops and set-points; narrowed by those of the joints that mimic this one
  JointLimits enforced;  ///< limits of its controller's commands: the same, unless joint_limits gives others
  SoftLimits soft;       ///< likewise
  Mimic mimic;
  double damping = 0.0;                          ///< [N s/m] or [N m s/rad]
  double friction = 0.0;                         ///< Coulomb, [N] or [N m]
  std::vector<Stribeck> stribeck;                ///< one at most; with those of followers where a drive adds them up
  std::vector<std::string> hardware_interfaces;  ///< from <transmission>, without "hardware_interface/"
  int index = -1;                                ///< into RobotModel::joint_names, -1 for fixed and floating

  bool moves() const { return type != JointType::kFixed && type != JointType::kFloating; }
  /** Dry friction at a speed: Coulomb's, and Stribeck's part of static friction (Armstrong-Helouvry, Dupont and Canudas
   *  de Wit, Automatica 30(7), 1994, section 2.3). */
  double dryFriction(double v) const;
};

struct Link {
  std::string name;
  int parent_joint = -1;  ///< index into RobotModel::joints, -1 for the root
  double mass_kg = 0.0;
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();          ///< in the link frame
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  ///< about the centre of mass, axes of the link frame
  std::vector<Visual> visuals;
  std::vector<Collision> collisions;
};

/** A <gazebo reference="link"><sensor type="camera"> with its plugin's names; zero or empty without the tag. */
struct CameraTag {
  std::string link, sensor_name, camera_name, image_topic, camera_info_topic, trigger_topic, frame, format;
  std::optional<std::string> robot_namespace;
  Pose X_link_sensor;  ///< the sensor looks along its x, z up
  double update_rate_hz = 0.0, horizontal_fov_rad = 0.0, near_m = 0.0, far_m = 0.0;
  int width = 0, height = 0;
  double noise_mean = 0.0, noise_stddev = 0.0;                    ///< of intensities 0 .. 1
  double cx = 0.0, cy = 0.0, focal_length = 0.0, baseline = 0.0;  ///< the plugin's, [px], [m]
  std::vector<double> sensor_distortion;                          ///< k1 k2 p1 p2 k3 of the sensor's <distortion>
  std::vector<double> distortion;                                 ///< the same of the plugin's keys
  bool auto_distortion = false, triggered = false;
  bool fisheye = false;           ///< <sensor type="wideanglecamera"> with an equidistant <lens>
  double cutoff_angle_rad = 0.0;  ///< of that lens
};

/** A <gazebo reference="link"><light>: its text, as SDF. */
struct LightTag {
  std::string link, sdf;
};

/** Returns ROBOT::NAME, the name of a link or a camera in a world of several robots; NAME if the robot has no name. */
std::string scoped(const std::string& robot, const std::string& name);

/** The contents of a URDF after checking; constant after loading. Parents stand before their children in `links`. */
struct RobotModel {
  std::string name;
  std::string source_name;  ///< file name for messages
  std::vector<Link> links;
  std::vector<Joint> joints;
  std::vector<std::string> joint_names;  ///< moving joints sorted by name: the order of every joint vector
  std::vector<int> moving_joints;        ///< joint_names[i] is joints[moving_joints[i]].name
  std::vector<CameraTag> cameras;
  std::vector<LightTag> lights;
  std::vector<std::string> warnings;  ///< what was ignored, one line each

  int dofs() const { return static_cast<int>(joint_names.size()); }
  /** @return index into joint_names. @throws UnknownNameError */
  int jointIndex(const std::string& joint_name) const;
  /** @return index into links. @throws UnknownNameError */
  int linkIndex(const std::string& link_name) const;
  /** Moving joint at an index of joint_names. */
  const Joint& movingJoint(int index) const { return joints[moving_joints[index]]; }
  /** The floating joint between the root link and its only child, or null. */
  const Joint* floatingJoint() const;
};

}  // namespace aras_visual_servo_sim
