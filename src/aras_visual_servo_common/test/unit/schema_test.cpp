// Each word of the vocabulary: what it accepts and what it refuses, of a value and of the schema itself.
#include "aras_visual_servo_common/schema.hpp"

#include <ctime>

#include "aras_visual_servo_common/text.hpp"
#include "aras_visual_servo_common/yaml_value.hpp"
#include "errors_of.hpp"

namespace aras_visual_servo_common::schema_test {
namespace {

/** A section with the one key `k`. */
std::string sectionOf(const std::string& key_schema) {
  return "{type: object, description: A toy., additionalProperties: false, properties: {k: " + key_schema + "}}";
}

/** What is said of a document whose key `k` has this value. It fits its section when nothing is said. */
std::string valueFault(const std::string& key_schema, const std::string& value) {
  const SchemaFolder folder({{"toy", sectionOf(key_schema)}});
  const YAML::Node document = YAML::Load("{k: " + value + "}");
  FaultList faults;
  const bool fits = folder.section("toy").check(document, "toy", faults);
  EXPECT_EQ(fits, faults.empty());
  EXPECT_EQ(folder.section("toy").fits(document), faults.empty()) << value;
  return joined(faults.lines(), "\n");
}

struct Word {
  const char* schema;   ///< of the key, without its description
  const char* good;     ///< a value it accepts
  const char* bad;      ///< one it refuses
  const char* allowed;  ///< with these words
};

void PrintTo(const Word& word, std::ostream* out) { *out << word.schema; }

class EachWord : public ::testing::TestWithParam<Word> {};

TEST_P(EachWord, AcceptsAndRefuses) {
  const Word& word = GetParam();
  const std::string schema = "{description: A key., " + std::string(word.schema) + "}";
  EXPECT_EQ(valueFault(schema, word.good), "");
  const std::string fault = valueFault(schema, word.bad);
  EXPECT_HAS(fault, "toy.k");
  EXPECT_HAS(fault, std::string("allowed ") + word.allowed);
}

INSTANTIATE_TEST_SUITE_P(
    Values, EachWord,
    ::testing::Values(
        Word{"type: number", "1.5", "text", "a number"}, Word{"type: number", "1", "'1'", "a number"},
        Word{"type: number", "+.5", "+", "a number"}, Word{"type: number, minimum: -2", "-.5", "-.inf", ">= -2"},
        Word{"type: number", "-1e3", ".nan", "finite"}, Word{"type: number", "0x10", ".inf", "finite"},
        Word{"type: integer", "3", "1.5", "an integer"}, Word{"type: integer", "2.0", "[2]", "an integer"},
        Word{"type: boolean", "true", "1", "true or false"}, Word{"type: boolean", "false", "'true'", "true or false"},
        Word{"type: string", "word", "[word]", "a text"}, Word{"type: string", "12", "null", "a text"},
        Word{"type: array", "[1, a]", "1", "a list of values"},
        Word{"type: object, additionalProperties: true", "{a: 1}", "1", "a map"},
        Word{"type: object, additionalProperties: {type: number}", "{a: 1}", "{a: x}", "a number"},
        Word{"type: object, additionalProperties: false, properties: {a: {type: number, description: A.}}", "{a: 1}",
             "{b: 1}", "a"},
        Word{"type: object, additionalProperties: false, required: [a], properties: {a: {type: number, description: "
             "A.}}",
             "{a: 1}", "{}", "a number (required)"},
        Word{"type: array, items: {type: number}", "[1, 2]", "[1, x]", "a list of numbers"},
        Word{"type: array, items: {type: number, minimum: 0}", "[1, 2]", "[1, -2]", ">= 0"},
        Word{"type: array, items: {type: array, items: {type: integer}}", "[[1], [2, 3]]", "[[1], [x]]",
             "a list of integers"},
        Word{"type: array, minItems: 1, items: {type: string}", "[a]", "[]", "a list of 1 or more texts"},
        Word{"type: array, maxItems: 2", "[1, 2]", "[1, 2, 3]", "a list of 0 to 2 values"},
        Word{"type: array, minItems: 2, maxItems: 2, items: {type: boolean}", "[true, no]", "[yes]",
             "a list of 2 true or false"},
        Word{"type: string, minLength: 1", "a", "''", "a text that is not empty"},
        Word{"type: string, minLength: 2", "ab", "a", "a text of at least 2 characters"},
        Word{"type: number, minimum: 1", "1", "0.9", ">= 1"}, Word{"type: number, maximum: 1", "1", "1.1", "<= 1"},
        Word{"type: number, exclusiveMinimum: 1", "1.1", "1", "> 1"},
        Word{"type: integer, exclusiveMaximum: 1", "0", "1", "< 1"},
        Word{"enum: [red, green]", "green", "gren", "one of red, green; did you mean green?"},
        Word{"enum: [1, 2]", "2.0", "3", "one of 1, 2"}, Word{"const: all", "all", "none", "all"},
        Word{"anyOf: [{const: all}, {type: array, items: {type: string}}]", "all", "some", "all or a list of texts"},
        Word{"anyOf: [{type: number}, {type: integer}]", "1", "x", "a number or an integer"},
        Word{"oneOf: [{type: number, minimum: 0}, {type: array}]", "1", "{}", "a number or a list of values"},
        Word{"oneOf: [{type: number}, {type: integer}]", "1.5", "1", "only one of them"},
        Word{"type: number, unit: m, default: 1", "2", "x", "a number"},
        Word{"type: number, minimum: 1.0e-6, maximum: 1.0e+6", "1", "1e999", "a number"},
        Word{"type: integer", "1e3", "1e300", "an integer"},
        Word{"type: number, default: 0x1e", "1", "1.5m", "a number"},
        Word{"type: string, default: 'off'", "'on'", "{}", "a text"},
        Word{"type: object, additionalProperties: false", "{}", "{b: 1}", "none"},
        Word{"type: object, additionalProperties: {type: number}", "{[1]: 2}", "{[1]: x}", "a number"},
        Word{"enum: [auto, 5]", "5", "fast", "one of auto, 5"}, Word{"const: 5", "5.0", "[5]", "5"},
        Word{"type: array, items: {enum: [red, green]}", "[red]", "1", "a list of values, each one of red, green"},
        Word{"type: array, items: {type: object, additionalProperties: true}", "[{}]", "1", "a list of maps"},
        Word{"type: array, items: {type: array}", "[[]]", "1", "a list of lists, each a list of values"},
        Word{"type: array, items: {description: Any.}", "[a, [1]]", "1", "a list of values"},
        Word{"type: array, items: {anyOf: [{type: number}, {const: all}]}", "[1, all]", "1",
             "a list of values, each a number or all"},
        Word{"type: array, items: {oneOf: [{type: number}, {type: string, minLength: 2}]}", "[1, ab]", "1",
             "a list of values, each a number or a text"},
        Word{"type: object, additionalProperties: {description: Any.}, required: [a]", "{a: 1}", "{}",
             "a value (required)"}));

TEST(Schema, AReferenceKeepsWhatIsSaidBesideIt) {
  const SchemaFolder folder({{"toy", sectionOf("{$ref: part, description: Its part., default: {a: 2}}")},
                             {"part",
                              "{type: object, description: A part., additionalProperties: false, "
                              "properties: {a: {type: integer, description: A., default: 1}}}"}});
  const SchemaPtr part = folder.section("toy").property(YAML::Node(), "k");
  EXPECT_EQ((*part->default_value)["a"].as<int>(), 2);
  EXPECT_EQ(part->name, "part");
  EXPECT_NE(part->property(YAML::Node(), "a"), nullptr);
}

const char kShapes[] =
    "{description: A shape., oneOf: ["
    "{type: object, additionalProperties: false, required: [radius_m], properties: {type: {const: circle}, "
    "radius_m: {type: number, description: R.}}},"
    "{type: object, additionalProperties: false, required: [side_m], properties: {type: {const: square}, "
    "side_m: {type: number, description: S.}}}]}";

TEST(Schema, FaultsOfOneOfSeveralMapsAreThoseOfTheOneThatIsMeant) {
  EXPECT_EQ(valueFault(kShapes, "{type: circle, radius_m: 1}"), "");
  EXPECT_EQ(valueFault(kShapes, "{type: circle, radius_m: x}"), "toy.k.radius_m: found x, allowed a number");
  const std::string fault = valueFault(kShapes, "{type: square, radius_m: 1}");
  EXPECT_HAS(fault, "toy.k.side_m: found nothing, allowed a number (required)");
  EXPECT_HAS(fault, "toy.k.radius_m: found an unknown key, allowed one of side_m, type");
}

TEST(Schema, AMapThatIsNoneOfSeveralIsToldWhichThereAre) {
  EXPECT_EQ(valueFault(kShapes, "{type: star}"), "toy.k.type: found star, allowed one of circle, square");
  EXPECT_EQ(valueFault(kShapes, "{}"), "toy.k.type: found nothing, allowed one of circle, square (required)");
  EXPECT_EQ(valueFault(kShapes, "5"), "toy.k: found 5, allowed a map or a map");
}

TEST(Schema, OneOfSeveralKeysIsCounted) {
  const std::string schema =
      "{type: object, description: A., additionalProperties: true, oneOf: [{required: [a]}, {required: [b, c]}]}";
  EXPECT_EQ(valueFault(schema, "{a: 1}"), "");
  EXPECT_EQ(valueFault(schema, "{d: 1}"), "toy.k: found 0 of these keys, allowed one of a, b with c");
  EXPECT_EQ(valueFault(schema, "{a: 1, b: 1, c: 1}"), "toy.k: found 2 of these keys, allowed one of a, b with c");
}

TEST(Schema, AtLeastOneOfSeveralKeysIsAskedFor) {
  const std::string schema =
      "{type: object, description: A., additionalProperties: true, anyOf: [{required: [a]}, {required: [b, c]}]}";
  EXPECT_EQ(valueFault(schema, "{a: 1, b: 1, c: 1}"), "");
  EXPECT_EQ(valueFault(schema, "{b: 1}"), "toy.k: found 0 of these keys, allowed one or more of a, b with c");
}

TEST(Schema, AValueWithoutANameIsCalledADocument) {
  const SchemaFolder folder(
      {{"toy", "{description: A toy., anyOf: [{type: number}, {const: all}]}"}, {"shape", kShapes}});
  const auto fault = [&](const std::string& section, const std::string& text) {
    FaultList faults;
    folder.section(section).check(YAML::Load(text), "", faults);
    return joined(faults.lines(), "\n");
  };
  EXPECT_EQ(fault("toy", "[]"), "document: found [], allowed a number or all");
  EXPECT_EQ(fault("shape", "{type: star}"), "type: found star, allowed one of circle, square");
}

TEST(Schema, TheNearestWordIsSuggestedWhereAMapIsAllowedToo) {
  const std::string schema =
      "{description: A., anyOf: [{type: string, enum: [dark, bright]}, {type: object, additionalProperties: true}]}";
  EXPECT_EQ(valueFault(schema, "drak"), "toy.k: found drak, allowed one of dark, bright or a map; did you mean dark?");
  EXPECT_EQ(valueFault(schema, "5"), "toy.k: found 5, allowed one of dark, bright or a map");
  EXPECT_EQ(valueFault(schema, "dark"), "");
}

TEST(Schema, ANullIsAnEmptyMapOrList) {
  EXPECT_EQ(valueFault("{type: array, description: A.}", "null"), "");
  EXPECT_EQ(valueFault("{type: object, additionalProperties: true, description: A.}", "null"), "");
  EXPECT_HAS(valueFault("{type: array, minItems: 1, description: A.}", "null"), "toy.k: found nothing");
}

/** To show such a list takes some 10 ms, and it was shown for each of its elements. */
TEST(Schema, AListOfThousandsOfWrongNumbersIsShownOnce) {
  constexpr double kMostCpuS = 30.0;  // it takes 0.1 s, and took 200
  std::string list = "[a";
  for (int k = 0; k < 20000; ++k) list += ",a";
  const std::clock_t before = std::clock();
  EXPECT_NE(
      valueFault("{type: array, items: {type: number}, description: Numbers.}", list + "]").find("allowed a list"),
      std::string::npos);
  EXPECT_LT(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC, kMostCpuS);
}

}  // namespace
}  // namespace aras_visual_servo_common::schema_test
