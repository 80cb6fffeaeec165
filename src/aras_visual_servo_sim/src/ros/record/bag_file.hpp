#pragma once

#include <ros/time.h>
#include <rosbag/bag.h>

#include <algorithm>
#include <boost/shared_ptr.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

/** A bag cannot be written; the text says which and why. */
class RecordingError : public ArasError {
 public:
  using ArasError::ArasError;
};

/** One bag, or the parts of a split one: FILE.bag.active until `close`. */
class BagFile {
 public:
  struct Options {
    std::string path;               ///< ends in .bag, does not exist
    std::string compression;        ///< none, lz4 or bz2
    std::uint64_t split_bytes = 0;  ///< a new bag, FILE_0.bag, FILE_1.bag ..., past this size; 0: one bag
  };

  /** @throws ParameterError naming path or compression, or if the file cannot be made, with the system's reason */
  explicit BagFile(const Options& options);
  /** Called at the beginning of every part but the first: writes what each part must hold, at the given time. */
  void onNewPart(std::function<void(const ros::Time&)> callback) { new_part_ = std::move(callback); }

  /** @param header  of the connection it came over; null: made from the type @throws RecordingError */
  template <typename Message>
  void write(const std::string& topic, const ros::Time& time, const Message& message,
             const boost::shared_ptr<ros::M_string>& header = nullptr) {
    guarded([&] {
      split(time);
      // A bag holds no time before 1 ns, and the simulated clock starts at 0.
      bag_->write(topic, std::max(time, ros::TIME_MIN), message, header);
    });
  }

  /** Writes what is left and takes the name without `.active`. @throws RecordingError */
  void close();

 private:
  struct Closer {
    void operator()(rosbag::Bag* bag) const;
  };
  void guarded(const std::function<void()>& action);
  void split(const ros::Time& time);
  void open();

  Options options_;
  std::unique_ptr<rosbag::Bag, Closer> bag_{new rosbag::Bag};
  std::string path_;
  int part_ = 0;
  bool splitting_ = false;
  std::function<void(const ros::Time&)> new_part_;
};

}  // namespace aras_visual_servo_sim
