#pragma once

#include <string>
#include <vector>

#include "aras_visual_servo_common/errors.hpp"

namespace aras_visual_servo_common {

/** Collects faults, so that the author of a configuration sees all of them at once. */
class FaultList {
 public:
  /** Adds a line; a line that is there already is not repeated. */
  void add(const std::string& line);

  /** Adds `where: found FOUND, allowed ALLOWED`. */
  void add(const std::string& where, const std::string& found, const std::string& allowed);

  /** Adds each fault of a part that was checked by itself, with a prefix before it, e.g. "sim.cameras[0].". */
  void adopt(const ParameterError& error, const std::string& prefix = "");

  /** Runs an action. If it throws one of our errors, its text is added, with the prefix before each line. */
  template <typename Action>
  void collect(Action&& action, const std::string& prefix = "") {
    try {
      action();
    } catch (const ParameterError& error) {
      adopt(error, prefix);
    } catch (const ArasError& error) {
      add(prefix + error.what());
    }
  }

  bool empty() const { return lines_.empty(); }
  const std::vector<std::string>& lines() const { return lines_; }

  /** @throws ParameterError listing all faults, if there is any */
  void throwIfAny() const;

 private:
  std::vector<std::string> lines_;
};

}  // namespace aras_visual_servo_common
