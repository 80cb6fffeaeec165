#include <algorithm>
#include <exception>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/simulation/world.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kLarge_px = 150000;  // an image that takes long enough for another thread to begin with it

int pixelsOf(const Camera& camera) { return camera.model().width() * camera.model().height(); }

}  // namespace

/** Poses of everything that this camera can see now. */
Moment World::present(const Camera& camera) {
  models_.move(timeNs());
  models_.follow(link_poses_);
  return momentOf(ticks(), camera.pose(robotOf(robots_, camera.robot()).body()), scene());
}

void World::expose() {
  if (!cameras_.anyLate()) return;
  for (Camera& camera : cameras_) {
    if (!camera.late() || camera.nextExposureTick() != ticks()) continue;
    hashRobots();
    camera.expose(present(camera), robotOf(robots_, camera.robot()).body());
  }
}

void World::requireDue(int camera) const {
  if (cameras_[camera].frameDue(ticks())) return;
  throw ParameterError("camera '" + cameras_.names()[camera] + "': no frame is due at tick " + std::to_string(ticks()));
}

std::int64_t World::takeFrame(int index) {
  Camera& camera = cameras_[index];
  requireDue(index);
  expose();  // before anything of this tick is taken
  if (camera.late()) return clock_.ns(camera.takeDelivered());
  hashRobots();
  camera.takeFrame();
  return timeNs();
}

const Image& World::render(int index) {
  Camera& camera = cameras_[index];
  models_.follow(link_poses_);
  const Image& image = drawer_.draw(camera, ticks(), cameraPose(index), models_.scene());
  if (camera.imageIsOfNewFrame()) run_hash_.add(image.data.data(), image.data.size());
  return image;
}

const GeometryImage& World::renderGeometry(int index, Distance distance) {
  models_.follow(link_poses_);
  return drawer_.drawGeometry(cameras_[index], cameraPose(index), scene(), distance);
}

const Scene& World::shownScene(int camera) const {
  const ExposedFrame* late = cameras_[camera].takenFrame();
  return late && late->models ? late->models->scene : scene();
}

FrameState World::frameState(int index) const {
  const Camera& camera = cameras_[index];
  if (const ExposedFrame* late = camera.takenFrame()) {
    const ModelSet& set = late->models ? *late->models : models_.set();
    return {clock_.ns(late->tick()), late->q,      late->v,
            late->present.X_WC,      late->V_WC_C, modelPoses(late->present, set)};
  }
  const MultibodyWorld& body = bodyOf(index);
  return {timeNs(),          body.jointPositions(), body.jointVelocities(),
          cameraPose(index), cameraTwist(index),    models_.set().poses()};
}

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
