#include <map>

#include "robot/gazebo/gazebo_tags.hpp"

namespace aras_visual_servo_sim {
namespace {

struct Row {
  Rgba diffuse;
  Rgba ambient;
  double specular, shininess;
};

Row alike(const Rgba& color, double specular, double shininess) { return {color, color, specular, shininess}; }

const std::map<std::string, Row>& rows() {
  static const std::map<std::string, Row> materials = {
      {"Grey", {{0.7, 0.7, 0.7}, {0.3, 0.3, 0.3}, 0.01, 1.5}},
      {"DarkGrey", alike({0.175, 0.175, 0.175}, 0.175, 1.5)},
      {"White", alike({1.0, 1.0, 1.0}, 0.1, 128.0)},
      {"FlatBlack", alike({0.1, 0.1, 0.1}, 0.01, 1.0)},
      {"Black", alike({0.0, 0.0, 0.0}, 0.1, 5.0)},
      {"Red", alike({1.0, 0.0, 0.0}, 0.1, 1.0)},
      {"RedBright", alike({0.87, 0.26, 0.07}, 0.4, 1.0)},
      {"Green", alike({0.0, 1.0, 0.0}, 0.1, 1.0)},
      {"Blue", alike({0.0, 0.0, 1.0}, 0.1, 1.0)},
      {"SkyBlue", {{0.0, 0.0, 1.0}, {0.13, 0.44, 0.7}, 0.1, 1.0}},
      {"Yellow", alike({1.0, 1.0, 0.0}, 0.0, 1.0)},
      {"ZincYellow", alike({0.9725, 0.9529, 0.2078}, 0.71, 1.0)},
      {"Purple", alike({1.0, 0.0, 1.0}, 0.1, 1.0)},
      {"Turquoise", alike({0.0, 1.0, 1.0}, 0.1, 1.0)},
      {"Orange", alike({1.0, 0.5088, 0.0468}, 0.5, 128.0)},
      {"Gold", {{0.8, 0.64869, 0.120759}, {0.4, 0.24869, 0.020759}, 0.4, 12.5}}};
  return materials;
}

}  // namespace

std::optional<GazeboMaterial> gazeboMaterial(const std::string& material) {
  const std::string prefix = "Gazebo/", glow = "Glow";
  if (material.compare(0, prefix.size(), prefix) != 0) return std::nullopt;
  std::string name = material.substr(prefix.size());
  const bool glows = name.size() > glow.size() && name.compare(name.size() - glow.size(), glow.size(), glow) == 0;
  if (glows) name.erase(name.size() - glow.size());
  const auto found = rows().find(name);
  if (found == rows().end()) return std::nullopt;
  const Row& row = found->second;
  GazeboMaterial result;
  result.diffuse = row.diffuse;
  result.finish.ambient = row.ambient;
  result.finish.specular = {row.specular, row.specular, row.specular, 1.0};
  result.finish.shininess = row.shininess;
  if (glows) result.finish.emissive = row.diffuse;
  return result;
}

}  // namespace aras_visual_servo_sim
