#include "edge_pieces.hpp"

#include <algorithm>
#include <cstring>

#include "aras_visual_servo_sim/config/wide.hpp"

namespace aras_visual_servo_sim {
namespace {

// Eight edges at a time, as vectors: choices in place of branches. Without AVX2 they are two vectors of four.
constexpr int kLanes = 8;
using Floats __attribute__((vector_size(4 * kLanes))) = float;
using Ints __attribute__((vector_size(4 * kLanes))) = std::int32_t;
#define ARAS_INLINE inline __attribute__((always_inline)) void

ARAS_INLINE load(const float* from, Floats& to) { std::memcpy(&to, from, sizeof to); }

/** The coordinates of edges along one axis. */
struct Axis {
  Floats from, length;
  Ints first, up, gap;  ///< texel of the start; -1 where the edge goes up, else 0; borders between texels it crosses

  ARAS_INLINE set(const float* a, const float* b) {
    Floats to;
    load(a, from);
    load(b, to);
    length = to - from;
    first = __builtin_convertvector(from, Ints);
    gap = __builtin_convertvector(to, Ints) - first;
    up = gap > 0;
    gap = up ? gap : -gap;
  }

  /** Share of the way to the k-th border, 1 where there is none. */
  ARAS_INLINE crossing(std::int32_t k, Floats& share) const {
    const Ints border = first + (up ? Ints{} + (k + 1) : Ints{} - k);
    share = (__builtin_convertvector(border, Floats) - from) / length;
    share = share > 0.0f ? share : Floats{};
    share = ((share < 1.0f) & (gap > k)) ? share : Floats{} + 1.0f;
  }
};

/** @return the most borders that an edge crosses */
template <int size>
inline __attribute__((always_inline)) int mostCrossed(const float* a, const float* b) {
  Ints most{};
  for (int i = 0; i < size; i += kLanes) {
    Axis axis;
    axis.set(a + i, b + i);
    most = axis.gap > most ? axis.gap : most;
  }
  std::int32_t result = 0;
  for (int i = 0; i < kLanes; ++i) result = std::max(result, most[i]);
  return result;
}

template <int size>
ARAS_INLINE cutEdges(const float* xa, const float* ya, const float* xb, const float* yb, std::int32_t stride,
                     int columns, int rows, EdgePieces<size>& pieces) {
  for (int i = 0; i < size; i += kLanes) {
    Axis x, y;
    x.set(xa + i, xb + i);
    y.set(ya + i, yb + i);
    Floats cuts[EdgePieces<size>::kMostPieces];
    for (int k = 0; k < columns; ++k) x.crossing(k, cuts[k]);
    for (int k = 0; k < rows; ++k) {  // each is sorted in
      Floats more;
      y.crossing(k, more);
      for (int m = 0; m < columns + k; ++m) {
        const Floats here = cuts[m];
        cuts[m] = here < more ? here : more;
        more = here < more ? more : here;
      }
      cuts[columns + k] = more;
    }
    cuts[columns + rows] = Floats{} + 1.0f;
    Floats begin{};
    for (int m = 0; m <= columns + rows; ++m) {
      const Floats end = cuts[m], middle = 0.5f * (begin + end);
      const Floats px = x.from + middle * x.length, py = y.from + middle * y.length;
      const Ints column = __builtin_convertvector(px, Ints), row = __builtin_convertvector(py, Ints);
      const Ints entry = row * stride + column;
      const Floats part = px - __builtin_convertvector(column, Floats), height = (end - begin) * y.length;
      std::memcpy(&pieces.entry[m][i], &entry, sizeof entry);
      std::memcpy(&pieces.part[m][i], &part, sizeof part);
      std::memcpy(&pieces.height[m][i], &height, sizeof height);
      begin = end;
    }
  }
  pieces.count = columns + rows + 1;
}
#undef ARAS_INLINE

ARAS_WIDE int mostCrossed8(const float* a, const float* b) { return mostCrossed<8>(a, b); }
ARAS_WIDE int mostCrossed16(const float* a, const float* b) { return mostCrossed<16>(a, b); }
ARAS_WIDE void cut8(const float* xa, const float* ya, const float* xb, const float* yb, std::int32_t stride,
                    int columns, int rows, EdgePieces<8>& pieces) {
  cutEdges<8>(xa, ya, xb, yb, stride, columns, rows, pieces);
}
ARAS_WIDE void cut16(const float* xa, const float* ya, const float* xb, const float* yb, std::int32_t stride,
                     int columns, int rows, EdgePieces<16>& pieces) {
  cutEdges<16>(xa, ya, xb, yb, stride, columns, rows, pieces);
}

}  // namespace

template <int size>
bool EdgePieces<size>::cut(const float* xa, const float* ya, const float* xb, const float* yb, std::int32_t stride) {
  const auto most = size == 8 ? mostCrossed8 : mostCrossed16;
  const int columns = most(xa, xb), rows = most(ya, yb);
  if (columns > kMostCuts || rows > kMostCuts) return false;
  if constexpr (size == 8) {
    cut8(xa, ya, xb, yb, stride, columns, rows, *this);
  } else {
    cut16(xa, ya, xb, yb, stride, columns, rows, *this);
  }
  return true;
}

template struct EdgePieces<8>;
template struct EdgePieces<16>;

}  // namespace aras_visual_servo_sim
