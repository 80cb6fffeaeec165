#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"

namespace aras_visual_servo_sim {

/** How the running sums of a texture level are computed with: one channel as numbers, three as vectors of four, whose
 *  last entry is of no meaning. */
template <int channels>
struct SumLanes;

template <>
struct SumLanes<1> {
  using Value = float;
  using Sums = std::int32_t;
  static Sums load(const std::int32_t* sums) { return *sums; }
  static Value real(Sums sums) { return static_cast<float>(sums); }
  static float at(const Value& value, int) { return value; }
};

template <>
struct SumLanes<3> {
  using Value __attribute__((vector_size(16))) = float;
  using Sums __attribute__((vector_size(16))) = std::int32_t;
  static Sums load(const std::int32_t* sums) {
    Sums loaded;
    std::memcpy(&loaded, sums, sizeof loaded);
    return loaded;
  }
  static Value real(const Sums& sums) { return __builtin_convertvector(sums, Value); }
  static float at(const Value& value, int channel) { return value[channel]; }
};

/** The part of a picture that a tile sees: running sums along its rows, from its first column on.
 *
 *  Beyond the picture's edges it goes on as the wrap modes say, so that a tile need not know where these are. Sums are
 *  below 2^24: exact in single precision. */
template <int channels>
class PictureWindow {
 public:
  using Lanes = SumLanes<channels>;
  using Value = typename Lanes::Value;
  static constexpr int kMost = 80;  ///< texels each way: 2^24 > 80 * 255

  /** @param low, high  texture coordinates that it has to reach @return false if these are too far apart */
  bool place(const Texture& texture, Wrap wrap_s, Wrap wrap_t, const Eigen::Array2d& low, const Eigen::Array2d& high);

  /** Texture coordinates of its first texel's corner. */
  const Eigen::Array2d& origin() const { return origin_; }
  /** Whether all its texels have the same colour. */
  bool isPlain() const { return plain_; }
  /** That colour. */
  Value color() const { return sums_[1]; }
  /** Entry (row, i) is row * stride() + i: the sum over the first i texels of a row. */
  const Value* sums() const { return sums_.data(); }
  int stride() const { return stride_; }

 private:
  bool findPlain(const Texture& texture) const;
  void copy(const Texture& texture);
  void gather(const Texture& texture);

  Eigen::Array2d origin_;
  bool plain_ = false;
  int width_ = 0, height_ = 0, stride_ = 0;  // width_ and height_ in texels
  bool inside_ = false;                      // no edge of the picture crosses it
  std::array<int, kMost> columns_, rows_;    // of the texture, for each texel
  std::vector<Value, Eigen::aligned_allocator<Value>> sums_;
};

/** Which texel shows at index x along an axis of a picture of `size` texels. */
int wrapped(Wrap wrap, double x, int size);

}  // namespace aras_visual_servo_sim
