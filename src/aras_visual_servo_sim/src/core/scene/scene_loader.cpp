#include "aras_visual_servo_sim/scene/scene_loader.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/yaml_reader.hpp"
#include "scene/mesh/mesh_cache.hpp"

namespace aras_visual_servo_sim {
namespace {

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

Pose readPose(YamlReader& reader) {
  Pose pose;
  pose.p = reader.optional<Eigen::Vector3d>("position_m", Eigen::Vector3d::Zero());
  pose.q = quaternionFromRpy(reader.optional<Eigen::Vector3d>("rpy_rad", Eigen::Vector3d::Zero()));
  return pose;
}

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

/** An `image:` section; the file is read later. */
struct ImageEntry {
  std::string file;
  Eigen::Vector2d size_m{0.0, 0.0};
};

/** The shape keys of a planar model; the model is made later, when all faults are known. */
struct PlanarShape {
  std::vector<Polygon> outlines;
  Rgb color;
  std::optional<PlanarModel::Board> board;
  std::optional<ImageEntry> image;

  PlanarModel make(const std::string& name, const PackagePaths& packages, const std::string& base_dir) const {
    std::optional<PlanarModel::Picture> picture;
    if (image) picture = {loadTexture(packages.resolve(image->file, base_dir)), image->size_m};
    return {name, outlines, color, board, picture};
  }
};

PlanarShape readPlanarShape(YamlReader& reader) {
  PlanarShape shape;
  shape.color = readColor(reader, "color_rgb", {20, 20, 20});
  shape.outlines = readOutlines(reader);
  shape.board = readBoard(reader);
  if (reader.has("image")) {
    YamlReader section = reader.section("image");
    shape.image = ImageEntry{section.required<std::string>("file"), readSize(section)};
  }
  return shape;
}

YAML::Node readFile(const std::string& path) {
  try {
    return YAML::LoadFile(path);
  } catch (const YAML::Exception& error) {
    throw ModelError("file '" + path + "': " + error.what());
  }
}

Geometry readGeometry(YamlReader& reader) {
  Geometry geometry;
  int kinds = 0;
  if (reader.has("box_m")) {
    geometry.type = Geometry::Type::kBox;
    geometry.size_m = reader.required<Eigen::Vector3d>("box_m", Range::positive());
    ++kinds;
  }
  if (reader.has("cylinder_m")) {
    geometry.type = Geometry::Type::kCylinder;
    const auto size = reader.required<std::vector<double>>("cylinder_m", Range::positive());
    if (size.size() == 2) {
      geometry.radius_m = size[0];
      geometry.length_m = size[1];
    } else {
      reader.fault("cylinder_m", std::to_string(size.size()) + " numbers", "two, radius and length");
    }
    ++kinds;
  }
  if (reader.has("sphere_m")) {
    geometry.type = Geometry::Type::kSphere;
    geometry.radius_m = reader.required<double>("sphere_m", Range::positive());
    ++kinds;
  }
  if (reader.has("mesh")) {
    geometry.type = Geometry::Type::kMesh;
    geometry.filename = reader.required<std::string>("mesh");
    geometry.scale = reader.optional<Eigen::Vector3d>("scale", Eigen::Vector3d::Ones());
    ++kinds;
  }
  if (kinds != 1) {
    reader.fault("shape", std::to_string(kinds) + " of them", "one of box_m, cylinder_m, sphere_m, mesh, urdf");
  }
  return geometry;
}

struct ModelEntry {
  std::string name, file;
  PlanarShape shape;
  Pose X_WM;
  bool visible = true;
  std::optional<ModelMotion> motion;
};

struct SolidEntry {
  std::string name, urdf;
  Geometry geometry;
  Rgb color;
  Pose X_WB;
  std::optional<ModelMotion> motion;
};

std::optional<ModelMotion> readMotion(YamlReader& reader) {
  if (!reader.has("motion")) return std::nullopt;
  YamlReader section = reader.section("motion");
  return ModelMotion::read(section, reader.raw("motion"));
}

ModelEntry readModel(YamlReader& reader) {
  ModelEntry entry;
  entry.name = reader.required<std::string>("name");
  entry.file = reader.optional<std::string>("file", "");
  entry.X_WM = readPose(reader);
  entry.visible = reader.optional<bool>("visible", true);
  entry.motion = readMotion(reader);
  if (entry.file.empty()) entry.shape = readPlanarShape(reader);
  return entry;
}

/** What only contacts use: checked here, read where they are made. */
void checkTouching(YamlReader& reader) {
  reader.optional<double>("mass_kg", 1.0, Range::positive());
  if (reader.has("mass_kg") && reader.has("urdf")) {
    reader.fault("mass_kg", "it beside urdf", "it with one shape: box_m, cylinder_m, sphere_m or mesh");
  }
  if (!reader.has("touches")) return;
  const YAML::Node touches = reader.raw("touches");
  bool good = touches.IsScalar() || touches.IsSequence();
  if (touches.IsSequence()) {
    for (const auto& name : touches) good = good && name.IsScalar();
  }
  if (!good) reader.fault("touches", "something else", "all, robot, or a list of links and solids by name");
}

SolidEntry readSolid(YamlReader& reader) {
  SolidEntry entry;
  entry.name = reader.required<std::string>("name");
  entry.color = readColor(reader, "color_rgb", {128, 128, 128});
  entry.X_WB = readPose(reader);
  entry.motion = readMotion(reader);
  entry.urdf = reader.optional<std::string>("urdf", "");
  if (entry.urdf.empty()) entry.geometry = readGeometry(reader);
  checkTouching(reader);
  return entry;
}

template <typename Entry>
void requireDistinct(const std::vector<Entry>& entries, const char* key, YamlReader& reader) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (entries[i].name == entries[j].name)
        reader.fault(key, "two named '" + entries[i].name + "'", "distinct names");
    }
  }
}

}  // namespace

PlanarModel planarModelFromYaml(const YAML::Node& node, const std::string& source_name, const PackagePaths& packages,
                                const std::string& base_dir) {
  YamlReader reader(node, source_name);
  const auto name = reader.required<std::string>("name");
  const PlanarShape shape = readPlanarShape(reader);
  reader.finish();
  return shape.make(name, packages, base_dir);
}

PlanarModel loadPlanarModel(const std::string& path, const PackagePaths& packages) {
  return planarModelFromYaml(readFile(path), path, packages, std::filesystem::path(path).parent_path().string());
}

Scene loadScene(const YAML::Node& node, const PackagePaths& packages) {
  Scene scene;
  YamlReader reader(node, "scene");
  scene.background = readColor(reader, "background_rgb", scene.background);
  scene.light_direction_W = reader.optional<Eigen::Vector3d>("light_direction", scene.light_direction_W);
  if (scene.light_direction_W.norm() == 0.0) reader.fault("light_direction", "zero", "any other direction");
  std::vector<ModelEntry> models;
  std::vector<SolidEntry> solids;
  for (YamlReader& entry : reader.list("models")) models.push_back(readModel(entry));
  for (YamlReader& entry : reader.list("solids")) solids.push_back(readSolid(entry));
  requireDistinct(models, "models", reader);
  requireDistinct(solids, "solids", reader);
  for (const SolidEntry& solid : solids) {
    const auto same = [&](const ModelEntry& model) { return model.name == solid.name; };
    if (std::any_of(models.begin(), models.end(), same)) {
      reader.fault("solids", "one named '" + solid.name + "' as a model is", "distinct names");
    }
  }
  reader.finish();

  for (const ModelEntry& entry : models) {
    if (entry.file.empty()) {
      scene.models.push_back(entry.shape.make(entry.name, packages, ""));
    } else {
      const PlanarModel loaded = loadPlanarModel(packages.resolve(entry.file), packages);
      scene.models.emplace_back(entry.name, loaded.outlines(), loaded.color(), loaded.board(), loaded.picture());
    }
    scene.models.back().X_WM = entry.X_WM;
    scene.models.back().visible = entry.visible;
    if (entry.motion) scene.motions.emplace(entry.name, *entry.motion);
  }
  MeshCache meshes(packages);
  for (const SolidEntry& entry : solids) {
    Body body;
    if (entry.urdf.empty()) {
      body.name = entry.name;
      body.shapes.push_back({Pose{}, meshes.of(entry.geometry), entry.color});
    } else {
      body = bodyFromUrdf(entry.name, entry.urdf, packages);
    }
    body.X_WB = entry.X_WB;
    scene.bodies.push_back(std::move(body));
    if (entry.motion) scene.motions.emplace(entry.name, *entry.motion);
  }
  return scene;
}

}  // namespace aras_visual_servo_sim
