#include "aras_visual_servo_sim/simulation/state/snapshots.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim::snapshots_test {
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

TEST(Snapshots, AFileThatIsNoSavedStateIsNotReplacedAndAPipeIsNotWaitedFor) {
  const std::string path = testing::TempDir() + "aras_state_of_others";
  const std::string mine = "ARASIM02 and so on";
  std::ofstream(path) << "the thesis of somebody";
  EXPECT_THROW(writeStateFile(path, mine), StateError);
  std::string kept;
  std::getline(std::ifstream(path), kept);
  EXPECT_EQ(kept, "the thesis of somebody");
  std::ofstream(path, std::ios::trunc) << "ARASIM02 of before";
  writeStateFile(path, mine);
  EXPECT_EQ(readStateFile(path), mine);
  std::remove(path.c_str());
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_THROW(readStateFile(path), StateError);
  EXPECT_THROW(writeStateFile(path, mine), StateError);
  std::remove(path.c_str());
}

TEST(Snapshots, AreNotKeptWithoutEnd) {
  Snapshots snapshots;
  for (int k = 0; k < 1000; ++k) snapshots.save("", "a");
  EXPECT_THROW(snapshots.save("", "a"), StateError);
  EXPECT_EQ(snapshots.save("state_7", "b"), "state_7");
}

}  // namespace
}  // namespace aras_visual_servo_sim::snapshots_test
