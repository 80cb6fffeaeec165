#include "aras_visual_servo_sim/physics/touching_robots.hpp"

#include <algorithm>
#include <utility>

#include "physics/body/articulated_body.hpp"
#include "physics/contact/world_contacts.hpp"
#include "physics/drive/joint_coupling.hpp"
#include "physics/drive/joint_solver.hpp"

namespace aras_visual_servo_sim {

namespace {

/** Points on a circle about the origin of a welded link, at which both links are held together [m]. */
const Eigen::Vector3d kWeldPoints[] = {{0.1, 0.0, 0.0}, {-0.05, 0.0866, 0.0}, {-0.05, -0.0866, 0.0}};

}  // namespace

/** A point between two robots; its bodies are those of robot a and of robot b. */
struct TouchingRobots::Crossing {
  std::size_t a, b;
  ContactPoint point;
  std::size_t mover;  // a, or b if the body of a does not move
  bool both_move;
};

TouchingRobots::TouchingRobots(const std::vector<MultibodyWorld*>& robots, std::vector<std::string> names,
                               std::vector<Weld> welds)
    : robots_(robots), names_(std::move(names)), welds_(std::move(welds)) {}
TouchingRobots::~TouchingRobots() = default;

void TouchingRobots::step() {
  for (MultibodyWorld* robot : robots_) {
    if (!robot->driven_) {
      robot->beginStep();
    } else if (robot->contacts_) {
      robot->contacts_->find(*robot->body_);
    }
  }
  findPoints();
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (island_[i] != i || robots_[i]->driven_) continue;
    touchesOther(i) ? solveIsland(i) : robots_[i]->solveStep();
  }
  for (MultibodyWorld* robot : robots_) robot->driven_ ? robot->advance() : robot->finishStep();
}

bool TouchingRobots::touchesOther(std::size_t robot) const {
  return std::any_of(crossings_.begin(), crossings_.end(),
                     [&](const Crossing& each) { return island_[each.mover] == island_[robot]; });
}

/** Finds the points between robots. A body that does not move, as a table, connects no robots. */
void TouchingRobots::findPoints() {
  crossings_.clear();
  boxes_.assign(robots_.size(), Eigen::AlignedBox3d());
  island_.resize(robots_.size());
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    island_[i] = i;
    WorldContacts* mine = robots_[i]->contacts_.get();
    if (!mine) continue;
    boxes_[i] = mine->shapes().boxAround(mine->sharedBodies());
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::AlignedBox3d near = boxes_[i].intersection(boxes_[j]);
      if (!near.isEmpty() && !(robots_[i]->driven_ && robots_[j]->driven_)) findBetween(j, i, near);
    }
  }
  findWelds();
  for (const Crossing& each : crossings_) {
    if (!each.both_move) continue;
    const std::size_t first = std::min(island_[each.a], island_[each.b]);
    const std::size_t second = std::max(island_[each.a], island_[each.b]);
    std::replace(island_.begin(), island_.end(), second, first);
  }
}

void TouchingRobots::findBetween(std::size_t a, std::size_t b, const Eigen::AlignedBox3d& near) {
  WorldContacts& one = *robots_[a]->contacts_;
  WorldContacts& other = *robots_[b]->contacts_;
  points_.clear();
  one.shapes().findWith(
      other.shapes(), one.sharedBodies(), other.sharedBodies(), near,
      [&](int here, int there) { return std::min(one.frictionBeyond(here), other.frictionBeyond(there)); }, points_);
  for (const ContactPoint& point : points_) {
    if (welded(a, point.a, b, point.b)) continue;
    const bool a_moves = one.moves(point.a, *robots_[a]->body_), b_moves = other.moves(point.b, *robots_[b]->body_);
    if (a_moves || b_moves) crossings_.push_back({a, b, point, a_moves ? a : b, a_moves && b_moves});
  }
}

bool TouchingRobots::moves(std::size_t robot, int link) const {
  return !robots_[robot]->driven_ && robots_[robot]->contacts_->moves(link, *robots_[robot]->body_);
}

bool TouchingRobots::welded(std::size_t a, int link_a, std::size_t b, int link_b) const {
  return std::any_of(welds_.begin(), welds_.end(), [&](const Weld& weld) {
    return (weld.a == a && weld.link_a == link_a && weld.b == b && weld.link_b == link_b) ||
           (weld.a == b && weld.link_a == link_b && weld.b == a && weld.link_b == link_a);
  });
}

/** Adds the points at which welds hold. */
void TouchingRobots::findWelds() {
  for (const Weld& weld : welds_) {
    const bool a_moves = moves(weld.a, weld.link_a), b_moves = moves(weld.b, weld.link_b);
    if (!a_moves && !b_moves) continue;
    const Pose X_WA = robots_[weld.a]->linkPose(weld.link_a), X_WB = robots_[weld.b]->linkPose(weld.link_b);
    for (const Eigen::Vector3d& p_B : kWeldPoints) {
      ContactPoint point;
      point.a = weld.link_a;
      point.b = weld.link_b;
      point.point = X_WB * p_B;
      point.normal = Eigen::Vector3d::UnitZ();
      point.bonded = true;
      point.gap = point.point - X_WA * (weld.X_AB * p_B);
      crossings_.push_back({weld.a, weld.b, point, a_moves ? weld.a : weld.b, a_moves && b_moves});
    }
  }
}

/** Returns the name of the other robot's body at each point, "" at those of this one. */
std::vector<std::string> TouchingRobots::othersOf(std::size_t robot, const std::vector<Crossing>& all) const {
  std::vector<std::string> names;
  for (const Crossing& each : all) {
    const std::size_t other = each.a == robot ? each.b : each.a;
    const int id = each.a == robot ? each.point.b : each.point.a;
    const bool named = !names_.empty() && !each.point.bonded && other != robot && (each.a == robot || each.b == robot);
    names.push_back(named ? names_[other] + "::" + robots_[other]->contacts_->nameOf(id) : std::string());
  }
  return names;
}

/** Returns all points of an island as one of its robots has them. */
std::vector<ContactPoint> TouchingRobots::pointsOf(std::size_t robot, const std::vector<Crossing>& all) const {
  std::vector<ContactPoint> points;
  for (const Crossing& each : all) {
    ContactPoint point = each.point;
    if (each.a != robot && point.a >= 0) point.a = ContactPoint::kElsewhere;
    if (each.b != robot && point.b >= 0) point.b = ContactPoint::kElsewhere;
    points.push_back(point);
  }
  return points;
}

void TouchingRobots::solveIsland(std::size_t island) {
  std::vector<std::size_t> members;
  std::vector<Crossing> all;
  Eigen::Index n = 0;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (island_[i] != island) continue;
    members.push_back(i);
    n += robots_[i]->coupling_->coordinates();
    for (const ContactPoint& point : robots_[i]->contacts_->points()) all.push_back({i, i, point, i, true});
  }
  for (const Crossing& each : crossings_) {
    if (island_[each.mover] == island) all.push_back(each);
  }
  const auto rows = static_cast<Eigen::Index>(3 * all.size());
  ContactRows sum;
  sum.J.setZero(rows, n);
  sum.S.setZero(rows, rows);
  sum.u0.setZero(rows);
  for (const Crossing& each : all) {
    sum.depth_m.push_back(each.point.depth_m);
    sum.friction.push_back(each.point.friction);
  }
  std::vector<double> M(n * n, 0.0);
  std::vector<JointGraph> graphs;
  Eigen::VectorXd v(n), v_free(n), effort(n);
  Eigen::Index first = 0;
  for (const std::size_t i : members) {
    MultibodyWorld& robot = *robots_[i];
    const Eigen::Index count = robot.coupling_->coordinates();
    robot.contacts_->share(pointsOf(i, all));
    robot.contacts_->nameOthers(othersOf(i, all));
    robot.contacts_->arrange(*robot.body_, *robot.coupling_, robot.v_free_);
    sum.J.middleCols(first, count) = robot.contacts_->rows().J;
    sum.S += robot.contacts_->rows().S;
    sum.u0 += robot.contacts_->rows().u0;
    sum.bonds = robot.contacts_->rows().bonds;  // the same for all members
    for (Eigen::Index k = 0; k < count; ++k) {
      std::copy_n(robot.massUsed().begin() + k * count, count, M.begin() + (first + k) * n + first);
    }
    graphs.insert(graphs.end(), robot.graphs_.begin(), robot.graphs_.end());
    v.segment(first, count) = robot.v_next_;
    v_free.segment(first, count) = robot.freeUsed();
    first += count;
  }
  const MultibodyWorld& leader = *robots_[members.front()];
  ContactSolver solver(leader.contacts_->config().stiffness_n_per_m, leader.contacts_->config().damping_n_s_per_m);
  JointSolver joints(static_cast<int>(n));
  const Eigen::VectorXd& lambda = solver.solve(sum, M, v_free, graphs, leader.config_.period_s, joints, v, effort);
  first = 0;
  for (const std::size_t i : members) {
    MultibodyWorld& robot = *robots_[i];
    const Eigen::Index count = robot.coupling_->coordinates();
    robot.contacts_->take(lambda);
    robot.unsettled_steps_ += solver.settled() ? 0 : 1;
    robot.v_next_ = v.segment(first, count);
    robot.total_ = effort.segment(first, count);
    first += count;
  }
}

}  // namespace aras_visual_servo_sim
