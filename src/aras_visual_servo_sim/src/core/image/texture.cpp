#include "aras_visual_servo_sim/image/texture.hpp"

#include <stb/stb_image.h>

#include <algorithm>
#include <aras_visual_servo_common/files.hpp>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/image/pixel_color.hpp"

namespace aras_visual_servo_sim {

namespace {

constexpr std::size_t kMostPictureBytes = 64 * 1024 * 1024;  // more than kMostTexels that are not compressed

void requireTexels(const std::string& name, int width, int height) {
  if (width >= 1 && height >= 1 && std::int64_t(width) * height <= Texture::kMostTexels) return;
  throw ModelError("picture '" + name + "': found " + std::to_string(width) + " x " + std::to_string(height) +
                   " texels, allowed 1 .. " + std::to_string(Texture::kMostTexels));
}

}  // namespace

Texture::Texture(std::string name, int width, int height, std::vector<std::uint8_t> rgb)
    : name_(std::move(name)), width_(width), height_(height), rgb_(std::move(rgb)) {
  requireTexels(name_, width, height);
  if (rgb_.size() != std::size_t(3) * width * height) {
    throw ModelError("picture '" + name_ + "': found " + std::to_string(rgb_.size()) + " bytes, needs 3 for each of " +
                     std::to_string(width) + " x " + std::to_string(height) + " texels");
  }
}

Rgb Texture::meanColor() const {
  std::array<std::int64_t, 3> sum{0, 0, 0};
  for (std::size_t i = 0; i < rgb_.size(); ++i) sum[i % 3] += rgb_[i];
  const std::int64_t count = std::int64_t(width_) * height_;
  const auto mean = [&](int c) { return static_cast<std::uint8_t>((sum[c] + count / 2) / count); };
  return {mean(0), mean(1), mean(2)};
}

const std::vector<Texture::Level>& Texture::levels(int channels) const {
  Pyramid& pyramid = pyramids_[channels == 3 ? 1 : 0];
  std::call_once(pyramid.once, [&] { build(channels, pyramid.levels); });
  return pyramid.levels;
}

void Texture::build(int channels, std::vector<Level>& levels) const {
  const std::size_t row_size = std::size_t(width_ + 1) * channels;
  Level finest{height_, std::vector<std::int32_t>(row_size * height_ + Level::kBeyond, 0)};
  for (int j = 0; j < height_; ++j) {
    std::int32_t* sum = finest.sums.data() + j * row_size;
    for (int i = 0; i < width_; ++i, sum += channels) {
      const std::uint8_t* rgb = texel(i, j);
      const auto texel_of = pixelOf({rgb[0], rgb[1], rgb[2]}, channels == 3 ? Encoding::kRgb8 : Encoding::kMono8);
      for (int c = 0; c < channels; ++c) sum[channels + c] = sum[c] + texel_of[c];
    }
  }
  levels.push_back(std::move(finest));
  while (levels.back().rows > 4) {  // fewer would not be used, and their sums might overflow
    const Level& fine = levels.back();
    Level coarse{(fine.rows + 1) / 2, {}};
    coarse.sums.resize(row_size * coarse.rows + Level::kBeyond);
    for (int j = 0; j < coarse.rows; ++j) {
      const std::int32_t* first = fine.sums.data() + std::size_t(2 * j) * row_size;
      const std::int32_t* second = 2 * j + 1 < fine.rows ? first + row_size : first;
      for (std::size_t i = 0; i < row_size; ++i) coarse.sums[j * row_size + i] = first[i] + second[i];
    }
    levels.push_back(std::move(coarse));
  }
}

namespace {

TexturePtr textureOf(const std::string& name, std::uint8_t* pixels, int width, int height) {
  const std::unique_ptr<std::uint8_t, void (*)(void*)> owner(pixels, stbi_image_free);
  if (!pixels) throw ModelError("picture '" + name + "': " + stbi_failure_reason());
  return std::make_shared<Texture>(name, width, height,
                                   std::vector<std::uint8_t>(pixels, pixels + std::size_t(3) * width * height));
}

}  // namespace

TexturePtr loadTexture(const std::string& path) {
  std::string bytes;
  try {
    bytes = aras_visual_servo_common::readFile(path, kMostPictureBytes);
  } catch (const ArasError& error) {
    throw ModelError("picture " + std::string(error.what()));
  }
  return loadTexture(path, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

TexturePtr loadTexture(const std::string& name, const std::uint8_t* bytes, std::size_t size) {
  int width = 0, height = 0, channels = 0;
  const auto most = static_cast<std::size_t>(kMostPictureBytes);
  if (size > most) {
    throw ModelError("picture '" + name + "': found " + std::to_string(size) +
                     " bytes, allowed <= " + std::to_string(most));
  }
  if (stbi_info_from_memory(bytes, static_cast<int>(size), &width, &height, &channels) != 0) {
    requireTexels(name, width, height);  // before memory is taken for them
  }
  std::uint8_t* pixels = stbi_load_from_memory(bytes, static_cast<int>(size), &width, &height, &channels, 3);
  return textureOf(name, pixels, width, height);
}

}  // namespace aras_visual_servo_sim
