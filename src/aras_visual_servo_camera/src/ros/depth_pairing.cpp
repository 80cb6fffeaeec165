#include "depth_pairing.hpp"

#include <algorithm>

namespace aras_visual_servo_camera {
namespace {

constexpr std::size_t kKept = 32;  // depth images whose images have not come

}  // namespace

std::deque<DepthPairing::Image>::const_iterator DepthPairing::depthOf(const Waiting& waiting) const {
  return std::find_if(depths_.begin(), depths_.end(),
                      [&](const Image& depth) { return depth->header.stamp == waiting.image->header.stamp; });
}

bool DepthPairing::isOverdue(Clock::time_point now) const {
  return !coming_ || now - waiting_.front().since > kPatience ||
         std::any_of(waiting_.begin() + 1, waiting_.end(),
                     [&](const Waiting& later) { return depthOf(later) != depths_.end(); });
}

void DepthPairing::addImage(const Image& image, const Info& info, Clock::time_point now) {
  waiting_.push_back({image, info, now});
  look(now);
}

void DepthPairing::addDepth(const Image& depth, Clock::time_point now) {
  coming_ = true;
  if (!depths_.empty() && depth->header.stamp < depths_.back()->header.stamp) depths_.clear();  // time went back
  if (depths_.size() == kKept) depths_.pop_front();
  depths_.push_back(depth);
  look(now);
}

void DepthPairing::look(Clock::time_point now) {
  while (!waiting_.empty()) {
    const auto found = depthOf(waiting_.front());
    Image depth;
    if (found != depths_.end()) {
      depth = *found;
      depths_.erase(depths_.begin(), found + 1);
    } else if (!isOverdue(now)) {
      return;
    } else if (now - waiting_.front().since > kPatience) {
      coming_ = false;
    }
    const Waiting first = waiting_.front();
    waiting_.pop_front();
    hand_on_(first.image, first.info, depth);
  }
}

}  // namespace aras_visual_servo_camera
