#include "urdf_text.hpp"

#include <cmath>
#include <cstdlib>

namespace aras_visual_servo_sim {

using tinyxml2::XMLElement;

std::string textOf(const XMLElement* element) {
  const char* text = element ? element->GetText() : nullptr;
  if (!text) return "";
  const std::string all = text;
  const auto first = all.find_first_not_of(" \t\r\n");
  return first == std::string::npos ? "" : all.substr(first, all.find_last_not_of(" \t\r\n") - first + 1);
}

std::string childText(const XMLElement* parent, const char* tag) {
  return parent ? textOf(parent->FirstChildElement(tag)) : "";
}

double childNumber(const UrdfSource& source, const XMLElement* parent, const char* tag, double fallback) {
  const XMLElement* child = parent ? parent->FirstChildElement(tag) : nullptr;
  if (!child) return fallback;
  const std::string text = textOf(child);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value)) {
    source.fail(*child, "value is '" + text + "', must be a finite number");
  }
  return value;
}

bool childFlag(const UrdfSource& source, const XMLElement* parent, const char* tag, bool fallback) {
  const XMLElement* child = parent ? parent->FirstChildElement(tag) : nullptr;
  if (!child) return fallback;
  const std::string text = textOf(child);
  if (text == "true" || text == "True" || text == "1") return true;
  if (text == "false" || text == "False" || text == "0") return false;
  source.fail(*child, "value is '" + text + "', must be true or false");
}

}  // namespace aras_visual_servo_sim
