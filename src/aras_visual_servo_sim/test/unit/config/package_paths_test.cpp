// Where package:// and model:// are looked for, and what is said when nothing is there.
#include "aras_visual_servo_sim/config/package_paths.hpp"

#include <cstdlib>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/folder_fixture.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::package_paths_test {
namespace {

/** A variable of the environment that has its old value afterwards. */
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name), known_(std::getenv(name) != nullptr) {
    if (known_) before_ = std::getenv(name);
    setenv(name, value.c_str(), 1);
  }
  ~Variable() { known_ ? setenv(name_, before_.c_str(), 1) : unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  bool known_;
  std::string before_;
};

class Paths : public testing::FolderFixture {
 protected:
  void SetUp() override {
    FolderFixture::SetUp();
    for (const char* folder : {"models/ball", "ws/ball", "prefix/share/arm", "ws/trap"}) {
      std::filesystem::create_directories(path(folder));
    }
    for (const char* file : {"models/ball/a.dae", "ws/ball/package.xml", "ws/ball/a.dae",
                             "prefix/share/arm/package.xml", "prefix/share/arm/a.dae"}) {
      write(file, "");
    }
  }
};

TEST_F(Paths, AModelOfGazeboComesBeforeAPackageOfItsName) {
  const Variable packages("ROS_PACKAGE_PATH", path("ws")), none("GAZEBO_MODEL_PATH", "");
  EXPECT_EQ(PackagePaths().resolve("model://ball/a.dae"), path("ws/ball/a.dae"));
  const Variable models("GAZEBO_MODEL_PATH", "/nowhere::" + path("models"));
  EXPECT_EQ(PackagePaths().resolve("model://ball/a.dae"), path("models/ball/a.dae"));
}

TEST_F(Paths, APackageIsAFolderWithAPackageXml) {
  const Variable packages("ROS_PACKAGE_PATH", path("ws") + ":" + path("ws/trap") + ":" + path("ws/ball/"));
  const Variable prefixes("CMAKE_PREFIX_PATH", path("ws") + ":" + path("prefix"));
  EXPECT_EQ(PackagePaths().resolve("package://ball/a.dae"), path("ws/ball/a.dae"));
  EXPECT_EQ(PackagePaths().resolve("package://arm/a.dae"), path("prefix/share/arm/a.dae"));
  EXPECT_EQ(messageOf<ModelError>([] { PackagePaths().resolve("package://trap/a.dae"); }),
            "file 'package://trap/a.dae': package 'trap' not found in package_paths, ROS_PACKAGE_PATH, "
            "CMAKE_PREFIX_PATH or /usr/share");
}

TEST_F(Paths, AModelThatIsNowhereIsNamed) {
  const Variable models("GAZEBO_MODEL_PATH", path("models"));
  EXPECT_EQ(messageOf<ModelError>([] { PackagePaths().resolve("model://moon"); }),
            "file 'model://moon': model 'moon' not found in GAZEBO_MODEL_PATH, nor as a package in package_paths, "
            "ROS_PACKAGE_PATH, CMAKE_PREFIX_PATH or /usr/share");
}

TEST_F(Paths, AFileThatIsMissingIsToldWhereItShouldBe) {
  const PackagePaths packages({{"other", path("models")}, {"ball", path("ws/ball")}});
  EXPECT_EQ(messageOf<ModelError>([&] { packages.resolve("package://ball/b.dae"); }),
            "file 'package://ball/b.dae': not found at " + path("ws/ball/b.dae"));
  EXPECT_EQ(messageOf<ModelError>([&] { packages.resolve("b.dae"); }), "file 'b.dae': not found");
  EXPECT_HAS(messageOf<ModelError>([&] { packages.resolve("", path("ws")); }), "file '': not found");
}

}  // namespace
}  // namespace aras_visual_servo_sim::package_paths_test
