#include "aras_visual_servo_sim/physics/contact_config.hpp"

namespace aras_visual_servo_sim {

ContactConfig::ContactConfig(const ContactsConfig& settings)
    : ground(settings.ground_plane),
      neighbours(settings.neighbours),
      friction(settings.friction),
      frictions(settings.frictions),
      stiffness_n_per_m(settings.stiffness_n_per_m),
      damping_n_s_per_m(settings.damping_n_s_per_m),
      free_bodies(settings.free_bodies) {
  // A list of [a, b], or the one word for all pairs.
  if (settings.pairs.IsScalar()) pairs = {{settings.pairs.Scalar(), settings.pairs.Scalar()}};
  for (const auto& pair : settings.pairs) {
    if (pair.IsSequence() && pair.size() == 2) pairs.emplace_back(pair[0].Scalar(), pair[1].Scalar());
  }
}

ContactConfig contactConfigFromYaml(const YAML::Node& node) {
  return readSection<ContactsConfig>(node, "sim.contacts", [](auto&&...) {});
}

}  // namespace aras_visual_servo_sim
