#include "schema_parser.hpp"

#include <algorithm>
#include <regex>
#include <set>

#include "aras_visual_servo_common/text.hpp"
#include "aras_visual_servo_common/yaml_value.hpp"

namespace aras_visual_servo_common {
namespace {

using Type = Schema::Type;

const std::map<std::string, Type>& typesByName() {
  static const std::map<std::string, Type> kTypes = {{"array", Type::kArray},     {"boolean", Type::kBoolean},
                                                     {"integer", Type::kInteger}, {"number", Type::kNumber},
                                                     {"object", Type::kObject},   {"string", Type::kString}};
  return kTypes;
}

const std::set<std::string> kWords = {"$ref",
                                      "additionalProperties",
                                      "anyOf",
                                      "const",
                                      "default",
                                      "description",
                                      "enum",
                                      "exclusiveMaximum",
                                      "exclusiveMinimum",
                                      "items",
                                      "maxItems",
                                      "maximum",
                                      "minItems",
                                      "minLength",
                                      "minimum",
                                      "oneOf",
                                      "pattern",
                                      "properties",
                                      "required",
                                      "type",
                                      "unit"};

/** Finds values that Python's YAML 1.1 reader would read otherwise: 1e-6 as a text, `off` as false. */
std::string pythonFault(const YAML::Node& value, Type type) {
  if (!value.IsScalar() || value.Tag() == "!") return "";
  const std::string& text = value.Scalar();
  const std::size_t exponent = text.find_first_of("eE");
  if (exponent != std::string::npos && numberOf(value) && text.compare(0, 2, "0x") != 0) {
    const bool sign = exponent + 1 < text.size() && (text[exponent + 1] == '-' || text[exponent + 1] == '+');
    if (!sign || text.find('.') > exponent) return "a point and the exponent's sign, as in 1.0e-6";
  }
  return type != Type::kBoolean && boolOf(value) ? "a truth value in quotes, where it is a word" : "";
}

}  // namespace

SchemaPtr SchemaParser::parse(const std::string& section) {
  SchemaPtr schema = parseSection(section, "");
  if (!faults_.empty()) throw SchemaError(joined(faults_.lines(), "\n"));
  return schema;
}

SchemaPtr SchemaParser::parseSection(const std::string& section, const std::string& asked_by) {
  const auto text = texts_.find(section);
  const auto nothing = std::make_shared<Schema>();
  if (text == texts_.end()) {
    faults_.add("schema " + asked_by + "/$ref", section, "one of " + joined(namesOf(texts_)));
    return nothing;
  }
  if (std::find(open_.begin(), open_.end(), section) != open_.end()) {
    faults_.add("schema " + asked_by + "/$ref", section, "a section that does not lead back to it");
    return nothing;
  }
  open_.push_back(section);
  SchemaPtr schema = nothing;
  try {
    schema = parseNode(YAML::Load(text->second), section);
    if (schema->description.empty())
      faults_.add("schema " + section + "/description", "nothing", "one line that says what it means");
  } catch (const YAML::Exception& error) {
    faults_.add("schema " + section + ": " + error.what());
  }
  open_.pop_back();
  return schema;
}

/** Takes over the other section; `description` and `default` beside the `$ref` take precedence over those of it. */
SchemaPtr SchemaParser::parseReference(const YAML::Node& node, const std::string& name) {
  const std::string section = nameIn(node["$ref"]);
  Schema schema = *parseSection(section, name);
  schema.name = section;
  for (const auto& entry : node) {
    const std::string word = nameIn(entry.first);
    if (word == "description" || word == "default") {
      parseWord(word, entry.second, schema);
    } else if (word != "$ref") {
      faults_.add("schema " + name + "/" + word, "it beside $ref", "description and default there");
    }
  }
  checkWhole(node, schema);
  return std::make_shared<Schema>(std::move(schema));
}

SchemaPtr SchemaParser::parseNode(const YAML::Node& node, const std::string& name) {
  Schema schema;
  schema.name = name;
  if (!node.IsMap()) {
    faults_.add("schema " + name, shown(node), "a map");
    return std::make_shared<Schema>(schema);
  }
  if (node["$ref"].IsDefined()) return parseReference(node, name);
  parseType(node, schema);
  std::set<std::string> seen;
  for (const auto& entry : node) {
    const std::string word = nameIn(entry.first);
    if (!seen.insert(word).second) faults_.add("schema " + name + "/" + word, "it twice", "it once");
    parseWord(word, entry.second, schema);
  }
  checkWhole(node, schema);
  return std::make_shared<Schema>(std::move(schema));
}

void SchemaParser::parseType(const YAML::Node& node, Schema& schema) {
  const YAML::Node type = node["type"];
  if (!type.IsDefined()) return;
  const auto known = typesByName().find(type.IsScalar() ? type.Scalar() : "");
  if (known != typesByName().end()) {
    schema.type = known->second;
  } else {
    faults_.add("schema " + schema.name + "/type", shown(type), "one of " + joined(namesOf(typesByName())));
  }
}

void SchemaParser::parseWord(const std::string& word, const YAML::Node& value, Schema& schema) {
  const std::string where = "schema " + schema.name + "/" + word;
  if (kWords.count(word) == 0) {
    faults_.add(where, "an unknown word", joined({kWords.begin(), kWords.end()}));
  } else if (word == "description") {
    schema.description = lineOf(word, value, schema);
  } else if (word == "unit") {
    schema.unit = lineOf(word, value, schema);
  } else if (word == "default") {
    schema.default_value = value;
    checkForPython(word, value, schema);
  } else if (word != "type" && !parseChoiceWord(word, value, schema) && !parseObjectWord(word, value, schema) &&
             !parseArrayWord(word, value, schema) && !parseNumberWord(word, value, schema) &&
             !parseTextWord(word, value, schema)) {
    faults_.add(where, "it", "words that go with this type");
  }
}

bool SchemaParser::parseChoiceWord(const std::string& word, const YAML::Node& value, Schema& schema) {
  if (word == "anyOf") {
    schema.any_of = several(word, value, schema);
  } else if (word == "oneOf") {
    schema.one_of = several(word, value, schema);
  } else if (word == "const" && value.IsScalar()) {
    schema.choices = {value};
  } else if (word == "enum" && value.IsSequence() && value.size() > 0) {
    for (const YAML::Node& choice : value) {
      schema.choices.push_back(choice);
      checkForPython(word, choice, schema);
    }
  } else if (word == "const" || word == "enum") {
    faults_.add("schema " + schema.name + "/" + word, shown(value), word == "enum" ? "a list of values" : "one value");
  } else {
    return false;
  }
  return true;
}

bool SchemaParser::parseObjectWord(const std::string& word, const YAML::Node& value, Schema& schema) {
  if (schema.type != Type::kObject && schema.type != Type::kAny) return false;
  const std::string where = "schema " + schema.name + "/" + word;
  if (word == "properties" && value.IsMap()) {
    for (const auto& entry : value) {
      const std::string key = nameIn(entry.first);
      const SchemaPtr property = parseNode(entry.second, schema.name + "/" + key);
      checkKey(*property);
      if (!schema.properties.emplace(key, property).second) faults_.add(where + "/" + key, "it twice", "it once");
    }
  } else if (word == "required" && value.IsSequence()) {
    for (const YAML::Node& key : value) schema.required.push_back(nameIn(key));
  } else if (word == "additionalProperties") {
    if (const auto open = boolOf(value)) {
      schema.closed = !*open;
    } else {
      schema.additional = parseNode(value, schema.name + "/*");
    }
  } else if (word == "properties" || word == "required") {
    faults_.add(where, shown(value), word == "required" ? "a list of keys" : "a map");
  } else {
    return false;
  }
  return true;
}

bool SchemaParser::parseArrayWord(const std::string& word, const YAML::Node& value, Schema& schema) {
  if (schema.type != Type::kArray) return false;
  if (word == "items") {
    schema.items = parseNode(value, schema.name + "[]");
  } else if (word == "minItems") {
    schema.min_items = count(word, value, schema);
  } else if (word == "maxItems") {
    schema.max_items = count(word, value, schema);
  } else {
    return false;
  }
  return true;
}

bool SchemaParser::parseNumberWord(const std::string& word, const YAML::Node& value, Schema& schema) {
  if (schema.type != Type::kNumber && schema.type != Type::kInteger) return false;
  if (word == "minimum" || word == "exclusiveMinimum") {
    schema.range.min = number(word, value, schema);
    schema.range.min_excluded = word != "minimum";
  } else if (word == "maximum" || word == "exclusiveMaximum") {
    schema.range.max = number(word, value, schema);
    schema.range.max_excluded = word != "maximum";
  } else {
    return false;
  }
  return true;
}

bool SchemaParser::parseTextWord(const std::string& word, const YAML::Node& value, Schema& schema) {
  if (schema.type != Type::kString) return false;
  if (word == "minLength") {
    schema.min_length = count(word, value, schema);
  } else if (word == "pattern") {
    const std::string pattern = nameIn(value);
    try {
      schema.matches = [expression = std::regex(pattern)](const std::string& text) {
        return std::regex_search(text, expression);
      };
      schema.pattern = pattern;
    } catch (const std::regex_error&) {
      faults_.add("schema " + schema.name + "/pattern", shown(value), "a regular expression");
    }
  } else {
    return false;
  }
  return true;
}

/** Checks that are possible only when all words have been read. */
void SchemaParser::checkWhole(const YAML::Node& node, const Schema& schema) {
  const std::string where = "schema " + schema.name;
  if (schema.type == Type::kObject && !schema.closed && !schema.additional &&
      !node["additionalProperties"].IsDefined() && !node["$ref"].IsDefined())
    faults_.add(where + "/additionalProperties", "nothing", "false, true or what all other keys are like");
  if (schema.type == Type::kObject) {
    for (const std::string& key : schema.required)
      if (!schema.property(YAML::Node(), key))
        faults_.add(where + "/required", key, "one of " + joined(namesOf(schema.properties)));
  }
  if (schema.range.min > schema.range.max) faults_.add(where, schema.range.text(), "a range that is not empty");
  if (schema.max_items && schema.min_items > *schema.max_items)
    faults_.add(where + "/minItems", std::to_string(schema.min_items), "at most maxItems");
  if (schema.default_value) schema.check(*schema.default_value, where + "/default", faults_);
  for (const std::string& key : schema.required) {
    const auto property = schema.properties.find(key);
    if (property != schema.properties.end() && property->second->default_value)
      faults_.add(where + "/" + key + "/default", "it of a required key", "it where the key may be left out");
  }
}

/** A key of a map says what it is and what it means; where it only fixes a value, that is enough. */
void SchemaParser::checkKey(const Schema& key) {
  const bool says = key.type != Type::kAny || !key.choices.empty() || !key.any_of.empty() || !key.one_of.empty();
  if (!says) faults_.add("schema " + key.name + "/type", "nothing", "one of " + joined(namesOf(typesByName())));
  if (key.description.empty() && key.choices.size() != 1)
    faults_.add("schema " + key.name + "/description", "nothing", "one line that says what it means");
}

std::string SchemaParser::lineOf(const std::string& word, const YAML::Node& value, const Schema& schema) {
  const std::string line = value.IsScalar() ? value.Scalar() : "";
  if (line.empty() || line.find('\n') != std::string::npos)
    faults_.add("schema " + schema.name + "/" + word, shown(value), "one line of text");
  return line;
}

double SchemaParser::number(const std::string& word, const YAML::Node& value, const Schema& schema) {
  const auto number = numberOf(value);
  if (!number) {
    faults_.add("schema " + schema.name + "/" + word, shown(value), "a number");
  }
  checkForPython(word, value, schema);
  return number.value_or(0.0);
}

void SchemaParser::checkForPython(const std::string& word, const YAML::Node& value, const Schema& schema) {
  const std::string allowed = pythonFault(value, schema.type);
  if (!allowed.empty()) faults_.add("schema " + schema.name + "/" + word, shown(value), allowed);
}

std::size_t SchemaParser::count(const std::string& word, const YAML::Node& value, const Schema& schema) {
  const auto count = integerOf(value);
  if (!count || *count < 0) faults_.add("schema " + schema.name + "/" + word, shown(value), "an integer >= 0");
  return count && *count > 0 ? static_cast<std::size_t>(*count) : 0;
}

std::vector<SchemaPtr> SchemaParser::several(const std::string& word, const YAML::Node& value, const Schema& schema) {
  std::vector<SchemaPtr> alternatives;
  if (!value.IsSequence() || value.size() == 0) {
    faults_.add("schema " + schema.name + "/" + word, shown(value), "a list of schemas");
    return alternatives;
  }
  for (const YAML::Node& each : value) alternatives.push_back(parseNode(each, schema.name));
  return alternatives;
}

}  // namespace aras_visual_servo_common
