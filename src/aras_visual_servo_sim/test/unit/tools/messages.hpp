#pragma once

#include <gtest/gtest.h>

#include <exception>
#include <string>

namespace aras_visual_servo_sim {

/** Message of the E that `act` must throw. */
template <typename E, typename Act>
std::string messageOf(Act act) {
  try {
    act();
  } catch (const E& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another error: " << error.what();
    return "";
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

#define EXPECT_HAS(text, part) \
  EXPECT_NE((text).find(part), std::string::npos) << "'" << (part) << "' not in: " << (text)

}  // namespace aras_visual_servo_sim
