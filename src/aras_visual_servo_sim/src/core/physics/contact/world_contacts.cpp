#include "world_contacts.hpp"

#include <algorithm>
#include <limits>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

using Eigen::Vector3d;

namespace {

const char kRobot[] = "robot";
const char kAll[] = "all";

/** Edges of the box around the shape, for the inertia of meshes. */
Vector3d sizeOf(const Geometry& geometry, const ContactConfig& config) {
  if (geometry.type != Geometry::Type::kMesh) return geometry.size_m;
  const auto found = config.mesh_points.find(geometry.filename);
  Vector3d low = Vector3d::Constant(1e300);
  Vector3d high = -low;
  for (const Vector3d& point : found == config.mesh_points.end() ? std::vector<Vector3d>{} : found->second) {
    low = low.cwiseMin(point.cwiseProduct(geometry.scale));
    high = high.cwiseMax(point.cwiseProduct(geometry.scale));
  }
  return high - low;
}

/** Rows: the normal and two tangents, right-handed. */
Eigen::Matrix3d axesAlong(const Vector3d& normal) {
  const Vector3d other = std::abs(normal.x()) < 0.6 ? Vector3d::UnitX() : Vector3d::UnitY();
  const Vector3d tangent = normal.cross(other).normalized();
  Eigen::Matrix3d axes;
  axes << normal.transpose(), tangent.transpose(), normal.cross(tangent).transpose();
  return axes;
}

/** Velocities along the axes at a point, of a body turning and moving about its centre. */
Eigen::Matrix<double, 3, 6> rowsAt(const Eigen::Matrix3d& axes, const Vector3d& arm) {
  Eigen::Matrix<double, 3, 6> rows;
  for (int k = 0; k < 3; ++k) {
    const Vector3d axis = axes.row(k).transpose();
    rows.row(k) << axis.transpose(), arm.cross(axis).transpose();
  }
  return rows;
}

}  // namespace

WorldContacts::WorldContacts(const RobotModel& model, const ContactConfig& config, const ArticulatedBody& body,
                             const Vector3d& gravity_m_s2, double period_s)
    : model_(model),
      config_(config),
      gravity_m_s2_(gravity_m_s2),
      period_s_(period_s),
      shapes_(config),
      solver_(config.stiffness_n_per_m, config.damping_n_s_per_m) {
  for (const auto& [name, mass_kg] : config_.free_bodies) {
    const auto found = std::find_if(config_.obstacles.begin(), config_.obstacles.end(),
                                    [&, &name = name](const Obstacle& each) { return each.name == name; });
    if (found == config_.obstacles.end()) {
      throw ParameterError("sim/contacts/free_bodies: found " + name + ", must be a solid of the scene");
    }
    found->mass_kg = mass_kg;
  }
  addLinks(body);
  addObstacles();
  watchPairs(body);
  for (int id = 0; id < static_cast<int>(model_.links.size() + config_.obstacles.size()); ++id) {
    const auto touched = [&](const auto& pair) { return pair.first == nameOf(id) || pair.second == nameOf(id); };
    const bool takes_part = id < static_cast<int>(model_.links.size()) || freeBodyOf(id) >= 0 ||
                            std::any_of(config_.pairs.begin(), config_.pairs.end(), touched);
    if (config_.neighbours && shapes_.has(id) && takes_part) shared_.push_back(id);
  }
}

void WorldContacts::addLinks(const ArticulatedBody& body) {
  for (std::size_t link = 0; link < model_.links.size(); ++link) {
    for (const Collision& collision : model_.links[link].collisions) {
      if (body.driven() && config_.hollow_meshes.count(collision.geometry.filename) > 0) continue;
      shapes_.add(static_cast<int>(link), collision.geometry, collision.X_link_collision);
    }
    shapes_.place(static_cast<int>(link), body.linkPose(static_cast<int>(link)));
  }
}

void WorldContacts::addObstacles() {
  const int first = static_cast<int>(model_.links.size());
  for (std::size_t k = 0; k < config_.obstacles.size(); ++k) {
    const Obstacle& obstacle = config_.obstacles[k];
    shapes_.add(first + static_cast<int>(k), obstacle.geometry, obstacle.X_OG);
    X_WO_.push_back(obstacle.X_WO);
    free_body_.push_back(-1);
    if (obstacle.mass_kg > 0.0) {
      free_body_.back() = static_cast<int>(free_.size());
      free_.emplace_back(obstacle, sizeOf(obstacle.geometry, config_));
    }
  }
}

std::string WorldContacts::nameOf(int id) const {
  if (id == ContactPoint::kGround) return "ground_plane";
  if (id == ContactPoint::kElsewhere) return "another robot";
  const int links = static_cast<int>(model_.links.size());
  return id < links ? model_.links[id].name : config_.obstacles[id - links].name;
}

std::vector<int> WorldContacts::idsOf(const std::string& name) const {
  std::vector<int> ids;
  const int links = static_cast<int>(model_.links.size());
  const int count = links + static_cast<int>(config_.obstacles.size());
  for (int id = 0; id < count; ++id) {
    const bool meant = name == kAll || (name == kRobot && id < links);
    if ((meant && shapes_.has(id)) || nameOf(id) == name) ids.push_back(id);
  }
  if (!ids.empty() || name == kRobot || name == kAll) return ids;
  std::string known = "`robot`";
  for (int id = 0; id < count; ++id) known += shapes_.has(id) ? ", " + nameOf(id) : "";
  throw ParameterError("sim/contacts/pairs: found " + name + ", allowed names with a shape: " + known);
}

/** As configured by name; without, no bound. */
double WorldContacts::frictionOf(int id) const {
  const auto found = config_.frictions.find(nameOf(id));
  return found == config_.frictions.end() ? std::numeric_limits<double>::infinity() : found->second;
}

bool WorldContacts::moves(int id, const ArticulatedBody& body) const {
  const int links = static_cast<int>(model_.links.size());
  return id < links ? body.moves(id) && !body.driven() : freeBodyOf(id) >= 0;
}

int WorldContacts::freeBodyOf(int id) const {
  const int links = static_cast<int>(model_.links.size());
  return id < links ? -1 : free_body_[id - links];
}

/** Whether a pair is looked at. Links on the same body or on bodies with one joint between them never touch, and
 * neither do two things that cannot move. */
bool WorldContacts::mayTouch(int a, int b, const ArticulatedBody& body) const {
  const int links = static_cast<int>(model_.links.size());
  if (a == b || (!moves(a, body) && !moves(b, body))) return false;
  return a >= links || b >= links || !body.adjacent(a, b);
}

void WorldContacts::watchPairs(const ArticulatedBody& body) {
  for (const auto& [first, second] : config_.pairs) {
    const bool named = first != kRobot && second != kRobot && first != kAll;
    for (const int a : idsOf(first)) {
      for (const int b : idsOf(second)) {
        if (named && !(mayTouch(a, b, body) && shapes_.has(a) && shapes_.has(b))) {
          throw ParameterError("sim/contacts/pairs: found [" + first + ", " + second +
                               "], must be two with a shape each, "
                               "one of them moving, and not links with only a joint between them");
        }
        if (mayTouch(a, b, body)) shapes_.watchPair(a, b, std::min({config_.friction, frictionOf(a), frictionOf(b)}));
      }
    }
  }
  if (!config_.ground) return;
  for (const int id : idsOf(kAll)) {
    if (moves(id, body)) shapes_.watchGround(id, std::min(config_.ground->friction, frictionOf(id)));
  }
}

void WorldContacts::find(const ArticulatedBody& body) {
  const int links = static_cast<int>(model_.links.size());
  for (int link = 0; link < links; ++link) {
    if (body.moves(link)) shapes_.place(link, body.linkPose(link));
  }
  for (std::size_t k = 0; k < X_WO_.size(); ++k) shapes_.place(links + static_cast<int>(k), obstaclePose(k));
  points_ = shapes_.find();
  others_.clear();
}

void WorldContacts::arrange(const ArticulatedBody& body, const JointCoupling& coupling, const Eigen::VectorXd& v_free) {
  layOut(body, coupling);
  addFreeMotion(body, v_free);
}

void WorldContacts::layOut(const ArticulatedBody& body, const JointCoupling& coupling) {
  const auto rows = static_cast<Eigen::Index>(3 * points_.size());
  rows_.J.setZero(rows, coupling.coordinates());
  rows_.S.setZero(rows, rows);
  rows_.u0.setZero(rows);
  J_base_.setZero(rows, 6);
  rows_.depth_m.clear();
  rows_.friction.clear();
  rows_.bonds.clear();
  axes_.clear();
  sides_.assign(2 * points_.size(), Side{});
  for (std::size_t k = 0; k < points_.size(); ++k) {
    rows_.depth_m.push_back(points_[k].depth_m);
    rows_.friction.push_back(points_[k].friction);
    axes_.push_back(axesAlong(points_[k].normal));
    if (points_[k].bonded) rows_.bonds[static_cast<int>(k)] = axes_.back() * points_[k].gap;
    addSide(k, points_[k].a, 1.0, body, coupling);
    addSide(k, points_[k].b, -1.0, body, coupling);
  }
}

/** The share of one of the two bodies in the relative velocity at a point of contact. */
void WorldContacts::addSide(std::size_t point, int id, double sign, const ArticulatedBody& body,
                            const JointCoupling& coupling) {
  if (id < 0 || !moves(id, body)) return;
  const Eigen::Matrix3d axes = sign * axes_[point];
  const Vector3d& p = points_[point].point;
  const auto row = static_cast<Eigen::Index>(3 * point);
  if (const int free_body = freeBodyOf(id); free_body >= 0) {
    Side& side = sides_[2 * point + (sign > 0.0 ? 0 : 1)];
    side.free_body = free_body;
    side.rows = rowsAt(axes, p - free_[free_body].pose().p);
    return;
  }
  body.addPointRows(id, p, axes, coupling, rows_.J.middleRows<3>(row));
  if (body.base()) J_base_.middleRows<3>(row) += rowsAt(axes, p - body.base()->com());
}

/** The part of the base and of the free bodies: how they move freely, and how they answer. */
void WorldContacts::addFreeMotion(const ArticulatedBody& body, const Eigen::VectorXd& v_free) {
  if (body.base()) {
    // So far J has the joints only. The base moves along with them, and impulses move it too.
    rows_.u0 += J_base_ * body.base()->velocityWithJointsHeld(v_free);
    rows_.S += J_base_ * body.base()->answer(J_base_.transpose());
  }
  free_velocity_.clear();
  for (const FreeBody& each : free_) free_velocity_.push_back(each.freeVelocity(gravity_m_s2_, period_s_));
  sides_of_.resize(free_.size());
  for (std::vector<std::size_t>& sides : sides_of_) sides.clear();
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    if (sides_[i].free_body >= 0) sides_of_[sides_[i].free_body].push_back(i);
  }
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const Side& one = sides_[i];
    if (one.free_body < 0) continue;
    const auto row = static_cast<Eigen::Index>(3 * (i / 2));
    rows_.u0.segment<3>(row) += one.rows * free_velocity_[one.free_body];
    for (int k = 0; k < 3; ++k) {
      const Twist answer = free_[one.free_body].answer(one.rows.row(k).transpose());
      for (const std::size_t j : sides_of_[one.free_body]) {
        rows_.S.block<3, 1>(static_cast<Eigen::Index>(3 * (j / 2)), row + k) += sides_[j].rows * answer;
      }
    }
  }
}

void WorldContacts::solve(const std::vector<double>& M, const Eigen::VectorXd& v_free,
                          const std::vector<JointGraph>& graphs, JointSolver& joints, Eigen::VectorXd& v,
                          Eigen::VectorXd& effort) {
  lambda_.resize(0);
  if (points_.empty()) {
    joints.solve(M, v_free, graphs, period_s_, v, effort);
  } else {
    lambda_ = solver_.solve(rows_, M, v_free, graphs, period_s_, joints, v, effort);
  }
}

void WorldContacts::finish(ArticulatedBody& body) {
  if (body.base() && lambda_.size() > 0) body.base()->addImpulse(J_base_.transpose() * lambda_);
  std::vector<Twist> impulses(free_.size(), Twist::Zero());
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    if (sides_[i].free_body < 0) continue;
    impulses[sides_[i].free_body] +=
        sides_[i].rows.transpose() * lambda_.segment<3>(static_cast<Eigen::Index>(3 * (i / 2)));
  }
  for (std::size_t k = 0; k < free_.size(); ++k) {
    const Twist velocity = free_velocity_[k] + free_[k].answer(impulses[k]);
    if (!velocity.allFinite()) {
      const auto found = std::find(free_body_.begin(), free_body_.end(), static_cast<int>(k));
      throw NotFiniteError(
          "solid '" + config_.obstacles[found - free_body_.begin()].name +
          "': its velocity is not finite, must be finite (mass or stiffness too far from the others?)");
    }
    free_[k].advance(velocity, period_s_);
  }
}

Vector3d WorldContacts::force(std::size_t point) const {
  return axes_[point].transpose() * lambda_.segment<3>(static_cast<Eigen::Index>(3 * point)) / period_s_;
}

Pose WorldContacts::obstaclePose(std::size_t k) const {
  return free_body_[k] < 0 ? X_WO_[k] : free_[free_body_[k]].pose();
}

void WorldContacts::placeObstacle(std::size_t k, const Pose& X_WO) {
  X_WO_[k] = X_WO;
  if (free_body_[k] >= 0) free_[free_body_[k]].restore(X_WO, Twist::Zero());
}

void WorldContacts::restoreObstacle(std::size_t k, const Pose& X_WO) {
  X_WO_[k] = X_WO;
  if (free_body_[k] >= 0) free_[free_body_[k]].restore(X_WO, free_[free_body_[k]].velocity());
}

void WorldContacts::takeOver(WorldContacts& other) {
  for (std::size_t k = 0; k < config_.obstacles.size(); ++k) {
    for (std::size_t i = 0; i < other.config_.obstacles.size(); ++i) {
      if (other.config_.obstacles[i].name != config_.obstacles[k].name) continue;
      placeObstacle(k, other.obstaclePose(i));
      if (free_body_[k] >= 0) free_[free_body_[k]].restore(other.obstaclePose(i), other.obstacleVelocity(i));
      break;
    }
  }
}

Twist WorldContacts::obstacleVelocity(std::size_t k) const {
  return free_body_[k] < 0 ? Twist(Twist::Zero()) : free_[free_body_[k]].velocity();
}

void WorldContacts::reset() {
  points_.clear();
  for (std::size_t k = 0; k < config_.obstacles.size(); ++k) placeObstacle(k, config_.obstacles[k].X_WO);
}

}  // namespace aras_visual_servo_sim
