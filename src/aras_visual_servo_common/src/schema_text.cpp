// What a schema allows, and values, in words.
#include <algorithm>

#include "aras_visual_servo_common/read_section.hpp"
#include "aras_visual_servo_common/text.hpp"

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
    return oneOf(words, "");
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
