#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** A picture to be stuck on a surface: width x height texels, each a square of one colour, never changed once made.
 *
 *  Texel (i, j) covers [i, i + 1] x [j, j + 1] of the texture coordinates (s, t): s to the right, t downwards, the
 *  picture's outline at 0 and width or height. */
class Texture {
 public:
  static constexpr std::int64_t kMostTexels = 4096LL * 4096LL;  ///< sums over half of them stay below 2^31

  /** @param rgb  height x width x 3 bytes, top row first
   *  @throws ModelError naming the picture: no texels, too many, or not as many bytes */
  Texture(std::string name, int width, int height, std::vector<std::uint8_t> rgb);

  const std::string& name() const { return name_; }
  int width() const { return width_; }
  int height() const { return height_; }
  const std::uint8_t* texel(int i, int j) const { return rgb_.data() + 3 * (std::size_t(j) * width_ + i); }
  /** Mean colour. */
  Rgb meanColor() const;

  /** Running sums along rows, 2^k texel rows of the picture making one row of level k: what sums over areas are
   *  made of. Entry ((row * (width + 1)) + i) * channels + c is the sum of channel c over the first i texels of each of
   *  the 2^k rows; rows beyond the last one repeat it. kBeyond zeros follow, to be read four at a time. */
  struct Level {
    static constexpr std::size_t kBeyond = 4;
    int rows = 0;
    std::vector<std::int32_t> sums;
  };
  /** Levels of r, g, b or of grey, rounded to 8 bits. Made at the first call. Thread-safe. @param channels  3 or 1 */
  const std::vector<Level>& levels(int channels) const;

 private:
  struct Pyramid {
    std::once_flag once;
    std::vector<Level> levels;
  };
  void build(int channels, std::vector<Level>& levels) const;

  std::string name_;
  int width_, height_;
  std::vector<std::uint8_t> rgb_;
  mutable std::array<Pyramid, 2> pyramids_;  // grey, colour
};

using TexturePtr = std::shared_ptr<const Texture>;

/** Reads a PNG, JPEG, BMP or TGA file; transparency is ignored. @throws ModelError naming the file and the reason */
TexturePtr loadTexture(const std::string& path);
/** The same from the bytes of such a file. @param name  for messages */
TexturePtr loadTexture(const std::string& name, const std::uint8_t* bytes, std::size_t size);

}  // namespace aras_visual_servo_sim
