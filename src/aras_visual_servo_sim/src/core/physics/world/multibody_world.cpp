#include "aras_visual_servo_sim/physics/multibody_world.hpp"

#include <cmath>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "physics/body/articulated_body.hpp"
#include "physics/body/driven_base.hpp"
#include "physics/contact/world_contacts.hpp"
#include "physics/drive/joint_coupling.hpp"
#include "physics/drive/joint_drive.hpp"
#include "physics/drive/joint_solver.hpp"

namespace aras_visual_servo_sim {

namespace {

void checkConfig(const WorldConfig& config) {
  FaultList faults;
  const std::string name = "sim";  // not a temporary: GCC 14 takes the section for a part of it
  const Schema& section = sectionOf(name);
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

}  // namespace

const std::vector<std::string>& jointNames(const RobotModel& model, const WorldConfig& config) {
  return config.base == Base::kDriven ? DrivenBase::coordinates() : model.joint_names;
}

MultibodyWorld::MultibodyWorld(const RobotModel& model, const WorldConfig& config)
    : model_((checkConfig(config), model)),
      config_(config),
      coupling_(std::make_unique<JointCoupling>(model_)),
      body_(std::make_unique<ArticulatedBody>(model_, config_.gravity_m_s2, isFloating(model_, config_),
                                              initialBasePose(), config_.base == Base::kDriven)),
      solver_(std::make_unique<JointSolver>(coupling_->coordinates())),
      graphs_(coupling_->coordinates()) {
  if (config_.base == Base::kDriven) {
    checkDriven();
    driven_ = std::make_unique<DrivenBase>();
  }
  const int n = driven_ ? static_cast<int>(DrivenBase::coordinates().size()) : model_.dofs();
  const int coordinates = coupling_->coordinates();
  q_ = v_ = v_before_ = v_free_ = effort_ = Eigen::VectorXd::Zero(n);
  v_next_ = v_free_c_ = total_ = Eigen::VectorXd::Zero(coordinates);
  M_.resize(static_cast<std::size_t>(n) * n);
  M_c_.resize(static_cast<std::size_t>(coordinates) * coordinates);
  makeDrives();
  body_->setPositions(q_);
  setContacts(config_.contacts);
  start();
}

MultibodyWorld::~MultibodyWorld() = default;

/** Nothing but the base of a driven robot moves, and nothing can push it. Other robots may touch it. */
void MultibodyWorld::checkDriven() const {
  FaultList faults;
  if (model_.dofs() > 0) {
    faults.add("base", "driven with the moving joint '" + model_.joint_names.front() + "'", "a robot without any");
  }
  if (config_.contacts.pushes()) faults.add("base", "driven with contacts", "no contacts: it has no inertia");
  faults.throwIfAny();
}

void MultibodyWorld::makeDrives() {
  for (int c = 0; c < coupling_->coordinates(); ++c) {
    const int i = coupling_->joint(c);
    const ControllerConfig* controller = nullptr;
    for (const auto& each : config_.controllers) {
      if (each.joint != model_.joint_names[i]) continue;
      if (controller) {
        throw ParameterError("joint '" + each.joint + "': found controllers " + controller->name + " and " + each.name +
                             ", allowed one");
      }
      controller = &each;
    }
    drives_.emplace_back(coupling_->driven(model_, c), controller, config_.drive, config_.period_s);
    q_[i] = clampPosition(model_.movingJoint(i).limits, 0.0);
    if (!controller) idle(drives_.back(), q_[i]);
  }
  for (const auto& each : config_.controllers) driveOfJoint(each.joint);
}

Pose MultibodyWorld::initialBasePose() const {
  if (config_.X_WB) return *config_.X_WB;
  return model_.floatingJoint() ? model_.floatingJoint()->X_PJ : Pose{};
}

const std::vector<std::string>& MultibodyWorld::jointNames() const {
  return aras_visual_servo_sim::jointNames(model_, config_);
}

void MultibodyWorld::start() {
  ticks_ = 0;
  unsettled_steps_ = 0;
  v_.setZero();
  v_before_.setZero();
  base_before_.setZero();
  endPushes();
  effort_.setZero();
  if (!driven_) coupling_->complete(q_, v_);
  for (std::size_t c = 0; c < drives_.size(); ++c) drives_[c].start(q_[coupling_->joint(static_cast<int>(c))]);
  restartControllers();
  placeBase(initialBasePose());
  if (contacts_) contacts_->reset();
}

void MultibodyWorld::reset(const Eigen::VectorXd& q) {
  if (q.size() != q_.size()) {
    throw ShapeError("reset: found " + std::to_string(q.size()) + " positions, must be " + std::to_string(q_.size()));
  }
  if (driven_) {
    std::map<int, double> positions;
    for (int i = 0; i < q.size(); ++i) positions[i] = q[i];
    if (!q.allFinite()) throw NotFiniteError("reset: found a position that is not finite, must be finite");
    start();
    driven_->place(positions);
    followDriven();
    return;
  }
  for (int i = 0; i < q.size(); ++i) {
    if (!coupling_->follows(i)) checkPosition(i, q[i]);
  }
  q_ = q;
  for (auto& drive : drives_) drive.memory().gains = drive.controller().gains;
  start();
}

void MultibodyWorld::setJointPositions(const std::map<std::string, double>& positions) {
  if (driven_) {
    driven_->place(drivenValues(positions, "position"));
    followDriven();
    return;
  }
  Eigen::VectorXd wanted = q_;
  for (const auto& item : positions) {
    const int i = model_.jointIndex(item.first);
    if (!coupling_->follows(i)) checkPosition(i, item.second);
    wanted[i] = item.second;
  }
  for (const auto& item : positions) checkFollower(model_.jointIndex(item.first), wanted);
  for (const auto& item : positions) {
    const int i = model_.jointIndex(item.first);
    if (coupling_->follows(i)) continue;
    q_[i] = item.second;
    v_[i] = 0.0;
    effort_[i] = 0.0;
    drives_[coupling_->coordinate(i)].start(item.second);
  }
  coupling_->complete(q_, v_);
  body_->setPositions(q_);
  restartControllers();
}

void MultibodyWorld::checkFollower(int joint, const Eigen::VectorXd& wanted) const {
  if (!coupling_->follows(joint)) return;
  const double position = coupling_->position(joint, wanted);
  if (std::abs(wanted[joint] - position) <= kMimicRounding * (1.0 + std::abs(position))) return;
  throw ParameterError("joint '" + model_.joint_names[joint] + "': position is " + numberText(wanted[joint]) +
                       ", must be " + numberText(position) + " (it mimics '" + driveOf(joint).joint().name +
                       "') or left out");
}

void MultibodyWorld::checkPosition(int joint, double position) const {
  const JointLimits& limits = model_.movingJoint(joint).limits;
  const std::string what = "joint '" + model_.joint_names[joint] + "': position is " + numberText(position);
  if (!std::isfinite(position)) throw NotFiniteError(what + ", must be finite");
  if (limits.has_position && (position < limits.lower || position > limits.upper)) {
    throw ParameterError(what + ", must be in [" + numberText(limits.lower) + ", " + numberText(limits.upper) + "]");
  }
}

void MultibodyWorld::setJointVelocities(const Eigen::VectorXd& v) {
  if (driven_) throw ParameterError("setJointVelocities: the base is driven, must be moved by commands");
  if (v.size() != model_.dofs()) {
    throw ShapeError("setJointVelocities: found " + std::to_string(v.size()) + " velocities, must be " +
                     std::to_string(model_.dofs()));
  }
  if (!v.allFinite()) throw NotFiniteError("setJointVelocities: found a velocity that is not finite, must be finite");
  v_ = v;
  coupling_->complete(q_, v_);
}

// --- a step ---------------------------------------------------------------------------------------------------------

void MultibodyWorld::step(int n) {
  if (n < 0) throw ParameterError("step: found " + std::to_string(n) + " steps, allowed >= 0");
  for (int i = 0; i < n; ++i) advance();
}

void MultibodyWorld::advance() {
  if (driven_) {
    driven_->step(ticks_, config_.period_s);
    followDriven();
    ++ticks_;
    return;
  }
  beginStep();
  solveStep();
  finishStep();
}

void MultibodyWorld::beginStep() {
  if (!acting_.empty()) letControllersAct();
  if (!link_pushes_.empty() || !joint_pushes_.empty()) letOutsidePush();
  v_before_ = v_;
  if (body_->base()) base_before_ = body_->base()->velocity();
  const int coordinates = coupling_->coordinates();
  for (int c = 0; c < coordinates; ++c) {
    const int i = coupling_->joint(c);
    drives_[c].prepare(q_[i], v_[i], ticks_, graphs_[c]);
    v_next_[c] = v_[i];
  }
  body_->massMatrix(M_);
  body_->freeVelocities(v_, config_.period_s, v_free_);
  if (coupling_->any()) coupling_->reduce(M_, v_free_, M_c_, v_free_c_);
  if (contacts_) contacts_->find(*body_);
}

void MultibodyWorld::solveStep() {
  if (contacts_) {
    contacts_->arrange(*body_, *coupling_, v_free_);
    contacts_->solve(massUsed(), freeUsed(), graphs_, *solver_, v_next_, total_);
    unsettled_steps_ += contacts_->settled() ? 0 : 1;
  } else {
    solver_->solve(massUsed(), freeUsed(), graphs_, config_.period_s, v_next_, total_);
  }
}

void MultibodyWorld::finishStep() {
  const double dt = config_.period_s;
  checkVelocities();
  for (int c = 0; c < coupling_->coordinates(); ++c) {
    const int i = coupling_->joint(c);
    effort_[i] = graphs_[c].actuatorEffort(v_next_[c], total_[c]);
    // A stop is reached to the last bit; for the others this changes nothing.
    q_[i] = clampPosition(drives_[c].joint().limits, q_[i] + dt * v_next_[c]);
    drives_[c].finish(q_[i], v_next_[c], v_[i]);
    v_[i] = v_next_[c];
  }
  if (coupling_->any()) coupling_->complete(q_, v_);
  if (contacts_) contacts_->finish(*body_);
  if (body_->base()) body_->base()->advance(v_, v_free_, dt);
  body_->setPositions(q_);
  ++ticks_;
}

void MultibodyWorld::checkVelocities() const {
  for (int c = 0; c < coupling_->coordinates(); ++c) {
    if (std::isfinite(v_next_[c])) continue;
    throw NotFiniteError("joint '" + model_.joint_names[coupling_->joint(c)] + "': velocity is " +
                         numberText(v_next_[c]) + " after tick " + std::to_string(ticks_) +
                         ", must be finite (gains too high for the explicit drive?)");
  }
}

const std::vector<double>& MultibodyWorld::massUsed() const { return coupling_->any() ? M_c_ : M_; }

const Eigen::VectorXd& MultibodyWorld::freeUsed() const { return coupling_->any() ? v_free_c_ : v_free_; }

// --- base, links and contacts ---------------------------------------------------------------------------------------

bool MultibodyWorld::floatingBase() const { return body_->base() != nullptr; }

Pose MultibodyWorld::basePose() const { return body_->base() ? body_->base()->pose() : initialBasePose(); }

void MultibodyWorld::setBasePose(const Pose& X_WB) {
  checkBase("setBasePose", X_WB.p.allFinite() && X_WB.q.coeffs().allFinite());
  placeBase(X_WB);
}

void MultibodyWorld::setBaseTwist(const Twist& V_WB_W) {
  checkBase("setBaseTwist", V_WB_W.allFinite());
  if (driven_) throw ParameterError("setBaseTwist: the base is driven, must be moved by commands");
  FloatingBase& base = *body_->base();
  Twist velocity = V_WB_W;  // of the centre of mass
  velocity.head<3>() += V_WB_W.tail<3>().cross(base.com() - base.p());
  base.setVelocity(velocity);
}

void MultibodyWorld::checkBase(const std::string& what, bool finite) const {
  if (!body_->base()) throw ParameterError(what + ": the base is fixed, must be floating (sim/base: floating)");
  if (!finite) throw NotFiniteError(what + ": found a value that is not finite, must be finite");
}

void MultibodyWorld::placeBase(const Pose& X_WB) {
  if (driven_) {
    driven_->place(X_WB);
    followDriven();
    return;
  }
  if (body_->base()) {
    body_->base()->place(X_WB);
    body_->base()->setVelocity(Twist::Zero());
  }
  body_->setPositions(q_);
}

void MultibodyWorld::followDriven() {
  q_ = driven_->positions();
  v_ = driven_->twist();
  FloatingBase& base = *body_->base();
  base.restore(driven_->pose(), Twist::Zero());
  Twist velocity;  // of the centre of mass in world axes
  velocity << base.R() * v_.head<3>(), base.R() * v_.tail<3>();
  velocity.head<3>() += velocity.tail<3>().cross(base.com() - base.p());
  base.setVelocity(velocity);
  body_->setPositions(q_);
}

Pose MultibodyWorld::linkPose(int link) const {
  if (link < 0 || link >= static_cast<int>(model_.links.size())) {
    throw UnknownNameError("link index is " + std::to_string(link) + ", must be in [0, " +
                           std::to_string(model_.links.size()) + ")");
  }
  return body_->linkPose(link);
}

Twist MultibodyWorld::linkTwist(int link) const {
  linkPose(link);
  return body_->linkTwist(link, v_);
}

Eigen::MatrixXd MultibodyWorld::massMatrix() const {
  std::vector<double> M;
  body_->massMatrix(M);
  return Eigen::Map<const Eigen::MatrixXd>(M.data(), model_.dofs(), model_.dofs());
}

double MultibodyWorld::energy() const {
  if (driven_) return 0.0;  // it has no inertia
  std::vector<double> M;
  body_->massMatrix(M);
  return body_->kineticEnergy(M, v_) + body_->potentialEnergy();
}

std::vector<ContactForce> MultibodyWorld::contacts() const {
  std::vector<ContactForce> forces;
  if (!contacts_) return forces;
  const auto& points = contacts_->points();
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (std::max(points[k].a, points[k].b) < 0 || points[k].bonded) continue;  // between others, or no contact
    forces.push_back({contacts_->nameAt(k, points[k].a), contacts_->nameAt(k, points[k].b), points[k].point,
                      points[k].normal, points[k].depth_m, contacts_->force(k)});
  }
  return forces;
}

std::size_t MultibodyWorld::obstacleIndex(const std::string& name) const {
  std::string known;
  if (contacts_) {
    for (std::size_t k = 0; k < contacts_->obstacles().size(); ++k) {
      if (contacts_->obstacles()[k].name == name) return k;
      known += (known.empty() ? "" : ", ") + contacts_->obstacles()[k].name;
    }
  }
  throw UnknownNameError("solid '" + name + "': takes no part in the contacts, those that do are: " + known);
}

Pose MultibodyWorld::obstaclePose(const std::string& obstacle) const {
  return contacts_->obstaclePose(obstacleIndex(obstacle));
}

void MultibodyWorld::setObstaclePose(const std::string& obstacle, const Pose& X_WO) {
  const std::size_t index = obstacleIndex(obstacle);
  if (!X_WO.p.allFinite() || !X_WO.q.coeffs().allFinite()) {
    throw NotFiniteError("solid '" + obstacle + "': pose is not finite");
  }
  const auto& obstacles = contacts_->obstacles();
  for (std::size_t k = index; k < obstacles.size(); ++k) {
    if (obstacles[k].name == obstacle) contacts_->placeObstacle(k, {X_WO.p, X_WO.q.normalized()});
  }
}

Twist MultibodyWorld::obstacleTwist(const std::string& obstacle) const {
  return contacts_->obstacleVelocity(obstacleIndex(obstacle));
}

void MultibodyWorld::setContacts(const ContactConfig& config) {
  if (driven_ && config.pushes()) throw ParameterError("base: found driven with contacts, allowed no contacts");
  std::unique_ptr<WorldContacts> next;
  if (config.any()) {
    next = std::make_unique<WorldContacts>(model_, config, *body_, config_.gravity_m_s2, config_.period_s);
    if (contacts_) next->takeOver(*contacts_);
  }
  contacts_ = std::move(next);
}

void MultibodyWorld::takeObstacles(MultibodyWorld& other) {
  if (contacts_ && other.contacts_) contacts_->takeOver(*other.contacts_);
}

}  // namespace aras_visual_servo_sim
