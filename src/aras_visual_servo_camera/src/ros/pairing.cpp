#include "pairing.hpp"

#include <algorithm>

namespace aras_visual_servo_camera {
namespace {

constexpr std::size_t kWaitingImages = 100, kKeptInfos = 100;
constexpr std::size_t kKeptDepths = 32;  // depth images whose images have not come

}  // namespace

void InfoPairing::addImage(const Image& image) {
  ++counts_.images;
  const ros::Time stamp = image->header.stamp;
  if (stamp < last_stamp_) {  // time went back: what is later belongs to another run
    while (!waiting_.empty()) giveUp();
    infos_.erase(std::remove_if(infos_.begin(), infos_.end(),
                                [&](const Info& info) { return info->header.stamp > stamp + slop_; }),
                 infos_.end());
  }
  last_stamp_ = stamp;
  if (waiting_.size() == kWaitingImages) giveUp();
  waiting_.push_back(image);
  look();
}

void InfoPairing::addInfo(const Info& info) {
  ++counts_.infos;
  if (!infos_.empty() && info->header.stamp < infos_.back()->header.stamp) infos_.clear();  // time went back
  if (infos_.size() == kKeptInfos) infos_.pop_front();
  infos_.push_back(info);
  look();
}

void InfoPairing::giveUp() {
  waiting_.pop_front();
  counts_.lost += paired_;
}

void InfoPairing::look() {
  while (!waiting_.empty() && !infos_.empty()) {
    const Image image = waiting_.front();
    const ros::Time stamp = image->header.stamp;
    const auto distance = [&](const Info& info) {
      return info->header.stamp < stamp ? stamp - info->header.stamp : info->header.stamp - stamp;
    };
    const auto nearest = std::min_element(infos_.begin(), infos_.end(),
                                          [&](const Info& a, const Info& b) { return distance(a) < distance(b); });
    const Info info = *nearest;
    if (distance(info) <= slop_) {
      infos_.erase(infos_.begin(), nearest);  // the pair's own may be the nearest of the next image, too
      waiting_.pop_front();
      paired_ = true;
      ++counts_.pairs;
      hand_on_(image, info);
    } else if (infos_.back()->header.stamp > stamp) {
      giveUp();
    } else {
      return;
    }
  }
}

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
  if (depths_.size() == kKeptDepths) depths_.pop_front();
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
