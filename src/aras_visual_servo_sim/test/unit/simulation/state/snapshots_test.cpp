#include "aras_visual_servo_sim/simulation/state/snapshots.hpp"

#include <gtest/gtest.h>

#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

TEST(Snapshots, AreKeptByNameAndReplaced) {
  Snapshots snapshots;
  EXPECT_EQ(snapshots.save("here", "a"), "here");
  EXPECT_EQ(snapshots.save("here", "b"), "here");
  EXPECT_EQ(snapshots.get("here"), "b");
}

TEST(Snapshots, WithoutANameGetTheNextNumber) {
  Snapshots snapshots;
  EXPECT_EQ(snapshots.save("", "a"), "state_1");
  EXPECT_EQ(snapshots.save("", "b"), "state_2");
  EXPECT_EQ(snapshots.get("state_1"), "a");
}

TEST(Snapshots, UnknownNameSaysWhichThereAre) {
  Snapshots snapshots;
  snapshots.save("here", "a");
  snapshots.save("there", "a");
  try {
    snapshots.get("moon");
    FAIL() << "was found";
  } catch (const UnknownNameError& error) {
    for (const char* word : {"moon", "here", "there"}) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  }
}

TEST(Snapshots, FilesKeepEveryByteAndBadPathsAreNamed) {
  const std::string path = testing::TempDir() + "aras_state_test";
  const std::string state("a\0b\n\r\xff", 6);
  writeStateFile(path, state);
  EXPECT_EQ(readStateFile(path), state);
  for (const std::string& bad : {path + "/below", path + "_missing/x"}) {
    EXPECT_THROW(writeStateFile(bad, state), StateError) << bad;
    EXPECT_THROW(readStateFile(bad), StateError) << bad;
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim
