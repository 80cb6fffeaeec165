#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

#include "aras_visual_servo_common/fault_list.hpp"
#include "aras_visual_servo_common/schema.hpp"
#include "aras_visual_servo_common/yaml_value.hpp"

namespace aras_visual_servo_common {

/** A map of a document while its author's faults are collected: for checks that a schema cannot express, such as those
 *  that compare two keys. */
class SectionCheck {
 public:
  /** @param where  dotted name of the map in messages, e.g. "sim.cameras[0]"; may be empty
   *  @param file   the file that the document comes from, which messages then begin with; may be empty */
  SectionCheck(const YAML::Node& node, const std::string& where, FaultList& faults, const std::string& file = "")
      : node_(node), where_(where), file_(file), faults_(faults) {}

  /** Returns whether the document itself has the key. */
  bool has(const std::string& key) const { return valueOf(node_, key).has_value(); }

  /** Returns the value of a key as it stands in the document; undefined when it is absent. */
  YAML::Node node(const std::string& key) const {
    return valueOf(node_, key).value_or(YAML::Node(YAML::NodeType::Undefined));
  }

  /** Returns the check of a nested map, or of entry k of a list of maps. */
  SectionCheck part(const std::string& key) const { return {node(key), path(key), faults_, file_}; }
  SectionCheck part(const std::string& key, std::size_t k) const;

  /** Adds `key: found FOUND, allowed ALLOWED`. */
  void fault(const std::string& key, const std::string& found, const std::string& allowed) const;
  void fault(const std::string& key, double found, const std::string& allowed) const;

  /** Adds that a key is required under a condition that the schema does not know. */
  void missing(const std::string& key, const std::string& allowed) const { fault(key, "nothing", allowed); }

  std::string path(const std::string& key) const { return where_.empty() ? key : where_ + "." + key; }
  FaultList& faults() const { return faults_; }

 private:
  YAML::Node node_;
  std::string where_, file_;
  FaultList& faults_;
};

/** Reads a section into its settings struct. The whole document is checked first: types, ranges, choices, required and
 *  unknown keys. What is absent or faulty has the default of the section.
 *  @param schema  of the document; it outlives the call */
template <typename Settings>
Settings readSettings(const YAML::Node& node, const Schema& schema, const std::string& where, FaultList& faults,
                      const std::string& file = "") {
  const bool fits = schema.check(node, where, faults, file);
  Settings settings;
  YamlValue<Settings>::read(node, fits ? nullptr : &schema, settings);
  return settings;
}

/** The same, after which `check(settings, SectionCheck)` may add faults.
 *  @throws ParameterError listing all faults */
template <typename Settings, typename Check>
Settings readSection(const YAML::Node& node, const std::string& where, Check&& check, const std::string& file = "") {
  FaultList faults;
  Settings settings = readSettings<Settings>(node, Settings::schema(), where, faults, file);
  check(settings, SectionCheck(node, where, faults, file));
  faults.throwIfAny();
  return settings;
}

}  // namespace aras_visual_servo_common
