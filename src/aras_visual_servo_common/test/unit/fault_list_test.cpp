#include "aras_visual_servo_common/fault_list.hpp"

#include <limits>

#include "aras_visual_servo_common/schema.hpp"
#include "errors_of.hpp"

namespace aras_visual_servo_common::fault_list_test {
namespace {

TEST(FaultList, ThrowsAllLinesAtOnceInTheirOrder) {
  FaultList faults;
  EXPECT_NO_THROW(faults.throwIfAny());
  faults.add("a", "1", "2");
  faults.add("b: something else");
  EXPECT_EQ(textOf<ParameterError>([&] { faults.throwIfAny(); }), "a: found 1, allowed 2\nb: something else");
}

TEST(FaultList, DoesNotRepeatALine) {
  FaultList faults;
  faults.add("a", "1", "2");
  faults.add("a", "1", "2");
  EXPECT_EQ(faults.lines().size(), 1u);
}

TEST(FaultList, EndsWithAWordAfterTwoHundredLines) {
  FaultList faults;
  for (int k = 0; k < 3000; ++k) faults.add(std::to_string(k));
  ASSERT_EQ(faults.lines().size(), 201u);
  EXPECT_EQ(faults.lines()[199], "199");
  EXPECT_EQ(faults.lines().back(), "found more than 200 faults, allowed none");
}

TEST(FaultList, EveryLineOfAnAdoptedErrorHasThePrefix) {
  FaultList faults;
  faults.adopt(ParameterError("width: found 0, allowed > 0\nheight: found 0, allowed > 0"), "sim/cameras[0]/");
  EXPECT_EQ(faults.lines(), (std::vector<std::string>{"sim/cameras[0]/width: found 0, allowed > 0",
                                                      "sim/cameras[0]/height: found 0, allowed > 0"}));
}

TEST(FaultList, CollectsOtherErrorsOfTheFamilyAndNoneBesides) {
  FaultList faults;
  faults.collect([] { throw ModelError("no mass"); }, "robot: ");
  faults.collect([] {});
  EXPECT_EQ(faults.lines(), std::vector<std::string>{"robot: no mass"});
  EXPECT_THROW(faults.collect([] { throw std::logic_error("other"); }), std::logic_error);
}

TEST(Range, ContainsItsEndsUnlessTheyAreExcluded) {
  EXPECT_TRUE((Range{0.0, 1.0}).contains(0.0));
  EXPECT_TRUE((Range{0.0, 1.0}).contains(1.0));
  EXPECT_FALSE((Range{0.0, 1.0, true, false}).contains(0.0));
  EXPECT_FALSE((Range{0.0, 1.0, false, true}).contains(1.0));
  EXPECT_FALSE(Range{}.contains(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(Range{}.contains(std::numeric_limits<double>::infinity()));
}

TEST(Range, SaysItselfInWords) {
  const double kLargest = std::numeric_limits<double>::max();
  EXPECT_EQ(Range{}.text(), "finite");
  EXPECT_EQ((Range{0.0, kLargest, true}).text(), "> 0");
  EXPECT_EQ((Range{0.0, 268435455.0}).text(), ">= 0 and <= 268435455");
  EXPECT_EQ((Range{-kLargest, 0.1, false, true}).text(), "< 0.1");
}

}  // namespace
}  // namespace aras_visual_servo_common::fault_list_test
