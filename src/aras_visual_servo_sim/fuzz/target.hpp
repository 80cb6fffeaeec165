#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim::fuzz {

/** Does what may be refused. A refusal is an ArasError that says why; any other exception ends the program, which is a
 *  finding, as is what the sanitizers see. @return whether it was done */
template <typename Do>
bool allow(const Do& act) {
  try {
    act();
    return true;
  } catch (const ArasError& error) {
    if (*error.what() == '\0') __builtin_trap();
    return false;
  }
}

/** Hands the bytes to a reader. @return 0, as libFuzzer wants it */
template <typename Read>
int offer(const std::uint8_t* bytes, std::size_t size, const Read& read) {
  allow([&] { read(std::string(reinterpret_cast<const char*>(bytes), size)); });
  return 0;
}

}  // namespace aras_visual_servo_sim::fuzz
