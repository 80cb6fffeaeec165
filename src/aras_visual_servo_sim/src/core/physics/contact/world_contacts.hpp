#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "contact_shapes.hpp"
#include "contact_solver.hpp"
#include "physics/body/articulated_body.hpp"
#include "physics/body/free_body.hpp"
#include "physics/drive/joint_coupling.hpp"

namespace aras_visual_servo_sim {

/** The contacts of a world: its bodies, the points where they touch in this step, and the impulses there. */
class WorldContacts {
 public:
  /** @throws ParameterError, ModelError naming a body that has no shape to touch with */
  WorldContacts(const RobotModel& model, const ContactConfig& config, const ArticulatedBody& body,
                const Eigen::Vector3d& gravity_m_s2, double period_s);

  /** Places everything and finds the points. */
  void find(const ArticulatedBody& body);
  /** Lays out the rows of the points, given the velocities the joints have freely. */
  void arrange(const ArticulatedBody& body, const JointCoupling& coupling, const Eigen::VectorXd& v_free);

  /** JointSolver::solve with the contacts. */
  void solve(const std::vector<double>& M, const Eigen::VectorXd& v_free, const std::vector<JointGraph>& graphs,
             JointSolver& joints, Eigen::VectorXd& v, Eigen::VectorXd& effort);

  // --- of several robots that touch each other, see TouchingRobots
  ContactShapes& shapes() { return shapes_; }
  const ContactConfig& config() const { return config_; }
  /** Bodies that those of other robots touch: the links with shapes, and the obstacles that touch anything. */
  const std::vector<int>& sharedBodies() const { return shared_; }
  /** Whether contacts can move a body; they do not move a driven base. */
  bool moves(int id, const ArticulatedBody& body) const;
  /** Coulomb's coefficient of a body against those of other robots. */
  double frictionBeyond(int id) const { return std::min(config_.friction, frictionOf(id)); }
  /** These points in the place of those that were found; the robots they are of have the same in the same order. */
  void share(std::vector<ContactPoint> points) { points_ = std::move(points); }
  /** Names of the bodies of other robots at the points of share(), "" elsewhere. */
  void nameOthers(std::vector<std::string> names) { others_ = std::move(names); }
  /** Name of one of the two bodies at a point. */
  std::string nameAt(std::size_t point, int id) const {
    return id == ContactPoint::kElsewhere && point < others_.size() && !others_[point].empty() ? others_[point]
                                                                                               : nameOf(id);
  }
  const ContactRows& rows() const { return rows_; }
  /** The impulses at these points, as they were found for all robots. */
  void take(const Eigen::VectorXd& lambda) { lambda_ = lambda; }

  /** Lets the impulses act on the base, and moves the free bodies. */
  void finish(ArticulatedBody& body);

  /** Points of the last step, with the force on body a [N] in the world. */
  const std::vector<ContactPoint>& points() const { return points_; }
  Eigen::Vector3d force(std::size_t point) const;
  /** Whether the impulses of the last step settled within the bound on the work of a step. */
  bool settled() const { return points_.empty() || solver_.settled(); }
  std::string nameOf(int id) const;

  const std::vector<Obstacle>& obstacles() const { return config_.obstacles; }
  Pose obstaclePose(std::size_t k) const;
  /** As it was, velocity kept. */
  void restoreObstacle(std::size_t k, const Pose& X_WO);
  /** At rest. */
  void placeObstacle(std::size_t k, const Pose& X_WO);
  std::vector<FreeBody>& freeBodies() { return free_; }
  /** [linear; angular] in world axes, of the centre of mass; zero without mass. */
  Twist obstacleVelocity(std::size_t k) const;
  /** Poses and velocities of those obstacles that another one has too, by name. */
  void takeOver(WorldContacts& other);
  void reset();

 private:
  struct Side {
    int free_body = -1;                // of free_
    Eigen::Matrix<double, 3, 6> rows;  // on that body
  };

  void addLinks(const ArticulatedBody& body);
  void addObstacles();
  void watchPairs(const ArticulatedBody& body);
  bool mayTouch(int a, int b, const ArticulatedBody& body) const;
  std::vector<int> idsOf(const std::string& name) const;
  double frictionOf(int id) const;
  int freeBodyOf(int id) const;
  void layOut(const ArticulatedBody& body, const JointCoupling& coupling);
  void addSide(std::size_t point, int id, double sign, const ArticulatedBody& body, const JointCoupling& coupling);
  void addFreeMotion(const ArticulatedBody& body, const Eigen::VectorXd& v_free);

  const RobotModel& model_;
  ContactConfig config_;
  Eigen::Vector3d gravity_m_s2_;
  double period_s_;
  ContactShapes shapes_;
  ContactSolver solver_;
  std::vector<Pose> X_WO_;      // of obstacles without mass
  std::vector<int> free_body_;  // of each obstacle, -1: it has no mass
  std::vector<FreeBody> free_;
  std::vector<int> shared_;
  std::vector<ContactPoint> points_;
  std::vector<std::string> others_;
  std::vector<Eigen::Matrix3d> axes_;  // rows: normal and tangents of each point
  ContactRows rows_;
  Eigen::Matrix<double, Eigen::Dynamic, 6> J_base_;
  std::vector<Side> sides_;                         // two for each point
  std::vector<std::vector<std::size_t>> sides_of_;  // of each free body
  std::vector<Twist> free_velocity_;
  Eigen::VectorXd lambda_;
};

}  // namespace aras_visual_servo_sim
