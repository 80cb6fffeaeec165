#include "aras_visual_servo_common/files.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "aras_visual_servo_common/errors.hpp"

namespace aras_visual_servo_common::files_test {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "aras_files_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t count() const { return std::distance(fs::directory_iterator(folder_), {}); }

  fs::path folder_;
};

template <typename Action>
std::string errorOf(const Action& action) {
  try {
    action();
  } catch (const ArasError& error) {
    return error.what();
  }
  return "no error";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST_F(Files, AreReadAsTheyWereWrittenAndNothingElseIsLeft) {
  const std::string bytes("a\0b\n", 4);
  writeFile(path("file"), "longer, and gone afterwards");
  writeFile(path("file"), bytes);
  EXPECT_EQ(readFile(path("file"), 4), bytes);
  EXPECT_EQ(count(), 1u);
}

TEST_F(Files, KeepTheirRightsAndGetThoseOfTheProcess) {
  writeFile(path("file"), "1");
  struct stat status {};
  stat(path("file").c_str(), &status);
  const mode_t mask = umask(0);
  umask(mask);
  EXPECT_EQ(status.st_mode & 0777, 0666 & ~mask);
  chmod(path("file").c_str(), 0640);
  writeFile(path("file"), "2");
  stat(path("file").c_str(), &status);
  EXPECT_EQ(status.st_mode & 0777, mode_t{0640});
}

TEST_F(Files, OfOtherKindsAreRefusedWithoutWaiting) {
  mkfifo(path("pipe").c_str(), 0600);
  for (const auto& [name, kind] :
       {std::pair{path("pipe"), "a pipe"}, {path(""), "a folder"}, {std::string("/dev/zero"), "a device or socket"}}) {
    const std::string allowed = std::string("found ") + kind + ", allowed a regular file";
    EXPECT_TRUE(contains(errorOf([&, name = name] { readFile(name, 10); }), allowed)) << name;
    EXPECT_TRUE(contains(errorOf([&, name = name] { checkFile(name, 10); }), allowed)) << name;
    EXPECT_TRUE(contains(errorOf([&, name = name] { writeFile(name, ""); }), allowed)) << name;
  }
}

TEST_F(Files, ThatAreMissingOrTooBigAreNamed) {
  EXPECT_EQ(errorOf([&] { readFile(path("none"), 10); }),
            "'" + path("none") + "': cannot be read: No such file or directory");
  EXPECT_EQ(errorOf([&] { checkFile(path("none"), 10); }),
            "'" + path("none") + "': cannot be read: No such file or directory");
  EXPECT_EQ(errorOf([&] { writeFile(path("none/file"), ""); }),
            "'" + path("none/file") + "': cannot be written: No such file or directory");
  writeFile(path("file"), "12345");
  EXPECT_TRUE(contains(errorOf([&] { readFile(path("file"), 4); }), "found 5 bytes, allowed <= 4"));
  EXPECT_TRUE(contains(errorOf([&] { checkFile(path("file"), 4); }), "found 5 bytes, allowed <= 4"));
  EXPECT_EQ(errorOf([&] { checkFile(path("file"), 5); }), "no error");
}

TEST_F(Files, StayWhatTheyWereWhenTheDiskIsFull) {
  writeFile(path("file"), "old");
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old_limit{};
  getrlimit(RLIMIT_FSIZE, &old_limit);
  const rlimit limit{1000, old_limit.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limit);  // files of a full disk grow no more
  const std::string error = errorOf([&] { writeFile(path("file"), std::string(2000, 'x')); });
  setrlimit(RLIMIT_FSIZE, &old_limit);
  std::signal(SIGXFSZ, before);
  EXPECT_TRUE(contains(error, "cannot be written: File too large")) << error;
  EXPECT_EQ(readFile(path("file"), 10), "old");
  EXPECT_EQ(count(), 1u);
}

TEST(Yaml, IsReadWithinItsBounds) {
  EXPECT_EQ(parseYaml("{a: [1, 2]}", 100)["a"][1].as<int>(), 2);
  EXPECT_TRUE(contains(errorOf([] { parseYaml("[1, 2, 3]", 8); }), "found 9 bytes of YAML, allowed <= 8"));
  EXPECT_TRUE(contains(errorOf([] { parseYaml("[1, 2", 100); }), "line 1"));
}

TEST(Yaml, ThatIsTooDeepOrHoldsItselfIsRefused) {
  const std::string deepest = std::string(kMostNested, '[') + "1" + std::string(kMostNested, ']');
  EXPECT_EQ(errorOf([&] { parseYaml(deepest, kMostFileYaml); }), "no error");
  for (const int depth : {kMostNested + 1, 1000, 50000}) {
    const std::string text = std::string(depth, '[') + std::string(depth, ']');
    EXPECT_NE(errorOf([&] { parseYaml(text, kMostFileYaml); }), "no error") << depth;
  }
  EXPECT_TRUE(contains(errorOf([] { parseYaml("a: &a [*a]", 100); }), "deep, allowed <= 64"));
  std::string bomb = "a0: &a0 [1, 1]\n";
  for (int k = 1; k < 40; ++k) {
    const std::string before = "*a" + std::to_string(k - 1), name = "a" + std::to_string(k);
    bomb += name + ": &" + name + " [" + before + ", " + before + "]\n";
  }
  EXPECT_TRUE(contains(errorOf([&] { parseYaml(bomb, kMostFileYaml); }), "values, allowed <= 500000"));
}

}  // namespace
}  // namespace aras_visual_servo_common::files_test
