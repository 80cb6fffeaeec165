#include "aras_visual_servo_sim/config/yaml_reader.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

namespace {

std::string numberText(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

std::string shown(const YAML::Node& node) {
  if (node.IsNull()) return "nothing";
  std::string text = YAML::Dump(node);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

template <typename T>
struct TypeText;
template <>
struct TypeText<double> {
  static constexpr const char* kText = "a number";
};
template <>
struct TypeText<int> {
  static constexpr const char* kText = "an integer";
};
template <>
struct TypeText<std::int64_t> {
  static constexpr const char* kText = "an integer";
};
template <>
struct TypeText<bool> {
  static constexpr const char* kText = "true or false";
};
template <>
struct TypeText<std::string> {
  static constexpr const char* kText = "a text";
};
template <>
struct TypeText<std::vector<double>> {
  static constexpr const char* kText = "a list of numbers";
};
template <>
struct TypeText<std::vector<std::string>> {
  static constexpr const char* kText = "a list of texts";
};
template <>
struct TypeText<Eigen::Vector3d> {
  static constexpr const char* kText = "a list of 3 numbers";
};

template <typename T>
T decode(const YAML::Node& node) {
  return node.as<T>();
}

/** @throws YAML::Exception as the library does. */
template <>
Eigen::Vector3d decode<Eigen::Vector3d>(const YAML::Node& node) {
  const auto values = node.as<std::vector<double>>();
  if (values.size() != 3) throw YAML::RepresentationException(node.Mark(), "not 3 numbers");
  return {values[0], values[1], values[2]};
}

/** What a faulty value reads as until finish() throws. */
template <typename T>
T zeroOf() {
  return T{};
}
template <>
Eigen::Vector3d zeroOf<Eigen::Vector3d>() {
  return Eigen::Vector3d::Zero();
}

bool inRange(double value, const Range& range) { return range.contains(value); }
bool inRange(int value, const Range& range) { return range.contains(value); }
bool inRange(std::int64_t value, const Range& range) { return range.contains(static_cast<double>(value)); }
bool inRange(bool, const Range&) { return true; }
bool inRange(const std::string&, const Range&) { return true; }
bool inRange(const std::vector<std::string>&, const Range&) { return true; }
bool inRange(const std::vector<double>& values, const Range& range) {
  return std::all_of(values.begin(), values.end(), [&](double value) { return range.contains(value); });
}
bool inRange(const Eigen::Vector3d& value, const Range& range) {
  return range.contains(value.x()) && range.contains(value.y()) && range.contains(value.z());
}

}  // namespace

bool Range::contains(double value) const {
  return std::isfinite(value) && (min_excluded ? value > min : value >= min) && value <= max;
}

std::string Range::text() const {
  const double kLargest = std::numeric_limits<double>::max();
  const std::string low = (min_excluded ? "> " : ">= ") + numberText(min);
  const std::string high = "<= " + numberText(max);
  if (min > -kLargest && max < kLargest) return low + " and " + high;
  if (min > -kLargest) return low;
  if (max < kLargest) return high;
  return "finite";
}

struct YamlReader::Level {
  YAML::Node node;
  std::string where;
  std::set<std::string> asked;
};

struct YamlReader::Family {
  std::vector<std::string> faults;
  std::vector<std::shared_ptr<Level>> levels;
};

YamlReader::YamlReader(const YAML::Node& node, const std::string& where)
    : YamlReader(node, where, std::make_shared<Family>()) {}

YamlReader::YamlReader(const YAML::Node& node, const std::string& where, std::shared_ptr<Family> family)
    : family_(std::move(family)), level_(std::make_shared<Level>()) {
  level_->where = where;
  family_->levels.push_back(level_);
  if (!node.IsDefined() || node.IsNull()) return;
  if (node.IsMap()) {
    level_->node = node;
  } else {
    family_->faults.push_back((where.empty() ? "document" : where) + ": found " + shown(node) + ", allowed a map");
  }
}

std::string YamlReader::path(const std::string& key) const {
  return level_->where.empty() ? key : level_->where + "/" + key;
}

YAML::Node YamlReader::find(const std::string& key) const {
  level_->asked.insert(key);
  const YAML::Node& node = level_->node;
  if (!node.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
  return node[key];
}

bool YamlReader::has(const std::string& key) const { return find(key).IsDefined(); }

YAML::Node YamlReader::raw(const std::string& key) { return find(key); }

std::vector<std::string> YamlReader::keys() const {
  std::vector<std::string> names;
  if (level_->node.IsMap()) {
    for (const auto& item : level_->node) names.push_back(item.first.as<std::string>());
  }
  return names;
}

void YamlReader::fault(const std::string& key, const std::string& found, const std::string& allowed) {
  family_->faults.push_back(path(key) + ": found " + found + ", allowed " + allowed);
}

template <typename T>
T YamlReader::convert(const std::string& key, const YAML::Node& value, const T& placeholder, const Range& range) {
  T result = placeholder;
  try {
    result = decode<T>(value);
  } catch (const YAML::Exception&) {
    fault(key, shown(value), TypeText<T>::kText);
    return placeholder;
  }
  if (inRange(result, range)) return result;
  fault(key, shown(value), range.text());
  return placeholder;
}

template <typename T>
T YamlReader::required(const std::string& key, const Range& range) {
  const YAML::Node value = find(key);
  const T placeholder = zeroOf<T>();
  if (value.IsDefined() && !value.IsNull()) return convert<T>(key, value, placeholder, range);
  fault(key, "nothing", std::string(TypeText<T>::kText) + " (required)");
  return placeholder;
}

template <typename T>
T YamlReader::optional(const std::string& key, const T& default_value, const Range& range) {
  const YAML::Node value = find(key);
  return value.IsDefined() ? convert<T>(key, value, default_value, range) : default_value;
}

std::string YamlReader::requiredChoice(const std::string& key, const std::vector<std::string>& allowed) {
  if (has(key)) return optionalChoice(key, "", allowed);
  fault(key, "nothing", "one of " + joined(allowed) + " (required)");
  return allowed.front();
}

std::string YamlReader::optionalChoice(const std::string& key, const std::string& default_value,
                                       const std::vector<std::string>& allowed) {
  const auto value = optional<std::string>(key, default_value);
  if (!has(key) || std::find(allowed.begin(), allowed.end(), value) != allowed.end()) return value;
  fault(key, value, "one of " + joined(allowed));
  return default_value;
}

YamlReader YamlReader::section(const std::string& key, bool must_exist) {
  const YAML::Node value = find(key);
  if (must_exist && !value.IsDefined()) fault(key, "nothing", "a map (required)");
  return YamlReader(value.IsDefined() ? value : YAML::Node(), path(key), family_);
}

std::vector<YamlReader> YamlReader::list(const std::string& key) {
  std::vector<YamlReader> readers;
  const YAML::Node value = find(key);
  if (!value.IsDefined() || value.IsNull()) return readers;
  if (!value.IsSequence()) {
    fault(key, shown(value), "a list of maps");
    return readers;
  }
  for (std::size_t i = 0; i < value.size(); ++i) {
    readers.push_back(YamlReader(value[i], path(key) + "[" + std::to_string(i) + "]", family_));
  }
  return readers;
}

void YamlReader::finish() {
  for (const auto& level : family_->levels) {
    if (!level->node.IsMap()) continue;
    for (const auto& item : level->node) {
      const auto key = item.first.as<std::string>();
      if (level->asked.count(key)) continue;
      const std::vector<std::string> known(level->asked.begin(), level->asked.end());
      family_->faults.push_back((level->where.empty() ? key : level->where + "/" + key) +
                                ": found an unknown key, allowed " + joined(known));
    }
  }
  if (family_->faults.empty()) return;
  std::string text;
  for (const auto& line : family_->faults) text += (text.empty() ? "" : "\n") + line;
  throw ParameterError(text);
}

#define ARAS_INSTANTIATE(T)                                             \
  template T YamlReader::required<T>(const std::string&, const Range&); \
  template T YamlReader::optional<T>(const std::string&, const T&, const Range&);
ARAS_INSTANTIATE(double)
ARAS_INSTANTIATE(int)
ARAS_INSTANTIATE(std::int64_t)
ARAS_INSTANTIATE(bool)
ARAS_INSTANTIATE(std::string)
ARAS_INSTANTIATE(std::vector<double>)
ARAS_INSTANTIATE(std::vector<std::string>)
ARAS_INSTANTIATE(Eigen::Vector3d)
#undef ARAS_INSTANTIATE

}  // namespace aras_visual_servo_sim
