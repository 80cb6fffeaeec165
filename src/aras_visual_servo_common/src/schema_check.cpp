// Checking a value against what a schema says of it.
#include <algorithm>
#include <set>

#include "aras_visual_servo_common/schema.hpp"
#include "aras_visual_servo_common/text.hpp"
#include "aras_visual_servo_common/yaml_value.hpp"

namespace aras_visual_servo_common {
namespace {

using Type = Schema::Type;

bool fitsType(const YAML::Node& value, Type type) {
  switch (type) {
    case Type::kAny:
      return true;
    case Type::kObject:
      return value.IsMap() || value.IsNull();
    case Type::kArray:
      return value.IsSequence() || value.IsNull();
    case Type::kNumber:
      return numberOf(value).has_value();
    case Type::kInteger:
      return integerOf(value).has_value();
    case Type::kBoolean:
      return boolOf(value).has_value();
    case Type::kString:
      return value.IsScalar();
  }
  return false;
}

bool same(const YAML::Node& a, const YAML::Node& b) {
  if (!a.IsDefined() || !a.IsScalar() || !b.IsScalar()) return false;
  const auto x = numberOf(a), y = numberOf(b);
  return x && y ? *x == *y : a.Scalar() == b.Scalar();
}

bool isScalar(Type type) { return type != Type::kAny && type != Type::kObject && type != Type::kArray; }

/** What is allowed instead of a value that is no map and no list; empty when the value is as it should be. */
std::string scalarFault(const YAML::Node& value, const Schema& schema) {
  if (!fitsType(value, schema.type)) return schema.text();
  const auto equal = [&value](const YAML::Node& choice) { return same(value, choice); };
  if (!schema.choices.empty() && std::none_of(schema.choices.begin(), schema.choices.end(), equal))
    return schema.text();
  if (schema.type == Type::kNumber || schema.type == Type::kInteger)
    return schema.range.contains(*numberOf(value)) ? "" : schema.range.text();
  if (schema.type != Type::kString) return "";
  if (value.Scalar().size() < schema.min_length)
    return schema.min_length == 1 ? "a text that is not empty"
                                  : "a text of at least " + std::to_string(schema.min_length) + " characters";
  if (schema.pattern && !schema.matches(value.Scalar())) return "a text of the form " + *schema.pattern;
  return "";
}

void checkObject(const YAML::Node& map, const Schema& schema, const std::string& where, FaultList& faults) {
  const std::string prefix = where.empty() ? "" : where + "/";
  for (const std::string& key : schema.required) {
    const SchemaPtr wanted = schema.property(map, key);
    if (map.IsMap() && map[key].IsDefined()) continue;
    faults.add(prefix + key, "nothing", (wanted ? wanted->text() : std::string("it")) + " (required)");
  }
  if (!map.IsMap()) return;
  for (const auto& item : map) {
    const std::string key = item.first.IsScalar() ? item.first.Scalar() : shown(item.first);
    const auto known = schema.properties.find(key);
    if (known != schema.properties.end()) {
      known->second->check(item.second, prefix + key, faults);
    } else if (schema.additional) {
      schema.additional->check(item.second, prefix + key, faults);
    } else if (schema.closed) {
      std::vector<std::string> names;
      for (const auto& property : schema.properties) names.push_back(property.first);
      faults.add(prefix + key, "an unknown key", names.empty() ? "none" : joined(names));
    }
  }
}

void checkArray(const YAML::Node& list, const Schema& schema, const std::string& where, FaultList& faults) {
  const std::size_t size = list.IsNull() ? 0 : list.size();
  if (size < schema.min_items || (schema.max_items && size > *schema.max_items))
    return faults.add(where, shown(list), schema.text());
  if (!schema.items) return;
  std::set<std::string> said;  // each fault of the whole list once: showing it takes as long as the list
  for (std::size_t k = 0; k < size; ++k) {
    if (!isScalar(schema.items->type)) {
      schema.items->check(list[k], where + "[" + std::to_string(k) + "]", faults);
      continue;
    }
    const std::string allowed = scalarFault(list[k], *schema.items);  // said of the whole list, which is short
    if (allowed.empty() || !said.insert(allowed).second) continue;
    faults.add(where, shown(list), allowed == schema.items->text() ? schema.text() : allowed);
  }
}

bool fitsWhole(const YAML::Node& value, const Schema& schema) {
  FaultList faults;
  schema.check(value, "", faults);
  return faults.empty();
}

/** A map is told by the keys whose value the schema fixes with `const`, other values by their choices and their type.
 */
bool isMeant(const YAML::Node& value, const Schema& schema) {
  if (!fitsType(value, schema.type)) return false;
  if (!value.IsMap()) return schema.choices.empty() || scalarFault(value, schema).empty();
  return std::all_of(schema.properties.begin(), schema.properties.end(), [&value](const auto& property) {
    const auto& choices = property.second->choices;
    return choices.size() != 1 || same(value[property.first], choices.front());
  });
}

/** Keys of alternatives that only require keys, e.g. [[box_m], [radius_m, length_m]]; empty if one says more than that.
 */
std::vector<std::string> keysAskedFor(const std::vector<SchemaPtr>& alternatives) {
  std::vector<std::string> keys;
  for (const SchemaPtr& each : alternatives) {
    const bool only = each->type == Type::kAny && each->properties.empty() && !each->required.empty();
    if (!only) return {};
    keys.push_back(joined(each->required, " with "));
  }
  return keys;
}

/** The key that every alternative fixes with `const`, by which maps are told apart; empty if there is none. */
std::string tellingKey(const std::vector<SchemaPtr>& alternatives) {
  const auto fixes = [](const SchemaPtr& each, const std::string& key) {
    const auto property = each->properties.find(key);
    return property != each->properties.end() && property->second->choices.size() == 1;
  };
  for (const auto& [key, property] : alternatives.front()->properties) {
    const auto fixesKey = [&, &key = key](const SchemaPtr& each) { return fixes(each, key); };
    if (std::all_of(alternatives.begin(), alternatives.end(), fixesKey)) return key;
  }
  return "";
}

/** None of the alternatives is meant by the value of the key that tells them apart. */
void addTellingFault(const YAML::Node& map, const std::string& key, const std::vector<SchemaPtr>& alternatives,
                     const std::string& where, FaultList& faults) {
  std::vector<std::string> known;
  for (const SchemaPtr& each : alternatives) known.push_back(shown(each->properties.at(key)->choices.front()));
  faults.add(where.empty() ? key : where + "/" + key, shown(map[key]),
             "one of " + joined(known) + (map[key].IsDefined() ? "" : " (required)"));
}

std::vector<std::string> textsOf(const std::vector<SchemaPtr>& alternatives) {
  std::vector<std::string> texts;
  for (const SchemaPtr& each : alternatives) texts.push_back(each->text());
  return texts;
}

void checkAlternatives(const YAML::Node& value, const std::vector<SchemaPtr>& alternatives, bool one_only,
                       const std::string& where, FaultList& faults) {
  std::vector<SchemaPtr> fitting, meant;
  for (const SchemaPtr& each : alternatives) {
    if (fitsWhole(value, *each)) fitting.push_back(each);
  }
  if (fitting.size() == 1 || (fitting.size() > 1 && !one_only)) return;
  for (const SchemaPtr& each : alternatives) {
    if (isMeant(value, *each)) meant.push_back(each);
  }
  const std::vector<std::string> keys = keysAskedFor(alternatives);
  const std::string what = where.empty() ? "document" : where;
  if (!keys.empty()) {
    faults.add(what, std::to_string(fitting.size()) + " of these keys",
               std::string(one_only ? "one" : "one or more") + " of " + joined(keys));
  } else if (fitting.size() > 1) {
    faults.add(what, shown(value) + ", which is " + joined(textsOf(fitting), " and "), "only one of them");
  } else if (meant.size() == 1) {
    meant.front()->check(value, where, faults);
  } else if (value.IsMap() && !tellingKey(alternatives).empty()) {
    addTellingFault(value, tellingKey(alternatives), alternatives, where, faults);
  } else {
    faults.add(what, shown(value), joined(textsOf(alternatives), " or "));
  }
}

SchemaPtr propertyOfAlternatives(const std::vector<SchemaPtr>& alternatives, const YAML::Node& map,
                                 const std::string& key) {
  std::vector<SchemaPtr> describing, properties;
  for (const SchemaPtr& each : alternatives) {
    SchemaPtr property = each->property(map, key);
    if (!property) continue;
    describing.push_back(each);
    properties.push_back(std::move(property));
  }
  if (properties.empty()) return nullptr;
  if (properties.size() == 1 || !map.IsDefined()) return properties.front();
  // Several describe the key: the first that fits the whole map, else the first that the map is meant to be.
  for (std::size_t k = 0; k < properties.size(); ++k) {
    if (fitsWhole(map, *describing[k])) return properties[k];
  }
  for (std::size_t k = 0; k < properties.size(); ++k) {
    if (isMeant(map, *describing[k])) return properties[k];
  }
  return properties.front();
}

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

void Schema::check(const YAML::Node& value, const std::string& where, FaultList& faults) const {
  if (!value.IsDefined()) return check(YAML::Node(), where, faults);
  const std::string allowed = scalarFault(value, *this);
  if (!allowed.empty()) return faults.add(where.empty() ? "document" : where, shown(value), allowed);
  const bool of_map = type == Type::kObject || (type == Type::kAny && (!properties.empty() || !required.empty()));
  if (of_map) checkObject(value, *this, where, faults);
  if (type == Type::kArray) checkArray(value, *this, where, faults);
  if (!any_of.empty()) checkAlternatives(value, any_of, false, where, faults);
  if (!one_of.empty()) checkAlternatives(value, one_of, true, where, faults);
}

SchemaPtr Schema::property(const YAML::Node& map, const std::string& key) const {
  const auto own = properties.find(key);
  if (own != properties.end()) return own->second;
  if (SchemaPtr found = propertyOfAlternatives(one_of, map, key)) return found;
  if (SchemaPtr found = propertyOfAlternatives(any_of, map, key)) return found;
  return additional;
}

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

}  // namespace aras_visual_servo_common
