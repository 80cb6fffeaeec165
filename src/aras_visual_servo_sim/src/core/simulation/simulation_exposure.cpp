// Motion blur of a Simulation's cameras: moments noted while stepping, images that are their mean.
#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/image/image_mean.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

/** What a camera sees now, as poses. @pre placeBodies(), moveModels() */
Moment Simulation::presentMoment(int camera) const {
  Moment moment{ticks(), cameraPose(camera), {}, {}};
  for (const PlanarModel& model : models_.scene.models) moment.models.push_back(model.X_WM);
  for (const Body& body : models_.scene.bodies) moment.bodies.push_back(body.X_WB);
  return moment;
}

void Simulation::showMoment(const Moment& moment, Scene& scene) {
  for (std::size_t k = 0; k < moment.models.size(); ++k) scene.models[k].X_WM = moment.models[k];
  for (std::size_t k = 0; k < moment.bodies.size(); ++k) scene.bodies[k].X_WB = moment.bodies[k];
}

/** Notes the present tick if the next image has a sample there. Of every scheduled frame, dropped or not asked for too:
 *  a trigger may come in the middle of its exposure.
 *  @return the next tick to stop at, kNever for a camera without blur */
std::int64_t Simulation::noteExposure(int index) {
  Camera& camera = cameras_[index];
  if (!camera.exposure.blurs()) return kNever;
  const std::int64_t frame_tick = camera.schedule.tickOf(camera.schedule.firstIndexFrom(ticks() + 1));
  if (camera.exposure.samples(ticks(), frame_tick)) {
    moveModels();
    placeBodies();
    camera.exposure.note(presentMoment(index), frame_tick);
  }
  return camera.exposure.nextSample(ticks(), frame_tick);
}

/** Something was put elsewhere: there is no way it came, nothing to blur along. */
void Simulation::forgetPast() {
  for (Camera& camera : cameras_) camera.exposure.forget();
}

/** The image of the present, without noise. */
void Simulation::drawPresent(int index) {
  Camera& camera = cameras_[index];
  placeBodies();
  const bool at_frame = camera.schedule.tickOf(camera.schedule.firstIndexFrom(ticks())) == ticks();
  if (!camera.exposure.blurs() || !at_frame) {
    renderer_->render(camera.model, cameraPose(index), models_.scene, camera.image);
    return;
  }
  const Moment present = presentMoment(index);
  ImageMean mean;
  try {
    for (const Exposure::Sample& sample : camera.exposure.samplesOf(present)) {
      showMoment(*sample.moment, models_.scene);
      renderer_->render(camera.model, sample.moment->X_WC, models_.scene, camera.image);
      mean.add(camera.image, sample.count);
    }
  } catch (const ArasError&) {
    showMoment(present, models_.scene);
    throw;
  }
  showMoment(present, models_.scene);
  mean.write(camera.image);
}

}  // namespace aras_visual_servo_sim
