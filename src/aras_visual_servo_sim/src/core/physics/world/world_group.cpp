#include "aras_visual_servo_sim/physics/world_group.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "world_impl.hpp"

namespace aras_visual_servo_sim {

class WorldGroup::Impl {
 public:
  explicit Impl(const std::vector<MultibodyWorld::Impl*>& worlds) : worlds_(worlds) {}

  void step() {
    for (MultibodyWorld::Impl* world : worlds_) {
      if (!world->driven) world->beginStep();
    }
    findPoints();
    for (std::size_t i = 0; i < worlds_.size(); ++i) {
      if (island_[i] == i && !touchesOther(i) && !worlds_[i]->driven) worlds_[i]->solveStep();
      if (island_[i] == i && touchesOther(i)) solveIsland(i);
    }
    for (MultibodyWorld::Impl* world : worlds_) world->driven ? world->step() : world->finishStep();
  }

 private:
  /** A point between two worlds, by their numbers; the bodies in it are those of world a and world b. */
  struct Crossing {
    std::size_t a, b;
    ContactPoint point;
  };

  bool touchesOther(std::size_t world) const {
    return std::any_of(crossings_.begin(), crossings_.end(),
                       [&](const Crossing& each) { return each.a == world || each.b == world; });
  }

  /** The points between worlds, and which worlds hang together by them: island_ is the first world of each. */
  void findPoints() {
    crossings_.clear();
    boxes_.assign(worlds_.size(), Eigen::AlignedBox3d());
    island_.resize(worlds_.size());
    for (std::size_t i = 0; i < worlds_.size(); ++i) {
      island_[i] = i;
      WorldContacts* mine = worlds_[i]->contacts.get();
      if (!mine) continue;
      boxes_[i] = mine->shapes().boxAround(mine->sharedBodies());
      for (std::size_t j = 0; j < i; ++j) {
        const Eigen::AlignedBox3d near = boxes_[i].intersection(boxes_[j]);
        if (!near.isEmpty()) findBetween(j, i, near);
      }
    }
    for (const Crossing& each : crossings_) join(each.a, each.b);
  }

  void findBetween(std::size_t a, std::size_t b, const Eigen::AlignedBox3d& near) {
    WorldContacts& one = *worlds_[a]->contacts;
    WorldContacts& other = *worlds_[b]->contacts;
    points_.clear();
    one.shapes().findWith(
        other.shapes(), one.sharedBodies(), other.sharedBodies(), near,
        [&](int here, int there) { return std::min(one.frictionBeyond(here), other.frictionBeyond(there)); }, points_);
    for (const ContactPoint& point : points_) {
      if (moves(a, point.a) || moves(b, point.b)) crossings_.push_back({a, b, point});
    }
  }

  bool moves(std::size_t world, int body) const { return worlds_[world]->contacts->moves(body, worlds_[world]->body); }

  void join(std::size_t a, std::size_t b) {
    const std::size_t first = std::min(island_[a], island_[b]);
    const std::size_t second = std::max(island_[a], island_[b]);
    std::replace(island_.begin(), island_.end(), second, first);
  }

  /** All points of the worlds of an island, as one of them has them. */
  std::vector<ContactPoint> pointsOf(std::size_t world, const std::vector<Crossing>& all) const {
    std::vector<ContactPoint> points;
    for (const Crossing& each : all) {
      ContactPoint point = each.point;
      if (each.a != world && point.a >= 0) point.a = ContactPoint::kElsewhere;
      if (each.b != world && point.b >= 0) point.b = ContactPoint::kElsewhere;
      points.push_back(point);
    }
    return points;
  }

  void solveIsland(std::size_t island) {
    std::vector<std::size_t> members;
    std::vector<Crossing> all;
    Eigen::Index n = 0;
    for (std::size_t i = 0; i < worlds_.size(); ++i) {
      if (island_[i] != island) continue;
      members.push_back(i);
      n += worlds_[i]->coupling.coordinates();
      for (const ContactPoint& point : worlds_[i]->contacts->points()) all.push_back({i, i, point});
    }
    for (const Crossing& each : crossings_) {
      if (island_[each.a] == island) all.push_back(each);
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
      MultibodyWorld::Impl& world = *worlds_[i];
      const Eigen::Index count = world.coupling.coordinates();
      world.contacts->share(pointsOf(i, all));
      world.contacts->arrange(world.body, world.coupling, world.v_free);
      sum.J.middleCols(first, count) = world.contacts->rows().J;
      sum.S += world.contacts->rows().S;
      sum.u0 += world.contacts->rows().u0;
      for (Eigen::Index k = 0; k < count; ++k) {
        std::copy_n(world.massUsed().begin() + k * count, count, M.begin() + (first + k) * n + first);
      }
      graphs.insert(graphs.end(), world.graphs.begin(), world.graphs.end());
      v.segment(first, count) = world.v_next;
      v_free.segment(first, count) = world.freeUsed();
      first += count;
    }
    const MultibodyWorld::Impl& leader = *worlds_[members.front()];
    ContactSolver solver(leader.contacts->config().stiffness_n_per_m, leader.contacts->config().damping_n_s_per_m);
    JointSolver joints(static_cast<int>(n));
    const Eigen::VectorXd& lambda = solver.solve(sum, M, v_free, graphs, leader.config.period_s, joints, v, effort);
    first = 0;
    for (const std::size_t i : members) {
      MultibodyWorld::Impl& world = *worlds_[i];
      const Eigen::Index count = world.coupling.coordinates();
      world.contacts->take(lambda);
      world.unsettled_steps += solver.settled() ? 0 : 1;
      world.v_next = v.segment(first, count);
      world.total = effort.segment(first, count);
      first += count;
    }
  }

  std::vector<MultibodyWorld::Impl*> worlds_;
  std::vector<Eigen::AlignedBox3d> boxes_;
  std::vector<std::size_t> island_;
  std::vector<Crossing> crossings_;
  std::vector<ContactPoint> points_;
};

WorldGroup::WorldGroup(const std::vector<MultibodyWorld*>& worlds) {
  std::vector<MultibodyWorld::Impl*> impls;
  for (MultibodyWorld* world : worlds) {
    if (world->config().period_s != worlds.front()->config().period_s) {
      throw ParameterError("step: found periods of " + shown(worlds.front()->config().period_s) + " and " +
                           shown(world->config().period_s) + " s, allowed is one for all");
    }
    impls.push_back(world->impl_.get());
  }
  impl_ = std::make_unique<Impl>(impls);
}

WorldGroup::~WorldGroup() = default;

void WorldGroup::step() { impl_->step(); }

}  // namespace aras_visual_servo_sim
