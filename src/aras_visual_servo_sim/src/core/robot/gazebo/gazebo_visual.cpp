#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "robot/gazebo/gazebo_tags.hpp"
#include "robot/urdf_check.hpp"

namespace aras_visual_servo_sim {

using tinyxml2::XMLElement;

namespace {

/** Red, green, blue and alpha; an alpha that is not given is 1. @throws ModelError for anything but finite numbers */
Rgba colorOf(const UrdfSource& source, const XMLElement& element) {
  Rgba color{0.0, 0.0, 0.0, 1.0};
  std::istringstream text(textOf(&element));
  std::string rest;
  const bool three = static_cast<bool>(text >> color.r >> color.g >> color.b);
  if (three && !(text >> color.a)) {
    text.clear();
    color.a = 1.0;
  }
  const bool finite = std::isfinite(color.r + color.g + color.b + color.a);
  if (!three || !finite || text >> rest) {
    source.fail(element, "value is '" + textOf(&element) + "', must be three or four finite numbers");
  }
  return color;
}

/** @throws ModelError for anything but six finite numbers */
TextureTransform textureTransformOf(const UrdfSource& source, const XMLElement& element) {
  TextureTransform A;
  std::istringstream text(textOf(&element));
  for (int i = 0; i < 6; ++i) text >> A(i / 3, i % 3);
  std::string rest;
  if (!text || !A.allFinite() || text >> rest) {
    source.fail(element, "value is '" + textOf(&element) + "', must be six finite numbers");
  }
  return A;
}

/** What a <material> says. Its named material comes first, its colours replace those of it. */
void paintAs(const UrdfSource& source, const XMLElement& element, Visual& visual) {
  for (const XMLElement* child = element.FirstChildElement("script"); child;
       child = child->NextSiblingElement("script")) {
    const std::string name = childText(child, "name");
    if (const auto found = gazeboMaterial(name)) {
      paint(*found, visual);
    } else if (!name.empty()) {
      source.warn(*child, "material '" + name + "' is not a plain colour of Gazebo's: ignored");
    }
  }
  const auto given = [&element](const char* key) { return element.FirstChildElement(key); };
  const XMLElement *diffuse = given("diffuse"), *ambient = given("ambient");
  if (diffuse || ambient) {
    if (!visual.has_color) visual.color = {1.0, 1.0, 1.0, 1.0};
    visual.has_color = true;
    visual.texture.clear();
  }
  if (diffuse) {
    visual.color = colorOf(source, *diffuse);
    visual.color.a = 1.0;  // what is transparent has <transparency>
  }
  if (ambient) visual.finish.ambient = colorOf(source, *ambient);
  if (const XMLElement* specular = given("specular")) visual.finish.specular = colorOf(source, *specular);
  if (const XMLElement* emissive = given("emissive")) visual.finish.emissive = colorOf(source, *emissive);
  if (const XMLElement* transform = given("texture_transform")) {
    visual.texture_transform = textureTransformOf(source, *transform);
  }
  visual.finish.unlit = !childFlag(source, &element, "lighting", true);
  warnOfOthers(source, &element,
               {"script", "diffuse", "ambient", "specular", "emissive", "lighting", "texture_transform"});
}

}  // namespace

void paint(const GazeboMaterial& material, Visual& visual) {
  visual.color = material.diffuse;
  visual.finish = material.finish;
  visual.has_color = true;
  visual.texture.clear();
}

void readVisualTag(const UrdfSource& source, const XMLElement& tag, const XMLElement& robot, Link& link) {
  const char* name = tag.Attribute("name");
  const XMLElement* described = robot.FirstChildElement("link");
  while (described && !described->Attribute("name", link.name.c_str())) {
    described = described->NextSiblingElement("link");
  }
  const XMLElement* own = described ? described->FirstChildElement("visual") : nullptr;
  for (Visual& visual : link.visuals) {  // in the order of the file
    const bool meant = !name || (own && own->Attribute("name", name));
    if (own) own = own->NextSiblingElement("visual");
    if (!meant) continue;
    if (const XMLElement* material = tag.FirstChildElement("material")) paintAs(source, *material, visual);
    const double transparency = childNumber(source, &tag, "transparency");
    if (transparency > 0.0) visual.color.a = std::clamp(1.0 - transparency, 0.0, 1.0);
  }
  for (const XMLElement* child = tag.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const std::string key = child->Name();
    if (key == "material" || key == "transparency" || key == "cast_shadows") continue;
    source.warn(*child, "in <visual> of <gazebo reference='" + link.name + "'>: ignored");
  }
}

}  // namespace aras_visual_servo_sim
