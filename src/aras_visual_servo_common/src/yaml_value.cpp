#include "aras_visual_servo_common/yaml_value.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>

namespace aras_visual_servo_common {
namespace {

bool plain(const YAML::Node& value) { return value.IsDefined() && value.IsScalar() && value.Tag() != "!"; }

/** Words do not: they need no stream to be told from numbers. .inf and .nan are numbers. */
bool beginsLikeNumber(const std::string& text) {
  return !text.empty() && (std::isdigit(static_cast<unsigned char>(text[0])) || std::strchr("+-.", text[0]));
}

/** Reads a number as most are written, -12.5e-3, without a stream. Nothing for other ways, which YAML knows. */
std::optional<double> decimalOf(const std::string& text) {
  const char* const end = text.data() + text.size();
  const std::size_t sign = !text.empty() && text.front() == '-' ? 1 : 0;
  if (sign >= text.size() || !std::isdigit(static_cast<unsigned char>(text[sign]))) return std::nullopt;
  double number = 0.0;
  const auto [last, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && last == end ? std::optional(number) : std::nullopt;
}

}  // namespace

std::optional<double> numberOf(const YAML::Node& value) {
  double number = 0.0;
  if (!plain(value) || !beginsLikeNumber(value.Scalar())) return std::nullopt;
  if (const auto decimal = decimalOf(value.Scalar())) return decimal;
  if (YAML::convert<double>::decode(value, number)) return number;
  const auto integer = integerOf(value);  // one written in another base
  return integer ? std::optional<double>(static_cast<double>(*integer)) : std::nullopt;
}

std::optional<std::int64_t> integerOf(const YAML::Node& value) {
  constexpr double kExact = 9007199254740992.0;  // 2^53: up to here a double holds every integer
  std::int64_t integer = 0;
  double number = 0.0;
  if (!plain(value) || !beginsLikeNumber(value.Scalar())) return std::nullopt;
  if (YAML::convert<std::int64_t>::decode(value, integer)) return integer;
  if (!YAML::convert<double>::decode(value, number)) return std::nullopt;
  if (number != std::floor(number) || std::abs(number) > kExact) return std::nullopt;
  return static_cast<std::int64_t>(number);
}

std::optional<bool> boolOf(const YAML::Node& value) {
  bool truth = false;
  return plain(value) && YAML::convert<bool>::decode(value, truth) ? std::optional(truth) : std::nullopt;
}

YAML::Node quotedText(const std::string& text) {
  YAML::Node node(text);
  node.SetTag("!");  // what yaml-cpp gives a quoted scalar
  return node;
}

YAML::Node exactNumber(double value) {
  if (std::isnan(value)) return YAML::Node(".nan");
  if (std::isinf(value)) return YAML::Node(value > 0.0 ? ".inf" : "-.inf");
  std::array<char, 32> text;  // the shortest that reads back as the same number has 24 characters at most
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return YAML::Node(std::string(text.data(), end));
}

}  // namespace aras_visual_servo_common
