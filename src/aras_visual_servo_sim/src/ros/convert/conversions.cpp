#include "conversions.hpp"

#include <aras_visual_servo_common/text.hpp>
#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kFarthestM = 1e4;       // metres in single precision have steps of a millimetre there
constexpr double kUnitTolerance = 1e-3;  // single-precision senders and three-digit command lines pass

}  // namespace

geometry_msgs::Pose toMessage(const Pose& pose) {
  geometry_msgs::Pose message;
  message.position.x = pose.p.x();
  message.position.y = pose.p.y();
  message.position.z = pose.p.z();
  message.orientation.x = pose.q.x();
  message.orientation.y = pose.q.y();
  message.orientation.z = pose.q.z();
  message.orientation.w = pose.q.w();
  return message;
}

Pose fromMessage(const geometry_msgs::Pose& message, Unset unset) {
  Pose pose;
  pose.p = {message.position.x, message.position.y, message.position.z};
  pose.q =
      Eigen::Quaterniond(message.orientation.w, message.orientation.x, message.orientation.y, message.orientation.z);
  if (unset == Unset::kIdentity && pose.q.coeffs().isZero(0.0)) pose.q.setIdentity();
  const double length = pose.q.norm();
  if (!pose.p.allFinite() || !std::isfinite(length)) throw NotFiniteError("pose: not finite");
  if (std::abs(length - 1.0) > kUnitTolerance) {
    throw ParameterError("pose: orientation has length " + aras_visual_servo_common::numberText(length) +
                         ", must be 1");
  }
  if (pose.p.cwiseAbs().maxCoeff() > kFarthestM) {
    throw ParameterError("pose: position is " + aras_visual_servo_common::numberText(pose.p.cwiseAbs().maxCoeff()) +
                         " m away, allowed <= " + aras_visual_servo_common::numberText(kFarthestM));
  }
  pose.q.normalize();
  return pose;
}

geometry_msgs::Twist toMessage(const Twist& V) {
  geometry_msgs::Twist message;
  message.linear.x = V[0];
  message.linear.y = V[1];
  message.linear.z = V[2];
  message.angular.x = V[3];
  message.angular.y = V[4];
  message.angular.z = V[5];
  return message;
}

sensor_msgs::CameraInfo toMessage(const CameraModel& camera) {
  sensor_msgs::CameraInfo message;
  message.header.frame_id = camera.config().frame;
  message.width = static_cast<std::uint32_t>(camera.width());
  message.height = static_cast<std::uint32_t>(camera.height());
  message.distortion_model = camera.distortionModel();
  message.D = camera.D();
  using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  Eigen::Map<RowMajor3>(message.K.data()) = camera.K();
  Eigen::Map<RowMajor3>(message.R.data()) = camera.R();
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(message.P.data()) = camera.P();
  return message;
}

}  // namespace aras_visual_servo_sim
