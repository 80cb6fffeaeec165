#include "aras_visual_servo_sim/simulation/time/time_config.hpp"

#include <gtest/gtest.h>

#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim::time_config_test {
namespace {

TimeConfig parse(const char* text) { return TimeConfig::fromYaml(YAML::Load(text)); }

TEST(TimeConfig, RendersForSubscribersOnlyUnlessInLockstepOrTold) {
  EXPECT_FALSE(parse("{}").render_always);
  EXPECT_TRUE(parse("{lockstep: true}").render_always);
  EXPECT_FALSE(parse("{lockstep: true, render: subscribed}").render_always);
  EXPECT_TRUE(parse("{render: always}").render_always);
}

TEST(TimeConfig, WhoAnswersWhichCameraAndTheClockOfAReset) {
  const TimeConfig config = parse("{lockstep_nodes: [b, /a], lockstep_cameras: [left], reset_clock: monotonic}");
  EXPECT_EQ(config.lockstep_nodes, (std::vector<std::string>{"b", "/a"}));
  EXPECT_EQ(config.lockstep_cameras, std::vector<std::string>{"left"});
  EXPECT_TRUE(config.monotonic_clock);
  EXPECT_FALSE(parse("{}").monotonic_clock);
}

TEST(TimeConfig, EveryKeyIsChecked) {
  for (const char* text :
       {"{real_time_factor: -1}", "{lockstep: 3}", "{lockstep_timeout_s: 0}", "{on_lockstep_timeout: panic}",
        "{start_paused: maybe}", "{clock_rate_hz: 0}", "{joint_state_rate_hz: .nan}", "{lockstep_nodes: [a, a]}",
        "{lockstep_cameras: ['']}", "{lockstep_nodes: controller}", "{reset_clock: sideways}", "{render: never}",
        "{unknown: 1}"}) {
    EXPECT_THROW(parse(text), ParameterError) << text;
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::time_config_test
