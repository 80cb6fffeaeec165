#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

namespace aras_visual_servo {

using PoseRef = Eigen::Ref<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>;

/** Displacement from one pose to another, in the frame of the first: [p; theta u], theta in [0, pi] [m; rad]. */
Eigen::Matrix<double, 6, 1> between(const PoseRef& X_A, const PoseRef& X_B);

/** What the images of the last seconds say of the features and of the camera's distance from the goal (docs/theory.md
 *  T60, T61). servo/stop_rule.py decides by it whether the servo has arrived. */
class Arrival {
 public:
  using Numbers = std::vector<double>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  struct Limits {
    double position_m, rotation_rad, tilt_rad;
  };
  /** What the images cannot tell by themselves of the displacements that they stand for. */
  struct Model {
    Matrix6 edges = Matrix6::Zero();  ///< covariance for a variance of 1 of the place of the object's sides
    std::vector<Matrix6> planes = {Matrix6::Identity()};  ///< what a displacement may be instead, the first itself
  };
  /** All but the two last are parts of the limits, 1 where a limit is met. */
  struct Place {
    double off;                       ///< farthest that the mean place was from the goal in the last hold_ns
    double moved;                     ///< farthest that the camera was in that time from where it is now
    double position, turn;            ///< as `off`, the uncertainty of the mean counted as distance
    double known;                     ///< the larger of both with what the model leaves open
    double open;                      ///< the part of `known` that more images do not make smaller
    double position_m, rotation_rad;  ///< of now, with all that
  };

  /** @param thresholds  of the features.  @param hold_ns  for which the servo has to be at the goal
   *  @param kept_ns  for which images tell the place.  @param sure  standard errors of a mean that count as distance
   *  @param taught_images  whose mean is the goal */
  Arrival(const Numbers& thresholds, std::int64_t hold_ns, std::int64_t kept_ns, const Limits& limits, double sure,
          int taught_images, Model model);

  void clear();

  /** Takes the errors of one image in.
   *  @param e  one per threshold.  @param tilt_rad  NaN: not known.  @param moved  as in place()
   *  @return the mean errors, and the largest tilt, of the last hold_ns, as parts of their limits. Where noise makes
   *      that mean too large, the mean of all images from about this place stands for it, with its uncertainty
   *  @throws ShapeError */
  std::pair<Numbers, double> features(std::int64_t stamp_ns, const Numbers& e, double tilt_rad,
                                      const Eigen::Ref<const Vector6>& moved);

  /** Takes the pose of one image in.
   *  @param moved  of the camera by the joints, since any fixed instant.  @param pose  by the image, from the goal
   *  @param edge_variance  of the place of the object's sides, in this image and at the goal together */
  Place place(std::int64_t stamp_ns, const Eigen::Ref<const Vector6>& moved, const Eigen::Ref<const Vector6>& pose,
              double edge_variance);

 private:
  struct Errors {
    std::int64_t stamp_ns;
    Numbers e;
    double tilt_rad;
    Vector6 moved;
  };
  struct Seen {
    std::int64_t stamp_ns;
    Vector6 moved, off;  // off: the pose by the image less the motion
  };

  /** The part of threshold i by all images from about this place, where `part` is that of the last `held` of them. */
  double noisyPart(std::size_t i, double part, double held, const Vector6& moved) const;
  bool isNear(const Vector6& place, const Vector6& moved) const;

  Numbers thresholds_;
  std::int64_t hold_ns_, kept_ns_;
  Limits limits_;
  double sure_;
  int taught_images_;
  Model model_;
  std::deque<Errors> errors_;
  std::deque<Seen> seen_;
};

}  // namespace aras_visual_servo
