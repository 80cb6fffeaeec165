#pragma once

#include <yaml-cpp/yaml.h>

#include <set>
#include <string>
#include <vector>

#include "aras_visual_servo_camera/errors.hpp"

namespace aras_visual_servo_camera {

/** Reads one YAML mapping strictly and collects every fault before it throws.
 *
 *  Faults: the node is not a mapping, a required key is missing, a value has the wrong type or lies out of range,
 *  a key nobody asked for is present. Quoted text is not taken for a number. */
class YamlReader {
 public:
  /** @param name  prefix of the keys in the messages, e.g. "vision" */
  YamlReader(const YAML::Node& node, std::string name);

  bool has(const std::string& key) const;

  /** Closed range [low, high]; a missing key is a fault, and `low` is returned so that reading goes on. */
  double requiredNumber(const std::string& key, double low, double high);
  double optionalNumber(const std::string& key, double low, double high, double fallback);
  int optionalInteger(const std::string& key, int low, int high, int fallback);
  int requiredInteger(const std::string& key, int low, int high);
  std::string requiredText(const std::string& key);
  std::string optionalText(const std::string& key, const std::string& fallback);
  /** One of `allowed`; returns its index. */
  int requiredChoice(const std::string& key, const std::vector<std::string>& allowed);
  int optionalChoice(const std::string& key, const std::vector<std::string>& allowed, int fallback);
  std::vector<double> requiredNumbers(const std::string& key);
  std::vector<double> optionalNumbers(const std::string& key);

  /** Accept the key, whatever it holds. */
  void ignore(const std::string& key);
  /** Add a fault found by the caller: `key: found X, allowed Y`. */
  void fault(const std::string& key, const std::string& found, const std::string& allowed);

  /** Add the faults of a section that was read by itself. */
  void adopt(const ParameterError& faults);

  /** @throws ParameterError listing all faults, one per line, if there is any */
  void finish();

 private:
  YAML::Node find(const std::string& key, bool required, const std::string& allowed);
  double number(const YAML::Node& node, const std::string& key, double low, double high, double fallback);
  int integer(const YAML::Node& node, const std::string& key, int low, int high, int fallback);
  int choice(const YAML::Node& node, const std::string& key, const std::vector<std::string>& allowed, int fallback);
  std::vector<double> numbers(const YAML::Node& node, const std::string& key);

  YAML::Node node_;
  std::string name_;
  bool is_map_ = false;
  std::set<std::string> known_;
  std::vector<std::string> faults_;
};

}  // namespace aras_visual_servo_camera
