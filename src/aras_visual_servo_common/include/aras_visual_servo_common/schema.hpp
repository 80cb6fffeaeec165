#pragma once

#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_common/fault_list.hpp"

namespace aras_visual_servo_common {

/** Interval a number must lie in; each end belongs to it unless it is excluded. NaN and infinities never do. */
struct Range {
  double min = -std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::max();
  bool min_excluded = false;
  bool max_excluded = false;

  bool contains(double value) const;

  /** In words, e.g. "> 0 and <= 255", or "finite" when there are no ends. */
  std::string text() const;
};

struct Schema;
using SchemaPtr = std::shared_ptr<const Schema>;

/** What a schema section says of one value, and of what it holds. The words are those of JSON Schema, see README.md. */
struct Schema {
  enum class Type { kAny, kObject, kArray, kNumber, kInteger, kBoolean, kString };

  std::string name;  ///< the section and the way into it, e.g. "vision.kernel.p"
  Type type = Type::kAny;
  std::optional<YAML::Node> default_value;
  std::vector<YAML::Node> choices;  ///< `enum`, or the one value of `const`; empty: any value

  // object
  std::map<std::string, SchemaPtr> properties;
  std::vector<std::string> required;
  bool closed = false;   ///< other keys are refused ...
  SchemaPtr additional;  ///< ... or must be like this; null and not closed: they may be anything

  // array
  SchemaPtr items;
  std::size_t min_items = 0;
  std::optional<std::size_t> max_items;

  // number, integer
  Range range;

  // string
  std::size_t min_length = 0;

  // alternatives: `anyOf` (at least one holds), `oneOf` (exactly one holds)
  std::vector<SchemaPtr> any_of, one_of;

  /** Adds a fault for everything in a value that is not as it should be; `where` names it in the messages, which begin
   *  with the name of the file and the line if there is a file. Returns whether there is none. */
  bool check(const YAML::Node& value, const std::string& where, FaultList& faults, const std::string& file = "") const;

  /** Whether check() would find nothing, sooner: the first fault is enough. */
  bool fits(const YAML::Node& value) const;

  /** The schema of a key of this map. It comes from the section itself, else from the alternative that the map fits or
   *  from any other alternative that has the key, else it is that of all other keys. Null when the section does not
   *  describe the key. */
  SchemaPtr property(const YAML::Node& map, const std::string& key) const;

  /** What is allowed, in words: "a list of 3 numbers", "one of dark, bright". */
  std::string text() const;
};

/** The sections a package ships, by the names of their files. */
class SchemaFolder {
 public:
  /** @param texts  name of a section (its file without .yaml) -> what the file says */
  explicit SchemaFolder(std::map<std::string, std::string> texts);

  /** A section, with each `$ref` put in place. It is read when it is first asked for and stays where it is.
   *  @throws UnknownNameError */
  const Schema& section(const std::string& name) const;

  std::vector<std::string> names() const;

 private:
  std::map<std::string, std::string> texts_;
  mutable std::map<std::string, SchemaPtr> sections_;
  mutable std::mutex mutex_;
};

/** "FILE:LINE: " of a value of that file; empty without a file. */
std::string placeOf(const YAML::Node& value, const std::string& file);

/** A value as messages show it: on one line, cut after 60 characters. */
std::string shown(const YAML::Node& value);

/** The name that a key of a map, or another value that should be a text, stands for: its text, or as messages show it
 * when it is a list or a map, which YAML allows for a key. */
std::string nameIn(const YAML::Node& key);

/** The value of a key, if this is a map that has the key. `map[key]` of yaml-cpp makes a stream for each key that is
 * not there, which takes most of the time of reading a section. */
std::optional<YAML::Node> valueOf(const YAML::Node& map, const std::string& key);

}  // namespace aras_visual_servo_common
