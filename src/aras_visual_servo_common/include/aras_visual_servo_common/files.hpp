#pragma once

#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <string>

namespace aras_visual_servo_common {

/** Most bytes of a text in YAML: yaml-cpp needs some 8 microseconds and 400 bytes for each number of it. */
constexpr std::size_t kMostFileYaml = 4 * 1024 * 1024;  ///< of a file, read once at the start
constexpr std::size_t kMostSentYaml = 128 * 1024;       ///< of a text that is sent while others wait for an answer
constexpr int kMostNested = 64;                         ///< maps and lists within each other
constexpr std::size_t kMostValues = 500000;             ///< in a text, those counted that its aliases stand for

/** Bytes of a regular file; a folder, pipe or device, which may never end, is refused.
 *  @throws ArasError naming the file, what was found and what is allowed */
std::string readFile(const std::string& path, std::size_t most_bytes);

/** For who reads the file with a library that takes its name. @throws ArasError as readFile does */
void checkFile(const std::string& path, std::size_t most_bytes);

/** Writes a whole file or none: a new one beside it, which then takes its name. Only a regular file is replaced.
 *  @throws ArasError naming the file and the system's reason */
void writeFile(const std::string& path, const std::string& bytes);

/** Reads a text in YAML that is not too long, not too deep, and does not hold itself.
 *  @throws ArasError saying what was found and what is allowed */
YAML::Node parseYaml(const std::string& text, std::size_t most_bytes);

}  // namespace aras_visual_servo_common
