#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace aras_visual_servo_sim {

/** Closed or half-open interval a number must lie in. NaN and infinities never do. */
struct Range {
  double min = -std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::max();
  bool min_excluded = false;

  static Range any() { return {}; }
  static Range positive() { return {0.0, std::numeric_limits<double>::max(), true}; }
  static Range nonNegative() { return {0.0, std::numeric_limits<double>::max(), false}; }
  static Range between(double min, double max) { return {min, max, false}; }

  bool contains(double value) const;
  std::string text() const;
};

/** Reads a map of parameters, collecting every fault instead of stopping at the first.
 *
 *  Ask for each key with required() or optional(), open nested maps with section() and list(), then call finish() once
 *  on any reader of the family: it adds a fault for each key nobody asked for and throws them all as lines of
 *  `key: found X, allowed Y`. Values read before finish() may be placeholders where there was a fault: use them after.
 *  T is one of double, int, std::int64_t, bool, std::string, std::vector<double>, std::vector<std::string>,
 *  Eigen::Vector3d. A range applies to every element of an array.
 */
class YamlReader {
 public:
  /** @param node   a map, or null for an empty one
   *  @param where  prefix of the keys in messages, e.g. "sim"; may be empty */
  explicit YamlReader(const YAML::Node& node, const std::string& where = "");

  bool has(const std::string& key) const;

  /** Value of a key that must be there. */
  template <typename T>
  T required(const std::string& key, const Range& range = Range::any());

  /** Value of a key that may be left out. */
  template <typename T>
  T optional(const std::string& key, const T& default_value, const Range& range = Range::any());

  /** As optional<std::string>, the value being one of a few words. */
  std::string requiredChoice(const std::string& key, const std::vector<std::string>& allowed);
  std::string optionalChoice(const std::string& key, const std::string& default_value,
                             const std::vector<std::string>& allowed);

  /** Reader of a nested map; empty when the key is absent (a fault if `must_exist`). */
  YamlReader section(const std::string& key, bool must_exist = false);

  /** Readers of the maps in a list; empty when the key is absent. */
  std::vector<YamlReader> list(const std::string& key);

  /** Unchecked node of a key, which then counts as known. */
  YAML::Node raw(const std::string& key);

  /** Keys of this map, in order. */
  std::vector<std::string> keys() const;

  /** Adds a fault of the caller's own. */
  void fault(const std::string& key, const std::string& found, const std::string& allowed);

  /** Full name of a key in messages, e.g. "sim/cameras[0]/width". */
  std::string path(const std::string& key) const;

  /** @throws ParameterError listing all faults of the whole family of readers, unknown keys included. */
  void finish();

 private:
  struct Family;
  struct Level;
  YamlReader(const YAML::Node& node, const std::string& where, std::shared_ptr<Family> family);
  YAML::Node find(const std::string& key) const;
  template <typename T>
  T convert(const std::string& key, const YAML::Node& value, const T& placeholder, const Range& range);

  std::shared_ptr<Family> family_;
  std::shared_ptr<Level> level_;
};

}  // namespace aras_visual_servo_sim
