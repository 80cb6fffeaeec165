#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/simulation/cameras/exposure.hpp"
#include "aras_visual_servo_sim/simulation/models/model_set.hpp"
#include "aras_visual_servo_sim/simulation/time/clock.hpp"

namespace aras_visual_servo_sim {

/** Everything about the instant at which a frame was exposed, so that it can be drawn, and its truth told, later. */
struct ExposedFrame {
  std::int64_t index = 0;                                 ///< of the camera's schedule
  Eigen::VectorXd q, v, efforts;                          ///< of the joints, sorted by name
  Twist V_WC_C = Twist::Zero();                           ///< of the camera
  Moment present;                                         ///< where everything was at the end of the exposure
  std::vector<std::pair<Moment, std::uint32_t>> samples;  ///< what a blurred image is the mean of; none: a sharp one
  std::shared_ptr<ModelSet> models;  ///< those of that time if models were added or removed since; else null

  std::int64_t tick() const { return present.tick; }
};

/** Frames of a camera with latency between exposure and delivery, oldest first.
 *
 *  Frame exposed at tick F is delivered at tick F + latency. It can be taken at that tick only; afterwards it is lost,
 * as a frame of a camera without latency is that nobody took. */
class FramesInFlight {
 public:
  /** For a camera without latency, which never has a frame in flight. */
  FramesInFlight() = default;
  /** @param latency_s  >= 0, rounded up to whole ticks [s]  @param period_ns  of a tick, > 0 [ns] */
  FramesInFlight(double latency_s, std::int64_t period_ns);

  std::int64_t latencyTicks() const { return latency_; }
  bool late() const { return latency_ > 0; }
  /** Tick at which the oldest frame in flight is delivered, or kNeverTick. */
  std::int64_t nextDelivery() const;
  /** True if the newest frame in flight was exposed at this tick. */
  bool exposedAt(std::int64_t tick) const { return !frames_.empty() && frames_.back().tick() == tick; }

  void expose(ExposedFrame frame) { frames_.push_back(std::move(frame)); }
  /** Takes the oldest frame. @pre there is one */
  const ExposedFrame& take();
  /** To be called when time has reached this tick: forgets frames that were taken, or could have been, before it. */
  void passTo(std::int64_t tick);

  /** The frame that was taken at the present tick, or null. */
  const ExposedFrame* taken() const { return taken_ ? &*taken_ : nullptr; }
  const std::deque<ExposedFrame>& inFlight() const { return frames_; }

  /** To be called before a model is added or removed: frames in flight keep the models they were exposed with. */
  void keepModels(const std::shared_ptr<ModelSet>& models);
  bool empty() const { return frames_.empty() && !taken_; }
  void clear();
  void restore(std::optional<ExposedFrame> taken, std::deque<ExposedFrame> frames);

 private:
  std::int64_t latency_ = 0;
  std::deque<ExposedFrame> frames_;
  std::optional<ExposedFrame> taken_;
};

}  // namespace aras_visual_servo_sim
