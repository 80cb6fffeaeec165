#pragma once

#include <map>
#include <string>
#include <vector>

#include "aras_visual_servo_common/schema.hpp"

namespace aras_visual_servo_common {

/** The keys of a map, in its order. */
template <typename Map>
std::vector<std::string> namesOf(const Map& map) {
  std::vector<std::string> names;
  for (const auto& entry : map) names.push_back(entry.first);
  return names;
}

/** Reads the text of one section, and those it refers to, and lists everything that is not of the vocabulary. */
class SchemaParser {
 public:
  /** @param texts  all sections of the folder; must outlive the parser */
  explicit SchemaParser(const std::map<std::string, std::string>& texts) : texts_(texts) {}

  /** @throws SchemaError listing all faults of the section */
  SchemaPtr parse(const std::string& section);

 private:
  SchemaPtr parseSection(const std::string& section, const std::string& asked_by);
  SchemaPtr parseReference(const YAML::Node& node, const std::string& name);
  SchemaPtr parseNode(const YAML::Node& node, const std::string& name);
  void parseType(const YAML::Node& node, Schema& schema);
  void parseWord(const std::string& word, const YAML::Node& value, Schema& schema);
  bool parseTextWord(const std::string& word, const YAML::Node& value, Schema& schema);
  bool parseNumberWord(const std::string& word, const YAML::Node& value, Schema& schema);
  bool parseArrayWord(const std::string& word, const YAML::Node& value, Schema& schema);
  bool parseObjectWord(const std::string& word, const YAML::Node& value, Schema& schema);
  bool parseChoiceWord(const std::string& word, const YAML::Node& value, Schema& schema);
  void checkWhole(const YAML::Node& node, const Schema& schema);
  void checkKey(const Schema& key);

  std::string lineOf(const std::string& word, const YAML::Node& value, const Schema& schema);
  double number(const std::string& word, const YAML::Node& value, const Schema& schema);
  void checkForPython(const std::string& word, const YAML::Node& value, const Schema& schema);
  std::size_t count(const std::string& word, const YAML::Node& value, const Schema& schema);
  std::vector<SchemaPtr> several(const std::string& word, const YAML::Node& value, const Schema& schema);

  const std::map<std::string, std::string>& texts_;
  std::vector<std::string> open_;  ///< sections being read, one within the other
  FaultList faults_;
};

}  // namespace aras_visual_servo_common
