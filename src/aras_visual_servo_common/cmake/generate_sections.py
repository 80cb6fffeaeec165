"""Generates C++ settings structs from the schema sections of a package.

    generate_sections.py PROJECT SCHEMA_FOLDER HEADER SOURCE

HEADER gets one struct for each map that a section describes, with the section's defaults and descriptions, and SOURCE
gets the sections themselves. aras_embed_schema() of CMake runs this program; README.md describes the vocabulary.
"""
import json
import math
import re
import sys
import textwrap
from pathlib import Path
from typing import Any, List, Sequence, Union

import jsonschema
import yaml

ANY = {"$ref", "anyOf", "const", "default", "description", "enum", "oneOf", "title", "type", "unit"}
MAP = {"additionalProperties", "properties", "required"}
NUMBER = {"exclusiveMaximum", "exclusiveMinimum", "maximum", "minimum"}
WORDS = {"object": MAP, "array": {"items", "maxItems", "minItems"}, "number": NUMBER, "integer": NUMBER,
         "boolean": set(), "string": {"minLength"}, None: MAP}
NAMES = {"boolean": "bool", "number": "double", "string": "std::string"}
INT_MAX = 2**31 - 1
WIDTH = 116


class Loader(yaml.SafeLoader):
    """Reads YAML, and rejects a key that stands twice in a map."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict:
        keys = [self.construct_object(key) for key, _ in node.value]
        for key in keys:
            if keys.count(key) > 1:
                raise yaml.constructor.ConstructorError(None, None, f"found {key} twice", node.start_mark)
        return super().construct_mapping(node, deep)


class Sections:
    """The sections of a folder, and the faults found in them."""

    def __init__(self, folder: Union[str, Path]) -> None:
        self.faults, self.raw = [], {}
        for path in sorted(Path(folder).glob("*.yaml")):
            try:
                self.raw[path.stem] = yaml.load(path.read_text(encoding="utf-8"), Loader)
            except yaml.YAMLError as error:
                self.faults.append(f"schema {path.stem}: {error}")
        for name, section in self.raw.items():
            self._check(section, name, True)

    def resolved(self, node: Any, open_sections: Sequence[str] = ()) -> Any:
        """Returns a schema with each $ref replaced by the section it names; its own words take precedence."""
        if isinstance(node, list):
            return [self.resolved(one, open_sections) for one in node]
        if not isinstance(node, dict):
            return node
        rest = {key: self.resolved(value, open_sections) for key, value in node.items() if key != "$ref"}
        name = node.get("$ref")
        if name is None or name not in self.raw or name in open_sections:
            return rest
        return {**self.resolved(self.raw[name], (*open_sections, name)), **rest}

    def _fault(self, where, found, allowed):
        self.faults.append(f"schema {where}: found {found}, allowed {allowed}")

    def _check(self, node, where, described):
        """Adds the faults of one schema and of those in it."""
        if not isinstance(node, dict):
            return self._fault(where, node, "a map")
        if "$ref" in node:
            return self._check_reference(node, where)
        kind = node.get("type")
        if kind not in WORDS:
            return self._fault(f"{where}.type", kind, "one of " + ", ".join(sorted(filter(None, WORDS))))
        for word in sorted(set(node) - ANY - WORDS[kind]):
            self._fault(f"{where}.{word}", "the word", f"those of type {kind or 'any'}")
        try:
            jsonschema.Draft7Validator.check_schema({word: without_parts(word, value) for word, value in node.items()})
        except jsonschema.SchemaError as error:
            return self._fault(".".join(map(str, [where, *error.absolute_path])), error.instance, error.message)
        if described and not ("const" in node or one_line(node.get("description"))):
            self._fault(f"{where}.description", node.get("description"), "a text")
        if described and not set(node) & {"type", "enum", "const", "anyOf", "oneOf"}:
            self._fault(f"{where}.type", "nothing", "one of " + ", ".join(sorted(filter(None, WORDS))))
        if kind == "object" and "additionalProperties" not in node:
            self._fault(f"{where}.additionalProperties", "nothing", "false, true or what the other keys are like")
        if node.get("enum") == []:
            self._fault(f"{where}.enum", "[]", "a list of values")
        low, high = (node.get(one, node.get(other)) for one, other in (("minimum", "exclusiveMinimum"),
                                                                       ("maximum", "exclusiveMaximum")))
        if None not in (low, high) and low > high or node.get("minItems", 0) > node.get("maxItems", math.inf):
            self._fault(where, "a range that is empty", "one that is not")
        self._check_parts(node, where)
        self._check_default(node, where)

    def _check_parts(self, node, where):
        for key, value in node.get("properties", {}).items():
            self._check(value, f"{where}.{key}", True)
            if key in node.get("required", ()) and isinstance(value, dict) and "default" in value:
                self._fault(f"{where}.{key}.default", "it for a required key", "it for a key that may be left out")
        known = set(node.get("properties", ())).union(*(one.get("properties", ()) for one in node.get("oneOf", ())))
        if node.get("type") == "object" and not isinstance(node.get("additionalProperties"), dict):
            for key in sorted(set(node.get("required", ())) - known):
                self._fault(f"{where}.required", key, ", ".join(sorted(known)))
        parts = [("[]", node.get("items")), (".*", node.get("additionalProperties"))]
        parts += [(f".{word}", one) for word in ("anyOf", "oneOf") for one in node.get(word, ())]
        for name, part in parts:
            if isinstance(part, dict):
                self._check(part, where + name, False)

    def _check_reference(self, node, where):
        name = node["$ref"]
        for word in sorted(set(node) - {"$ref", "default", "description"}):
            self._fault(f"{where}.{word}", "it beside $ref", "default and description there")
        seen, open_names = set(), [name]
        while open_names:
            current = open_names.pop()
            if current not in self.raw:
                return self._fault(f"{where}.$ref", current, "one of " + ", ".join(self.raw))
            if current == where.split(".")[0].split("[")[0]:
                return self._fault(f"{where}.$ref", name, "a section that does not lead back to this one")
            if current not in seen:
                seen.add(current)
                open_names += references(self.raw[current])
        self._check_default(node, where)

    def _check_default(self, node, where):
        if "default" in node and not self.faults:
            schema = self.resolved({**node, "default": None})
            for error in jsonschema.Draft7Validator(schema).iter_errors(node["default"]):
                self._fault(f"{where}.default", node["default"], error.message)


def references(node: Any) -> List[str]:
    """Returns the names that a schema refers to."""
    if isinstance(node, dict):
        own = [node["$ref"]] if isinstance(node.get("$ref"), str) else []
        return own + [name for value in node.values() for name in references(value)]
    return [name for one in node for name in references(one)] if isinstance(node, list) else []


def without_parts(word: str, value: Any) -> Any:
    """Returns what stands after a word, with true in place of each schema in it."""
    if isinstance(value, dict):
        return True if word in ("items", "additionalProperties") else {key: True for key in value}
    return [True if isinstance(one, dict) else one for one in value] if isinstance(value, list) else value


def one_line(text: Any) -> bool:
    """Returns whether this is a text of one line."""
    return isinstance(text, str) and bool(text) and "\n" not in text


def bare(node: Any, keys: bool = False) -> Any:
    """Returns a schema without what is for people only."""
    if isinstance(node, list):
        return [bare(one) for one in node]
    if not isinstance(node, dict):
        return node
    return {key: bare(value, key == "properties") for key, value in node.items()
            if keys or key not in ("description", "title", "unit")}


def camel(name: str) -> str:
    """Returns `nearest_to_previous` as NearestToPrevious."""
    return "".join(part[:1].upper() + part[1:] for part in re.split(r"\W+|_", str(name)))


def comment(text: str, indent: str) -> List[str]:
    """Returns the lines of a documentation comment."""
    lines = textwrap.wrap("/** " + text.replace("*/", "* /"), WIDTH, initial_indent=indent,
                          subsequent_indent=indent + " *  ", break_on_hyphens=False)
    return [*lines[:-1], lines[-1] + " */"]


class Generator:
    """Collects the C++ of the sections of one package."""

    def __init__(self, project: str, sections: Sections) -> None:
        self.project, self.sections, self.done = project, sections, {}
        self.lines, self.words, self.variants, self.of_section = [], [], [], []
        for name, section in sections.raw.items():
            if self._is_struct(section):
                struct = self._struct(name, section)
                self.of_section.append((struct, name))

    @staticmethod
    def _is_struct(schema):
        return "properties" in schema or any("properties" in one for one in schema.get("oneOf", ()))

    def type_of(self, key: str, schema: dict) -> str:
        """Returns the C++ type of a value, having generated what it needs."""
        name = schema.get("$ref")
        if name is not None:
            return self.type_of(name, self.sections.raw[name])
        kind = schema.get("type")
        if self._is_struct(schema):
            return self._struct(key, schema)
        if any("properties" in one for one in schema.get("anyOf", ())):
            return self._variant(key, schema["anyOf"])
        if "enum" in schema:
            return self._enum(schema)
        if "const" in schema:
            return "std::string"
        if kind == "integer":
            return "int" if schema.get("maximum", math.inf) <= INT_MAX else "std::int64_t"
        if kind == "array" and "items" in schema:
            return self._array(key, schema)
        if kind == "object" and isinstance(schema["additionalProperties"], dict):
            return f"std::map<std::string, {self.type_of(key, schema['additionalProperties'])}>"
        return NAMES.get(kind, "YAML::Node")

    def _variant(self, key, kinds):
        """A value that is a map, or of one other type."""
        other, struct = sorted(kinds, key=self._is_struct) if len(kinds) == 2 else (kinds[0], {})
        if self._is_struct(other) or not self._is_struct(struct):
            sys.exit(f"{self.project}: {key}: found anyOf with a map, allowed one map and one other type")
        types = [self.type_of(key, one) for one in (other, struct)]
        whole = tuple(one if one in NAMES.values() or "::" in one else f"{self.project}::{one}" for one in types)
        if whole not in self.variants:
            self.variants.append(whole)
        return f"std::variant<{', '.join(types)}>"

    def _array(self, key, schema):
        entry, size = self.type_of(key, schema["items"]), schema.get("maxItems")
        if size is None or size != schema.get("minItems"):
            return f"std::vector<{entry}>"
        return f"Eigen::Vector{size}d" if entry == "double" and size in (2, 3, 4) else f"std::array<{entry}, {size}>"

    def _enum(self, schema):
        words, name = schema["enum"], schema.get("title")
        if not isinstance(words[0], str):
            return "int"
        if name is None:
            return "std::string"
        if self._is_new(name, schema):
            self.lines += [*comment(schema["description"], ""),
                           f"enum class {name} {{ {', '.join('k' + camel(word) for word in words)} }};", ""]
            self.words.append((name, words))
        return name

    def _is_new(self, name, schema):
        before = self.done.get(name)
        if before not in (None, schema):
            sys.exit(f"{self.project}: two schemas have the C++ name {name}; give one of them a `title`")
        self.done[name] = schema
        return before is None

    def _struct(self, key, schema):
        name = schema.get("title", camel(key) + "Config")
        if not self._is_new(name, schema):
            return name
        kinds = [schema, *(one for one in schema.get("oneOf", ()) if "properties" in one)]
        properties = {}
        for kind in kinds:
            for each, value in kind.get("properties", {}).items():
                properties.setdefault(each, value)
        needed = set(schema.get("required", ())) | {each for one in kinds[1:] for each in one.get("required", ())}
        members = [line for each, value in properties.items() for line in self._member(each, value, each in needed)]
        visits = [f'    visit("{each}", self.{each});' for each in properties]
        others = schema.get("additionalProperties")
        if isinstance(others, dict):
            entry = self.type_of(key + "_other", others)
            members.append(f"  std::map<std::string, {entry}> others;  ///< by other names")
            visits.append("    visit.others(self.others);")
        about = schema.get("description") or f"One of the entries of `{key}`."
        self.lines += [*comment(about, ""), f"struct {name} {{", *members, "",
                       "  template <typename Self, typename Visitor>",
                       "  static void visitKeys(Self& self, Visitor&& visit) {", *visits, "  }"]
        if any(schema is section for section in self.sections.raw.values()):
            self.lines += ["  /** Returns the section that describes these keys. */",
                           "  static const aras_visual_servo_common::Schema& schema();"]
        self.lines += ["};", ""]
        return name

    def _member(self, key, schema, needed):
        kind, whole = self.type_of(key, schema), self.sections.resolved(schema)
        unit = f" [{whole['unit']}]" if "unit" in whole else ""
        initial = "" if kind == "YAML::Node" else "{}"
        if "default" in whole and kind != "YAML::Node":
            initial = self._value(kind, whole["default"])
        elif not needed and kind != "YAML::Node":
            kind, initial = f"std::optional<{kind}>", ""
        about = whole.get("description", "")
        return [*comment(f"{about}{unit}", "  "), f"  {kind} {key}{initial};"]

    def _value(self, kind, value):
        """Returns an initialiser."""
        if isinstance(value, bool):
            return f" = {str(value).lower()}"
        if kind == "double":
            return f" = {float(value)!r}"
        if isinstance(value, int):
            return f" = {value}"
        if isinstance(value, str):
            return f" = {json.dumps(value)}" if kind == "std::string" else f" = {kind}::k{camel(value)}"
        entries = [] if isinstance(value, dict) else value
        return "{" + ", ".join(json.dumps(one) for one in entries) + "}"

    def header(self) -> str:
        """Returns the text of the header."""
        standard = ("array", "cstdint", "map", "optional", "string", *["variant"] * bool(self.variants), "vector")
        lines = ["// Generated from the folder schema: do not edit.", "#pragma once", "", "#include <yaml-cpp/yaml.h>",
                 "", "#include <Eigen/Core>",
                 "#include <aras_visual_servo_common/read_section.hpp>",
                 *(f"#include <{name}>" for name in standard), "",
                 f"namespace {self.project} {{", "", "/** Returns the sections of this package. */",
                 "const aras_visual_servo_common::SchemaFolder& schemaSections();", "", *self.lines,
                 f"}}  // namespace {self.project}", ""]
        if self.words or self.variants:
            lines += ["namespace aras_visual_servo_common {"]
            for name, words in self.words:
                whole = f"{self.project}::{name}"
                lines += ["template <>", f"struct YamlValue<{whole}> : YamlScalar {{",
                          f"  static void read(const YAML::Node& value, const Schema*, {whole}& word) {{",
                          f"    readWord(value, {{{', '.join(map(json.dumps, words))}}}, word);", "  }", "};"]
            for other, struct in self.variants:
                name = f"std::variant<{other}, {struct}>"
                reader = "YamlValue<{}>::read(value, schema, found.emplace<{}>());"
                lines += ["template <>", f"struct YamlValue<{name}> {{", "  static constexpr bool kHasParts = true;",
                          f"  static void read(const YAML::Node& value, const Schema* schema, {name}& found) {{",
                          "    if (value.IsMap()) return " + reader.format(struct, 1),
                          "    " + reader.format(other, 0), "  }", "};"]
            lines += ["}  // namespace aras_visual_servo_common", ""]
        return "\n".join(lines)

    def source(self) -> str:
        """Returns the text of the source."""
        lines = [f'#include "{self.project}/config/sections.hpp"', "", f"namespace {self.project} {{", "",
                 "const aras_visual_servo_common::SchemaFolder& schemaSections() {",
                 "  static const aras_visual_servo_common::SchemaFolder kSections({"]
        for name, section in self.sections.raw.items():
            text = json.dumps(bare(section), ensure_ascii=False)
            lines.append(f'      {{"{name}", R"schema({text})schema"}},')
        lines += ["  });", "  return kSections;", "}", ""]
        for struct, name in self.of_section:
            lines += [f"const aras_visual_servo_common::Schema& {struct}::schema() {{",
                      f'  static const auto& kSchema = schemaSections().section("{name}");',
                      "  return kSchema;", "}", ""]
        return "\n".join([*lines, f"}}  // namespace {self.project}", ""])


def write(path: Union[str, Path], text: str) -> None:
    """Writes a file, unless it says so already: then nothing is compiled again."""
    path = Path(path)
    if not path.is_file() or path.read_text(encoding="utf-8") != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def main(project: str, folder: str, header: str, source: str) -> None:
    """Generates both files. Exits with the faults of the sections, if there are any."""
    sections = Sections(folder)
    if sections.faults or not sections.raw:
        sys.exit("\n".join(sections.faults) or f"{folder}: found no .yaml")
    generator = Generator(project, sections)
    write(header, generator.header())
    write(source, generator.source())


if __name__ == "__main__":
    main(*sys.argv[1:])
