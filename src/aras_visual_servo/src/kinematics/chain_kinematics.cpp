#include "chain_kinematics.hpp"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <kdl/frames.hpp>
#include <kdl/tree.hpp>
#include <limits>

#include "joint_wish.hpp"

namespace aras_visual_servo {
namespace {

/** Below this a manipulability is rounding: entries of about 10, six rows, and the square root of a determinant. */
constexpr double kNoManipulability = 1e-9;

/** Collects what urdfdom would print, so that it becomes the cause in a ModelError. */
class LogCapture : public console_bridge::OutputHandler {
 public:
  LogCapture() { console_bridge::useOutputHandler(this); }
  ~LogCapture() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/, int /*line*/) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) text_ += (text_.empty() ? "" : "; ") + text;
  }
  std::string cause(const std::string& otherwise) const { return text_.empty() ? otherwise : text_; }

 private:
  std::string text_;
};

urdf::ModelInterfaceSharedPtr parse(const std::string& urdf_xml) {
  LogCapture log;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(urdf_xml);
  } catch (const std::exception& error) {
    throw ModelError(std::string("URDF: ") + error.what());
  }
  if (!model) throw ModelError("URDF: " + log.cause("cannot be parsed"));
  return model;
}

void requireLink(const urdf::ModelInterface& model, const std::string& name) {
  if (model.getLink(name)) return;
  std::string known;
  for (const auto& link : model.links_) known += (known.empty() ? "" : ", ") + link.first;
  throw ModelError("robot '" + model.getName() + "': no link '" + name + "', it has: " + known);
}

/** @return whether the joint moves. @throws ModelError when it moves in a way the chain cannot represent */
bool isMoving(const urdf::Joint& joint) {
  if (joint.type == urdf::Joint::FIXED) return false;
  if (joint.type != urdf::Joint::REVOLUTE && joint.type != urdf::Joint::CONTINUOUS &&
      joint.type != urdf::Joint::PRISMATIC)
    throw ModelError("joint '" + joint.name + "': type must be revolute, continuous, prismatic or fixed");
  if (joint.mimic) throw ModelError("joint '" + joint.name + "': <mimic> is not supported");
  return true;
}

/** The links from this one up to the root. */
std::vector<urdf::LinkConstSharedPtr> wayUp(const urdf::ModelInterface& model, const std::string& from) {
  std::vector<urdf::LinkConstSharedPtr> way{model.getLink(from)};
  while (way.back()->parent_joint) way.push_back(model.getLink(way.back()->parent_joint->parent_link_name));
  return way;
}

/** The joints that move between two links, from the first to the second: up to where their ways meet, then down. */
std::vector<urdf::JointConstSharedPtr> movingBetween(const urdf::ModelInterface& model, const std::string& base_link,
                                                     const std::string& tip_link) {
  std::vector<urdf::LinkConstSharedPtr> up = wayUp(model, base_link), down = wayUp(model, tip_link);
  while (!up.empty() && !down.empty() && up.back() == down.back()) {
    up.pop_back();
    down.pop_back();
  }
  std::vector<urdf::JointConstSharedPtr> moving;
  const auto add = [&moving](const urdf::LinkConstSharedPtr& link) {
    if (isMoving(*link->parent_joint)) moving.push_back(link->parent_joint);
  };
  std::for_each(up.begin(), up.end(), add);
  std::for_each(down.rbegin(), down.rend(), add);
  return moving;
}

KDL::Frame frameOf(const urdf::Pose& pose) {
  double x, y, z, w;
  pose.rotation.getQuaternion(x, y, z, w);
  return {KDL::Rotation::Quaternion(x, y, z, w), KDL::Vector(pose.position.x, pose.position.y, pose.position.z)};
}

/** The segment from the frame of the parent link to that of the joint's child link, without inertia. */
KDL::Segment segmentOf(const urdf::Joint& joint) {
  const KDL::Frame X_PJ = frameOf(joint.parent_to_joint_origin_transform);
  const KDL::Vector axis_P = X_PJ.M * KDL::Vector(joint.axis.x, joint.axis.y, joint.axis.z);
  KDL::Joint moves(joint.name, KDL::Joint::None);
  if (joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS)
    moves = KDL::Joint(joint.name, X_PJ.p, axis_P, KDL::Joint::RotAxis);
  else if (joint.type == urdf::Joint::PRISMATIC)
    moves = KDL::Joint(joint.name, X_PJ.p, axis_P, KDL::Joint::TransAxis);
  return KDL::Segment(joint.child_link_name, moves, X_PJ);
}

/** kdl_parser makes the same tree, but brings roscpp and log4cxx into every process: 9 MB. */
KDL::Tree treeOf(const urdf::ModelInterface& model) {
  KDL::Tree tree(model.getRoot()->name);
  std::vector<urdf::LinkConstSharedPtr> waiting{model.getRoot()};
  while (!waiting.empty()) {
    const urdf::LinkConstSharedPtr link = waiting.back();
    waiting.pop_back();
    for (const urdf::LinkSharedPtr& child : link->child_links) {
      tree.addSegment(segmentOf(*child->parent_joint), link->name);
      waiting.push_back(child);
    }
  }
  return tree;
}

}  // namespace

ChainKinematics::ChainKinematics(const std::string& urdf_xml, const std::string& base_link, const std::string& tip_link,
                                 bool upwards) {
  const urdf::ModelInterfaceSharedPtr model = parse(urdf_xml);
  requireLink(*model, base_link);
  requireLink(*model, tip_link);

  const std::vector<urdf::LinkConstSharedPtr> above = wayUp(*model, tip_link);
  const auto is_base = [&](const urdf::LinkConstSharedPtr& link) { return link->name == base_link; };
  if (!upwards && std::none_of(above.begin(), above.end(), is_base))
    throw ModelError("link '" + tip_link + "' is not below link '" + base_link + "'");
  const std::vector<urdf::JointConstSharedPtr> moving = movingBetween(*model, base_link, tip_link);
  if (moving.empty()) throw ModelError("no moving joint between '" + base_link + "' and '" + tip_link + "'");
  if (!treeOf(*model).getChain(base_link, tip_link, chain_))
    throw ModelError("no kinematic chain from '" + base_link + "' to '" + tip_link + "'");

  for (const auto& joint : moving) joint_names_.push_back(joint->name);
  std::sort(joint_names_.begin(), joint_names_.end());
  const auto n = static_cast<Eigen::Index>(moving.size());
  const double infinity = std::numeric_limits<double>::infinity();
  lower_ = Eigen::VectorXd::Constant(n, -infinity);
  upper_ = velocity_ = Eigen::VectorXd::Constant(n, infinity);
  for (const auto& joint : moving) {
    const auto place = std::lower_bound(joint_names_.begin(), joint_names_.end(), joint->name);
    const int i = static_cast<int>(place - joint_names_.begin());
    index_.push_back(i);
    if (!joint->limits) continue;
    if (joint->type != urdf::Joint::CONTINUOUS) {
      lower_[i] = joint->limits->lower;
      upper_[i] = joint->limits->upper;
    }
    if (joint->limits->velocity > 0.0) velocity_[i] = joint->limits->velocity;
    if (!(lower_[i] < upper_[i])) throw ModelError("joint '" + joint->name + "': limits, lower must be below upper");
  }
}

void ChainKinematics::check(const Joints& q) const {
  requireSize("q", q.size(), static_cast<Eigen::Index>(joint_names_.size()));
  if (!q.allFinite()) throw NotFiniteError("q: a joint position is not finite");
}

ChainKinematics::Matrix4 ChainKinematics::pose(const Joints& q) const {
  check(q);
  KDL::Frame X_BC = KDL::Frame::Identity();
  std::size_t moving = 0;
  for (const KDL::Segment& segment : chain_.segments) {
    const bool fixed = segment.getJoint().getType() == KDL::Joint::None;
    X_BC = X_BC * segment.pose(fixed ? 0.0 : q[index_[moving++]]);
  }
  Matrix4 pose;
  X_BC.Make4x4(pose.data());
  return pose;
}

ChainKinematics::Jacobian ChainKinematics::jacobian(const Joints& q) const {
  check(q);
  Jacobian columns = Jacobian::Zero(6, q.size());
  // From the tip backwards, X_LC: pose of C in the frame L that the segment's joint moves.
  KDL::Frame X_LC = KDL::Frame::Identity();
  std::size_t moving = index_.size();
  for (auto segment = chain_.segments.rbegin(); segment != chain_.segments.rend(); ++segment) {
    if (segment->getJoint().getType() == KDL::Joint::None) {
      X_LC = segment->pose(0.0) * X_LC;
      continue;
    }
    const int i = index_[--moving];
    // Unit twist of the segment's tip, at its origin, expressed in the segment's root frame; then moved to C.
    const KDL::Frame X_RL = segment->pose(q[i]);
    const KDL::Twist V_R = segment->twist(q[i], 1.0).RefPoint(X_RL.M * X_LC.p);
    X_LC = X_RL * X_LC;
    const KDL::Twist V_C = X_LC.M.Inverse(V_R);
    for (int row = 0; row < 6; ++row) columns(row, i) = V_C(row);
  }
  return columns;
}

std::pair<Eigen::VectorXd, double> ChainKinematics::held(const TwistInverse& inverse,
                                                         const TwistInverse::JacobianRef& jacobian, const Joints& q,
                                                         const Joints& q_dot, double dt_s, double most_part) const {
  check(q);
  requireSize("q_dot", q_dot.size(), q.size());
  const double factor = velocityFactor(q_dot, velocity_);
  Eigen::VectorXd slowed = q_dot;
  if (factor < 1.0) slowed *= factor;
  const double half_s = 0.5 * dt_s;
  slowed += inverse.turning(jacobian, this->jacobian(q + half_s * slowed), slowed, most_part);
  return {std::move(slowed), factor};
}

std::pair<double, Eigen::VectorXd> ChainKinematics::manipulability(const Joints& q, double length_m,
                                                                   const std::vector<int>& rows) const {
  const Jacobian J = jacobian(q);
  const auto m = static_cast<Eigen::Index>(rows.size());
  if (m == 0 || m > J.cols()) throw ShapeError("rows: " + std::to_string(m) + ", expected 1 to the number of joints");
  if (!(length_m > 0.0)) throw ShapeError("length_m: " + std::to_string(length_m) + ", must be > 0");
  for (const int row : rows)
    if (row < 0 || row > 5) throw ShapeError("rows: found " + std::to_string(row) + ", expected 0 to 5");
  const auto pick = [&](const Eigen::Matrix<double, 6, 1>& column) {
    Eigen::VectorXd picked(m);
    for (Eigen::Index i = 0; i < m; ++i) picked[i] = column[rows[i]] / (rows[i] < 3 ? length_m : 1.0);
    return picked;
  };
  Eigen::MatrixXd A(m, J.cols());
  for (Eigen::Index j = 0; j < J.cols(); ++j) A.col(j) = pick(J.col(j));
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(J.cols());
  const Eigen::MatrixXd square = A * A.transpose();
  const double w = std::sqrt(std::max(0.0, square.determinant()));
  if (!(w > kNoManipulability)) return {0.0, gradient};
  // d(ln w)/dq_i = tr((A A^T)^-1 dA/dq_i A^T), and column j of dA/dq_i is -[J_i, J_j] for joints i below j in the
  // chain.
  const Eigen::MatrixXd weight = square.ldlt().solve(A);
  for (std::size_t below = 0; below < index_.size(); ++below) {
    const Eigen::Vector3d v = J.col(index_[below]).head<3>(), w_i = J.col(index_[below]).tail<3>();
    for (std::size_t above = 0; above < below; ++above) {
      const Eigen::Vector3d v_j = J.col(index_[above]).head<3>(), w_j = J.col(index_[above]).tail<3>();
      Eigen::Matrix<double, 6, 1> derivative;
      derivative << -(w_i.cross(v_j) + v.cross(w_j)), -w_i.cross(w_j);
      gradient[index_[below]] += weight.col(index_[above]).dot(pick(derivative));
    }
  }
  return {w, gradient};
}

}  // namespace aras_visual_servo
