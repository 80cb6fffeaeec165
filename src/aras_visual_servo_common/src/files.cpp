#include "aras_visual_servo_common/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>

#include "aras_visual_servo_common/errors.hpp"

namespace aras_visual_servo_common {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what, const std::string& why) {
  throw ArasError("'" + path + "': cannot be " + what + ": " + why);
}

std::string kindOf(const struct stat& status) {
  if (S_ISDIR(status.st_mode)) return "a folder";
  if (S_ISFIFO(status.st_mode)) return "a pipe";
  return "a device or socket";
}

void requireRegular(const std::string& path, const std::string& what, const struct stat& status) {
  if (!S_ISREG(status.st_mode)) fail(path, what, "found " + kindOf(status) + ", allowed a regular file");
}

/** Returns the size of a regular file that is not too big. */
std::size_t sizeOf(const std::string& path, std::size_t most_bytes) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) fail(path, "read", std::strerror(errno));
  requireRegular(path, "read", status);
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size <= most_bytes) return size;
  fail(path, "read", "found " + std::to_string(size) + " bytes, allowed <= " + std::to_string(most_bytes));
}

/** yaml-cpp does not say that it stumbled over a tab, which YAML does not allow in an indentation. */
std::string tabHint(const std::string& text, const YAML::Mark& mark) {
  std::istringstream lines(text);
  std::string line;
  for (int k = 0; k <= mark.line && std::getline(lines, line); ++k) {
    const std::size_t tab = line.find('\t');
    if (tab != std::string::npos && tab < line.find_first_not_of(" \t"))
      return "; line " + std::to_string(k + 1) + " is indented by a tab, allowed spaces";
  }
  return "";
}

/** Counts what a node holds. @throws ArasError when it is too much or too deep */
void count(const YAML::Node& node, int depth, std::size_t& values) {
  if (!node.IsScalar() && depth > kMostNested) {
    throw ArasError("found maps and lists more than " + std::to_string(kMostNested) +
                    " deep, allowed <= " + std::to_string(kMostNested));
  }
  if (++values > kMostValues) {
    throw ArasError("found more than " + std::to_string(kMostValues) +
                    " values, allowed <= " + std::to_string(kMostValues));
  }
  if (node.IsSequence()) {
    for (const YAML::Node& each : node) count(each, depth + 1, values);
  } else if (node.IsMap()) {
    for (const auto& each : node) {
      count(each.first, depth + 1, values);
      count(each.second, depth + 1, values);
    }
  }
}

}  // namespace

std::string readFile(const std::string& path, std::size_t most_bytes) {
  std::string bytes(sizeOf(path, most_bytes), '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(path, "read", std::strerror(errno));
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));  // it may have become shorter meanwhile
  return bytes;
}

void checkFile(const std::string& path, std::size_t most_bytes) { sizeOf(path, most_bytes); }

void writeFile(const std::string& path, const std::string& bytes) {
  struct stat status {};
  const bool exists = stat(path.c_str(), &status) == 0;
  if (exists) requireRegular(path, "written", status);
  std::string partial = path + ".XXXXXX";
  const int number = mkostemp(partial.data(), O_CLOEXEC);
  if (number < 0) fail(path, "written", std::strerror(errno));
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(fdopen(number, "wb"), std::fclose);
  // mkostemp gives it to its owner alone, which a file that others may read is not.
  const mode_t mask = umask(0);
  umask(mask);
  fchmod(number, exists ? status.st_mode & 0777 : 0666 & ~mask);
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
  if (written && std::fflush(file.get()) == 0 && fsync(number) == 0 && std::rename(partial.c_str(), path.c_str()) == 0)
    return;
  const std::string why = std::strerror(errno);
  unlink(partial.c_str());
  fail(path, "written", why);
}

YAML::Node parseYaml(const std::string& text, std::size_t most_bytes) {
  if (text.size() > most_bytes) {
    throw ArasError("found " + std::to_string(text.size()) +
                    " bytes of YAML, allowed <= " + std::to_string(most_bytes));
  }
  try {
    const YAML::Node node = YAML::Load(text);
    std::size_t values = 0;
    count(node, 1, values);
    return node;
  } catch (const YAML::Exception& error) {
    throw ArasError(error.what() + tabHint(text, error.mark));
  }
}

}  // namespace aras_visual_servo_common
