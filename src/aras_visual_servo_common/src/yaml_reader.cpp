#include "aras_visual_servo_common/yaml_reader.hpp"

#include <algorithm>

#include "aras_visual_servo_common/text.hpp"

namespace aras_visual_servo_common {

/** One map of a family of readers. */
struct YamlReader::Level {
  YAML::Node node;
  const Schema* schema;
  SchemaPtr keep;  ///< holds the schema where the section does not
  std::string where;
  std::shared_ptr<FaultList> faults;
};

YamlReader::YamlReader(const YAML::Node& node, const Schema& schema, const std::string& where)
    : level_(std::make_shared<Level>(Level{node, &schema, nullptr, where, std::make_shared<FaultList>()})) {
  schema.check(node, where, *level_->faults);
}

YamlReader::YamlReader(std::shared_ptr<Level> level) : level_(std::move(level)) {}

std::string YamlReader::path(const std::string& key) const {
  return level_->where.empty() ? key : level_->where + "/" + key;
}

SchemaPtr YamlReader::described(const std::string& key) const {
  SchemaPtr found = level_->schema->property(level_->node, key);
  if (!found) level_->faults->add(path(key) + ": is read, but not described in schema " + level_->schema->name);
  return found;
}

bool YamlReader::has(const std::string& key) const { return described(key) && valueOf(level_->node, key); }

YamlReader::Asked YamlReader::ask(const std::string& key, const std::string& type, bool (*fits)(const Schema&)) {
  const SchemaPtr schema = described(key);
  if (!schema) return {false, {}};
  if (!fits(*schema)) {
    faults().add(path(key) + ": is read as " + type + ", but schema " + schema->name + " allows " + schema->text());
    return {false, {}};
  }
  const auto value = valueOf(level_->node, key);
  if (value && schema->fits(*value)) return {false, value};  // what is wrong was listed when the reader was made
  return {!value && !schema->default_value, schema->default_value};
}

void YamlReader::missing(const std::string& key) {
  const YAML::Node& map = level_->node;
  if (!map.IsMap() && !map.IsNull()) return;  // there is no map: that was said already
  if (const SchemaPtr schema = described(key)) fault(key, "nothing", schema->text() + " (required)");
}

void YamlReader::requireWords(const std::string& key, const std::vector<std::string>& words) {
  const SchemaPtr schema = described(key);
  if (!schema) return;
  std::vector<std::string> said;
  for (const YAML::Node& choice : schema->choices) said.push_back(choice.Scalar());
  if (!std::is_permutation(words.begin(), words.end(), said.begin(), said.end()))
    faults().add(path(key) + ": is read as one of " + joined(words) + ", but schema " + schema->name + " allows " +
                 schema->text());
}

YamlReader YamlReader::section(const std::string& key) {
  static const Schema kAnything;
  static const YAML::Node kNothing;
  const SchemaPtr schema = described(key);
  return YamlReader(
      std::make_shared<Level>(Level{valueOf(level_->node, key).value_or(kNothing), schema ? schema.get() : &kAnything,
                                    schema, path(key), level_->faults}));
}

std::vector<YamlReader> YamlReader::list(const std::string& key) {
  std::vector<YamlReader> readers;
  const SchemaPtr schema = described(key);
  const auto value = valueOf(level_->node, key);
  if (!schema || !value || !value->IsSequence()) return readers;
  if (!schema->items) {
    faults().add(path(key) + ": is read as a list, but schema " + schema->name + " allows " + schema->text());
    return readers;
  }
  const std::size_t count = std::min(value->size(), schema->max_items.value_or(value->size()));
  for (std::size_t k = 0; k < count; ++k)
    readers.push_back(YamlReader(std::make_shared<Level>(Level{
        (*value)[k], schema->items.get(), schema->items, path(key) + "[" + std::to_string(k) + "]", level_->faults})));
  return readers;
}

YAML::Node YamlReader::raw(const std::string& key) {
  described(key);
  const auto value = valueOf(level_->node, key);
  return value ? *value : YAML::Node(YAML::NodeType::Undefined);
}

std::vector<std::string> YamlReader::keys() const {
  std::vector<std::string> names;
  if (!level_->node.IsDefined() || !level_->node.IsMap()) return names;
  for (const auto& item : level_->node)
    if (item.first.IsScalar()) names.push_back(item.first.Scalar());
  return names;
}

void YamlReader::fault(const std::string& key, const std::string& found, const std::string& allowed) {
  level_->faults->add(path(key), found, allowed);
}

FaultList& YamlReader::faults() { return *level_->faults; }

void YamlReader::finish() { level_->faults->throwIfAny(); }

}  // namespace aras_visual_servo_common
