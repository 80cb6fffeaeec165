#pragma once

#include <algorithm>

namespace aras_visual_servo_sim {

/** x within low .. high; low if it is no number: what becomes an index goes through here. */
template <typename T>
constexpr T held(T x, T low, T high) {
  return x > low ? (x < high ? x : high) : low;
}

/** Pixels u0 <= u < u1, v0 <= v < v1. */
struct PixelBox {
  int u0 = 0, v0 = 0, u1 = 0, v1 = 0;

  bool empty() const { return u0 >= u1 || v0 >= v1; }
  double area() const { return empty() ? 0.0 : double(u1 - u0) * (v1 - v0); }
  bool overlaps(const PixelBox& other) const {
    return !empty() && !other.empty() && u0 < other.u1 && other.u0 < u1 && v0 < other.v1 && other.v0 < v1;
  }
  /** Both, and what lies between them. */
  PixelBox with(const PixelBox& other) const {
    if (empty()) return other;
    if (other.empty()) return *this;
    return {std::min(u0, other.u0), std::min(v0, other.v0), std::max(u1, other.u1), std::max(v1, other.v1)};
  }
  /** What both share; empty if they share nothing, and then still inside the other. */
  PixelBox within(const PixelBox& other) const {
    const int left = std::clamp(u0, other.u0, other.u1), top = std::clamp(v0, other.v0, other.v1);
    return {left, top, std::clamp(u1, left, other.u1), std::clamp(v1, top, other.v1)};
  }
};

}  // namespace aras_visual_servo_sim
