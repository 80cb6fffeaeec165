#pragma once

namespace aras_visual_servo_sim {

/** x within low .. high; low if it is no number: what becomes an index goes through here. */
template <typename T>
constexpr T held(T x, T low, T high) {
  return x > low ? (x < high ? x : high) : low;
}

}  // namespace aras_visual_servo_sim
