// Checking a value against what a schema says of it.
#include <algorithm>
#include <regex>
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

/** Where faults go. Without a list only whether there is one is asked for: no text is made, and `enough` after the
 *  first. */
class Findings {
 public:
  explicit Findings(FaultList* list = nullptr, const std::string& file = "") : list_(list), file_(file) {}

  /** `text` makes what is said, "FOUND, allowed ALLOWED". @param at  what stands there, or the map in which it is
   * missing
   */
  template <typename Text>
  void add(const YAML::Node& at, const std::string& where, const Text& text) {
    count();
    if (list_) list_->add(placeOf(at, file_) + (where.empty() ? "document" : where) + ": found " + text());
  }

  /** A fault without words. */
  void count() { any_ = true; }

  bool any() const { return any_; }
  bool silent() const { return !list_; }
  bool enough() const { return any_ && silent(); }

  /** Name of a key, or of `[k]`, in messages; empty when there are none. */
  std::string keyOf(const std::string& where, const std::string& key) const {
    return !list_ || where.empty() ? key : where + "." + key;
  }
  std::string elementOf(const std::string& where, std::size_t k) const {
    return list_ ? where + "[" + std::to_string(k) + "]" : "";
  }

 private:
  FaultList* list_;
  std::string file_;
  bool any_ = false;
};

void checkValue(const YAML::Node& value, const Schema& schema, const std::string& where, Findings& findings);

/** What is wrong with a value that is no map and no list. */
enum class Fault { kNone, kType, kChoice, kRange, kLength };

Fault faultOf(const YAML::Node& value, const Schema& schema) {
  if (!fitsType(value, schema.type)) return Fault::kType;
  const auto equal = [&value](const YAML::Node& choice) { return same(value, choice); };
  if (!schema.choices.empty() && std::none_of(schema.choices.begin(), schema.choices.end(), equal))
    return Fault::kChoice;
  if (schema.type == Type::kNumber || schema.type == Type::kInteger)
    return schema.range.contains(*numberOf(value)) ? Fault::kNone : Fault::kRange;
  if (schema.type != Type::kString) return Fault::kNone;
  return value.Scalar().size() < schema.min_length ? Fault::kLength : Fault::kNone;
}

std::vector<std::string> wordsOf(const std::vector<YAML::Node>& choices) {
  std::vector<std::string> words;
  for (const YAML::Node& choice : choices) words.push_back(shown(choice));
  return words;
}

/** For a number that was written 1,5. */
std::string decimalHint(const YAML::Node& value) {
  static const std::regex kComma("[-+]?[0-9]*,[0-9]+");
  const std::string text = value.IsScalar() ? value.Scalar() : "";
  if (text.size() > 30 || !std::regex_match(text, kComma)) return "";
  return "; the decimal mark is a point, " + text.substr(0, text.find(',')) + "." + text.substr(text.find(',') + 1);
}

/** {p: 1,5} is {p: 1, 5: null} to YAML. */
bool isDecimalPart(const YAML::Node& key, const YAML::Node& value) { return value.IsNull() && integerOf(key); }

/** What is allowed instead. */
std::string allowedInstead(Fault fault, const Schema& schema, const YAML::Node& value) {
  switch (fault) {
    case Fault::kRange:
      return schema.range.text();
    case Fault::kLength:
      return schema.min_length == 1 ? "a text that is not empty"
                                    : "a text of at least " + std::to_string(schema.min_length) + " characters";
    case Fault::kChoice:
      return oneOf(wordsOf(schema.choices), nameIn(value));
    case Fault::kNone:
    case Fault::kType:
      break;
  }
  return schema.text() + decimalHint(value);
}

void checkObject(const YAML::Node& map, const Schema& schema, const std::string& where, Findings& findings) {
  for (const std::string& key : schema.required) {
    if (valueOf(map, key)) continue;
    findings.add(map, findings.keyOf(where, key), [&] {
      const SchemaPtr wanted = schema.property(map, key);
      return "nothing, allowed " + (wanted ? wanted->text() : "it") + " (required)";
    });
  }
  if (!map.IsMap()) return;
  for (const auto& item : map) {
    if (findings.enough()) return;
    const std::string key = nameIn(item.first);
    const auto known = schema.properties.find(key);
    if (known != schema.properties.end()) {
      checkValue(item.second, *known->second, findings.keyOf(where, key), findings);
    } else if (schema.additional) {
      checkValue(item.second, *schema.additional, findings.keyOf(where, key), findings);
    } else if (schema.closed) {
      findings.add(item.first, findings.keyOf(where, key), [&] {
        std::vector<std::string> names;
        for (const auto& property : schema.properties) names.push_back(property.first);
        const bool decimal = isDecimalPart(item.first, item.second);
        return "an unknown key, allowed " + oneOf(names, key) + (decimal ? "; the decimal mark is a point" : "");
      });
    }
  }
}

void checkArray(const YAML::Node& list, const Schema& schema, const std::string& where, Findings& findings) {
  const std::size_t size = list.IsNull() ? 0 : list.size();
  if (size < schema.min_items || (schema.max_items && size > *schema.max_items))
    return findings.add(list, where, [&] { return shown(list) + ", allowed " + schema.text(); });
  if (!schema.items) return;
  std::set<Fault> said;  // each fault of the whole list once: showing it takes as long as the list
  for (std::size_t k = 0; k < size && !findings.enough(); ++k) {
    if (!isScalar(schema.items->type)) {
      checkValue(list[k], *schema.items, findings.elementOf(where, k), findings);
      continue;
    }
    const Fault fault = faultOf(list[k], *schema.items);  // said of the whole list, which is short
    if (fault == Fault::kNone || !said.insert(fault).second) continue;
    findings.add(list, where, [&] {
      const std::string allowed = allowedInstead(fault, *schema.items, list[k]);
      return shown(list) + ", allowed " + (allowed == schema.items->text() ? schema.text() : allowed);
    });
  }
}

/** A map is told by the keys whose value the schema fixes with `const`, other values by their choices and their type.
 */
bool isMeant(const YAML::Node& value, const Schema& schema) {
  if (!fitsType(value, schema.type)) return false;
  if (!value.IsMap()) return schema.choices.empty() || faultOf(value, schema) == Fault::kNone;
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
                     const std::string& where, Findings& findings) {
  findings.add(map, findings.keyOf(where, key), [&] {
    std::vector<YAML::Node> known;
    for (const SchemaPtr& each : alternatives) known.push_back(each->properties.at(key)->choices.front());
    const auto found = valueOf(map, key);
    if (!found) return "nothing, allowed " + oneOf(wordsOf(known), "") + " (required)";
    return shown(*found) + ", allowed " + oneOf(wordsOf(known), nameIn(*found));
  });
}

std::vector<std::string> textsOf(const std::vector<SchemaPtr>& alternatives) {
  std::vector<std::string> texts;
  for (const SchemaPtr& each : alternatives) texts.push_back(each->text());
  return texts;
}

/** How many of the alternatives fit a value; two stand for more. */
std::size_t fittingOf(const YAML::Node& value, const std::vector<SchemaPtr>& alternatives) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < alternatives.size() && count < 2; ++k) count += alternatives[k]->fits(value);
  return count;
}

/** Says what is wrong with a value that none, or too many, of the alternatives fit. */
void addAlternativesFault(const YAML::Node& value, const std::vector<SchemaPtr>& alternatives, bool one_only,
                          const std::string& where, Findings& findings) {
  std::vector<SchemaPtr> fitting, meant;
  for (const SchemaPtr& each : alternatives) {
    if (each->fits(value)) fitting.push_back(each);
    if (isMeant(value, *each)) meant.push_back(each);
  }
  const std::vector<std::string> keys = keysAskedFor(alternatives);
  if (!keys.empty()) {
    findings.add(value, where, [&] {
      return std::to_string(fitting.size()) + " of these keys, allowed one " + (one_only ? "" : "or more ") + "of " +
             joined(keys);
    });
  } else if (fitting.size() > 1) {
    findings.add(value, where, [&] {
      return shown(value) + ", which is " + joined(textsOf(fitting), " and ") + ", allowed only one of them";
    });
  } else if (meant.size() == 1) {
    checkValue(value, *meant.front(), where, findings);
  } else if (value.IsMap() && !tellingKey(alternatives).empty()) {
    addTellingFault(value, tellingKey(alternatives), alternatives, where, findings);
  } else {
    findings.add(value, where, [&] {
      std::vector<std::string> words;
      for (const SchemaPtr& each : alternatives)
        for (const std::string& word : wordsOf(each->choices)) words.push_back(word);
      return shown(value) + ", allowed " + joined(textsOf(alternatives), " or ") + didYouMean(nameIn(value), words);
    });
  }
}

void checkAlternatives(const YAML::Node& value, const std::vector<SchemaPtr>& alternatives, bool one_only,
                       const std::string& where, Findings& findings) {
  const std::size_t fitting = fittingOf(value, alternatives);
  if (fitting == 1 || (fitting > 1 && !one_only)) return;
  if (findings.silent()) return findings.count();
  addAlternativesFault(value, alternatives, one_only, where, findings);
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
  auto found = std::find_if(describing.begin(), describing.end(), [&](const auto& each) { return each->fits(map); });
  if (found == describing.end())
    found = std::find_if(describing.begin(), describing.end(), [&](const auto& each) { return isMeant(map, *each); });
  return found == describing.end() ? properties.front() : properties[found - describing.begin()];
}

void checkValue(const YAML::Node& value, const Schema& schema, const std::string& where, Findings& findings) {
  if (!value.IsDefined()) return checkValue(YAML::Node(), schema, where, findings);
  const Fault fault = faultOf(value, schema);
  if (fault != Fault::kNone)
    return findings.add(value, where,
                        [&] { return shown(value) + ", allowed " + allowedInstead(fault, schema, value); });
  const bool of_map = schema.type == Type::kObject ||
                      (schema.type == Type::kAny && !(schema.properties.empty() && schema.required.empty()));
  if (of_map) checkObject(value, schema, where, findings);
  if (schema.type == Type::kArray) checkArray(value, schema, where, findings);
  if (findings.enough()) return;
  if (!schema.any_of.empty()) checkAlternatives(value, schema.any_of, false, where, findings);
  if (!schema.one_of.empty()) checkAlternatives(value, schema.one_of, true, where, findings);
}

}  // namespace

bool Schema::check(const YAML::Node& value, const std::string& where, FaultList& faults,
                   const std::string& file) const {
  Findings findings(&faults, file);
  checkValue(value, *this, where, findings);
  return !findings.any();
}

bool Schema::fits(const YAML::Node& value) const {
  Findings findings;
  checkValue(value, *this, "", findings);
  return !findings.any();
}

SchemaPtr Schema::property(const YAML::Node& map, const std::string& key) const {
  const auto own = properties.find(key);
  if (own != properties.end()) return own->second;
  if (SchemaPtr found = propertyOfAlternatives(one_of, map, key)) return found;
  if (SchemaPtr found = propertyOfAlternatives(any_of, map, key)) return found;
  return additional;
}

}  // namespace aras_visual_servo_common
