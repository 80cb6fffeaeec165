#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"
#include "aras_visual_servo_sim/simulation/models/model_set.hpp"

namespace aras_visual_servo_sim {

/** Poses, at one tick, of everything that a camera can see. */
struct Moment {
  std::int64_t tick = 0;
  Pose X_WC;
  std::vector<Pose> models;  ///< X_WM, in the order of the scene
  std::vector<Pose> bodies;  ///< X_WB, in the order of the scene
  std::vector<Pose> lights;  ///< X_WA of what carries them, of the attached ones in the order of the scene
};

/** @param scene  as it is at this tick */
Moment momentOf(std::int64_t tick, const Pose& X_WC, const Scene& scene);

/** Puts everything in the scene where it was. */
void show(const Moment& moment, Scene& scene);

/** X_WM by name of the models of a set as they were. */
std::map<std::string, Pose> modelPoses(const Moment& moment, const ModelSet& set);

/** The shutter of a camera: the ticks over which one image is averaged, and where everything was at these ticks.
 *
 *  The exposure ends at the tick T of the frame. It is cut into `samples` equal parts, each of them stands for its
 * middle: sample j is taken at T - (j + 1/2) exposure / samples, at the nearest tick, of two equally near ones the
 * later. The caller notes the moments; samples from before the first noted moment count for that one. */
class Exposure {
 public:
  /** A shutter that is open for an instant only: images are sharp. */
  Exposure() = default;
  /** @param exposure_s  >= 0, 0 as above [s]  @param samples  >= 1  @param period_ns  of a tick, > 0 [ns] */
  Exposure(double exposure_s, int samples, std::int64_t period_ns);
  /** Of a rolling shutter: every tick of the time in which some row is exposed. @param all_s  that time, > 0 [s] */
  static Exposure ofRows(double all_s, std::int64_t period_ns);

  /** False if every image is that of one moment. */
  bool blurs() const { return !ages_.empty(); }
  /** True if the image of a frame at frame_tick has a sample at `tick`. */
  bool samples(std::int64_t tick, std::int64_t frame_tick) const;
  /** The first tick after `tick` that the image of a frame at frame_tick > tick has a sample at, or frame_tick. */
  std::int64_t nextSample(std::int64_t tick, std::int64_t frame_tick) const;

  /** Keeps a moment, later than those before, for the frame at frame_tick; drops those that are too old for it. */
  void note(Moment moment, std::int64_t frame_tick);
  void forget() { past_.clear(); }
  const std::vector<Moment>& past() const { return past_; }
  void setPast(std::vector<Moment> past) { past_ = std::move(past); }

  /** A moment and how many samples fall to it. */
  struct Sample {
    const Moment* moment;
    std::uint32_t count;
  };
  /** The moments over which the image of a frame at present.tick is averaged, in the order of time. @pre blurs()
   *  @return pointers into past() and to `present`; the counts sum up to the number of samples */
  std::vector<Sample> samplesOf(const Moment& present) const;

 private:
  std::vector<std::int64_t> ages_;  ///< of the samples, in ticks before the frame's, oldest first
  std::vector<Moment> past_;
};

}  // namespace aras_visual_servo_sim
