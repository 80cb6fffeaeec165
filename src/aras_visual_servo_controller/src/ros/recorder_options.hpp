#pragma once

#include <rosbag/bag.h>

#include <aras_visual_servo_common/errors.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace aras_visual_servo_controller {

/** The command line cannot be used; the text says which word. */
class OptionError : public aras_visual_servo_common::ArasError {
 public:
  using ArasError::ArasError;
};

struct Options {
  std::string bag;                  ///< path, ends in .bag
  std::vector<std::string> topics;  ///< at least one
  rosbag::CompressionType compression = rosbag::compression::Uncompressed;
  std::uint64_t split_bytes = 0;  ///< a new bag, FILE_0.bag, FILE_1.bag ..., past this size; 0: one bag
};

/** Options of the command line, the words of `rosbag record` where it has the same. Throws OptionError. */
Options parseOptions(int argc, char** argv);

}  // namespace aras_visual_servo_controller
