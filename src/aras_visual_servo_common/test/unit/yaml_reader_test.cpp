#include "aras_visual_servo_common/yaml_reader.hpp"

#include <functional>

#include "errors_of.hpp"

namespace aras_visual_servo_common {
namespace {

const std::string kSection = R"(
type: object
description: A toy.
additionalProperties: false
required: [name]
properties:
  name: {type: string, minLength: 1, description: A.}
  mass_kg: {type: number, exclusiveMinimum: 0, default: 0.5, description: A.}
  count: {type: integer, minimum: 0, default: 7, description: A.}
  on: {type: boolean, default: true, description: A.}
  size_m: {type: array, items: {type: number}, minItems: 3, maxItems: 3, default: [1, 2, 3], description: A.}
  names: {type: array, items: {type: string}, default: [], description: A.}
  numbers: {type: array, items: {type: number}, description: A.}
  color: {enum: [red, green], default: green, description: A.}
  pairs: {anyOf: [{const: all}, {type: array, items: {type: array, minItems: 2, maxItems: 2}}], description: A.}
  grip:
    type: object
    description: A.
    additionalProperties: false
    required: [force_n]
    properties: {force_n: {type: number, description: A.}, teeth: {type: integer, default: 2, description: A.}}
  wheels:
    type: array
    description: A.
    maxItems: 4
    items:
      type: object
      additionalProperties: false
      properties: {teeth: {type: integer, minimum: 3, default: 12, description: A.}}
  joints: {type: object, description: A., additionalProperties: {type: number}}
)";

std::string without(const std::string& key) {
  std::string text = kSection;
  const std::size_t begin = text.find("  " + key + ":");
  text.erase(begin, text.find('\n', begin) + 1 - begin);
  return text;
}

class ReadToy : public ::testing::Test {
 protected:
  YamlReader reader(const std::string& document, const std::string& section = kSection) {
    folder_ = std::make_unique<SchemaFolder>(std::map<std::string, std::string>{{"toy", section}});
    return YamlReader(YAML::Load(document), folder_->section("toy"), "toy");
  }
  static std::string faultsOf(YamlReader& reader) {
    return textOf<ParameterError>([&] { reader.finish(); });
  }

 private:
  std::unique_ptr<SchemaFolder> folder_;
};

TEST_F(ReadToy, ReadsEveryType) {
  YamlReader toy = reader(
      "{name: box, mass_kg: 2, count: 5, on: false, size_m: [4, 5, 6.5], names: [a, b], numbers: [1.5], color: red, "
      "grip: {force_n: 3}, wheels: [{teeth: 9}, {}], joints: {j1: 0.1, j2: -1}, pairs: [[a, b]]}");
  EXPECT_EQ(toy.get<std::string>("name"), "box");
  EXPECT_EQ(toy.get<double>("mass_kg"), 2.0);
  EXPECT_EQ(toy.get<double>("count"), 5.0);
  EXPECT_EQ(toy.get<int>("count"), 5);
  EXPECT_EQ(toy.get<std::int64_t>("count"), 5);
  EXPECT_FALSE(toy.get<bool>("on"));
  EXPECT_EQ(toy.get<Eigen::Vector3d>("size_m"), Eigen::Vector3d(4, 5, 6.5));
  EXPECT_EQ((toy.get<std::array<double, 3>>("size_m")), (std::array<double, 3>{4, 5, 6.5}));
  EXPECT_EQ(toy.get<std::vector<double>>("size_m"), (std::vector<double>{4, 5, 6.5}));
  EXPECT_EQ(toy.get<std::vector<std::string>>("names"), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(toy.find<std::vector<double>>("numbers").value(), std::vector<double>{1.5});
  EXPECT_EQ(toy.get<std::string>("color"), "red");
  EXPECT_EQ(toy.section("grip").get<double>("force_n"), 3.0);
  std::vector<int> teeth;
  for (YamlReader& wheel : toy.list("wheels")) teeth.push_back(wheel.get<int>("teeth"));
  EXPECT_EQ(teeth, (std::vector<int>{9, 12}));
  YamlReader joints = toy.section("joints");
  EXPECT_EQ(joints.keys(), (std::vector<std::string>{"j1", "j2"}));
  EXPECT_EQ(joints.get<double>("j2"), -1.0);
  EXPECT_EQ(toy.get<YAML::Node>("pairs")[0][1].Scalar(), "b");
  EXPECT_EQ(toy.raw("pairs").size(), 1u);
  EXPECT_NO_THROW(toy.finish());
}

TEST_F(ReadToy, WhatIsLeftOutHasTheDefaultOfTheSection) {
  YamlReader toy = reader("{name: box}");
  EXPECT_EQ(toy.get<double>("mass_kg"), 0.5);
  EXPECT_EQ(toy.get<int>("count"), 7);
  EXPECT_TRUE(toy.get<bool>("on"));
  EXPECT_EQ(toy.get<Eigen::Vector3d>("size_m"), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(toy.get<std::vector<std::string>>("names").empty());
  EXPECT_EQ(toy.get<std::string>("color"), "green");
  EXPECT_FALSE(toy.find<std::vector<double>>("numbers").has_value());
  EXPECT_FALSE(toy.has("numbers"));
  EXPECT_TRUE(toy.has("name"));
  EXPECT_EQ(toy.section("grip").get<int>("teeth"), 2);
  EXPECT_TRUE(toy.list("wheels").empty());
  EXPECT_FALSE(toy.raw("pairs").IsDefined());
  EXPECT_NO_THROW(toy.finish());
}

TEST_F(ReadToy, OfAListThatIsTooLongTheEntriesBeyondAreNotRead) {
  YamlReader whole = reader("{name: box, wheels: [{}, {}, {}, {}]}");
  EXPECT_EQ(whole.list("wheels").size(), 4u);
  EXPECT_NO_THROW(whole.finish());
  YamlReader longer = reader("{name: box, wheels: [{}, {}, {}, {}, {}]}");
  EXPECT_EQ(longer.list("wheels").size(), 4u);
  EXPECT_HAS(faultsOf(longer), "toy/wheels: found [ {}, {}, {}, {}, {}], allowed a list of 0 to 4 maps");
}

TEST_F(ReadToy, AllFaultsOfAllLevelsAreListedAtOnceWithTheirFullPath) {
  YamlReader toy = reader(
      "{mass_kg: -1, count: 1.5, size_m: [1, 2], color: blue, grip: {teeth: x, claw: 1}, wheels: [{}, {teeth: 1}], "
      "joints: {j1: far}, extra: 1}");
  EXPECT_EQ(faultsOf(toy), R"(toy/name: found nothing, allowed a text (required)
toy/mass_kg: found -1, allowed > 0
toy/count: found 1.5, allowed an integer
toy/size_m: found [1, 2], allowed a list of 3 numbers
toy/color: found blue, allowed one of red, green
toy/grip/force_n: found nothing, allowed a number (required)
toy/grip/teeth: found x, allowed an integer
toy/grip/claw: found an unknown key, allowed force_n, teeth
toy/wheels[1]/teeth: found 1, allowed >= 3
toy/joints/j1: found far, allowed a number
toy/extra: found an unknown key, allowed color, count, grip, joints, mass_kg, name, names, numbers, on, pairs, size_m, wheels)");
}

TEST_F(ReadToy, ReadingAFaultyValueAddsNoFaultAndGivesAPlaceholder) {
  YamlReader toy = reader("{mass_kg: -1, size_m: 3, grip: 5}");
  const std::string faults = faultsOf(toy);
  EXPECT_EQ(toy.get<std::string>("name"), "");
  EXPECT_EQ(toy.get<double>("mass_kg"), 0.5);
  EXPECT_EQ(toy.get<Eigen::Vector3d>("size_m"), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(toy.section("grip").get<int>("teeth"), 2);
  EXPECT_EQ(faultsOf(toy), faults);
}

TEST_F(ReadToy, AKeyTakenOutOfTheSectionIsRefusedInADocumentAndCannotBeAskedFor) {
  YamlReader with = reader("{name: box, count: 3}");
  EXPECT_EQ(with.get<int>("count"), 3);
  EXPECT_NO_THROW(with.finish());

  YamlReader document = reader("{name: box, count: 3}", without("count"));
  EXPECT_HAS(faultsOf(document), "toy/count: found an unknown key");

  YamlReader asked = reader("{name: box}", without("count"));
  EXPECT_EQ(asked.get<int>("count"), 0);
  EXPECT_EQ(faultsOf(asked), "toy/count: is read, but not described in schema toy");
}

TEST_F(ReadToy, EveryWayOfAskingForAKeyThatIsNotDescribedIsAFault) {
  const std::vector<std::function<void(YamlReader&)>> ways = {
      [](YamlReader& toy) { toy.has("none"); }, [](YamlReader& toy) { toy.raw("none"); },
      [](YamlReader& toy) { toy.list("none"); }, [](YamlReader& toy) { toy.section("none"); },
      [](YamlReader& toy) { toy.find<int>("none"); }};
  for (const auto& way : ways) {
    YamlReader toy = reader("{name: box}");
    way(toy);
    EXPECT_EQ(faultsOf(toy), "toy/none: is read, but not described in schema toy");
  }
}

TEST_F(ReadToy, AKeyWithoutDefaultThatIsAskedForIsRequired) {
  YamlReader toy = reader("{name: box}");
  toy.get<std::vector<double>>("numbers");
  EXPECT_EQ(faultsOf(toy), "toy/numbers: found nothing, allowed a list of numbers (required)");
}

TEST_F(ReadToy, AskingForAnotherTypeThanTheSectionSaysIsAFault) {
  YamlReader toy = reader("{name: box}");
  toy.get<int>("mass_kg");
  toy.get<double>("name");
  toy.get<Eigen::Vector2d>("size_m");
  EXPECT_EQ(faultsOf(toy), R"(toy/mass_kg: is read as an integer of 32 bits, but schema toy/mass_kg allows a number
toy/name: is read as a number, but schema toy/name allows a text
toy/size_m: is read as a list of 2, each element a number, but schema toy/size_m allows a list of 3 numbers)");
}

TEST_F(ReadToy, AnIntegerThatDoesNotFitIsRefused) {
  YamlReader toy = reader("{name: box, count: 3000000000}");
  EXPECT_EQ(toy.get<std::int64_t>("count"), 3000000000);
  toy.get<int>("count");
  EXPECT_EQ(faultsOf(toy), "toy/count: found 3000000000, allowed an integer of 32 bits");
}

enum class Color { kRed, kGreen, kBlue };

TEST_F(ReadToy, AChoiceIsReadAsWhatItsWordStandsFor) {
  const std::initializer_list<std::pair<const char*, Color>> words = {{"green", Color::kGreen}, {"red", Color::kRed}};
  EXPECT_EQ(reader("{name: box, color: red}").choice("color", words), Color::kRed);
  EXPECT_EQ(reader("{name: box}").choice("color", words), Color::kGreen);

  YamlReader other = reader("{name: box}");
  other.choice<Color>("color", {{"red", Color::kRed}, {"blue", Color::kBlue}});
  EXPECT_EQ(faultsOf(other), "toy/color: is read as one of red, blue, but schema toy/color allows one of red, green");
}

TEST_F(ReadToy, FaultsOfTheCallerHaveTheFullPathToo) {
  YamlReader toy = reader("{name: box, wheels: [{}]}");
  toy.list("wheels")[0].fault("teeth", "12", "as many as the other wheel has");
  EXPECT_EQ(faultsOf(toy), "toy/wheels[0]/teeth: found 12, allowed as many as the other wheel has");
}

TEST_F(ReadToy, AKeyOfSeveralMapsIsReadAsTheMapThatIsMeantHasIt) {
  const std::string shapes = R"(
description: A shape.
oneOf:
  - type: object
    additionalProperties: false
    required: [type]
    properties: {type: {const: box}, size: {type: number, default: 1, description: A.}}
  - type: object
    additionalProperties: false
    required: [type]
    properties: {type: {const: ball}, size: {type: number, default: 2, description: A.}}
)";
  EXPECT_EQ(reader("{type: box}", shapes).get<double>("size"), 1.0);
  EXPECT_EQ(reader("{type: ball}", shapes).get<double>("size"), 2.0);
  EXPECT_EQ(reader("{type: ball, color: red}", shapes).get<double>("size"), 2.0);
  YamlReader wrong = reader("{type: ball, size: x}", shapes);
  EXPECT_EQ(faultsOf(wrong), "toy/size: found x, allowed a number");
}

TEST_F(ReadToy, AListIsReadOnlyOfAList) {
  YamlReader wrong = reader("{name: box, wheels: 4}");
  const std::string said = faultsOf(wrong);
  EXPECT_EQ(said, "toy/wheels: found 4, allowed a list of 0 to 4 maps");
  EXPECT_TRUE(wrong.list("wheels").empty());
  EXPECT_EQ(faultsOf(wrong), said);
}

TEST_F(ReadToy, AListOfReadersNeedsASectionThatSaysWhatItHolds) {
  YamlReader toy = reader("{name: box, numbers: [1]}", R"(
type: object
description: A toy.
additionalProperties: true
properties: {numbers: {type: array, description: A.}}
)");
  EXPECT_TRUE(toy.list("numbers").empty());
  EXPECT_EQ(faultsOf(toy), "toy/numbers: is read as a list, but schema toy/numbers allows a list of values");
}

TEST_F(ReadToy, AListWithANumberThatDoesNotFitIsRefused) {
  const std::string counts = R"(
type: object
description: A toy.
additionalProperties: false
properties: {counts: {type: array, items: {type: integer}, description: A.}}
)";
  YamlReader toy = reader("{counts: [1, -3000000000]}", counts);
  EXPECT_EQ(toy.get<std::vector<std::int64_t>>("counts"), (std::vector<std::int64_t>{1, -3000000000}));
  toy.get<std::vector<int>>("counts");
  EXPECT_EQ(faultsOf(toy), "toy/counts: found [1, -3000000000], allowed a list, each element an integer of 32 bits");
  EXPECT_TRUE(reader("{counts: }", counts).get<std::vector<int>>("counts").empty());
}

TEST_F(ReadToy, ALengthThatTheSectionLeavesOpenCannotBeAskedFor) {
  YamlReader toy = reader("{name: box, numbers: [1, 2]}");
  toy.get<Eigen::Vector2d>("numbers");
  toy.get<std::array<double, 2>>("pairs");
  toy.get<std::vector<double>>("names");
  const std::string faults = faultsOf(toy);
  EXPECT_HAS(faults, "toy/numbers: is read as a list of 2, each element a number, but schema");
  EXPECT_HAS(faults, "toy/pairs: is read as a list of 2, each element a number, but schema");
  EXPECT_HAS(faults, "toy/names: is read as a list, each element a number, but schema");
}

TEST_F(ReadToy, AChoiceThatIsNotDescribedIsAFault) {
  YamlReader toy = reader("{name: box}");
  EXPECT_EQ(toy.choice<Color>("none", {{"red", Color::kRed}}), Color::kRed);
  EXPECT_EQ(faultsOf(toy), "toy/none: is read, but not described in schema toy");
}

TEST_F(ReadToy, AFaultyValueWithoutADefaultReadsAsZero) {
  YamlReader toy = reader("{name: box, grip: {force_n: strong}}");
  EXPECT_EQ(toy.section("grip").get<double>("force_n"), 0.0);
  EXPECT_EQ(faultsOf(toy), "toy/grip/force_n: found strong, allowed a number");
}

TEST_F(ReadToy, OnlyAMapHasKeysAndOnlyThoseThatAreTexts) {
  EXPECT_TRUE(reader("{name: box}").section("joints").keys().empty());
  EXPECT_TRUE(reader("{name: box, joints: 3}").section("joints").keys().empty());
  EXPECT_EQ(reader("{name: box, joints: {[1]: 2, j1: 1}}").section("joints").keys(), std::vector<std::string>{"j1"});
}

TEST_F(ReadToy, AnythingButAMapIsRefused) {
  YamlReader list = reader("[1, 2]");
  list.get<std::string>("name");
  EXPECT_EQ(faultsOf(list), "toy: found [1, 2], allowed a map");
  YamlReader nothing = reader("");
  EXPECT_EQ(faultsOf(nothing), "toy/name: found nothing, allowed a text (required)");
}

}  // namespace
}  // namespace aras_visual_servo_common
