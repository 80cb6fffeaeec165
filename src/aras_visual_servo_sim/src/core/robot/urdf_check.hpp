#pragma once

#include <tinyxml2.h>

#include <string>
#include <vector>

namespace aras_visual_servo_sim {

/** Where messages about a document come from and go to. */
struct UrdfSource {
  std::string name;
  std::vector<std::string>* warnings;

  /** "name:line: <tag>: text". */
  std::string at(const tinyxml2::XMLElement& element, const std::string& text) const;
  [[noreturn]] void fail(const tinyxml2::XMLElement& element, const std::string& text) const;
  void warn(const tinyxml2::XMLElement& element, const std::string& text) const;
};

/** `count` finite numbers of an attribute. @throws ModelError; `owner` is e.g. "joint 'J1'". */
std::vector<double> numbersOf(const UrdfSource& source, const tinyxml2::XMLElement& element, const char* attribute,
                              std::size_t count, const std::string& owner);

/** Everything that can be said about a URDF before it is turned into a model: names, tree, numbers, limits, inertias.
 *  @throws ModelError at the first fault; ignored content becomes warnings. */
void checkUrdf(const UrdfSource& source, const tinyxml2::XMLElement& robot);

}  // namespace aras_visual_servo_sim
