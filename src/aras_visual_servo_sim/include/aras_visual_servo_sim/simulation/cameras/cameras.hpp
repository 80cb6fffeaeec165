#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "aras_visual_servo_sim/simulation/cameras/camera.hpp"

namespace aras_visual_servo_sim {

/** The cameras of a world, in the order in which they are configured. */
class Cameras {
 public:
  /** @param robot  of this name and number in its world  @param seed  of the simulation
   *  @throws ParameterError naming the camera: its name is taken, there is no such link, a value is out of range */
  void add(const CameraConfig& config, const RobotModel& robot, std::uint64_t seed, std::int64_t period_ns,
           const std::string& name = "", int number = 0);
  /** Adds the cameras of one more robot, whose first frames are those at or after a tick. */
  void add(Cameras others, std::int64_t tick);
  /** Removes the cameras of a robot. */
  void remove(int robot);

  const std::vector<std::string>& names() const { return names_; }
  /** @throws UnknownNameError naming the cameras there are */
  int index(const std::string& camera) const;
  std::size_t size() const { return cameras_.size(); }
  const Camera& operator[](int index) const { return cameras_[static_cast<std::size_t>(index)]; }
  Camera& operator[](int index) { return cameras_[static_cast<std::size_t>(index)]; }
  auto begin() const { return cameras_.begin(); }
  auto end() const { return cameras_.end(); }
  auto begin() { return cameras_.begin(); }
  auto end() { return cameras_.end(); }

  /** Whether some camera has latency, and the longest of them. */
  bool anyLate() const { return longest_latency_ > 0; }
  std::int64_t longestLatencyTicks() const { return longest_latency_; }
  /** Number of frames dropped so far because of drop_probability. */
  std::uint64_t droppedFrames() const;

  /** The same cameras with other settings, to take the place of these: see Simulation::setCameras. */
  Cameras with(const std::vector<CameraConfig>& configs, const RobotModel& robot, std::uint64_t seed,
               std::int64_t period_ns) const;
  /** @param next  of `with` @param now  the present tick */
  void become(Cameras next, std::int64_t now);

  /** To be called before a model is added or removed: frames in flight keep the models they were exposed with. */
  void keepModels(const ModelSet& models);
  /** To be called when a joint or model was placed elsewhere: exposures begin anew. */
  void forgetPast();
  /** To be called when a robot comes or goes: frames on their way are lost. */
  void loseFrames();
  void reset();

 private:
  void findLongestLatency();

  std::vector<std::string> names_;
  std::vector<Camera> cameras_;
  std::int64_t longest_latency_ = 0;
};

}  // namespace aras_visual_servo_sim
