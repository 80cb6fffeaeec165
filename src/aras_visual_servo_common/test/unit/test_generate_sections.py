"""The generator refuses sections that are not of the vocabulary, and lists all their faults."""
import pathlib
import subprocess
import sys

import pytest
import yaml

GENERATOR = pathlib.Path(__file__).resolve().parents[2] / "cmake" / "generate_sections.py"
MAP = "type: object, description: A., additionalProperties: false"


def generate(folder, **sections):
    """Returns what the generator says; the header is then folder/out.hpp."""
    schema = folder / "schema"
    schema.mkdir(exist_ok=True)
    for name, text in sections.items():
        (schema / f"{name}.yaml").write_text(text)
    result = subprocess.run([sys.executable, str(GENERATOR), "toys", str(schema), str(folder / "out.hpp"),
                             str(folder / "out.cpp")], stderr=subprocess.PIPE, text=True)
    assert (result.returncode == 0) == (folder / "out.hpp").exists() == (not result.stderr)
    return result.stderr


def section(key):
    return f"{{type: object, description: A toy., additionalProperties: false, properties: {{k: {key}}}}}"


@pytest.mark.parametrize("key, part", [
    ("5", "schema toy.k: found 5"),
    ("{type: number, description: A., minimun: 0}", "schema toy.k.minimun: found"),
    ("{type: float, description: A.}", "schema toy.k.type: found float"),
    ("{description: A.}", "schema toy.k.type: found nothing"),
    ("{type: number}", "schema toy.k.description: found None"),
    ('{type: number, description: "a\\nb"}', "schema toy.k.description: found"),
    ("{type: number, description: A., minimum: x}", "schema toy.k.minimum: found x"),
    ("{type: number, description: A., minimum: 1e-6}", "schema toy.k.minimum: found 1e-6"),
    ("{type: number, description: A., default: 1e6}", "schema toy.k.default: found 1e6"),
    ("{type: string, description: A., default: off}", "schema toy.k.default: found False"),
    ("{type: number, description: A., minimum: 2, maximum: 1}", "schema toy.k: found"),
    ("{type: array, description: A., minItems: 2, maxItems: 1}", "schema toy.k: found"),
    ("{type: number, description: A., minItems: 1}", "schema toy.k.minItems: found"),
    ("{type: array, description: A., minItems: -1}", "schema toy.k.minItems: found -1"),
    ("{type: array, description: A., items: {type: real}}", "schema toy.k[].type: found real"),
    ("{description: A., enum: []}", "schema toy.k.enum: found []"),
    ("{description: A., anyOf: []}", "schema toy.k.anyOf: found []"),
    ("{type: object, description: A.}", "schema toy.k.additionalProperties: found nothing"),
    ("{%s, required: [a]}" % MAP, "schema toy.k.required: found a"),
    ("{%s, properties: 1}" % MAP, "schema toy.k.properties: found 1"),
    ("{type: number, description: A., minimum: 0, default: -1}", "schema toy.k.default: found -1"),
    ("{%s, required: [a], properties: {a: {type: number, description: A., default: 1}}}" % MAP,
     "schema toy.k.a.default: found"),
    ("{%s, properties: {a: {const: 1}, a: {const: 2}}}" % MAP, "found a twice"),
    ("{$ref: part, minimum: 1}", "schema toy.k.minimum: found"),
    ("{$ref: nowhere}", "schema toy.k.$ref: found nowhere"),
    ("{$ref: toy}", "schema toy.k.$ref: found toy"),
    ("{$ref: back}", "schema toy.k.$ref: found back"),
])
def test_a_wrong_section_is_refused(tmp_path, key, part):
    found = generate(tmp_path, toy=section(key), part="{type: number, description: A part.}",
                     back="{type: array, description: A way back., items: {$ref: toy}}")
    assert part in found, found


def test_all_faults_are_listed_at_once(tmp_path):
    found = generate(tmp_path, toy=section("{type: number, minimun: 0}"), other="{type: number}", bad="{a: [}")
    assert all(part in found for part in ("toy.k.minimun", "toy.k.description", "other.description", "schema bad"))


def test_two_maps_of_one_name_need_titles(tmp_path):
    one, two = (section("{%s, properties: {%s: {type: number, description: A.}}}" % (MAP, key)) for key in "ab")
    assert "KConfig" in generate(tmp_path, one=one, two=two)
    assert generate(tmp_path, two=two.replace("{type: object, description: A.,", "{title: Two, type: object, "
                                              "description: A.,")) == ""
    assert "struct Two {" in (tmp_path / "out.hpp").read_text()


def test_a_file_that_says_the_same_is_not_written_again(tmp_path):
    toy = section("{type: number, description: A., default: 1}")
    assert generate(tmp_path, toy=toy) == ""
    before = (tmp_path / "out.hpp").stat().st_mtime_ns
    assert generate(tmp_path, toy=yaml.safe_dump(yaml.safe_load(toy))) == ""
    assert (tmp_path / "out.hpp").stat().st_mtime_ns == before


WORD = "{title: Shade, type: string, enum: [dark, bright], description: A.}"
COLOUR = "{title: Colour, %s, properties: {hue: {type: number, description: A.}}}" % MAP


def test_a_word_or_a_map_is_a_variant(tmp_path):
    assert generate(tmp_path, toy=section("{description: A., anyOf: [%s, %s]}" % (COLOUR, WORD))) == ""
    text = (tmp_path / "out.hpp").read_text()
    assert "std::variant<Shade, Colour>" in text and "#include <variant>" in text
    assert "struct YamlValue<std::variant<toys::Shade, toys::Colour>> {" in text


def test_of_several_types_beside_a_map_none_is_guessed(tmp_path):
    kinds = "{description: A., anyOf: [%s, %s, {type: number}]}" % (COLOUR, WORD)
    assert "toys: k: found anyOf" in generate(tmp_path, toy=section(kinds))
