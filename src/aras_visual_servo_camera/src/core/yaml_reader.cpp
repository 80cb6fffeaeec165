#include "aras_visual_servo_camera/yaml_reader.hpp"

#include <cmath>
#include <sstream>

#include "aras_visual_servo_camera/errors.hpp"

namespace aras_visual_servo_camera {
namespace {

std::string describe(const YAML::Node& node) {
  if (!node.IsDefined()) return "nothing";
  if (node.IsNull()) return "null";
  if (node.IsScalar()) return "'" + node.Scalar() + "'";
  return node.IsSequence() ? "a list" : "a mapping";
}

bool isQuoted(const YAML::Node& node) { return node.Tag() == "!"; }

bool toFinite(const YAML::Node& node, double* value) {
  return node.IsScalar() && !isQuoted(node) && YAML::convert<double>::decode(node, *value) && std::isfinite(*value);
}

std::string range(double low, double high) {
  std::ostringstream text;
  text.precision(12);
  text << low << " to " << high;
  return text.str();
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

YamlReader::YamlReader(const YAML::Node& node, std::string name) : node_(node), name_(std::move(name)) {
  is_map_ = node_.IsDefined() && node_.IsMap();
  if (!is_map_) faults_.push_back(name_ + ": found " + describe(node_) + ", allowed a mapping");
}

bool YamlReader::has(const std::string& key) const {
  const YAML::Node& node = node_;  // the const operator[] does not insert
  return is_map_ && node[key].IsDefined();
}

void YamlReader::fault(const std::string& key, const std::string& found, const std::string& allowed) {
  faults_.push_back(name_ + "/" + key + ": found " + found + ", allowed " + allowed);
}

void YamlReader::adopt(const ParameterError& faults) { faults_.push_back(faults.what()); }

void YamlReader::ignore(const std::string& key) { known_.insert(key); }

YAML::Node YamlReader::find(const std::string& key, bool required, const std::string& allowed) {
  known_.insert(key);
  const YAML::Node& node = node_;
  if (has(key)) return node[key];
  if (required && is_map_) fault(key, "nothing", allowed);
  return YAML::Node(YAML::NodeType::Undefined);
}

double YamlReader::number(const YAML::Node& node, const std::string& key, double low, double high, double fallback) {
  if (!node.IsDefined()) return fallback;
  double value = 0.0;
  if (toFinite(node, &value) && value >= low && value <= high) return value;
  fault(key, describe(node), "a number from " + range(low, high));
  return fallback;
}

int YamlReader::integer(const YAML::Node& node, const std::string& key, int low, int high, int fallback) {
  if (!node.IsDefined()) return fallback;
  double value = 0.0;
  if (toFinite(node, &value) && value == std::floor(value) && value >= low && value <= high)
    return static_cast<int>(value);
  fault(key, describe(node), "an integer from " + range(low, high));
  return fallback;
}

double YamlReader::requiredNumber(const std::string& key, double low, double high) {
  return number(find(key, true, "a number from " + range(low, high)), key, low, high, low);
}

double YamlReader::optionalNumber(const std::string& key, double low, double high, double fallback) {
  return number(find(key, false, ""), key, low, high, fallback);
}

int YamlReader::requiredInteger(const std::string& key, int low, int high) {
  return integer(find(key, true, "an integer from " + range(low, high)), key, low, high, low);
}

int YamlReader::optionalInteger(const std::string& key, int low, int high, int fallback) {
  return integer(find(key, false, ""), key, low, high, fallback);
}

std::string YamlReader::requiredText(const std::string& key) {
  const YAML::Node node = find(key, true, "text");
  if (!node.IsDefined()) return "";
  if (node.IsScalar()) return node.Scalar();
  fault(key, describe(node), "text");
  return "";
}

std::string YamlReader::optionalText(const std::string& key, const std::string& fallback) {
  return has(key) ? requiredText(key) : (find(key, false, ""), fallback);
}

int YamlReader::choice(const YAML::Node& node, const std::string& key, const std::vector<std::string>& allowed,
                       int fallback) {
  if (!node.IsDefined()) return fallback;
  for (std::size_t k = 0; k < allowed.size(); ++k)
    if (node.IsScalar() && node.Scalar() == allowed[k]) return static_cast<int>(k);
  fault(key, describe(node), "one of " + join(allowed));
  return fallback;
}

int YamlReader::requiredChoice(const std::string& key, const std::vector<std::string>& allowed) {
  return choice(find(key, true, "one of " + join(allowed)), key, allowed, 0);
}

int YamlReader::optionalChoice(const std::string& key, const std::vector<std::string>& allowed, int fallback) {
  return choice(find(key, false, ""), key, allowed, fallback);
}

std::vector<double> YamlReader::numbers(const YAML::Node& node, const std::string& key) {
  std::vector<double> values;
  if (!node.IsDefined()) return values;
  if (!node.IsSequence()) {
    fault(key, describe(node), "a list of numbers");
    return values;
  }
  for (const YAML::Node& item : node) {
    double value = 0.0;
    if (!toFinite(item, &value)) fault(key, describe(item), "finite numbers");
    values.push_back(value);
  }
  return values;
}

std::vector<double> YamlReader::requiredNumbers(const std::string& key) {
  return numbers(find(key, true, "a list of numbers"), key);
}

std::vector<double> YamlReader::optionalNumbers(const std::string& key) { return numbers(find(key, false, ""), key); }

void YamlReader::finish() {
  if (is_map_) {
    std::vector<std::string> known(known_.begin(), known_.end());
    for (const auto& entry : node_) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : describe(entry.first);
      if (known_.count(key) == 0) fault(key, "an unknown key", join(known));
    }
  }
  if (faults_.empty()) return;
  std::string text;
  for (const std::string& line : faults_) text += (text.empty() ? "" : "\n") + line;
  throw ParameterError(text);
}

}  // namespace aras_visual_servo_camera
