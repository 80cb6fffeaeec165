#include "planar_shape.hpp"

#include <cmath>

namespace aras_visual_servo_sim {
namespace {

/** Outlines as a list of lists of [x, y]; a fault of any depth is one fault of the key. */
std::vector<Polygon> readOutlines(YamlReader& reader) {
  std::vector<Polygon> outlines;
  if (!reader.has("outlines_m")) return outlines;
  try {
    const YAML::Node node = reader.raw("outlines_m");
    for (const auto& points : node.as<std::vector<std::vector<std::vector<double>>>>()) {
      Polygon outline;
      for (const auto& point : points) {
        if (point.size() != 2) throw YAML::Exception(YAML::Mark::null_mark(), "a corner is not [x, y]");
        outline.emplace_back(point[0], point[1]);
      }
      outlines.push_back(std::move(outline));
    }
  } catch (const YAML::Exception& error) {
    reader.fault("outlines_m", error.what(), "a list of outlines, each a list of corners [x, y] in metres");
  }
  return outlines;
}

Eigen::Vector2d readSize(YamlReader& section) {
  const auto size = section.required<std::vector<double>>("size_m", Range::positive());
  if (size.size() == 2) return {size[0], size[1]};
  section.fault("size_m", std::to_string(size.size()) + " numbers", "two, width and height");
  return Eigen::Vector2d::Ones();
}

std::optional<PlanarModel::Board> readBoard(YamlReader& reader) {
  if (!reader.has("board")) return std::nullopt;
  YamlReader section = reader.section("board");
  PlanarModel::Board board;
  board.size_m = readSize(section);
  board.color = readColor(section, "color_rgb", {255, 255, 255});
  return board;
}

}  // namespace

Rgb readColor(YamlReader& reader, const std::string& key, const Rgb& default_color) {
  const std::vector<double> fallback{double(default_color.r), double(default_color.g), double(default_color.b)};
  const std::vector<double> c = reader.optional<std::vector<double>>(key, fallback, Range::between(0.0, 255.0));
  if (c.size() != 3) {
    reader.fault(key, std::to_string(c.size()) + " numbers", "three, red green blue, 0 .. 255");
    return default_color;
  }
  const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(value)); };
  return {byte(c[0]), byte(c[1]), byte(c[2])};
}

PlanarShape readPlanarShape(YamlReader& reader) {
  PlanarShape shape;
  shape.color = readColor(reader, "color_rgb", {20, 20, 20});
  shape.outlines = readOutlines(reader);
  shape.board = readBoard(reader);
  if (reader.has("image")) {
    YamlReader section = reader.section("image");
    shape.picture = PlanarShape::PictureFile{section.required<std::string>("file"), readSize(section)};
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
