#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/archive.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"
#include "aras_visual_servo_sim/simulation/cameras/camera.hpp"
#include "aras_visual_servo_sim/simulation/models/models.hpp"

namespace aras_visual_servo_sim {

/** A saved state of a World: an archive that ends with its checksum. */
class StateArchive : public Archive {
 public:
  /** Makes models again as they were saved. */
  using Compose = std::function<ModelSet(const std::vector<SavedModel>&)>;

  /** Writes. */
  StateArchive() = default;
  /** Reads what take() gave. @throws StateError if it is not whole */
  explicit StateArchive(const std::string& record);
  std::string take() const;

  /** Models and lights. */
  void models(ModelSet& set, const Compose& compose);
  /** @throws StateError unless each is of a model of the set */
  void motions(std::map<std::string, MotionRun>& motions, const ModelSet& set);
  /** @throws StateError unless it is of a scene with as many models and bodies */
  void moment(Moment& moment, const Scene& scene);
  /** @param joints  of the camera's robot  @param scene  of frames without models of their own */
  void frame(ExposedFrame& frame, Eigen::Index joints, const Scene& scene, const Compose& compose);
};

void visit(Archive& archive, FramePlan::State& plan);
void visit(Archive& archive, Sensor::State& sensor);
void visit(Archive& archive, Light& light);
void visit(Archive& archive, JointCommand& command);

}  // namespace aras_visual_servo_sim
