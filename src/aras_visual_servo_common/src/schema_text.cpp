// What a schema allows, and values, in words.
#include <algorithm>

#include "aras_visual_servo_common/schema.hpp"
#include "aras_visual_servo_common/text.hpp"
#include "aras_visual_servo_common/yaml_value.hpp"

namespace aras_visual_servo_common {
namespace {

using Type = Schema::Type;

std::string several(const Schema& schema) {
  if (!schema.choices.empty()) return "values, each " + schema.text();
  switch (schema.type) {
    case Type::kObject:
      return "maps";
    case Type::kArray:
      return "lists, each " + schema.text();
    case Type::kNumber:
      return "numbers";
    case Type::kInteger:
      return "integers";
    case Type::kBoolean:
      return "true or false";
    case Type::kString:
      return "texts";
    case Type::kAny:
      break;
  }
  return schema.any_of.empty() && schema.one_of.empty() ? "values" : "values, each " + schema.text();
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
    return words.size() == 1 ? words.front() : "one of " + joined(words);
  }
  if (type == Type::kArray) return listText(*this);
  if (type == Type::kObject) return "a map";
  if (type == Type::kNumber) return "a number";
  if (type == Type::kInteger) return "an integer";
  if (type == Type::kBoolean) return "true or false";
  if (type == Type::kString) return "a text";
  std::vector<std::string> ways;
  for (const SchemaPtr& each : any_of) ways.push_back(each->text());
  for (const SchemaPtr& each : one_of) ways.push_back(each->text());
  return ways.empty() ? "a value" : joined(ways, " or ");
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

}  // namespace aras_visual_servo_common
