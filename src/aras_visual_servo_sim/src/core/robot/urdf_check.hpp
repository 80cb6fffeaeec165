#pragma once

#include <tinyxml2.h>

#include <initializer_list>
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

/** The same of one number that may be absent: then the fallback. */
double numberOf(const UrdfSource& source, const tinyxml2::XMLElement& element, const char* attribute, double fallback,
                const std::string& owner);

/** Warns of child elements beside the known ones. @param parent  may be null */
void warnOfOthers(const UrdfSource& source, const tinyxml2::XMLElement* parent,
                  std::initializer_list<const char*> known);

/** Everything that can be said about a URDF before it is turned into a model: names, tree, numbers, limits, inertias.
 *  @throws ModelError at the first fault; ignored content becomes warnings. */
void checkUrdf(const UrdfSource& source, const tinyxml2::XMLElement& robot);

/** Text of an element without the white space around it; empty for null. */
std::string textOf(const tinyxml2::XMLElement* element);

/** Text of a child element; empty when there is none. @param parent  may be null */
std::string childText(const tinyxml2::XMLElement* parent, const char* tag);

/** Number in the text of a child element, fallback when there is no such child. @param parent  may be null
 *  @throws ModelError naming file and line unless it is one finite number */
double childNumber(const UrdfSource& source, const tinyxml2::XMLElement* parent, const char* tag,
                   double fallback = 0.0);

/** Truth of a child element's text as sdformat reads it (true, 1, false, 0). @throws ModelError for anything else */
bool childFlag(const UrdfSource& source, const tinyxml2::XMLElement* parent, const char* tag, bool fallback);

}  // namespace aras_visual_servo_sim
