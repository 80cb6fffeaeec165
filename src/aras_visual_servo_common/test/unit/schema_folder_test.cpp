// The sections of test/schema, as CMake put them into this program.
#include "aras_visual_servo_common/yaml_reader.hpp"
#include "errors_of.hpp"
#include "schema_sections.hpp"

namespace aras_visual_servo_common {
namespace {

TEST(SchemaFolder, HoldsEveryFileByItsName) {
  EXPECT_EQ(schemaSections().names(), (std::vector<std::string>{"toy", "wheel"}));
  EXPECT_EQ(schemaSections().section("toy").description, "A toy that every test may look at.");
  EXPECT_EQ(schemaSections().section("toy").property(YAML::Node(), "mass_kg")->unit, "kg");
}

TEST(SchemaFolder, NamesTheSectionsItHas) {
  EXPECT_HAS(textOf<UnknownNameError>([] { schemaSections().section("car"); }),
             "found 'car', allowed one of toy, wheel");
}

TEST(SchemaFolder, ASectionStaysWhereItIs) {
  EXPECT_EQ(&schemaSections().section("toy"), &schemaSections().section("toy"));
}

}  // namespace
}  // namespace aras_visual_servo_common
