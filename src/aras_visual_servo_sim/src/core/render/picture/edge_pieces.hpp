#pragma once

#include <cstdint>

namespace aras_visual_servo_sim {

/** Straight edges among texels, cut where they pass from one to the next. `size` edges (8 or 16) at a time. */
template <int size>
struct EdgePieces {
  static constexpr int kMostCuts = 5;  ///< through columns, and as many through rows
  static constexpr int kMostPieces = 2 * kMostCuts + 1;

  int count = 0;                                      ///< pieces of each edge, some of no length
  alignas(32) std::int32_t entry[kMostPieces][size];  ///< row * stride + column of the texel about a piece
  alignas(32) float part[kMostPieces][size];          ///< share of the texel's width left of the piece's middle
  alignas(32) float height[kMostPieces][size];        ///< that the piece spans, signed

  /** Cuts edges from (xa, ya) to (xb, yb). @pre no coordinate is negative @return false if kMostCuts are too few */
  bool cut(const float* xa, const float* ya, const float* xb, const float* yb, std::int32_t stride);
};

}  // namespace aras_visual_servo_sim
