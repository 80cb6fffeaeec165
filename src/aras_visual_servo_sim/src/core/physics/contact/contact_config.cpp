#include "aras_visual_servo_sim/physics/contact_config.hpp"

namespace aras_visual_servo_sim {

namespace {

/** A list of [a, b], or the one word for all pairs. */
void readPairs(YamlReader& reader, ContactConfig& config) {
  const auto pairs = reader.get<YAML::Node>("pairs");
  if (pairs.IsScalar()) config.pairs = {{pairs.Scalar(), pairs.Scalar()}};
  for (const auto& pair : pairs) {
    if (pair.IsSequence() && pair.size() == 2) config.pairs.emplace_back(pair[0].Scalar(), pair[1].Scalar());
  }
}

}  // namespace

ContactConfig::ContactConfig()
    : neighbours(defaultOf<bool>("contacts", "neighbours")),
      friction(defaultOf<double>("contacts", "friction")),
      stiffness_n_per_m(defaultOf<double>("contacts", "stiffness_n_per_m")),
      damping_n_s_per_m(defaultOf<double>("contacts", "damping_n_s_per_m")) {}

ContactConfig readContacts(YamlReader reader) {
  ContactConfig config;
  if (reader.has("ground_plane")) {
    YamlReader plane = reader.section("ground_plane");
    config.ground = GroundPlane{plane.get<double>("z_m"), plane.get<double>("friction")};
  }
  readPairs(reader, config);
  config.neighbours = reader.get<bool>("neighbours");
  config.friction = reader.get<double>("friction");
  config.stiffness_n_per_m = reader.get<double>("stiffness_n_per_m");
  config.damping_n_s_per_m = reader.get<double>("damping_n_s_per_m");
  YamlReader frictions = reader.section("frictions");
  for (const std::string& name : frictions.keys()) config.frictions[name] = frictions.get<double>(name);
  YamlReader bodies = reader.section("free_bodies");
  for (const std::string& name : bodies.keys()) config.free_bodies[name] = bodies.get<double>(name);
  return config;
}

ContactConfig contactConfigFromYaml(const YAML::Node& node) {
  YamlReader reader(node, sectionOf("contacts"), "sim/contacts");
  ContactConfig config = readContacts(reader);
  reader.finish();
  return config;
}

}  // namespace aras_visual_servo_sim
