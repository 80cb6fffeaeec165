// Latency of a Simulation's cameras: frames that were exposed and are delivered later. Drawn when they are looked at.
#include "aras_visual_servo_sim/image/image_mean.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

bool Simulation::frameExposed(int camera) const {
  const FramesInFlight& flight = cameras_[camera].flight;
  return flight.late() ? flight.exposedAt(ticks()) : frameDue(camera);
}

void Simulation::expose() {
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    Camera& camera = cameras_[k];
    const int index = static_cast<int>(k);
    if (!camera.flight.late() || nextExposureTick(index) != ticks()) continue;
    moveModels();
    placeBodies();
    ExposedFrame frame;
    frame.index = nextFrame(camera);
    frame.q = world_->jointPositions();
    frame.v = world_->jointVelocities();
    frame.efforts = world_->jointEfforts();
    frame.V_WC_C = cameraTwist(index);
    frame.present = presentMoment(index);
    if (camera.exposure.blurs()) {
      for (const Exposure::Sample& sample : camera.exposure.samplesOf(frame.present)) {
        frame.samples.emplace_back(*sample.moment, sample.count);
      }
    }
    passFrame(camera);
    camera.flight.expose(std::move(frame));
  }
}

void Simulation::passFramesInFlight() {
  for (Camera& camera : cameras_) camera.flight.passTo(ticks());
}

std::vector<const ExposedFrame*> Simulation::lateFrames(int camera) const {
  const FramesInFlight& flight = cameras_[camera].flight;
  std::vector<const ExposedFrame*> frames;
  if (flight.taken()) frames.push_back(flight.taken());
  for (const ExposedFrame& frame : flight.inFlight()) frames.push_back(&frame);
  return frames;
}

/** Before models come or go. */
void Simulation::keepSeenModels() {
  std::shared_ptr<ModelSet> kept;
  for (Camera& camera : cameras_) {
    if (camera.flight.empty()) continue;
    if (!kept) kept = std::make_shared<ModelSet>(models_);
    camera.flight.keepModels(kept);
  }
}

const Scene& Simulation::shownScene(int camera) const {
  const ExposedFrame* frame = takenFrame(camera);
  return frame && frame->models ? frame->models->scene : models_.scene;
}

std::map<std::string, Pose> Simulation::shownModels(int camera) const {
  const ExposedFrame* frame = takenFrame(camera);
  const ModelSet& set = frame && frame->models ? *frame->models : models_;
  std::map<std::string, Pose> poses;
  for (std::size_t k = 0; k < set.scene.models.size(); ++k) {
    const PlanarModel& model = set.scene.models[k];
    poses[model.name()] = frame ? frame->present.models[k] : model.X_WM;
  }
  for (std::size_t k = 0; k < set.body_links.size(); ++k) {
    if (set.body_links[k] >= 0) continue;
    const Body& body = set.scene.bodies[k];
    poses[body.name] = frame ? frame->present.bodies[k] : body.X_WB;
  }
  return poses;
}

/** The image of a frame exposed before, without noise. */
void Simulation::drawFrame(Camera& camera, const ExposedFrame& frame) {
  Scene scene = frame.models ? frame.models->scene : models_.scene;
  const auto draw = [&](const Moment& moment) {
    showMoment(moment, scene);
    renderer_->render(camera.model, moment.X_WC, scene, camera.image);
  };
  if (frame.samples.empty()) return draw(frame.present);
  ImageMean mean;
  for (const auto& [moment, count] : frame.samples) {
    draw(moment);
    mean.add(camera.image, count);
  }
  mean.write(camera.image);
}

const GeometryImage& Simulation::renderGeometry(int index, Distance distance) {
  Camera& camera = cameras_[index];
  const ExposedFrame* late = camera.flight.taken();
  if (!late) {
    placeBodies();
    geometry_renderer_.render(camera.model, cameraPose(index), models_.scene, camera.geometry, distance);
    return camera.geometry;
  }
  Scene scene = shownScene(index);
  showMoment(late->present, scene);
  geometry_renderer_.render(camera.model, late->present.X_WC, scene, camera.geometry, distance);
  return camera.geometry;
}

}  // namespace aras_visual_servo_sim
