#include "aras_visual_servo_common/yaml_value.hpp"

#include <cmath>

namespace aras_visual_servo_common {
namespace {

bool plain(const YAML::Node& value) { return value.IsDefined() && value.IsScalar() && value.Tag() != "!"; }

}  // namespace

std::optional<double> numberOf(const YAML::Node& value) {
  double number = 0.0;
  if (plain(value) && YAML::convert<double>::decode(value, number)) return number;
  const auto integer = integerOf(value);  // one written in another base
  return integer ? std::optional<double>(static_cast<double>(*integer)) : std::nullopt;
}

std::optional<std::int64_t> integerOf(const YAML::Node& value) {
  constexpr double kExact = 9007199254740992.0;  // 2^53: up to here a double holds every integer
  std::int64_t integer = 0;
  double number = 0.0;
  if (!plain(value)) return std::nullopt;
  if (YAML::convert<std::int64_t>::decode(value, integer)) return integer;
  if (!YAML::convert<double>::decode(value, number)) return std::nullopt;
  if (number != std::floor(number) || std::abs(number) > kExact) return std::nullopt;
  return static_cast<std::int64_t>(number);
}

std::optional<bool> boolOf(const YAML::Node& value) {
  bool truth = false;
  return plain(value) && YAML::convert<bool>::decode(value, truth) ? std::optional(truth) : std::nullopt;
}

}  // namespace aras_visual_servo_common
