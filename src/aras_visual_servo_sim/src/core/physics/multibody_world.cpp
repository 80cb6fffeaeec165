#include "aras_visual_servo_sim/multibody_world.hpp"

#include <cmath>
#include <cstring>

#include "aras_visual_servo_sim/errors.hpp"
#include "articulated_body.hpp"
#include "joint_drive.hpp"
#include "joint_solver.hpp"
#include "state_stream.hpp"

namespace aras_visual_servo_sim {

namespace {

std::string shown(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

void checkConfig(const WorldConfig& config) {
  std::string faults;
  const auto check = [&](bool good, const std::string& text) {
    if (!good) faults += (faults.empty() ? "" : "\n") + text;
  };
  check(config.period_s > 0.0 && std::isfinite(config.period_s),
        "period_s: found " + shown(config.period_s) + ", allowed > 0");
  check(config.gravity_m_s2.allFinite(), "gravity_m_s2: found a value that is not finite, allowed 3 finite numbers");
  check(config.command_timeout_s >= 0.0 && std::isfinite(config.command_timeout_s),
        "command_timeout_s: found " + shown(config.command_timeout_s) + ", allowed >= 0");
  if (!faults.empty()) throw ParameterError(faults);
  for (const auto& controller : config.controllers) checkGains(controller.gains, controller.name);
}

}  // namespace

class MultibodyWorld::Impl {
 public:
  Impl(const RobotModel& the_model, const WorldConfig& the_config)
      : model((checkConfig(the_config), the_model)),
        config(the_config),
        body(model, config.gravity_m_s2),
        solver(model.dofs()),
        graphs(model.dofs()) {
    const int n = model.dofs();
    q = v = v_next = v_free = total = effort = Eigen::VectorXd::Zero(n);
    M.resize(static_cast<std::size_t>(n) * n);
    // The first tick at or after the timeout; the small slack keeps 0.1 s / 0.001 s at 100.
    const auto timeout = static_cast<std::int64_t>(std::ceil(config.command_timeout_s / config.period_s - 1e-9));
    for (int i = 0; i < n; ++i) {
      const ControllerConfig* controller = nullptr;
      for (const auto& each : config.controllers) {
        if (each.joint != model.joint_names[i]) continue;
        if (controller) {
          throw ParameterError("joint '" + each.joint + "': found controllers " + controller->name + " and " +
                               each.name + ", allowed one");
        }
        controller = &each;
      }
      drives.emplace_back(model.movingJoint(i), controller, config.drive, config.period_s, timeout);
      q[i] = clampPosition(model.movingJoint(i).limits, 0.0);
    }
    for (const auto& each : config.controllers) model.jointIndex(each.joint);
    start();
  }

  void start() {
    ticks = 0;
    v.setZero();
    effort.setZero();
    for (int i = 0; i < model.dofs(); ++i) drives[i].start(q[i]);
    body.setPositions(q);
  }

  void checkPosition(int joint, double position) const {
    const JointLimits& limits = model.movingJoint(joint).limits;
    const std::string what = "joint '" + model.joint_names[joint] + "': position is " + shown(position);
    if (!std::isfinite(position)) throw NotFiniteError(what + ", must be finite");
    if (limits.has_position && (position < limits.lower || position > limits.upper)) {
      throw ParameterError(what + ", must be in [" + shown(limits.lower) + ", " + shown(limits.upper) + "]");
    }
  }

  void step() {
    const double dt = config.period_s;
    const int n = model.dofs();
    for (int i = 0; i < n; ++i) drives[i].prepare(q[i], v[i], ticks, graphs[i]);
    body.massMatrix(M);
    body.freeVelocities(v, dt, v_free);
    v_next = v;
    solver.solve(M, v_free, graphs, dt, v_next, total);
    for (int i = 0; i < n; ++i) {
      if (!std::isfinite(v_next[i])) {
        throw NotFiniteError("joint '" + model.joint_names[i] + "': velocity is " + shown(v_next[i]) + " after tick " +
                             std::to_string(ticks) + ", must be finite (gains too high for the explicit drive?)");
      }
    }
    for (int i = 0; i < n; ++i) {
      effort[i] = graphs[i].actuatorEffort(v_next[i], total[i]);
      // A stop is reached to the last bit; for the others this changes nothing.
      q[i] = clampPosition(drives[i].joint().limits, q[i] + dt * v_next[i]);
      drives[i].finish(q[i], v_next[i], v[i]);
      v[i] = v_next[i];
    }
    body.setPositions(q);
    ++ticks;
  }

  /** One checked command: everything is looked up before anything is done. */
  void checkCommand(const std::map<std::string, double>& values, bool (JointDrive::*takes)() const,
                    const char* kind) const {
    for (const auto& item : values) {
      const JointDrive& drive = drives[model.jointIndex(item.first)];
      const std::string what = "joint '" + item.first + "': " + kind + " command is " + shown(item.second);
      if (!std::isfinite(item.second)) throw NotFiniteError(what + ", must be finite");
      if ((drive.*takes)()) continue;
      throw ParameterError(what + ", must be one its controller takes (" +
                           (drive.hasController() ? controllerTypeName(drive.controller().type) : "it has none") + ")");
    }
  }

  void command(const JointCommand& command, bool expires) {
    checkCommand(command.position, &JointDrive::takesPosition, "position");
    checkCommand(command.velocity, &JointDrive::takesVelocity, "velocity");
    checkCommand(command.effort, &JointDrive::takesEffort, "effort");
    for (const auto& item : command.position) drives[model.jointIndex(item.first)].commandPosition(item.second);
    for (const auto& item : command.velocity) {
      drives[model.jointIndex(item.first)].commandVelocity(item.second, ticks, expires);
    }
    for (const auto& item : command.effort) drives[model.jointIndex(item.first)].commandEffort(item.second);
  }

  JointDrive& driveOf(const std::string& controller) {
    std::string known;
    for (auto& drive : drives) {
      if (!drive.hasController()) continue;
      if (drive.controller().name == controller) return drive;
      known += (known.empty() ? "" : ", ") + drive.controller().name;
    }
    throw UnknownNameError("controller '" + controller + "' does not exist, allowed: " + known);
  }

  /** Reads or writes everything that decides the future, in one order for both. */
  template <typename Stream>
  void visitState(Stream& stream) {
    stream.value(ticks);
    for (int i = 0; i < model.dofs(); ++i) {
      stream.value(q[i]);
      stream.value(v[i]);
      stream.value(effort[i]);
      visitMemory(stream, drives[i].memory());
    }
  }

  template <typename Stream>
  static void visitMemory(Stream& stream, DriveMemory& memory) {
    for (double* value : {&memory.set_point, &memory.velocity_command, &memory.process_value, &memory.process_value_dot,
                          &memory.error, &memory.command, &memory.gains.p, &memory.gains.i, &memory.gains.d,
                          &memory.gains.i_min, &memory.gains.i_max, &memory.pid.error, &memory.pid.last_error,
                          &memory.pid.error_dot, &memory.pid.integral, &memory.pid.command}) {
      stream.value(*value);
    }
    stream.value(memory.command_tick);
    stream.value(memory.expires);
    stream.value(memory.gains.antiwindup);
    stream.value(memory.pid.last_error_valid);
  }

  /** What a saved state must match: the joints, their controllers and the period. */
  std::string signature() const {
    std::string text = model.name + '\n' + shown(config.period_s);
    for (const auto& drive : drives) {
      text += '\n' + drive.joint().name;
      if (drive.hasController())
        text += ' ' + drive.controller().name + ' ' + controllerTypeName(drive.controller().type);
    }
    return text;
  }

  const RobotModel model;
  const WorldConfig config;
  ArticulatedBody body;
  JointSolver solver;
  std::vector<JointDrive> drives;
  std::vector<JointGraph> graphs;
  std::vector<double> M;
  Eigen::VectorXd q, v, v_next, v_free, total, effort;
  std::int64_t ticks = 0;
};

MultibodyWorld::MultibodyWorld(const RobotModel& model, const WorldConfig& config)
    : impl_(std::make_unique<Impl>(model, config)) {}
MultibodyWorld::~MultibodyWorld() = default;

const RobotModel& MultibodyWorld::model() const { return impl_->model; }
const WorldConfig& MultibodyWorld::config() const { return impl_->config; }
std::int64_t MultibodyWorld::ticks() const { return impl_->ticks; }
const Eigen::VectorXd& MultibodyWorld::jointPositions() const { return impl_->q; }
const Eigen::VectorXd& MultibodyWorld::jointVelocities() const { return impl_->v; }
const Eigen::VectorXd& MultibodyWorld::jointEfforts() const { return impl_->effort; }

void MultibodyWorld::reset(const Eigen::VectorXd& q) {
  if (q.size() != impl_->model.dofs()) {
    throw ShapeError("reset: found " + std::to_string(q.size()) + " positions, must be " +
                     std::to_string(impl_->model.dofs()));
  }
  for (int i = 0; i < q.size(); ++i) impl_->checkPosition(i, q[i]);
  impl_->q = q;
  for (auto& drive : impl_->drives) drive.memory().gains = drive.controller().gains;
  impl_->start();
}

void MultibodyWorld::setJointPositions(const std::map<std::string, double>& positions) {
  for (const auto& item : positions) impl_->checkPosition(impl_->model.jointIndex(item.first), item.second);
  for (const auto& item : positions) {
    const int i = impl_->model.jointIndex(item.first);
    impl_->q[i] = item.second;
    impl_->v[i] = 0.0;
    impl_->effort[i] = 0.0;
    impl_->drives[i].start(item.second);
  }
  impl_->body.setPositions(impl_->q);
}

void MultibodyWorld::setJointVelocities(const Eigen::VectorXd& v) {
  if (v.size() != impl_->model.dofs()) {
    throw ShapeError("setJointVelocities: found " + std::to_string(v.size()) + " velocities, must be " +
                     std::to_string(impl_->model.dofs()));
  }
  if (!v.allFinite()) throw NotFiniteError("setJointVelocities: found a velocity that is not finite, must be finite");
  impl_->v = v;
}

void MultibodyWorld::step(int n) {
  if (n < 0) throw ParameterError("step: found " + std::to_string(n) + " periods, allowed >= 0");
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
  return 0.5 * impl_->v.dot(massMatrix() * impl_->v) + impl_->body.potentialEnergy();
}

std::string MultibodyWorld::saveState() const {
  StateWriter writer;
  writer.text(impl_->signature());
  impl_->visitState(writer);
  return writer.bytes();
}

void MultibodyWorld::restoreState(const std::string& state) {
  StateWriter mine;
  mine.text(impl_->signature());
  StateWriter whole = mine;
  impl_->visitState(whole);
  if (state.size() != whole.bytes().size() || state.compare(0, mine.bytes().size(), mine.bytes()) != 0) {
    throw StateError("state: found " + std::to_string(state.size()) +
                     " bytes of another model or other controllers, must come from saveState() of a world like this");
  }
  StateReader reader(state, mine.bytes().size());
  impl_->visitState(reader);
  impl_->body.setPositions(impl_->q);
}

}  // namespace aras_visual_servo_sim
