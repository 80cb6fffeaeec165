// Reads sections, which cmake/generate_sections.py has checked: what they say wrong is ignored here.
#include "aras_visual_servo_common/text.hpp"
#include "aras_visual_servo_common/yaml_value.hpp"

namespace aras_visual_servo_common {
namespace {

using Type = Schema::Type;
using Texts = std::map<std::string, std::string>;

SchemaPtr parse(const YAML::Node& node, const std::string& name, const Texts& texts);

Type typeNamed(const std::string& name) {
  static const std::map<std::string, Type> kTypes = {{"array", Type::kArray},     {"boolean", Type::kBoolean},
                                                     {"integer", Type::kInteger}, {"number", Type::kNumber},
                                                     {"object", Type::kObject},   {"string", Type::kString}};
  const auto found = kTypes.find(name);
  return found == kTypes.end() ? Type::kAny : found->second;
}

void setWord(const std::string& word, const YAML::Node& value, const Texts& texts, Schema& schema) {
  const auto several = [&](std::vector<SchemaPtr>& into) {
    for (const YAML::Node& each : value) into.push_back(parse(each, schema.name, texts));
  };
  const auto count = [&value] { return static_cast<std::size_t>(integerOf(value).value_or(0)); };
  if (word == "type") schema.type = typeNamed(value.Scalar());
  if (word == "default") schema.default_value = value;
  if (word == "const") schema.choices = {value};
  if (word == "enum") schema.choices = {value.begin(), value.end()};
  if (word == "anyOf") several(schema.any_of);
  if (word == "oneOf") several(schema.one_of);
  if (word == "required") schema.required = value.as<std::vector<std::string>>();
  if (word == "properties") {
    for (const auto& entry : value) {
      const std::string key = entry.first.Scalar();
      schema.properties.emplace(key, parse(entry.second, schema.name + "." + key, texts));
    }
  }
  if (word == "additionalProperties" && value.IsMap()) schema.additional = parse(value, schema.name + ".*", texts);
  if (word == "additionalProperties" && value.IsScalar()) schema.closed = !value.as<bool>();
  if (word == "items") schema.items = parse(value, schema.name + "[]", texts);
  if (word == "minItems") schema.min_items = count();
  if (word == "maxItems") schema.max_items = count();
  if (word == "minLength") schema.min_length = count();
  schema.range.min_excluded = schema.range.min_excluded || word == "exclusiveMinimum";
  schema.range.max_excluded = schema.range.max_excluded || word == "exclusiveMaximum";
  if (word == "minimum" || word == "exclusiveMinimum") schema.range.min = numberOf(value).value_or(0.0);
  if (word == "maximum" || word == "exclusiveMaximum") schema.range.max = numberOf(value).value_or(0.0);
}

SchemaPtr parse(const YAML::Node& node, const std::string& name, const Texts& texts) {
  Schema schema;
  if (const auto reference = valueOf(node, "$ref")) {
    schema = *parse(YAML::Load(texts.at(reference->Scalar())), reference->Scalar(), texts);
  } else {
    schema.name = name;
  }
  for (const auto& entry : node) setWord(entry.first.Scalar(), entry.second, texts, schema);
  return std::make_shared<Schema>(std::move(schema));
}

}  // namespace

SchemaFolder::SchemaFolder(Texts texts) : texts_(std::move(texts)) {}

const Schema& SchemaFolder::section(const std::string& name) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto text = texts_.find(name);
  if (text == texts_.end()) {
    throw UnknownNameError("schema: found '" + name + "', allowed " + oneOf(names(), name));
  }
  SchemaPtr& section = sections_[name];
  if (!section) section = parse(YAML::Load(text->second), name, texts_);
  return *section;
}

std::vector<std::string> SchemaFolder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : texts_) names.push_back(entry.first);
  return names;
}

}  // namespace aras_visual_servo_common
