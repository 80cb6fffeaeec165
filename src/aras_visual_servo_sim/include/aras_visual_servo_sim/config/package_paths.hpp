#pragma once

#include <string>
#include <utility>
#include <vector>

namespace aras_visual_servo_sim {

/** Finds files named by `package://name/path`, `model://name/path`, `file://path` or a plain path.
 *
 *  Packages are looked up in the map given; then in ROS_PACKAGE_PATH, where an entry may be the package itself, a
 *  folder of packages or an install space's share folder; then in share/ of every CMAKE_PREFIX_PATH entry; then in
 *  /usr/share, where Debian's packages are. */
class PackagePaths {
 public:
  PackagePaths() = default;
  explicit PackagePaths(std::vector<std::pair<std::string, std::string>> packages) : packages_(std::move(packages)) {}

  /** @param base_dir  what relative plain paths are relative to; empty = working directory
   *  @return a path that exists
   *  @throws ModelError naming uri and where it was looked for */
  std::string resolve(const std::string& uri, const std::string& base_dir = "") const;

 private:
  std::string findPackage(const std::string& name) const;
  std::vector<std::pair<std::string, std::string>> packages_;
};

}  // namespace aras_visual_servo_sim
