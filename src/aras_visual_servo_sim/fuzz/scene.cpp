// The reader of the section `scene`, and of models that are spawned: a description in one text. Files are not read.
#include <aras_visual_servo_common/files.hpp>

#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "target.hpp"

using namespace aras_visual_servo_sim;
using aras_visual_servo_common::kMostSentYaml;
using aras_visual_servo_common::parseYaml;

namespace {

bool namesFile(const SceneEntry& entry) {
  if (const auto* flat = std::get_if<ModelEntry>(&entry)) return !flat->file.empty() || flat->shape.picture.has_value();
  const auto& solid = std::get<SolidEntry>(entry);
  return solid.geometry.type == Geometry::Type::kMesh || solid.urdf.find('<') == std::string::npos;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return fuzz::offer(bytes, size, [](const std::string& text) {
    fuzz::allow([&] { SceneConfig::fromYaml(parseYaml(text, kMostSentYaml)); });
    const SceneEntry entry = sceneEntryFromYaml(modelEntry("spawned", text));
    Scene scene;
    if (!namesFile(entry)) loadSceneEntry(entry, PackagePaths(), scene);
  });
}
