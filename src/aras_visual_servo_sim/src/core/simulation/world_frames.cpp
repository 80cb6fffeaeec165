#include <algorithm>
#include <exception>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/simulation/world.hpp"

namespace aras_visual_servo_sim {
namespace {

int pixelsOf(const Camera& camera) { return camera.model().width() * camera.model().height(); }

}  // namespace

void World::takeFrames(std::vector<FrameWanted>& frames) {
  for (const FrameWanted& frame : frames) requireDue(frame.camera);
  expose();
  for (const FrameWanted& frame : frames) {
    Camera& camera = cameras_[frame.camera];
    camera.late() ? static_cast<void>(camera.takeDelivered()) : camera.takeFrame();
  }
  draw(frames);
  for (FrameWanted& frame : frames) {
    Camera& camera = cameras_[frame.camera];
    if (!camera.late()) hashRobots();
    if (!frame.image || frame.failed || !camera.imageIsOfNewFrame()) continue;
    run_hash_.add(camera.image.data.data(), camera.image.data.size());
  }
}

/** Draws what is wanted. A blurred image moves the scene while it is drawn: such are drawn first, one by one. */
void World::draw(std::vector<FrameWanted>& frames) {
  models_.follow(link_poses_);
  std::vector<DrawingThreads::Task> together;
  std::vector<FrameWanted*> of_task;
  for (FrameWanted& frame : frames) {
    Camera& camera = cameras_[frame.camera];
    const int index = frame.camera;
    const auto drawImage = [this, &camera, index](FrameDrawer& drawer) {
      drawer.draw(camera, ticks(), cameraPose(index), models_.scene());
    };
    const auto drawGeometry = [this, &camera, index](FrameDrawer& drawer) {
      drawer.drawGeometry(camera, cameraPose(index), scene(), Distance::kDepth);
    };
    const bool alone = pixelsOf(camera) < kLarge_px || (camera.blurs() && !camera.late());
    for (const auto& [wanted, task] : {std::pair<bool, DrawingThreads::Task>(frame.image, drawImage),
                                       std::pair<bool, DrawingThreads::Task>(frame.geometry, drawGeometry)}) {
      if (!wanted) continue;
      if (!alone) {
        together.push_back(task);
        of_task.push_back(&frame);
        continue;
      }
      try {
        task(drawer_);
      } catch (const ArasError&) {
        if (!frame.failed) frame.failed = std::current_exception();
      }
    }
  }
  const std::vector<std::exception_ptr> thrown = threads_.run(together, drawer_);
  for (std::size_t k = 0; k < thrown.size(); ++k) {
    if (thrown[k] && !of_task[k]->failed) of_task[k]->failed = thrown[k];
  }
}

}  // namespace aras_visual_servo_sim
