#include "bag_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

const std::map<std::string, rosbag::CompressionType> kCompressions = {
    {"none", rosbag::compression::Uncompressed}, {"lz4", rosbag::compression::LZ4}, {"bz2", rosbag::compression::BZ2}};
const std::string kEnding = ".bag";

void check(const BagFile::Options& options) {
  const std::string& path = options.path;
  if (path.size() <= kEnding.size() || path.compare(path.size() - kEnding.size(), kEnding.size(), kEnding) != 0)
    throw ParameterError("recording: found the file '" + path + "', allowed a path that ends in .bag");
  if (path.front() != '/') throw ParameterError("recording: found the file '" + path + "', allowed an absolute path");
  if (std::filesystem::exists(path))
    throw ParameterError("recording: found the file '" + path + "', allowed one that does not exist");
  if (kCompressions.count(options.compression) == 0)
    throw ParameterError("recording: found the compression '" + options.compression + "', allowed none, lz4 or bz2");
}

}  // namespace

BagFile::BagFile(const Options& options) : options_(options) {
  check(options_);
  guarded([this] { open(); });
}

void BagFile::Closer::operator()(rosbag::Bag* bag) const {
  try {
    bag->close();
  } catch (const std::exception&) {
    return;  // the destructor would close it again, and what that throws ends the program: the bag is given up
  }
  delete bag;
}

void BagFile::close() {
  guarded([this] {
    bag_->close();
    std::filesystem::rename(path_ + ".active", path_);
  });
}

/** Errors of rosbag do not say why the system refused. */
void BagFile::guarded(const std::function<void()>& action) {
  errno = 0;
  try {
    action();
  } catch (const RecordingError&) {
    throw;
  } catch (const std::exception& error) {
    const int code = errno;
    throw RecordingError(path_ + ": " + (code != 0 ? std::strerror(code) + std::string(", ") : "") + error.what());
  }
}

void BagFile::split(const ros::Time& time) {
  if (options_.split_bytes == 0 || splitting_ || bag_->getSize() <= options_.split_bytes) return;
  close();
  ++part_;
  open();
  splitting_ = true;
  if (new_part_) new_part_(time);
  splitting_ = false;
}

void BagFile::open() {
  path_ = options_.path;
  if (options_.split_bytes > 0) path_.insert(path_.size() - kEnding.size(), "_" + std::to_string(part_));
  bag_->open(path_ + ".active", rosbag::bagmode::Write);
  bag_->setCompression(kCompressions.at(options_.compression));
}

}  // namespace aras_visual_servo_sim
