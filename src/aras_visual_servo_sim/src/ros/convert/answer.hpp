#pragma once

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

/** Answers a service that has `success` and `message`: what the action throws is the reason of a refusal.
 *  @return true: the call was answered */
template <typename Response, typename Action>
bool answer(Response& response, const Action& action) {
  try {
    action();
    response.success = true;
  } catch (const ArasError& error) {
    response.success = false;
    response.message = error.what();
  }
  return true;
}

}  // namespace aras_visual_servo_sim
