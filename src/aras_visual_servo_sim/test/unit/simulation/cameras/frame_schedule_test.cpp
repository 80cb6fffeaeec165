#include "aras_visual_servo_sim/simulation/cameras/frame_schedule.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim::frame_schedule_test {
namespace {

constexpr std::int64_t kMillisecond = 1000000;

TEST(FrameSchedule, FrameIsAtTheFirstTickNotBeforeItsTime) {
  const FrameSchedule schedule(30.0, kMillisecond);
  const std::int64_t expected[] = {0, 34, 67, 100, 134, 167, 200};
  for (std::int64_t k = 0; k < 7; ++k) EXPECT_EQ(schedule.tickOf(k), expected[k]) << k;
}

TEST(FrameSchedule, DoesNotDriftInADay) {
  const std::int64_t day_s = 86400;
  EXPECT_EQ(FrameSchedule(30.0, kMillisecond).tickOf(30 * day_s), 1000 * day_s);
}

TEST(FrameSchedule, FirstIndexFromIsTheInverseOfTickOf) {
  for (const double rate_hz : {1.0, 7.3, 30.0, 59.94, 999.0, 1000.0}) {
    const FrameSchedule schedule(rate_hz, kMillisecond);
    for (std::int64_t tick = 0; tick < 300; ++tick) {
      const std::int64_t index = schedule.firstIndexFrom(tick);
      EXPECT_GE(schedule.tickOf(index), tick) << rate_hz;
      if (index > 0) {
        EXPECT_LT(schedule.tickOf(index - 1), tick) << rate_hz;
      }
    }
  }
}

TEST(FrameSchedule, RefusesRatesThatTheTicksCannotServe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double rate_hz : {0.0, -30.0, 1001.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(FrameSchedule(rate_hz, kMillisecond), ParameterError) << rate_hz;
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::frame_schedule_test
