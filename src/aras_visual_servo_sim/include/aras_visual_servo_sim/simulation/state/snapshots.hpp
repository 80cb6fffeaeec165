#pragma once

#include <map>
#include <string>

namespace aras_visual_servo_sim {

/** Saved states by name, in memory; and as files. */
class Snapshots {
 public:
  /** Keeps a state under a name, in place of one that has it. @param name  empty: the first free of state_1, ...
   *  @return the name */
  std::string save(const std::string& name, const std::string& state);
  /** @throws UnknownNameError naming the snapshots there are */
  const std::string& get(const std::string& name) const;

 private:
  std::map<std::string, std::string> states_;
};

/** Writes a whole file or none, in place of no other file than a saved state. Files are regular files: no folders, no
 *  pipes. @throws StateError naming the file and the reason */
void writeStateFile(const std::string& path, const std::string& state);
std::string readStateFile(const std::string& path);

}  // namespace aras_visual_servo_sim
