// Lights as SDF describes them, with the defaults of its specification (sdformat.org/spec, element light).
#include "aras_visual_servo_sim/robot/sdf_light.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "urdf_check.hpp"

namespace aras_visual_servo_sim {
namespace {

using tinyxml2::XMLElement;

/** The numbers of a child element's text, as many as the fallback has. */
template <typename Vector>
Vector childNumbers(const UrdfSource& source, const XMLElement& parent, const char* tag, const Vector& fallback) {
  const XMLElement* child = parent.FirstChildElement(tag);
  if (!child) return fallback;
  std::istringstream text(textOf(child));
  Vector values = fallback;
  std::string rest;
  bool fine = true;
  for (double& value : values) fine = fine && text >> value && std::isfinite(value);
  if (!fine || text >> rest) {
    source.fail(*child,
                "value is '" + textOf(child) + "', must be " + std::to_string(fallback.size()) + " finite numbers");
  }
  return values;
}

/** Red, green and blue of "r g b" or "r g b a", 0 .. 1. */
Eigen::Vector3d childColor(const UrdfSource& source, const XMLElement& light, const char* tag, double fallback) {
  const XMLElement* child = light.FirstChildElement(tag);
  if (!child) return Eigen::Vector3d::Constant(fallback);
  std::istringstream text(textOf(child));
  std::vector<double> values;
  for (double value = 0.0; text >> value;) values.push_back(value);
  const bool fine = text.eof() && (values.size() == 3 || values.size() == 4) &&
                    std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v) && v >= 0.0; });
  if (!fine) source.fail(*child, "value is '" + textOf(child) + "', must be three or four numbers >= 0");
  return {values[0], values[1], values[2]};
}

double atLeast(double least, const UrdfSource& source, const XMLElement* parent, const char* tag, double fallback) {
  const double value = childNumber(source, parent, tag, fallback);
  if (value < least) {
    source.fail(*parent->FirstChildElement(tag),
                "value is " + childText(parent, tag) + ", must be >= " + std::to_string(least));
  }
  return value;
}

SdfLight::Type typeOf(const UrdfSource& source, const XMLElement& element) {
  const char* given = element.Attribute("type");
  const std::string type = given ? given : "";
  if (type == "directional") return SdfLight::Type::kDirectional;
  if (type == "point") return SdfLight::Type::kPoint;
  if (type == "spot") return SdfLight::Type::kSpot;
  source.fail(element, "type is '" + type + "', must be point, directional or spot");
}

void readSpot(const UrdfSource& source, const XMLElement* spot, SdfLight& light) {
  light.inner_angle_rad = atLeast(0.0, source, spot, "inner_angle", 0.0);
  light.outer_angle_rad = atLeast(0.0, source, spot, "outer_angle", 0.0);
  light.falloff = atLeast(0.0, source, spot, "falloff", 0.0);
  if (!spot || light.outer_angle_rad == 0.0 || light.outer_angle_rad < light.inner_angle_rad) {
    throw ModelError(source.name + ": light '" + light.name + "': outer_angle of its <spot> is " +
                     std::to_string(light.outer_angle_rad) + ", must be > 0 and >= inner_angle, " +
                     std::to_string(light.inner_angle_rad));
  }
  constexpr double kSharp = 0.999;  // an edge without any width is not drawn
  light.inner_angle_rad = std::min(light.inner_angle_rad, kSharp * light.outer_angle_rad);
  warnOfOthers(source, spot, {"inner_angle", "outer_angle", "falloff"});
}

SdfLight lightOf(const UrdfSource& source, const XMLElement& element) {
  SdfLight light;
  light.name = element.Attribute("name") ? element.Attribute("name") : "";
  if (light.name.empty()) source.fail(element, "has no name, must have one");
  light.type = typeOf(source, element);
  const XMLElement* pose = element.FirstChildElement("pose");
  if (pose && pose->Attribute("relative_to")) source.warn(*pose, "relative_to is ignored");
  const auto place = childNumbers<std::array<double, 6>>(source, element, "pose", {});
  light.X_AL = {{place[0], place[1], place[2]}, quaternionFromRpy({place[3], place[4], place[5]})};
  const auto direction = childNumbers<std::array<double, 3>>(source, element, "direction", {0.0, 0.0, -1.0});
  light.direction_A = light.X_AL.q * Eigen::Vector3d(direction[0], direction[1], direction[2]);
  if (light.type != SdfLight::Type::kPoint && light.direction_A.norm() == 0.0) {
    source.fail(*element.FirstChildElement("direction"), "is zero, must be any other direction");
  }
  const double intensity =
      childFlag(source, &element, "light_on", true) ? atLeast(0.0, source, &element, "intensity", 1.0) : 0.0;
  light.diffuse = intensity * childColor(source, element, "diffuse", 1.0);
  light.specular = intensity * childColor(source, element, "specular", 0.1);
  const XMLElement* fading = element.FirstChildElement("attenuation");
  constexpr double kLeast = 1e-9;  // for a zero, by which something is divided
  light.range_m = std::max(kLeast, atLeast(0.0, source, fading, "range", 10.0));
  light.constant = std::max(kLeast, atLeast(0.0, source, fading, "constant", 1.0));
  light.linear_per_m = atLeast(0.0, source, fading, "linear", 1.0);
  light.quadratic_per_m2 = atLeast(0.0, source, fading, "quadratic", 0.0);
  if (light.constant + light.linear_per_m + light.quadratic_per_m2 <= kLeast) light.constant = 1.0;  // it fades never
  light.casts_shadows = childFlag(source, &element, "cast_shadows", false);
  if (light.type == SdfLight::Type::kSpot) readSpot(source, element.FirstChildElement("spot"), light);
  warnOfOthers(source, fading, {"range", "constant", "linear", "quadratic"});
  warnOfOthers(source, &element,
               {"pose", "direction", "light_on", "intensity", "diffuse", "specular", "attenuation", "cast_shadows",
                "spot", "visualize"});
  return light;
}

}  // namespace

SdfLight readSdfLight(const std::string& xml, const std::string& source, std::vector<std::string>* warnings) {
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.c_str()) != tinyxml2::XML_SUCCESS) {
    throw ModelError(source + ": " + document.ErrorStr());
  }
  const XMLElement* element = document.RootElement();
  if (element && std::string(element->Name()) == "sdf") element = element->FirstChildElement("light");
  if (!element || std::string(element->Name()) != "light") {
    throw ModelError(source + ": found <" + (element ? element->Name() : "") + ">, must be <light>");
  }
  std::vector<std::string> unread;
  return lightOf({source, warnings ? warnings : &unread}, *element);
}

}  // namespace aras_visual_servo_sim
