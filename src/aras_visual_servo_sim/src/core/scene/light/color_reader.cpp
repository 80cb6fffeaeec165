#include "color_reader.hpp"

#include <cmath>

namespace aras_visual_servo_sim {

Rgb colorOf(const Eigen::Vector3d& rgb) {
  const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(value)); };
  return {byte(rgb[0]), byte(rgb[1]), byte(rgb[2])};
}

Rgb readColor(YamlReader& reader, const std::string& key) { return colorOf(reader.get<Eigen::Vector3d>(key)); }

}  // namespace aras_visual_servo_sim
