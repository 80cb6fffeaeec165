// How lights are written into a saved state and read from it.
#include "aras_visual_servo_sim/config/errors.hpp"
#include "state_record.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Calls `each` with every number of a light. */
template <typename AnyLight, typename Each>
void forNumbers(AnyLight& light, const Each& each) {
  for (auto* vector : {&light.position_W, &light.direction_W, &light.position_A, &light.direction_A, &light.diffuse,
                       &light.specular}) {
    for (int k = 0; k < 3; ++k) each((*vector)[k]);
  }
  for (auto* number : {&light.range_m, &light.constant, &light.linear_per_m, &light.quadratic_per_m2,
                       &light.inner_angle_rad, &light.outer_angle_rad, &light.falloff}) {
    each(*number);
  }
}

}  // namespace

void StateWriter::putLights(const std::vector<Light>& lights) {
  put<std::uint64_t>(lights.size());
  for (const Light& light : lights) {
    putText(light.name);
    putText(light.attached_to);
    put(static_cast<std::uint32_t>(light.type));
    put(static_cast<std::uint32_t>(light.casts_shadows));
    putPose(light.X_WA);
    forNumbers(light, [this](double number) { put(number); });
  }
}

std::vector<Light> StateReader::getLights() {
  const auto count = get<std::uint64_t>();
  if (count > Lighting::kMostLights) {
    throw StateError("saved state: found " + std::to_string(count) + " lights, allowed up to " +
                     std::to_string(Lighting::kMostLights));
  }
  std::vector<Light> lights(count);
  for (Light& light : lights) {
    light.name = getText();
    light.attached_to = getText();
    light.type = static_cast<Light::Type>(get<std::uint32_t>());
    light.casts_shadows = get<std::uint32_t>() != 0;
    light.X_WA = getPose();
    forNumbers(light, [this](double& number) { number = get<double>(); });
  }
  return lights;
}

}  // namespace aras_visual_servo_sim
