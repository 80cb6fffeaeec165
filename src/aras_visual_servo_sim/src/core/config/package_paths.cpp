#include "aras_visual_servo_sim/config/package_paths.hpp"

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> pathList(const char* variable) {
  std::vector<std::string> entries;
  const char* value = std::getenv(variable);
  std::istringstream stream(value ? value : "");
  for (std::string entry; std::getline(stream, entry, ':');) {
    if (!entry.empty()) entries.push_back(entry);
  }
  return entries;
}

bool startsWith(const std::string& text, const std::string& start) { return text.compare(0, start.size(), start) == 0; }

bool isPackage(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / "package.xml", ignored);
}

/** Folder of one of Gazebo's models; "" if there is none. */
std::string findModel(const std::string& name) {
  for (const std::string& entry : pathList("GAZEBO_MODEL_PATH")) {
    std::error_code ignored;
    if (fs::is_directory(fs::path(entry) / name, ignored)) return (fs::path(entry) / name).string();
  }
  return "";
}

}  // namespace

std::string PackagePaths::findPackage(const std::string& name) const {
  for (const auto& [package, path] : packages_) {
    if (package == name) return path;
  }
  for (const std::string& entry : pathList("ROS_PACKAGE_PATH")) {
    const fs::path folder = fs::path(entry).lexically_normal();
    const fs::path last = folder.has_filename() ? folder.filename() : folder.parent_path().filename();
    if (last == name && isPackage(folder)) return folder.string();
    if (isPackage(folder / name)) return (folder / name).string();
  }
  for (const std::string& entry : pathList("CMAKE_PREFIX_PATH")) {
    const fs::path folder = fs::path(entry) / "share" / name;
    if (isPackage(folder)) return folder.string();
  }
  const fs::path debian = fs::path("/usr/share") / name;  // where rospack looks last, too
  return isPackage(debian) ? debian.string() : "";
}

std::string PackagePaths::resolve(const std::string& uri, const std::string& base_dir) const {
  const std::string package_scheme = "package://", model_scheme = "model://", file_scheme = "file://";
  const bool is_model = startsWith(uri, model_scheme);
  fs::path path;
  if (is_model || startsWith(uri, package_scheme)) {
    const std::string rest = uri.substr((is_model ? model_scheme : package_scheme).size());
    const std::string name = rest.substr(0, rest.find('/'));
    std::string folder = is_model ? findModel(name) : "";
    if (folder.empty()) folder = findPackage(name);
    if (folder.empty()) {
      throw ModelError("file '" + uri + "': " + (is_model ? "model '" : "package '") + name + "' not found in " +
                       (is_model ? "GAZEBO_MODEL_PATH, nor as a package in " : "") +
                       "package_paths, ROS_PACKAGE_PATH, CMAKE_PREFIX_PATH or /usr/share");
    }
    path = fs::path(folder) / rest.substr(std::min(rest.size(), name.size() + 1));
  } else {
    path = startsWith(uri, file_scheme) ? uri.substr(file_scheme.size()) : uri;
    if (path.is_relative() && !base_dir.empty()) path = fs::path(base_dir) / path;
  }
  std::error_code ignored;
  if (uri.empty() || !fs::exists(path, ignored)) {
    throw ModelError("file '" + uri + "': not found" + (path == uri ? "" : " at " + path.string()));
  }
  return path.string();
}

}  // namespace aras_visual_servo_sim
