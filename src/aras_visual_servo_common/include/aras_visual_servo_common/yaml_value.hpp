#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
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

/** How YamlReader reads a value as T: `fits` says whether the section describes a T, `read` reads a value that was
 *  checked against the section (nothing when T cannot hold it), `text` names T in messages, `zero` is what a faulty
 *  value reads as until the reader's finish(). */
template <typename T>
struct YamlValue;

template <>
struct YamlValue<double> {
  static bool fits(const Schema& s) { return s.type == Schema::Type::kNumber || s.type == Schema::Type::kInteger; }
  static std::optional<double> read(const YAML::Node& value) { return numberOf(value); }
  static std::string text() { return "a number"; }
  static double zero() { return 0.0; }
};

template <>
struct YamlValue<std::int64_t> {
  static bool fits(const Schema& s) { return s.type == Schema::Type::kInteger; }
  static std::optional<std::int64_t> read(const YAML::Node& value) { return integerOf(value); }
  static std::string text() { return "an integer"; }
  static std::int64_t zero() { return 0; }
};

template <>
struct YamlValue<int> {
  static bool fits(const Schema& s) { return s.type == Schema::Type::kInteger; }
  static std::optional<int> read(const YAML::Node& value) {
    const auto wide = integerOf(value);
    if (!wide || *wide < std::numeric_limits<int>::min() || *wide > std::numeric_limits<int>::max()) return {};
    return static_cast<int>(*wide);
  }
  static std::string text() { return "an integer of 32 bits"; }
  static int zero() { return 0; }
};

template <>
struct YamlValue<bool> {
  static bool fits(const Schema& s) { return s.type == Schema::Type::kBoolean; }
  static std::optional<bool> read(const YAML::Node& value) { return boolOf(value); }
  static std::string text() { return "true or false"; }
  static bool zero() { return false; }
};

/** Texts, and the words of an `enum`. */
template <>
struct YamlValue<std::string> {
  static bool fits(const Schema& s) {
    return s.type == Schema::Type::kString || (s.type == Schema::Type::kAny && !s.choices.empty());
  }
  static std::optional<std::string> read(const YAML::Node& value) {
    return value.IsScalar() ? std::optional(value.Scalar()) : std::nullopt;
  }
  static std::string text() { return "a text"; }
  static std::string zero() { return ""; }
};

/** The node itself, for what has no simple type: it was checked against the section. */
template <>
struct YamlValue<YAML::Node> {
  static bool fits(const Schema&) { return true; }
  static std::optional<YAML::Node> read(const YAML::Node& value) { return value; }
  static std::string text() { return "anything"; }
  static YAML::Node zero() { return {}; }
};

template <typename T>
struct YamlValue<std::vector<T>> {
  static bool fits(const Schema& s) {
    return s.type == Schema::Type::kArray && s.items != nullptr && YamlValue<T>::fits(*s.items);
  }
  static std::optional<std::vector<T>> read(const YAML::Node& value) {
    std::vector<T> values;
    if (value.IsNull()) return values;
    for (const YAML::Node& item : value) {
      const std::optional<T> one = YamlValue<T>::read(item);
      if (!one) return {};
      values.push_back(*one);
    }
    return values;
  }
  static std::string text() { return "a list, each element " + YamlValue<T>::text(); }
  static std::vector<T> zero() { return {}; }
};

template <typename T, std::size_t N>
struct YamlValue<std::array<T, N>> {
  static bool fits(const Schema& s) {
    return YamlValue<std::vector<T>>::fits(s) && s.min_items == N && s.max_items == N;
  }
  static std::optional<std::array<T, N>> read(const YAML::Node& value) {
    const auto list = YamlValue<std::vector<T>>::read(value);
    if (!list || list->size() != N) return {};
    std::array<T, N> values{};
    std::copy(list->begin(), list->end(), values.begin());
    return values;
  }
  static std::string text() { return "a list of " + std::to_string(N) + ", each element " + YamlValue<T>::text(); }
  static std::array<T, N> zero() {
    std::array<T, N> values{};
    values.fill(YamlValue<T>::zero());
    return values;
  }
};

template <int N>
struct YamlValue<Eigen::Matrix<double, N, 1>> {
  using List = YamlValue<std::array<double, static_cast<std::size_t>(N)>>;
  using Vector = Eigen::Matrix<double, N, 1>;
  static bool fits(const Schema& s) { return List::fits(s); }
  static std::optional<Vector> read(const YAML::Node& value) {
    const auto list = List::read(value);
    return list ? std::optional<Vector>(Eigen::Map<const Vector>(list->data())) : std::nullopt;
  }
  static std::string text() { return List::text(); }
  static Vector zero() { return Vector::Zero(); }
};

}  // namespace aras_visual_servo_common
