#include "aras_visual_servo_sim/physics/pid.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace aras_visual_servo_sim::pid_test {
namespace {

struct PidCase {
  const char* what;
  PidGains gains;  // p i d i_min i_max antiwindup
  double dt_s;
  std::vector<double> errors, commands;
};

// Worked by hand from control_toolbox's definition: command = p e + clamp(i sum(e dt)) + d (e - e_last) / dt, the first
// derivative being 0. Numbers are sums of a few powers of two, so the comparison is exact.
const PidCase kCases[] = {
    {"p alone", {2, 0, 0, 0, 0, false}, 0.5, {1, -3, 0}, {2, -6, 0}},
    {"d from the second call on", {0, 0, 2, 0, 0, false}, 0.5, {1, 3, 3, 0}, {0, 8, 0, -12}},
    {"i accumulates within its clamp", {0, 2, 0, -8, 8, false}, 0.5, {1, 1, -4}, {1, 2, -2}},
    {"i_clamp of 0 means no integral", {1, 2, 0, 0, 0, false}, 0.5, {1, 1}, {1, 1}},
    {"without antiwindup the sum goes on", {0, 2, 0, -1, 1, false}, 0.5, {4, 4, -4, -4, -2}, {1, 1, 1, 0, -1}},
    {"with antiwindup the sum is held", {0, 2, 0, -1, 1, true}, 0.5, {4, 4, -0.5, -0.5}, {1, 1, 0.5, 0}},
    {"and held below too", {0, 2, 0, -1, 1, true}, 0.5, {-4, -4, 0.5, 0.5}, {-1, -1, -0.5, 0}},
    {"clamps need not be symmetric", {0, 4, 0, -1, 2, false}, 0.5, {4, -8}, {2, -1}},
    {"all three", {1, 2, 0.5, -8, 8, false}, 0.5, {2, 1}, {4, 3}},
};

TEST(Pid, FollowsTheTableOfCases) {
  for (const PidCase& each : kCases) {
    Pid pid(each.gains);
    for (std::size_t i = 0; i < each.errors.size(); ++i) {
      EXPECT_EQ(pid.compute(each.errors[i], each.dt_s), each.commands[i]) << each.what << ", call " << i;
    }
  }
}

TEST(Pid, AGivenDerivativeIsUsedAsItIs) {
  Pid pid(PidGains{1, 0, 2, 0, 0, false});
  EXPECT_EQ(pid.compute(1.0, 3.0, 0.5), 7.0);
  EXPECT_EQ(pid.state().error, 1.0);
  EXPECT_EQ(pid.state().error_dot, 3.0);
  EXPECT_EQ(pid.compute(2.0, 0.5), 8.0) << "kept until there are two errors to make one of";
}

TEST(Pid, ADerivativeThatIsNotFiniteGivesNoCommandAndLeavesTheIntegral) {
  Pid pid(PidGains{1, 2, 3, -10, 10, false});
  EXPECT_EQ(pid.compute(1.0, std::numeric_limits<double>::infinity(), 0.5), 0.0);
  EXPECT_EQ(pid.state().integral, 0.0);
}

TEST(Pid, ResetForgetsEverythingButTheGains) {
  Pid pid(PidGains{1, 2, 3, -10, 10, false});
  const double first = pid.compute(0.5, 0.25);
  pid.compute(2.0, 0.25);
  pid.reset();
  EXPECT_EQ(pid.state().integral, 0.0);
  EXPECT_EQ(pid.compute(0.5, 0.25), first);
}

TEST(Pid, AnErrorThatIsNotFiniteGivesNoCommandAndLeavesNoTrace) {
  Pid pid(PidGains{1, 2, 3, -10, 10, false});
  pid.compute(1.0, 0.5);
  const double integral = pid.state().integral;
  EXPECT_EQ(pid.compute(std::numeric_limits<double>::quiet_NaN(), 0.5), 0.0);
  EXPECT_EQ(pid.compute(std::numeric_limits<double>::infinity(), 0.5), 0.0);
  EXPECT_EQ(pid.compute(1.0, 0.0), 0.0);
  EXPECT_EQ(pid.state().integral, integral);
  EXPECT_EQ(pid.compute(3.0, 0.5), 19.0) << "the error before it is the last finite one";
}

TEST(Pid, GainsChangeWhileTheIntegralIsKept) {
  Pid pid(PidGains{0, 2, 0, -10, 10, false});
  pid.compute(2.0, 0.5);
  pid.setGains(PidGains{0, 4, 0, -10, 10, false});
  EXPECT_EQ(pid.compute(0.0, 0.5), 4.0);
}

}  // namespace
}  // namespace aras_visual_servo_sim::pid_test
