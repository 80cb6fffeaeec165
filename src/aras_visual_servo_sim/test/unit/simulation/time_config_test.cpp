#include <gtest/gtest.h>

#include <string>

#include "aras_visual_servo_sim/errors.hpp"
#include "aras_visual_servo_sim/simulation_config.hpp"

namespace aras_visual_servo_sim {
namespace {

TimeConfig parse(const char* text) { return TimeConfig::fromYaml(YAML::Load(text)); }

TEST(TimeConfig, RendersForSubscribersOnlyUnlessInLockstepOrTold) {
  EXPECT_FALSE(parse("{}").render_always);
  EXPECT_TRUE(parse("{lockstep: true}").render_always);
  EXPECT_FALSE(parse("{lockstep: true, render: subscribed}").render_always);
  EXPECT_TRUE(parse("{render: always}").render_always);
}

TEST(TimeConfig, EveryKeyIsChecked) {
  for (const char* text : {"{real_time_factor: -1}", "{lockstep: 3}", "{lockstep_timeout_s: 0}",
                           "{on_lockstep_timeout: panic}", "{start_paused: maybe}", "{clock_rate_hz: 0}",
                           "{joint_state_rate_hz: .nan}", "{render: never}", "{unknown: 1}"}) {
    EXPECT_THROW(parse(text), ParameterError) << text;
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim
