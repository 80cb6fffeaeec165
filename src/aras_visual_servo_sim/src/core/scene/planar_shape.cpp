#include "planar_shape.hpp"

#include <array>

namespace aras_visual_servo_sim {
namespace {

using Corner = std::array<double, 2>;

Eigen::Vector2d readSize(YamlReader& section) { return section.get<Eigen::Vector2d>("size_m"); }

}  // namespace

PlanarShape readPlanarShape(YamlReader& reader) {
  PlanarShape shape;
  shape.color = readColor(reader, "color_rgb");
  for (const auto& corners :
       reader.find<std::vector<std::vector<Corner>>>("outlines_m").value_or(std::vector<std::vector<Corner>>())) {
    shape.outlines.emplace_back();
    for (const Corner& corner : corners) shape.outlines.back().emplace_back(corner[0], corner[1]);
  }
  if (reader.has("board")) {
    YamlReader board = reader.section("board");
    shape.board = PlanarModel::Board{readSize(board), readColor(board, "color_rgb")};
  }
  if (reader.has("image")) {
    YamlReader picture = reader.section("image");
    shape.picture = PlanarShape::PictureFile{picture.get<std::string>("file"), readSize(picture)};
  }
  return shape;
}

PlanarModel planarModelOf(const std::string& name, const PlanarShape& shape, const PackagePaths& packages,
                          const std::string& base_dir) {
  std::optional<PlanarModel::Picture> picture;
  if (shape.picture) {
    picture = {loadTexture(packages.resolve(shape.picture->file, base_dir)), shape.picture->size_m};
  }
  return {name, shape.outlines, shape.color, shape.board, picture};
}

}  // namespace aras_visual_servo_sim
