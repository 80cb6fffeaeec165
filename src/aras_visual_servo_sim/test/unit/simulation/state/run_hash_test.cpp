#include "aras_visual_servo_sim/simulation/state/run_hash.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace aras_visual_servo_sim::run_hash_test {
namespace {

std::string hashOf(const std::vector<std::string>& records) {
  RunHash hash;
  for (const std::string& record : records) hash.add(record.data(), record.size());
  return hash.hex();
}

TEST(RunHash, EveryByteOfEveryLengthMatters) {
  std::set<std::string> seen;
  int cases = 0;
  for (std::size_t size = 1; size < 100; ++size) {
    for (std::size_t at = 0; at < size; ++at) {
      std::string record(size, 'a');
      record[at] = 'b';
      seen.insert(hashOf({record}));
      ++cases;
    }
  }
  EXPECT_EQ(static_cast<int>(seen.size()), cases);
}

TEST(RunHash, RecordsDoNotRunIntoEachOther) {
  EXPECT_NE(hashOf({"ab", "c"}), hashOf({"a", "bc"}));
  EXPECT_NE(hashOf({"ab", "c"}), hashOf({"c", "ab"}));
  EXPECT_NE(hashOf({"a"}), hashOf({"a", ""}));
}

TEST(RunHash, StateCarriesEverything) {
  RunHash first;
  first.add("before", 6);
  RunHash second;
  second.setState(first.state());
  first.add("after", 5);
  second.add("after", 5);
  EXPECT_EQ(first.hex(), second.hex());
}

}  // namespace
}  // namespace aras_visual_servo_sim::run_hash_test
