#include "aras_visual_servo_common/text.hpp"
#include "schema_parser.hpp"

namespace aras_visual_servo_common {

SchemaFolder::SchemaFolder(std::map<std::string, std::string> texts) : texts_(std::move(texts)) {}

const Schema& SchemaFolder::section(const std::string& name) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (texts_.count(name) == 0)
    throw UnknownNameError("schema: found '" + name + "', allowed one of " + joined(names()));
  SchemaPtr& section = sections_[name];
  if (!section) section = SchemaParser(texts_).parse(name);
  return *section;
}

std::vector<std::string> SchemaFolder::names() const { return namesOf(texts_); }

}  // namespace aras_visual_servo_common
