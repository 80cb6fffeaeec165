#include "aras_visual_servo_sim/simulation/state/snapshots.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw StateError("state file '" + path + "': cannot be " + what + ": " + std::strerror(errno));
}

}  // namespace

std::string Snapshots::save(const std::string& name, const std::string& state) {
  std::string key = name;
  for (std::size_t k = 1; key.empty(); ++k) {
    const std::string next = "state_" + std::to_string(k);
    if (states_.count(next) == 0) key = next;
  }
  states_[key] = state;
  return key;
}

const std::string& Snapshots::get(const std::string& name) const {
  const auto found = states_.find(name);
  if (found != states_.end()) return found->second;
  std::string known;
  for (const auto& [key, state] : states_) known += (known.empty() ? "" : ", ") + key;
  throw UnknownNameError("snapshot '" + name + "' does not exist; snapshots: " + (known.empty() ? "none" : known));
}

void writeStateFile(const std::string& path, const std::string& state) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file.write(state.data(), static_cast<std::streamsize>(state.size()));
  file.close();
  if (!file) fail(path, "written");
}

std::string readStateFile(const std::string& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string state{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.is_open() || file.bad()) fail(path, "read");
  return state;
}

}  // namespace aras_visual_servo_sim
