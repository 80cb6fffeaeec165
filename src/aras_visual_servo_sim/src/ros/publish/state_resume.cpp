// What StatePublisher sends after a restored state.
#include <map>
#include <utility>

#include "state_publisher.hpp"

namespace aras_visual_servo_sim {

std::vector<int> StatePublisher::resume() {
  const std::int64_t tick = simulation_.ticks();
  sampled_tick_ = -1;
  next_clock_ = clock_schedule_.firstIndexFrom(tick);
  next_joints_ = joint_schedule_.firstIndexFrom(tick);
  path_message_.poses.clear();
  publishClock();
  publishLate();
  publishPresentJoints(true);
  std::vector<int> taken;
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    if (simulation_.cameras()[static_cast<int>(k)].frameTaken(tick)) taken.push_back(static_cast<int>(k));
  }
  const ros::Time stamp = time_.now();
  if (!taken.empty()) publishTarget(stamp);
  for (const int camera : taken) {
    if (!simulation_.cameras()[camera].takenFrame()) {
      publishCamera(camera, stamp, simulation_.cameraPose(camera), simulation_.cameraTwist(camera));
    }
    publishImage(camera);
  }
  return taken;
}

/** What belongs to the images that are on their way, or went out just now, in the order of their stamps. */
void StatePublisher::publishLate() {
  std::multimap<std::int64_t, std::pair<int, const ExposedFrame*>> frames;
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    for (const ExposedFrame* frame : simulation_.cameras()[static_cast<int>(k)].lateFrames()) {
      frames.emplace(frame->tick(), std::make_pair(static_cast<int>(k), frame));
    }
  }
  for (const auto& [tick, entry] : frames) {
    const auto& [camera, frame] = entry;
    const ros::Time stamp = time_.at(tick * simulation_.periodNs());
    publishJoints(stamp, frame->q, frame->v, frame->efforts, true);
    publishCamera(camera, stamp, frame->present.X_WC, frame->V_WC_C);
  }
}

}  // namespace aras_visual_servo_sim
