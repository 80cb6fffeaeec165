#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"
#include "aras_visual_servo_sim/simulation/cameras/camera.hpp"
#include "aras_visual_servo_sim/simulation/models/models.hpp"

namespace aras_visual_servo_sim {

/** A flat record in the byte order of this machine, its checksum last. */
class StateWriter {
 public:
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void putText(const std::string& text);
  void putVector(const Eigen::VectorXd& values);
  void putPose(const Pose& pose);
  void putMoment(const Moment& moment);
  void putModels(const std::vector<SavedModel>& models);
  void putLights(const std::vector<Light>& lights);
  void putMotions(const std::map<std::string, MotionRun>& motions);
  void putFrame(const ExposedFrame& frame);
  void putFrames(const FramesInFlight& flight);
  void putSensor(const Sensor::State& state);
  std::string take();

 private:
  std::string bytes_;
};

/** Reads a record of StateWriter. @throws StateError where the bytes are not such a record */
class StateReader {
 public:
  /** Models as they were saved, made again. */
  using Compose = std::function<ModelSet(const std::vector<SavedModel>&)>;

  /** @param bytes  outlive this object @throws StateError if the record is not whole */
  explicit StateReader(const std::string& bytes);
  template <typename T>
  T get() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, take(sizeof(T)), sizeof(T));
    return value;
  }
  std::string getText();
  /** @throws StateError unless it has this size */
  Eigen::VectorXd getVector(Eigen::Index size);
  Pose getPose();
  /** @throws StateError unless it is of a scene with as many models and bodies */
  Moment getMoment(const Scene& scene);
  std::vector<SavedModel> getModels();
  std::vector<Light> getLights();
  /** The models and lights of putModels and putLights, one after the other. */
  ModelSet getSet(const Compose& compose);
  /** @throws StateError unless each is of a model of the set */
  std::map<std::string, MotionRun> getMotions(const ModelSet& set);
  /** @param scene  of frames without models of their own */
  ExposedFrame getFrame(int joints, const Scene& scene, const Compose& compose);
  void getFrames(int joints, const Scene& scene, const Compose& compose, Camera::State& camera);
  Sensor::State getSensor();
  bool atEnd() const { return at_ == end_; }

 private:
  const char* take(std::uint64_t size);
  std::vector<Pose> getPoses(std::size_t count);
  const std::string& bytes_;
  std::size_t at_ = 0, end_ = 0;
};

}  // namespace aras_visual_servo_sim
