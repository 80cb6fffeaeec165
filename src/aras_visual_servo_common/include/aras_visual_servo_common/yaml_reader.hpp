#pragma once

#include <yaml-cpp/yaml.h>

#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aras_visual_servo_common/schema.hpp"
#include "aras_visual_servo_common/yaml_value.hpp"

namespace aras_visual_servo_common {

/** Reads a map of parameters that a schema section describes, collecting every fault instead of stopping at the first.
 *
 *  The whole map, with all it holds, is checked against the section when the reader is made: types, ranges, choices,
 *  required keys, unknown keys. Then ask for each key by name and type, open nested maps with section() and list(), and
 *  call finish() once on any reader of the family: it throws all faults as lines of `key: found X, allowed Y`. Ranges,
 *  choices and defaults stand in the section only, and a key that the section does not describe cannot be asked for:
 *  that is a fault too. Values read before finish() may be placeholders where there was a fault: use them after.
 *
 *  T is double, int, std::int64_t, bool, std::string (also for choices), YAML::Node, a std::vector or std::array of
 * these or an Eigen vector of fixed size; see YamlValue. A null where the section says map or list is an empty one.
 */
class YamlReader {
 public:
  /** @param node    a map, or null for an empty one
   *  @param schema  what the map may hold; it must outlive the reader
   *  @param where   prefix of the keys in messages, e.g. "sim"; may be empty */
  YamlReader(const YAML::Node& node, const Schema& schema, const std::string& where = "");

  /** The document holds the key. */
  bool has(const std::string& key) const;

  /** Value of a key, else the section's default; nothing when there is neither. */
  template <typename T>
  std::optional<T> find(const std::string& key) {
    const Asked asked = ask(key, YamlValue<T>::text(), &YamlValue<T>::fits);
    if (asked.absent) return std::nullopt;
    std::optional<T> value;
    if (asked.value) value = YamlValue<T>::read(*asked.value);
    if (asked.value && !value) fault(key, shown(*asked.value), YamlValue<T>::text());
    return value ? value : YamlValue<T>::zero();
  }

  /** Value of a key, else the section's default; it is a fault when there is neither. */
  template <typename T>
  T get(const std::string& key) {
    const std::optional<T> value = find<T>(key);
    if (!value) missing(key);
    return value ? *value : YamlValue<T>::zero();
  }

  /** Value of a choice as get<std::string>() has it, by what each word of the section stands for. It is a fault if the
   *  section has other words than the table; a faulty value reads as the table's first. */
  template <typename E>
  E choice(const std::string& key, std::initializer_list<std::pair<const char*, E>> meanings) {
    std::vector<std::string> words;
    for (const auto& meaning : meanings) words.emplace_back(meaning.first);
    requireWords(key, words);
    const std::string word = get<std::string>(key);
    for (const auto& meaning : meanings)
      if (word == meaning.first) return meaning.second;
    return meanings.begin()->second;
  }

  /** Reader of a nested map; of an empty one, which has the section's defaults, when the key is absent. */
  YamlReader section(const std::string& key);

  /** Readers of the maps in a list; none when the key is absent. Those beyond the longest list that is allowed, which
   * is a fault, are not read. */
  std::vector<YamlReader> list(const std::string& key);

  /** Node of a key as the document has it; undefined when the key is absent. */
  YAML::Node raw(const std::string& key);

  /** Keys of this map, in the order of the document. */
  std::vector<std::string> keys() const;

  /** Adds a fault of the caller's own, what no section can say: `key: found FOUND, allowed ALLOWED`. */
  void fault(const std::string& key, const std::string& found, const std::string& allowed);

  /** Faults of the whole family. Faults of a part that is read by itself can be added here. */
  FaultList& faults();

  /** Full name of a key in messages, e.g. "sim/cameras[0]/width". */
  std::string path(const std::string& key) const;

  /** @throws ParameterError listing all faults of the whole family of readers. */
  void finish();

 private:
  struct Level;
  struct Asked {
    bool absent;                      ///< neither in the document nor a default
    std::optional<YAML::Node> value;  ///< what to read; none of what is faulty
  };

  explicit YamlReader(std::shared_ptr<Level> level);
  /** Schema of a key; null, and a fault, when the section does not describe it. */
  SchemaPtr described(const std::string& key) const;
  Asked ask(const std::string& key, const std::string& type, bool (*fits)(const Schema&));
  void missing(const std::string& key);
  void requireWords(const std::string& key, const std::vector<std::string>& words);

  std::shared_ptr<Level> level_;
};

}  // namespace aras_visual_servo_common
