#include "recorder_options.hpp"

namespace aras_visual_servo_controller {

Options parseOptions(int argc, char** argv) {
  Options options;
  bool split = false;
  std::uint64_t size_mib = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&]() -> std::string {
      if (++i >= argc) throw OptionError(word + ": the value is missing");
      return argv[i];
    };
    if (word == "-O") {
      options.bag = value();
    } else if (word == "--lz4") {
      options.compression = rosbag::compression::LZ4;
    } else if (word == "--bz2") {
      options.compression = rosbag::compression::BZ2;
    } else if (word == "--split") {
      split = true;
    } else if (word == "--size") {
      const std::string text = value();
      if (text.empty() || text.size() > 9 || text.find_first_not_of("0123456789") != std::string::npos)
        throw OptionError("--size: found '" + text + "', allowed a whole number of MiB");
      size_mib = std::stoull(text);
    } else if (word.rfind("-", 0) == 0) {
      throw OptionError(word + ": unknown, known are -O, --lz4, --bz2, --split, --size");
    } else {
      options.topics.push_back(word);
    }
  }
  const std::string ending = ".bag";
  if (options.bag.size() <= ending.size() ||
      options.bag.compare(options.bag.size() - ending.size(), ending.size(), ending) != 0)
    throw OptionError("-O: found '" + options.bag + "', allowed a path that ends in .bag");
  if (options.topics.empty()) throw OptionError("no topic is named");
  if (split != (size_mib > 0)) throw OptionError("--split needs --size MIB > 0, and the other way round");
  options.split_bytes = size_mib << 20;
  return options;
}

}  // namespace aras_visual_servo_controller
