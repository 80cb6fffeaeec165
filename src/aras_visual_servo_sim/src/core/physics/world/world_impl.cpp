#include "world_impl.hpp"

#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

namespace {

void checkConfig(const WorldConfig& config) {
  FaultList faults;
  const Schema& section = sectionOf("sim");
  checkValue(section, "period_s", config.period_s, faults);
  const Eigen::Vector3d& gravity = config.gravity_m_s2;
  checkValue(section, "gravity_m_s2", std::vector<double>(gravity.data(), gravity.data() + gravity.size()), faults);
  checkValue(section, "command_timeout_s", config.command_timeout_s, faults);
  if (config.X_WB && !(config.X_WB->p.allFinite() && config.X_WB->q.coeffs().allFinite())) {
    faults.add("base_pose", "a value that is not finite", "finite numbers");
  }
  faults.throwIfAny();
  for (const auto& controller : config.controllers) checkGains(controller.gains, controller.name);
}

bool isFloating(const RobotModel& model, const WorldConfig& config) {
  return config.base == Base::kFloating || config.base == Base::kDriven ||
         (config.base == Base::kFromModel && model.floatingJoint());
}

/** How far the position given for a mimic joint may differ from the one it has: the rounding of a few operations. */
constexpr double kMimicRounding = 1e-9;

/** A timeout of this many periods or more counts as none; the number is far below the largest tick. */
constexpr double kLongestTimeout = 1e18;

}  // namespace

const std::vector<std::string>& jointNames(const RobotModel& model, const WorldConfig& config) {
  return config.base == Base::kDriven ? DrivenBase::coordinates() : model.joint_names;
}

MultibodyWorld::Impl::Impl(const RobotModel& the_model, const WorldConfig& the_config)
    : model((checkConfig(the_config), the_model)),
      config(the_config),
      coupling(model),
      body(model, config.gravity_m_s2, isFloating(model, config), initialBasePose(), config.base == Base::kDriven),
      solver(coupling.coordinates()),
      graphs(coupling.coordinates()) {
  if (config.base == Base::kDriven) {
    checkDriven();
    driven = std::make_unique<DrivenBase>();
  }
  const int n = driven ? static_cast<int>(DrivenBase::coordinates().size()) : model.dofs();
  const int coordinates = coupling.coordinates();
  q = v = v_before = v_free = effort = Eigen::VectorXd::Zero(n);
  v_next = v_free_c = total = Eigen::VectorXd::Zero(coordinates);
  M.resize(static_cast<std::size_t>(n) * n);
  M_c.resize(static_cast<std::size_t>(coordinates) * coordinates);
  makeDrives();
  body.setPositions(q);
  setContacts(config.contacts);
  start();
}

/** Nothing but the base of a driven robot moves, and nothing can push it. Other robots may touch it. */
void MultibodyWorld::Impl::checkDriven() const {
  FaultList faults;
  if (model.dofs() > 0) {
    faults.add("base", "driven with the moving joint '" + model.joint_names.front() + "'", "a robot without any");
  }
  if (config.contacts.pushes()) faults.add("base", "driven with contacts", "no contacts: it has no inertia");
  faults.throwIfAny();
}

void MultibodyWorld::Impl::makeDrives() {
  for (int c = 0; c < coupling.coordinates(); ++c) {
    const int i = coupling.joint(c);
    const ControllerConfig* controller = nullptr;
    for (const auto& each : config.controllers) {
      if (each.joint != model.joint_names[i]) continue;
      if (controller) {
        throw ParameterError("joint '" + each.joint + "': found controllers " + controller->name + " and " + each.name +
                             ", allowed one");
      }
      controller = &each;
    }
    drives.emplace_back(coupling.driven(model, c), controller, config.drive, config.period_s);
    q[i] = clampPosition(model.movingJoint(i).limits, 0.0);
    if (!controller) idle(drives.back(), q[i]);
  }
  for (const auto& each : config.controllers) driveOfJoint(each.joint);
}

/** The first tick at or after the timeout; the small slack keeps 0.1 s / 0.001 s at 100. */
std::int64_t MultibodyWorld::Impl::expiryTick(double timeout_s) const {
  const double periods = std::ceil(timeout_s / config.period_s - 1e-9);
  return timeout_s > 0.0 && periods < kLongestTimeout ? ticks + static_cast<std::int64_t>(periods) : kNever;
}

Pose MultibodyWorld::Impl::initialBasePose() const {
  if (config.X_WB) return *config.X_WB;
  return model.floatingJoint() ? model.floatingJoint()->X_PJ : Pose{};
}

void MultibodyWorld::Impl::start() {
  ticks = 0;
  unsettled_steps = 0;
  v.setZero();
  v_before.setZero();
  base_before.setZero();
  endPushes();
  effort.setZero();
  if (!driven) coupling.complete(q, v);
  for (std::size_t c = 0; c < drives.size(); ++c) drives[c].start(q[coupling.joint(static_cast<int>(c))]);
  restartControllers();
  placeBase(initialBasePose());
  if (contacts) contacts->reset();
}

void MultibodyWorld::Impl::placeBase(const Pose& X_WB) {
  if (driven) {
    driven->place(X_WB);
    followDriven();
    return;
  }
  if (body.base()) {
    body.base()->place(X_WB);
    body.base()->setVelocity(Twist::Zero());
  }
  body.setPositions(q);
}

void MultibodyWorld::Impl::followDriven() {
  q = driven->positions();
  v = driven->twist();
  FloatingBase& base = *body.base();
  base.restore(driven->pose(), Twist::Zero());
  Twist velocity;  // of the centre of mass in world axes
  velocity << base.R() * v.head<3>(), base.R() * v.tail<3>();
  velocity.head<3>() += velocity.tail<3>().cross(base.com() - base.p());
  base.setVelocity(velocity);
  body.setPositions(q);
}

void MultibodyWorld::Impl::step() {
  if (driven) {
    driven->step(ticks, config.period_s);
    followDriven();
    ++ticks;
    return;
  }
  beginStep();
  solveStep();
  finishStep();
}

void MultibodyWorld::Impl::beginStep() {
  if (!acting_.empty()) letControllersAct();
  if (!link_pushes.empty() || !joint_pushes.empty()) letOutsidePush();
  v_before = v;
  if (body.base()) base_before = body.base()->velocity();
  const int coordinates = coupling.coordinates();
  for (int c = 0; c < coordinates; ++c) {
    const int i = coupling.joint(c);
    drives[c].prepare(q[i], v[i], ticks, graphs[c]);
    v_next[c] = v[i];
  }
  body.massMatrix(M);
  body.freeVelocities(v, config.period_s, v_free);
  if (coupling.any()) coupling.reduce(M, v_free, M_c, v_free_c);
  if (contacts) contacts->find(body);
}

void MultibodyWorld::Impl::solveStep() {
  if (contacts) {
    contacts->arrange(body, coupling, v_free);
    contacts->solve(massUsed(), freeUsed(), graphs, solver, v_next, total);
    unsettled_steps += contacts->settled() ? 0 : 1;
  } else {
    solver.solve(massUsed(), freeUsed(), graphs, config.period_s, v_next, total);
  }
}

void MultibodyWorld::Impl::finishStep() {
  const double dt = config.period_s;
  checkVelocities();
  for (int c = 0; c < coupling.coordinates(); ++c) {
    const int i = coupling.joint(c);
    effort[i] = graphs[c].actuatorEffort(v_next[c], total[c]);
    // A stop is reached to the last bit; for the others this changes nothing.
    q[i] = clampPosition(drives[c].joint().limits, q[i] + dt * v_next[c]);
    drives[c].finish(q[i], v_next[c], v[i]);
    v[i] = v_next[c];
  }
  if (coupling.any()) coupling.complete(q, v);
  if (contacts) contacts->finish(body);
  if (body.base()) body.base()->advance(v, v_free, dt);
  body.setPositions(q);
  ++ticks;
}

void MultibodyWorld::Impl::checkVelocities() const {
  for (int c = 0; c < coupling.coordinates(); ++c) {
    if (std::isfinite(v_next[c])) continue;
    throw NotFiniteError("joint '" + model.joint_names[coupling.joint(c)] + "': velocity is " + shown(v_next[c]) +
                         " after tick " + std::to_string(ticks) +
                         ", must be finite (gains too high for the explicit drive?)");
  }
}

const JointDrive& MultibodyWorld::Impl::driveOfJoint(const std::string& name) const {
  const int joint = model.jointIndex(name);
  if (coupling.follows(joint)) {
    throw ParameterError("joint '" + name + "': mimics '" + driveOf(joint).joint().name +
                         "', must be moved through that joint");
  }
  return driveOf(joint);
}

JointDrive& MultibodyWorld::Impl::driveOfJoint(const std::string& name) {
  return const_cast<JointDrive&>(static_cast<const Impl*>(this)->driveOfJoint(name));
}

JointDrive& MultibodyWorld::Impl::driveOf(const std::string& controller) {
  std::string known;
  for (auto& drive : drives) {
    if (!drive.hasController() || drive.controller().name.empty()) continue;
    if (drive.controller().name == controller) return drive;
    known += (known.empty() ? "" : ", ") + drive.controller().name;
  }
  throw UnknownNameError("controller '" + controller + "' does not exist, allowed: " + known);
}

std::size_t MultibodyWorld::Impl::obstacle(const std::string& name) const {
  std::string known;
  if (contacts) {
    for (std::size_t k = 0; k < contacts->obstacles().size(); ++k) {
      if (contacts->obstacles()[k].name == name) return k;
      known += (known.empty() ? "" : ", ") + contacts->obstacles()[k].name;
    }
  }
  throw UnknownNameError("solid '" + name + "': takes no part in the contacts, those that do are: " + known);
}

void MultibodyWorld::Impl::setContacts(const ContactConfig& wanted) {
  std::unique_ptr<WorldContacts> next;
  if (wanted.any()) {
    next = std::make_unique<WorldContacts>(model, wanted, body, config.gravity_m_s2, config.period_s);
    if (contacts) next->takeOver(*contacts);
  }
  contacts = std::move(next);
}

void MultibodyWorld::Impl::checkBase(const std::string& what, bool finite) const {
  if (!body.base()) throw ParameterError(what + ": the base is fixed, must be floating (sim/base: floating)");
  if (!finite) throw NotFiniteError(what + ": found a value that is not finite, must be finite");
}

void MultibodyWorld::Impl::checkFollower(int joint, const Eigen::VectorXd& wanted) const {
  if (!coupling.follows(joint)) return;
  const double position = coupling.position(joint, wanted);
  if (std::abs(wanted[joint] - position) <= kMimicRounding * (1.0 + std::abs(position))) return;
  throw ParameterError("joint '" + model.joint_names[joint] + "': position is " + shown(wanted[joint]) + ", must be " +
                       shown(position) + " (it mimics '" + driveOf(joint).joint().name + "') or left out");
}

void MultibodyWorld::Impl::checkPosition(int joint, double position) const {
  const JointLimits& limits = model.movingJoint(joint).limits;
  const std::string what = "joint '" + model.joint_names[joint] + "': position is " + shown(position);
  if (!std::isfinite(position)) throw NotFiniteError(what + ", must be finite");
  if (limits.has_position && (position < limits.lower || position > limits.upper)) {
    throw ParameterError(what + ", must be in [" + shown(limits.lower) + ", " + shown(limits.upper) + "]");
  }
}

void MultibodyWorld::Impl::checkCommand(const std::map<std::string, double>& values, bool (JointDrive::*takes)() const,
                                        const char* kind) const {
  for (const auto& item : values) {
    const JointDrive& drive = driveOfJoint(item.first);
    if (std::isfinite(item.second) && (drive.*takes)()) continue;
    const std::string what = "joint '" + item.first + "': " + kind + " command is " + shown(item.second);
    if (!std::isfinite(item.second)) throw NotFiniteError(what + ", must be finite");
    throw ParameterError(what + ", must be one its controller takes (" +
                         (drive.hasController() ? controllerTypeName(drive.controller().type) : "it has none") + ")");
  }
}

std::map<int, double> MultibodyWorld::Impl::drivenValues(const std::map<std::string, double>& values,
                                                         const char* kind) const {
  std::map<int, double> checked;
  for (const auto& [name, value] : values) {
    checked[DrivenBase::index(name)] = value;
    if (std::isfinite(value)) continue;
    throw NotFiniteError("joint '" + name + "': " + kind + " is " + shown(value) + ", must be finite");
  }
  return checked;
}

void MultibodyWorld::Impl::commandDriven(const JointCommand& command, bool expires) {
  const auto positions = drivenValues(command.position, "position command");
  const auto velocities = drivenValues(command.velocity, "velocity command");
  if (!command.effort.empty()) {
    throw ParameterError("joint '" + command.effort.begin()->first +
                         "': found an effort command, a driven base takes position and velocity");
  }
  if (!positions.empty()) {
    driven->place(positions);
    followDriven();
  }
  if (velocities.empty()) return;
  driven->command(velocities, ticks, expires ? expiryTick(config.command_timeout_s) : kNever);
}

void MultibodyWorld::Impl::command(const JointCommand& command, bool expires) {
  if (driven) return commandDriven(command, expires);
  checkCommand(command.position, &JointDrive::takesPosition, "position");
  checkCommand(command.velocity, &JointDrive::takesVelocity, "velocity");
  checkCommand(command.effort, &JointDrive::takesEffort, "effort");
  for (const auto& item : command.position) driveOfJoint(item.first).commandPosition(item.second);
  for (const auto& item : command.velocity) {
    JointDrive& drive = driveOfJoint(item.first);
    drive.commandVelocity(item.second,
                          expiryTick(expires ? config.command_timeout_s : drive.controller().command_timeout_s));
  }
  for (const auto& item : command.effort) {
    JointDrive& drive = driveOfJoint(item.first);
    drive.commandEffort(item.second, expiryTick(drive.controller().command_timeout_s));
  }
}

}  // namespace aras_visual_servo_sim
