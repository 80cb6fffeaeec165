#pragma once

#include <string>

#include "aras_visual_servo_camera/config/errors.hpp"

namespace aras_visual_servo_camera::testing {

/** The text of the Error that an action throws; empty when it throws none. */
template <typename Error = ArasError, typename Action>
std::string textOf(Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace aras_visual_servo_camera::testing
