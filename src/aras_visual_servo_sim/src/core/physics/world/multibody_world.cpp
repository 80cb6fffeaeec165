#include "aras_visual_servo_sim/physics/multibody_world.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "world_impl.hpp"

namespace aras_visual_servo_sim {

MultibodyWorld::MultibodyWorld(const RobotModel& model, const WorldConfig& config)
    : impl_(std::make_unique<Impl>(model, config)) {}
MultibodyWorld::~MultibodyWorld() = default;

const RobotModel& MultibodyWorld::model() const { return impl_->model; }
const WorldConfig& MultibodyWorld::config() const { return impl_->config; }
const std::vector<std::string>& MultibodyWorld::jointNames() const {
  return aras_visual_servo_sim::jointNames(impl_->model, impl_->config);
}
std::int64_t MultibodyWorld::ticks() const { return impl_->ticks; }
void MultibodyWorld::beginAt(std::int64_t tick) { impl_->ticks = tick; }
const Eigen::VectorXd& MultibodyWorld::jointPositions() const { return impl_->q; }
const Eigen::VectorXd& MultibodyWorld::jointVelocities() const { return impl_->v; }
const Eigen::VectorXd& MultibodyWorld::jointEfforts() const { return impl_->effort; }

void MultibodyWorld::reset(const Eigen::VectorXd& q) {
  if (q.size() != impl_->q.size()) {
    throw ShapeError("reset: found " + std::to_string(q.size()) + " positions, must be " +
                     std::to_string(impl_->q.size()));
  }
  if (impl_->driven) {
    std::map<int, double> positions;
    for (int i = 0; i < q.size(); ++i) positions[i] = q[i];
    if (!q.allFinite()) throw NotFiniteError("reset: found a position that is not finite, must be finite");
    impl_->start();
    impl_->driven->place(positions);
    impl_->followDriven();
    return;
  }
  for (int i = 0; i < q.size(); ++i) {
    if (!impl_->coupling.follows(i)) impl_->checkPosition(i, q[i]);
  }
  impl_->q = q;
  for (auto& drive : impl_->drives) drive.memory().gains = drive.controller().gains;
  impl_->start();
}

void MultibodyWorld::setJointPositions(const std::map<std::string, double>& positions) {
  if (impl_->driven) {
    impl_->driven->place(impl_->drivenValues(positions, "position"));
    impl_->followDriven();
    return;
  }
  Eigen::VectorXd wanted = impl_->q;
  for (const auto& item : positions) {
    const int i = impl_->model.jointIndex(item.first);
    if (!impl_->coupling.follows(i)) impl_->checkPosition(i, item.second);
    wanted[i] = item.second;
  }
  for (const auto& item : positions) impl_->checkFollower(impl_->model.jointIndex(item.first), wanted);
  for (const auto& item : positions) {
    const int i = impl_->model.jointIndex(item.first);
    if (impl_->coupling.follows(i)) continue;
    impl_->q[i] = item.second;
    impl_->v[i] = 0.0;
    impl_->effort[i] = 0.0;
    impl_->drives[impl_->coupling.coordinate(i)].start(item.second);
  }
  impl_->coupling.complete(impl_->q, impl_->v);
  impl_->body.setPositions(impl_->q);
  impl_->restartControllers();
}

void MultibodyWorld::setJointVelocities(const Eigen::VectorXd& v) {
  if (impl_->driven) throw ParameterError("setJointVelocities: the base is driven, must be moved by commands");
  if (v.size() != impl_->model.dofs()) {
    throw ShapeError("setJointVelocities: found " + std::to_string(v.size()) + " velocities, must be " +
                     std::to_string(impl_->model.dofs()));
  }
  if (!v.allFinite()) throw NotFiniteError("setJointVelocities: found a velocity that is not finite, must be finite");
  impl_->v = v;
  impl_->coupling.complete(impl_->q, impl_->v);
}

std::uint64_t MultibodyWorld::unsettledSteps() const { return impl_->unsettled_steps; }

std::vector<ContactForce> MultibodyWorld::contacts() const {
  std::vector<ContactForce> forces;
  if (!impl_->contacts) return forces;
  const auto& points = impl_->contacts->points();
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (std::max(points[k].a, points[k].b) < 0) continue;  // between others
    forces.push_back({impl_->contacts->nameOf(points[k].a), impl_->contacts->nameOf(points[k].b), points[k].point,
                      points[k].normal, points[k].depth_m, impl_->contacts->force(k)});
  }
  return forces;
}

Pose MultibodyWorld::obstaclePose(const std::string& obstacle) const {
  return impl_->contacts->obstaclePose(impl_->obstacle(obstacle));
}

void MultibodyWorld::setObstaclePose(const std::string& obstacle, const Pose& X_WO) {
  const std::size_t index = impl_->obstacle(obstacle);
  if (!X_WO.p.allFinite() || !X_WO.q.coeffs().allFinite()) {
    throw NotFiniteError("solid '" + obstacle + "': pose is not finite");
  }
  const auto& obstacles = impl_->contacts->obstacles();
  for (std::size_t k = index; k < obstacles.size(); ++k) {
    if (obstacles[k].name == obstacle) impl_->contacts->placeObstacle(k, {X_WO.p, X_WO.q.normalized()});
  }
}

Twist MultibodyWorld::obstacleTwist(const std::string& obstacle) const {
  return impl_->contacts->obstacleVelocity(impl_->obstacle(obstacle));
}

void MultibodyWorld::setContacts(const ContactConfig& config) {
  if (impl_->driven && config.pushes()) throw ParameterError("base: found driven with contacts, allowed no contacts");
  impl_->setContacts(config);
}

void MultibodyWorld::takeObstacles(MultibodyWorld& other) {
  if (impl_->contacts && other.impl_->contacts) impl_->contacts->takeOver(*other.impl_->contacts);
}

bool MultibodyWorld::floatingBase() const { return impl_->body.base() != nullptr; }

bool MultibodyWorld::drivenBase() const { return impl_->driven != nullptr; }

Pose MultibodyWorld::basePose() const {
  return impl_->body.base() ? impl_->body.base()->pose() : impl_->initialBasePose();
}

void MultibodyWorld::setBasePose(const Pose& X_WB) {
  impl_->checkBase("setBasePose", X_WB.p.allFinite() && X_WB.q.coeffs().allFinite());
  impl_->placeBase(X_WB);
}

void MultibodyWorld::setBaseTwist(const Twist& V_WB_W) {
  impl_->checkBase("setBaseTwist", V_WB_W.allFinite());
  if (impl_->driven) throw ParameterError("setBaseTwist: the base is driven, must be moved by commands");
  FloatingBase& base = *impl_->body.base();
  Twist velocity = V_WB_W;  // of the centre of mass
  velocity.head<3>() += V_WB_W.tail<3>().cross(base.com() - base.p());
  base.setVelocity(velocity);
}

void MultibodyWorld::step(int n) {
  if (n < 0) throw ParameterError("step: found " + std::to_string(n) + " steps, allowed >= 0");
  for (int i = 0; i < n; ++i) impl_->step();
}

void MultibodyWorld::setCommand(const JointCommand& command) { impl_->command(command, true); }

void MultibodyWorld::setPosition(const std::string& joint, double set_point) {
  impl_->command(JointCommand{{{joint, set_point}}, {}, {}}, true);
}

void MultibodyWorld::setVelocity(const std::string& joint, double velocity) {
  impl_->command(JointCommand{{}, {{joint, velocity}}, {}}, true);
}

void MultibodyWorld::setEffort(const std::string& joint, double effort) {
  impl_->command(JointCommand{{}, {}, {{joint, effort}}}, true);
}

JointCommand MultibodyWorld::twistCommand(const Twist& V_WL_L, const std::string& link) const {
  if (!impl_->driven) throw ParameterError("twist command: the base is not driven (sim/base: driven)");
  Twist V_WB_B = V_WL_L;
  if (!link.empty()) {
    const int index = impl_->model.linkIndex(link);
    if (!impl_->body.moves(index)) {
      throw ParameterError("twist command: found frame '" + link + "', allowed is a link that the driven base carries");
    }
    const Pose X_BL = impl_->driven->pose().inverse() * impl_->body.linkPose(index);
    V_WB_B << X_BL.q * V_WL_L.head<3>(), X_BL.q * V_WL_L.tail<3>();
    V_WB_B.head<3>() -= V_WB_B.tail<3>().cross(X_BL.p);
  }
  JointCommand command;
  for (int k = 0; k < 6; ++k) command.velocity[DrivenBase::coordinates()[k]] = V_WB_B[k];
  return command;
}

void MultibodyWorld::hold() {
  JointCommand rest;
  if (impl_->driven) {
    for (const std::string& name : jointNames()) rest.velocity[name] = 0.0;
    return impl_->command(rest, true);
  }
  for (const ControllerConfig& controller : impl_->config.controllers) {
    if (controller.type != ControllerType::kEffort) setVelocity(controller.joint, 0.0);
  }
}

void MultibodyWorld::setControllerCommand(const std::string& controller, double value) {
  const JointDrive& drive = impl_->driveOf(controller);
  JointCommand command;
  (drive.takesPosition()   ? command.position
   : drive.takesVelocity() ? command.velocity
                           : command.effort)
      .emplace(drive.joint().name, value);
  impl_->command(command, false);
}

std::vector<std::string> MultibodyWorld::controllerNames() const {
  std::vector<std::string> names;
  for (const auto& controller : impl_->config.controllers) names.push_back(controller.name);
  return names;
}

const ControllerConfig& MultibodyWorld::controllerConfig(const std::string& controller) const {
  return impl_->driveOf(controller).controller();
}

ControllerState MultibodyWorld::controllerState(const std::string& controller) const {
  const DriveMemory& memory = impl_->driveOf(controller).memory();
  ControllerState state;
  state.set_point = memory.set_point;
  state.process_value = memory.process_value;
  state.process_value_dot = memory.process_value_dot;
  state.error = memory.error;
  state.time_step_s = impl_->config.period_s;
  state.command = memory.command;
  state.gains = memory.gains;
  return state;
}

void MultibodyWorld::setGains(const std::string& controller, const PidGains& gains) {
  JointDrive& drive = impl_->driveOf(controller);
  checkGains(gains, controller);
  drive.memory().gains = gains;
}

Pose MultibodyWorld::linkPose(int link) const {
  if (link < 0 || link >= static_cast<int>(impl_->model.links.size())) {
    throw UnknownNameError("link index is " + std::to_string(link) + ", must be in [0, " +
                           std::to_string(impl_->model.links.size()) + ")");
  }
  return impl_->body.linkPose(link);
}

Pose MultibodyWorld::linkPose(const std::string& link) const { return linkPose(impl_->model.linkIndex(link)); }

Twist MultibodyWorld::linkTwist(int link) const {
  linkPose(link);
  return impl_->body.linkTwist(link, impl_->v);
}

Twist MultibodyWorld::linkTwist(const std::string& link) const { return linkTwist(impl_->model.linkIndex(link)); }

Eigen::MatrixXd MultibodyWorld::massMatrix() const {
  std::vector<double> M;
  impl_->body.massMatrix(M);
  return Eigen::Map<const Eigen::MatrixXd>(M.data(), impl_->model.dofs(), impl_->model.dofs());
}

double MultibodyWorld::energy() const {
  if (impl_->driven) return 0.0;  // it has no inertia
  std::vector<double> M;
  impl_->body.massMatrix(M);
  return impl_->body.kineticEnergy(M, impl_->v) + impl_->body.potentialEnergy();
}

}  // namespace aras_visual_servo_sim
