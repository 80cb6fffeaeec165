// What a schema allows, and values, in words.
#include <algorithm>
#include <array>
#include <cmath>

#include "aras_visual_servo_common/read_section.hpp"
#include "aras_visual_servo_common/text.hpp"

namespace aras_visual_servo_common {
namespace {

using Type = Schema::Type;

/** What values of a type are called, one of them and several, in the order of the types. */
constexpr std::array<std::array<const char*, 2>, 7> kWords = {{{"a value", "values"},
                                                               {"a map", "maps"},
                                                               {"a list", "lists"},
                                                               {"a number", "numbers"},
                                                               {"an integer", "integers"},
                                                               {"true or false", "true or false"},
                                                               {"a text", "texts"}}};

std::string several(const Schema& schema) {
  if (!schema.choices.empty()) return "values, each " + schema.text();
  const std::string words = kWords[static_cast<std::size_t>(schema.type)][1];
  const bool alternatives = !schema.any_of.empty() || !schema.one_of.empty();
  const bool more = schema.type == Type::kArray || (schema.type == Type::kAny && alternatives);
  return more ? words + ", each " + schema.text() : words;
}

std::string listText(const Schema& schema) {
  std::string count;
  if (schema.max_items && schema.min_items == *schema.max_items) {
    count = std::to_string(schema.min_items) + " ";
  } else if (schema.max_items) {
    count = std::to_string(schema.min_items) + " to " + std::to_string(*schema.max_items) + " ";
  } else if (schema.min_items > 0) {
    count = std::to_string(schema.min_items) + " or more ";
  }
  return "a list of " + count + (schema.items ? several(*schema.items) : "values");
}

}  // namespace

std::string Schema::text() const {
  if (!choices.empty()) {
    std::vector<std::string> words;
    for (const YAML::Node& choice : choices) words.push_back(shown(choice));
    return oneOf(words, "");
  }
  if (type == Type::kArray) return listText(*this);
  std::vector<std::string> ways;
  if (type == Type::kAny) {
    for (const SchemaPtr& each : any_of) ways.push_back(each->text());
    for (const SchemaPtr& each : one_of) ways.push_back(each->text());
  }
  return ways.empty() ? kWords[static_cast<std::size_t>(type)][0] : joined(ways, " or ");
}

bool Range::contains(double value) const {
  const bool above = min_excluded ? value > min : value >= min;
  const bool below = max_excluded ? value < max : value <= max;
  return std::isfinite(value) && above && below;
}

std::string Range::text() const {
  constexpr double kLargest = std::numeric_limits<double>::max();
  const std::string low = (min_excluded ? "> " : ">= ") + numberText(min);
  const std::string high = (max_excluded ? "< " : "<= ") + numberText(max);
  if (min > -kLargest && max < kLargest) return low + " and " + high;
  if (min > -kLargest) return low;
  if (max < kLargest) return high;
  return "finite";
}

std::string placeOf(const YAML::Node& value, const std::string& file) {
  if (file.empty()) return "";
  const YAML::Mark mark = value.IsDefined() ? value.Mark() : YAML::Mark::null_mark();
  return file + (mark.is_null() ? "" : ":" + std::to_string(mark.line + 1)) + ": ";
}

std::string shown(const YAML::Node& value) {
  constexpr std::size_t kLongest = 60;
  if (!value.IsDefined() || value.IsNull()) return "nothing";
  const bool quoted = value.IsScalar() && value.Tag() == "!";
  if (quoted) {
    const YAML::Node plain(value.Scalar());
    return numberOf(plain) || boolOf(plain) || value.Scalar().empty() ? "'" + value.Scalar() + "'" : value.Scalar();
  }
  YAML::Emitter out;
  out << YAML::Flow << value;
  std::string text = out.c_str();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.size() > kLongest ? text.substr(0, kLongest - 3) + "..." : text;
}

std::string nameIn(const YAML::Node& key) { return key.IsScalar() ? key.Scalar() : shown(key); }

std::optional<YAML::Node> valueOf(const YAML::Node& map, const std::string& key) {
  if (!map.IsDefined() || !map.IsMap()) return std::nullopt;
  for (const auto& item : map)
    if (item.first.IsScalar() && item.first.Scalar() == key) return item.second;
  return std::nullopt;
}

SectionCheck SectionCheck::part(const std::string& key, std::size_t k) const {
  const YAML::Node list = node(key);
  const bool has_it = list.IsDefined() && list.IsSequence() && k < list.size();
  return {has_it ? list[k] : YAML::Node(), path(key) + "[" + std::to_string(k) + "]", faults_, file_};
}

void SectionCheck::fault(const std::string& key, const std::string& found, const std::string& allowed) const {
  faults_.add(placeOf(has(key) ? node(key) : node_, file_) + path(key), found, allowed);
}

void SectionCheck::fault(const std::string& key, double found, const std::string& allowed) const {
  fault(key, numberText(found), allowed);
}

}  // namespace aras_visual_servo_common
