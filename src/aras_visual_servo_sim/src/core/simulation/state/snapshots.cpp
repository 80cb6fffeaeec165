#include "aras_visual_servo_sim/simulation/state/snapshots.hpp"

#include <aras_visual_servo_common/files.hpp>
#include <filesystem>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::size_t kMostSnapshots = 1000;                // of some kilobytes each
constexpr std::size_t kMostStateBytes = 256 * 1024 * 1024;  // of a scene with the most that it may have
constexpr std::size_t kMagicBytes = 8;

/** What `action` returns, its errors as those of a state file. */
template <typename Action>
auto onFile(const Action& action) {
  try {
    return action();
  } catch (const ArasError& error) {
    throw StateError("state file " + std::string(error.what()));
  }
}

}  // namespace

std::string Snapshots::save(const std::string& name, const std::string& state) {
  std::string key = name;
  for (std::size_t k = 1; key.empty(); ++k) {
    const std::string next = "state_" + std::to_string(k);
    if (states_.count(next) == 0) key = next;
  }
  if (states_.count(key) == 0 && states_.size() >= kMostSnapshots) {
    throw StateError("snapshot '" + key + "': found " + std::to_string(states_.size()) +
                     " snapshots, allowed <= " + std::to_string(kMostSnapshots) + "; use a name that is there");
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
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored) && std::filesystem::file_size(path, ignored) > 0) {
    const std::string old = readStateFile(path);
    if (old.compare(0, kMagicBytes, state, 0, kMagicBytes) != 0) {
      throw StateError("state file '" + path + "': cannot be written: found a file that is no saved state, allowed a " +
                       "new name or that of a saved state");
    }
  }
  onFile([&] { aras_visual_servo_common::writeFile(path, state); });
}

std::string readStateFile(const std::string& path) {
  return onFile([&] { return aras_visual_servo_common::readFile(path, kMostStateBytes); });
}

}  // namespace aras_visual_servo_sim
