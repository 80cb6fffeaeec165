#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/image/image.hpp"
#include "aras_visual_servo_sim/image/sensor/sensor.hpp"
#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "aras_visual_servo_sim/render/geometry_image.hpp"
#include "aras_visual_servo_sim/simulation/cameras/exposure.hpp"
#include "aras_visual_servo_sim/simulation/cameras/frame_plan.hpp"
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

/** One camera in the course of time: which frames it takes, what its shutter has seen, which frames wait for delivery.
 *
 *  A frame is exposed at the first tick at or after index / rate. Without latency it can be taken at that tick; with
 *  latency it is kept as poses and can be taken when it is delivered, latency_s later. A frame that nobody took at its
 *  tick is missed. `now` is the present tick. */
class Camera {
 public:
  /** @param robot  number of the robot that carries it, at this link
   *  @param index  among the robot's cameras, keeps their noise and their drops apart  @param seed  of the simulation
   *  @throws ParameterError for a rate beyond that of the ticks */
  Camera(CameraModel model, int robot, int link, int index, std::uint64_t seed, std::int64_t period_ns);

  const CameraModel& model() const { return model_; }
  int robot() const { return robot_; }                  ///< its number
  std::int64_t periodNs() const { return period_ns_; }  ///< of a tick
  Pose pose(const MultibodyWorld& robot) const;         ///< X_WC
  Twist twist(const MultibodyWorld& robot) const;       ///< V_WC_C

  // --- which frames
  bool late() const { return latency_ticks_ > 0; }
  std::int64_t latencyTicks() const { return latency_ticks_; }
  /** Tick at which the next frame is exposed that was not yet, or kNeverTick. */
  std::int64_t nextExposureTick() const { return plan_.nextTick(); }
  /** Tick at which the next frame can be taken that was neither taken, missed nor dropped, or kNeverTick. */
  std::int64_t nextFrameTick() const;
  /** True if a frame can be taken now and was not taken yet. */
  bool frameDue(std::int64_t now) const { return nextFrameTick() == now; }
  /** True if a frame was taken now. */
  bool frameTaken(std::int64_t now) const;
  /** True if a frame that is neither dropped nor missed is exposed now: without latency the one that is due. */
  bool frameExposed(std::int64_t now) const {
    return late() ? !in_flight_.empty() && in_flight_.back().tick() == now : frameDue(now);
  }
  /** See FramePlan::trigger. */
  void trigger(std::int64_t now) { plan_.trigger(now); }
  std::uint64_t droppedFrames() const { return plan_.state().dropped; }

  /** Takes or misses the frame that is due, of a camera without latency. */
  void takeFrame() { unhashed_frame_ = plan_.pass(); }
  void missFrame() { plan_.pass(); }
  /** Exposes the frame of this tick, of a camera with latency. @param present  of this tick */
  void expose(Moment present, const MultibodyWorld& robot);
  /** Takes the frame that is delivered now. @return its tick */
  std::int64_t takeDelivered();
  /** The frame taken at the present tick of a camera with latency; null if there is none, or no latency. */
  const ExposedFrame* takenFrame() const { return taken_ ? &*taken_ : nullptr; }
  /** The frame taken last and those in flight of a camera with latency, oldest first; none of one without. */
  std::vector<const ExposedFrame*> lateFrames() const;
  /** To be called when time goes on: an image drawn afterwards is not that of a frame taken before. */
  void leaveTick() { unhashed_frame_ = -1; }
  /** To be called when time has reached this tick: frames that could have been taken before it are lost. */
  void passTo(std::int64_t now);
  /** To be called before a model is added or removed: frames on their way keep the models they were exposed with. */
  void keepModels(const std::shared_ptr<ModelSet>& models);
  bool hasFramesInFlight() const { return !in_flight_.empty() || taken_; }
  void loseFrames();
  /** Lets the first frame be the first of the schedule at or after this tick, of a camera that has no frame yet. */
  void beginAt(std::int64_t tick) { plan_.setState({plan_.indexFrom(tick)}); }

  // --- the shutter
  bool blurs() const { return exposure_.blurs(); }
  /** True if the next image has a sample at this tick, so that note() has to be called. This includes dropped frames
   * and frames that nobody has asked for: a trigger may come during the exposure. */
  bool samples(std::int64_t now) const { return exposure_.samples(now, plan_.tickFrom(now + 1)); }
  std::int64_t nextSampleTick(std::int64_t now) const { return exposure_.nextSample(now, plan_.tickFrom(now + 1)); }
  void note(Moment moment);
  /** To be called when something was placed elsewhere: the exposure begins anew, so that no jump is blurred. */
  void forgetPast() { exposure_.forget(); }
  /** True at the ticks of its schedule: an image drawn then is the mean over the exposure. */
  bool scheduledAt(std::int64_t now) const { return plan_.tickFrom(now) == now; }
  std::vector<Exposure::Sample> samplesOf(const Moment& present) const { return exposure_.samplesOf(present); }

  // --- the image
  Image image{};
  GeometryImage geometry{};
  /** What falls on a camera with a sensor, noise, a Bayer pattern or 16 bits a value; readOut() makes the image. */
  FineImage light{};
  bool readsOut() const;
  /** Whether light has to go through focus() before it is read out. */
  bool seesDepth() const { return sensor_ && sensor_->seesDepth(); }
  /** Spreads the light of the frame that was drawn by its depth. @pre seesDepth() */
  void focus(const GeometryImage& depth) { sensor_->focus(depth.depth_m, light); }
  /** Makes the image of the light of the frame that was drawn. @pre readsOut() */
  void readOut(std::int64_t now);
  /** Null without a section `sensor`. */
  const Sensor* sensor() const { return sensor_ ? &*sensor_ : nullptr; }
  /** Of a rolling shutter: the rows as cameras of their own; else empty. */
  const std::vector<CameraModel>& rows() const { return rows_; }
  /** True once for each frame taken, when its image is drawn. */
  bool imageIsOfNewFrame();

  // --- whole state
  struct State {
    FramePlan::State plan;
    std::int64_t unhashed_frame = -1;  ///< taken, its image not drawn yet
    std::vector<Moment> past;
    std::optional<ExposedFrame> taken;
    std::deque<ExposedFrame> in_flight;
    Sensor::State sensor{};  ///< what the camera has set by itself
  };
  State state() const;
  void restore(State state);
  /** @throws StateError  no camera of this schedule can be in this state at the tick `now` */
  void check(const State& state, std::int64_t now) const;
  /** Goes on where another camera of the same schedule is, at the tick `now`: its counters and images, the frames that
   *  are on their way as far as this latency lets them come, and what its sensor has set by itself. The exposure begins
   *  anew. */
  void continueFrom(Camera& before, std::int64_t now);

 private:
  CameraModel model_;
  int robot_, link_;
  std::int64_t period_ns_;
  std::uint64_t noise_seed_;
  FramePlan plan_;
  Exposure exposure_;
  std::int64_t latency_ticks_;
  std::deque<ExposedFrame> in_flight_;  // exposed and not delivered, oldest first
  std::optional<ExposedFrame> taken_;
  std::optional<Sensor> sensor_;
  std::vector<CameraModel> rows_;
  FineImage mosaic_;  // scratch
  std::int64_t unhashed_frame_ = -1;
};

}  // namespace aras_visual_servo_sim
