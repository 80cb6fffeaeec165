// The sections of test/schema, and the structs that were generated from them.
#include "aras_visual_servo_common/read_section.hpp"

#include "aras_visual_servo_common/config/sections.hpp"
#include "errors_of.hpp"

namespace aras_visual_servo_common::read_section_test {
namespace {

ToyConfig read(const std::string& document) {
  return readSection<ToyConfig>(YAML::Load(document), "toy", [](auto&&...) {});
}

std::string faultsOf(const std::string& document) {
  return textOf<ParameterError>([&] { read(document); });
}

TEST(ReadSection, ReadsEveryType) {
  const ToyConfig toy = read(
      "{name: box, mass_kg: 2, count: 3000000000, age: 9, loud: false, size_m: [4, 5, 6.5], names: [a, b], numbers: "
      "[1.5], "
      "color: red, finish: glossy, grip: {force_n: 3}, wheels: [{teeth: 9}, {}], joints: {j1: 0.1, j2: -1}, "
      "pairs: [[a, b]], rotation: [1, 2, 3, 4, 5, 6, 7, 8, 9], parts: {body: tin, left: {teeth: 5}}}");
  EXPECT_EQ(toy.name, "box");
  EXPECT_EQ(toy.mass_kg, 2.0);
  EXPECT_EQ(toy.count, 3000000000);
  EXPECT_EQ(toy.age, 9);
  EXPECT_FALSE(toy.loud);
  EXPECT_EQ(toy.size_m, Eigen::Vector3d(4, 5, 6.5));
  EXPECT_EQ(toy.rotation.value()[8], 9.0);
  EXPECT_EQ(toy.names, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(toy.numbers, std::vector<double>{1.5});
  EXPECT_EQ(toy.color, Color::kRed);
  EXPECT_EQ(toy.finish, "glossy");
  EXPECT_EQ(toy.grip.value().force_n, 3.0);
  EXPECT_EQ(toy.grip.value().teeth, 2);
  ASSERT_EQ(toy.wheels.size(), 2u);
  EXPECT_EQ(toy.wheels[0].teeth + 100 * toy.wheels[1].teeth, 9 + 100 * 12);
  EXPECT_EQ(toy.joints, (std::map<std::string, double>{{"j1", 0.1}, {"j2", -1.0}}));
  EXPECT_EQ(toy.pairs[0][1].Scalar(), "b");
  EXPECT_EQ(toy.parts.body, "tin");
  EXPECT_EQ(toy.parts.others.at("left").teeth, 5);
  EXPECT_EQ(toy.parts.others.size(), 1u);
}

TEST(ReadSection, WhatIsLeftOutHasTheDefaultOfTheSection) {
  const ToyConfig made, toy = read("{name: box}");
  for (const ToyConfig& each : {made, toy}) {
    EXPECT_EQ(each.mass_kg, 0.5);
    EXPECT_EQ(each.count, 7);
    EXPECT_TRUE(each.loud);
    EXPECT_EQ(each.size_m, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(each.color, Color::kDarkGreen);
    EXPECT_EQ(each.spare.teeth, 12);
    EXPECT_TRUE(each.names.empty() && each.wheels.empty() && each.joints.empty());
    EXPECT_FALSE(each.age || each.numbers || each.grip || each.rotation || each.pairs.size() > 0);
  }
  EXPECT_TRUE(read("{name: box, names: , wheels: , joints: , spare: }").wheels.empty());
}

TEST(ReadSection, AllFaultsOfAllLevelsAreListedAtOnceWithTheirFullPath) {
  EXPECT_EQ(faultsOf("{mass_kg: -1, count: 1.5, size_m: [1, 2], color: blue, grip: {teeth: x, claw: 1}, "
                     "wheels: [{}, {teeth: 1}], joints: {j1: far}, parts: {left: 1}, weels: }"),
            R"(toy.name: found nothing, allowed a text (required)
toy.mass_kg: found -1, allowed > 0
toy.count: found 1.5, allowed an integer
toy.size_m: found [1, 2], allowed a list of 3 numbers
toy.color: found blue, allowed one of red, dark_green
toy.grip.force_n: found nothing, allowed a number (required)
toy.grip.teeth: found x, allowed an integer
toy.grip.claw: found an unknown key, allowed one of force_n, teeth
toy.wheels[1].teeth: found 1, allowed >= 3 and <= 100
toy.joints.j1: found far, allowed a number
toy.parts.left: found 1, allowed a map
toy.weels: found an unknown key, allowed one of 17 names; did you mean wheels?)");
  EXPECT_EQ(faultsOf("[1, 2]"), "toy: found [1, 2], allowed a map");
  EXPECT_EQ(faultsOf(""), "toy.name: found nothing, allowed a text (required)");
}

TEST(ReadSection, AFaultyValueHasItsDefaultAndTheOthersAreRead) {
  FaultList faults;
  const YAML::Node document = YAML::Load(
      "{mass_kg: -1, count: 8, size_m: 3, grip: {force_n: strong, teeth: 4}, wheels: [{}, {}, {}, {teeth: 1}, {}]}");
  const auto toy = readSettings<ToyConfig>(document, ToyConfig::schema(), "toy", faults);
  EXPECT_EQ(faults.lines().size(), 5u);
  EXPECT_EQ(toy.mass_kg, 0.5);
  EXPECT_EQ(toy.count, 8);
  EXPECT_EQ(toy.size_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(toy.grip.value().force_n + toy.grip.value().teeth, 4.0);
  ASSERT_EQ(toy.wheels.size(), 4u);
  EXPECT_EQ(toy.wheels[3].teeth, 12);
}

TEST(ReadSection, ChecksOfTheCallerHaveTheFullPathAndTheFaultsOfAFileItsLine) {
  const std::string text = textOf<ParameterError>([] {
    readSection<ToyConfig>(
        YAML::Load("name: box\nmass_kg: -1\nwheels:\n  - {}\n  - teeth: 12\n"), "toy",
        [](const ToyConfig& toy, const SectionCheck& section) {
          EXPECT_TRUE(section.has("wheels") && !section.has("grip"));
          section.part("wheels", 1).fault("teeth", toy.wheels[1].teeth, "as many as the other wheel has");
          section.part("wheels", 0).missing("teeth", "some");
          section.part("grip").fault("force_n", "it", "none");
        },
        "toy.yaml");
  });
  EXPECT_EQ(text, R"(toy.yaml:2: toy.mass_kg: found -1, allowed > 0
toy.yaml:5: toy.wheels[1].teeth: found 12, allowed as many as the other wheel has
toy.yaml:4: toy.wheels[0].teeth: found nothing, allowed some
toy.yaml: toy.grip.force_n: found it, allowed none)");
}

TEST(ReadSection, AMapOfSeveralKindsHasTheKeysOfAll) {
  const auto read = [](const char* text) { return readSection<ShapeConfig>(YAML::Load(text), "", [](auto&&...) {}); };
  EXPECT_EQ(read("{type: box}").type + std::to_string(read("{type: box}").side_m), "box1.000000");
  EXPECT_EQ(read("{type: ball, radius_m: 3}").radius_m, 3.0);
  EXPECT_EQ(textOf<ParameterError>([&] { read("{type: ball, side_m: 3}"); }),
            "radius_m: found nothing, allowed a number (required)\n"
            "side_m: found an unknown key, allowed one of radius_m, type");
}

TEST(ReadSection, NamesTheSectionsThereAre) {
  EXPECT_EQ(schemaSections().names(), (std::vector<std::string>{"parts", "shape", "toy", "wheel"}));
  EXPECT_EQ(&schemaSections().section("toy"), &ToyConfig::schema());
  EXPECT_HAS(textOf<UnknownNameError>([] { schemaSections().section("whel"); }), "did you mean wheel?");
}

}  // namespace
}  // namespace aras_visual_servo_common::read_section_test
