#pragma once

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

/** Where a response has the reason of a refusal: `message`, in those of Gazebo's kind `status_message`. */
template <typename Response>
auto reasonOf(Response& response, int) -> decltype((response.status_message)) {
  return response.status_message;
}
template <typename Response>
auto reasonOf(Response& response, long) -> decltype((response.message)) {
  return response.message;
}

/** Answers a service that has `success`: what the action throws is the reason of a refusal.
 *  @return true: the call was answered */
template <typename Response, typename Action>
bool answer(Response& response, const Action& action) {
  try {
    action();
    response.success = true;
  } catch (const ArasError& error) {
    response.success = false;
    reasonOf(response, 0) = error.what();
  }
  return true;
}

}  // namespace aras_visual_servo_sim
