#include "aras_visual_servo_common/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "aras_visual_servo_common/errors.hpp"

namespace aras_visual_servo_common {
namespace {

/** A file descriptor that is closed at the end. */
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int operator*() const { return number_; }

 private:
  int number_;
};

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

void requireReadable(const std::string& path, const struct stat& status, std::size_t most_bytes) {
  requireRegular(path, "read", status);
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size <= most_bytes) return;
  fail(path, "read", "found " + std::to_string(size) + " bytes, allowed <= " + std::to_string(most_bytes));
}

void writeAll(int file, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = write(file, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno != EINTR) throw std::runtime_error(std::strerror(errno));
    if (count > 0) done += static_cast<std::size_t>(count);
  }
  if (fsync(file) != 0) throw std::runtime_error(std::strerror(errno));
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
  // Not to wait for somebody who writes to a pipe.
  const Descriptor file(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  struct stat status {};
  if (*file < 0 || fstat(*file, &status) != 0) fail(path, "read", std::strerror(errno));
  requireReadable(path, status, most_bytes);
  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = read(*file, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno != EINTR) fail(path, "read", std::strerror(errno));
    if (count == 0) break;  // it became shorter meanwhile
    if (count > 0) done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

void checkFile(const std::string& path, std::size_t most_bytes) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) fail(path, "read", std::strerror(errno));
  requireReadable(path, status, most_bytes);
}

void writeFile(const std::string& path, const std::string& bytes) {
  struct stat status {};
  const bool exists = stat(path.c_str(), &status) == 0;
  if (exists) requireRegular(path, "written", status);
  std::string partial = path + ".XXXXXX";
  const Descriptor file(mkostemp(partial.data(), O_CLOEXEC));
  if (*file < 0) fail(path, "written", std::strerror(errno));
  try {
    // mkostemp gives it to its owner alone, which a file that others may read is not.
    const mode_t mask = umask(0);
    umask(mask);
    fchmod(*file, exists ? status.st_mode & 0777 : 0666 & ~mask);
    writeAll(*file, bytes);
    if (std::rename(partial.c_str(), path.c_str()) != 0) throw std::runtime_error(std::strerror(errno));
  } catch (const std::runtime_error& error) {
    unlink(partial.c_str());
    fail(path, "written", error.what());
  }
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
