#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_common/schema.hpp"

namespace aras_visual_servo_common {

/** The number a scalar holds, if it is one. Quoted text is not taken for a number. */
std::optional<double> numberOf(const YAML::Node& value);

/** The integer a scalar holds, if it is one; 2.0 is one, as in JSON Schema. */
std::optional<std::int64_t> integerOf(const YAML::Node& value);

/** The truth value a scalar holds, if it is one. Quoted text is not. */
std::optional<bool> boolOf(const YAML::Node& value);

/** Text that is never taken for a number or a truth value, as if it stood in quotes. */
YAML::Node quotedText(const std::string& text);

/** A number with every bit; NaN and infinities as YAML writes them. */
YAML::Node exactNumber(double value);

/** Names the keys of a map to the settings struct that cmake/generate_sections.py made for it, and reads them. */
class KeyReader {
 public:
  /** @param schema  null where the whole document fits its schema; else values that do not fit are passed over */
  KeyReader(const YAML::Node& map, const Schema* schema) : map_(map), schema_(schema) {}

  template <typename T>
  void operator()(const std::string& key, T& value) {
    names_.push_back(key);
    if (const auto found = valueOf(map_, key)) read(key, *found, value);
  }

  /** Reads the keys that no member is named after. */
  template <typename T>
  void others(std::map<std::string, T>& values) {
    if (!map_.IsDefined() || !map_.IsMap()) return;
    for (const auto& item : map_) {
      const std::string name = nameIn(item.first);
      const bool is_member = std::find(names_.begin(), names_.end(), name) != names_.end();
      if (item.first.IsScalar() && !is_member) read(name, item.second, values[name]);
    }
  }

 private:
  template <typename T>
  void read(const std::string& key, const YAML::Node& found, T& value) const;

  const YAML::Node& map_;
  const Schema* schema_;
  std::vector<std::string> names_;
};

/** Reads a value that was checked against its schema as T. What T cannot hold is passed over; kHasParts says that parts
 *  of a faulty value are read nevertheless. This template reads a generated settings struct. */
template <typename T>
struct YamlValue {
  static constexpr bool kHasParts = true;
  static void read(const YAML::Node& value, const Schema* schema, T& settings) {
    T::visitKeys(settings, KeyReader(value, schema));
  }
};

struct YamlScalar {
  static constexpr bool kHasParts = false;
};

template <>
struct YamlValue<double> : YamlScalar {
  static void read(const YAML::Node& value, const Schema*, double& number) {
    number = numberOf(value).value_or(number);
  }
};

template <>
struct YamlValue<std::int64_t> : YamlScalar {
  static void read(const YAML::Node& value, const Schema*, std::int64_t& number) {
    number = integerOf(value).value_or(number);
  }
};

template <>
struct YamlValue<int> : YamlScalar {
  static void read(const YAML::Node& value, const Schema*, int& number) {
    number = static_cast<int>(integerOf(value).value_or(number));  // the schema bounds it
  }
};

template <>
struct YamlValue<bool> : YamlScalar {
  static void read(const YAML::Node& value, const Schema*, bool& truth) { truth = boolOf(value).value_or(truth); }
};

template <>
struct YamlValue<std::string> : YamlScalar {
  static void read(const YAML::Node& value, const Schema*, std::string& text) {
    if (value.IsScalar()) text = value.Scalar();
  }
};

/** The node itself, for what has no simple type. */
template <>
struct YamlValue<YAML::Node> : YamlScalar {
  static void read(const YAML::Node& value, const Schema*, YAML::Node& node) { node.reset(value); }
};

template <typename T>
struct YamlValue<std::optional<T>> {
  static constexpr bool kHasParts = YamlValue<T>::kHasParts;
  static void read(const YAML::Node& value, const Schema* schema, std::optional<T>& given) {
    YamlValue<T>::read(value, schema, given.emplace());
  }
};

template <typename T>
struct YamlValue<std::vector<T>> {
  static constexpr bool kHasParts = YamlValue<T>::kHasParts;
  static void read(const YAML::Node& value, const Schema* schema, std::vector<T>& values) {
    values.clear();
    if (!value.IsSequence()) return;
    // A list that is too long is a fault, and the entries beyond are not read.
    const std::size_t most = schema && schema->max_items ? *schema->max_items : value.size();
    values.reserve(std::min(most, value.size()));
    for (const YAML::Node& item : value) {
      if (values.size() == most) return;
      YamlValue<T>::read(item, schema ? schema->items.get() : nullptr, values.emplace_back());
    }
  }
};

template <typename T, std::size_t N>
struct YamlValue<std::array<T, N>> : YamlScalar {
  static void read(const YAML::Node& value, const Schema*, std::array<T, N>& values) {
    if (value.size() != N) return;
    for (std::size_t k = 0; k < N; ++k) YamlValue<T>::read(value[k], nullptr, values[k]);
  }
};

template <int N>
struct YamlValue<Eigen::Matrix<double, N, 1>> : YamlScalar {
  static void read(const YAML::Node& value, const Schema*, Eigen::Matrix<double, N, 1>& vector) {
    if (value.size() != N) return;
    for (int k = 0; k < N; ++k) YamlValue<double>::read(value[k], nullptr, vector[k]);
  }
};

template <typename T>
struct YamlValue<std::map<std::string, T>> {
  static constexpr bool kHasParts = true;
  static void read(const YAML::Node& value, const Schema* schema, std::map<std::string, T>& values) {
    KeyReader(value, schema).others(values);
  }
};

/** Reads one of the words of an enum, whose values are in the order of the words. */
template <typename E>
void readWord(const YAML::Node& value, std::initializer_list<const char*> words, E& meaning) {
  int index = 0;
  for (const char* word : words) {
    if (value.IsScalar() && value.Scalar() == word) meaning = static_cast<E>(index);
    ++index;
  }
}

template <typename T>
void KeyReader::read(const std::string& key, const YAML::Node& found, T& value) const {
  const SchemaPtr schema = schema_ ? schema_->property(map_, key) : nullptr;
  if (schema_ && !YamlValue<T>::kHasParts && !(schema && schema->fits(found))) return;
  YamlValue<T>::read(found, schema.get(), value);
}

}  // namespace aras_visual_servo_common
