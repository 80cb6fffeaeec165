#include <cmath>
#include <limits>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "tools/pan_lift.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::place_test {
namespace {

Pose placeOf(double x_m, double w) { return {{x_m, 0.0, 0.0}, Eigen::Quaterniond(w, 0.0, 0.0, 0.0)}; }

TEST(Place, IsWithinTheBoundsOfAScene) {
  EXPECT_NO_THROW(checkPlace("model 'a'", placeOf(1e4, 1.0)));
  EXPECT_NO_THROW(checkPlace("model 'a'", placeOf(-1e4, 3e4)));
  EXPECT_HAS(messageOf<ParameterError>([] { checkPlace("model 'a'", placeOf(10001.0, 1.0)); }),
             "model 'a': found a position of 10001.000000 m, allowed >= -10000 and <= 10000");
  EXPECT_THROW(checkPlace("model 'a'", placeOf(-1e300, 1.0)), ParameterError);
  EXPECT_THROW(checkPlace("model 'a'", placeOf(std::nan(""), 1.0)), NotFiniteError);
}

TEST(Place, HasAQuaternionThatCanBeMadeOne) {
  for (const double w : {0.0, 1e-10, 1e300}) {
    EXPECT_HAS(messageOf<ParameterError>([w] { checkPlace("model 'a'", placeOf(0.0, w)); }), "found a quaternion");
  }
}

TEST(Place, OfAModelIsChecked) {
  Simulation simulation = fixture::panLift();
  EXPECT_THROW(simulation.setModelPose("target", placeOf(1e300, 1.0)), ParameterError);
  EXPECT_THROW(simulation.setModelPose("target", placeOf(0.0, 0.0)), ParameterError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::place_test
