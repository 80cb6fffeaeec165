#include "aras_visual_servo_sim/physics/contact_config.hpp"

#include "aras_visual_servo_sim/config/yaml_reader.hpp"

namespace aras_visual_servo_sim {

namespace {

void readPairs(YamlReader& reader, ContactConfig& config) {
  const YAML::Node pairs = reader.raw("pairs");
  const std::string allowed = "all, or a list of [a, b], names of links or solids or `robot`";
  if (!pairs.IsDefined() || pairs.IsNull()) return;
  if (pairs.IsScalar() && pairs.Scalar() == "all") {
    config.pairs = {{"all", "all"}};
  } else if (!pairs.IsSequence()) {
    reader.fault("pairs", pairs.IsScalar() ? pairs.Scalar() : "a map", allowed);
  } else {
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const YAML::Node& pair = pairs[k];
      if (pair.IsSequence() && pair.size() == 2 && pair[0].IsScalar() && pair[1].IsScalar()) {
        config.pairs.emplace_back(pair[0].Scalar(), pair[1].Scalar());
      } else {
        reader.fault("pairs[" + std::to_string(k) + "]", "something else",
                     "[a, b], names of links or solids or `robot`");
      }
    }
  }
}

}  // namespace

ContactConfig contactConfigFromYaml(const YAML::Node& node) {
  ContactConfig config;
  YamlReader reader(node, "sim/contacts");
  if (reader.has("ground_plane")) {
    YamlReader plane = reader.section("ground_plane");
    GroundPlane ground;
    ground.z_m = plane.optional<double>("z_m", ground.z_m);
    ground.friction = plane.optional<double>("friction", ground.friction, Range::nonNegative());
    config.ground = ground;
  }
  readPairs(reader, config);
  config.friction = reader.optional<double>("friction", config.friction, Range::nonNegative());
  config.stiffness_n_per_m = reader.optional<double>("stiffness_n_per_m", config.stiffness_n_per_m, Range::positive());
  config.damping_n_s_per_m =
      reader.optional<double>("damping_n_s_per_m", config.damping_n_s_per_m, Range::nonNegative());
  YamlReader bodies = reader.section("free_bodies");
  for (const std::string& name : bodies.keys()) {
    config.free_bodies[name] = bodies.required<double>(name, Range::positive());
  }
  reader.finish();
  return config;
}

}  // namespace aras_visual_servo_sim
