#include "segmentation/object_selector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aras_visual_servo_camera {
namespace {

constexpr double kMaxMove = 0.5;    // part of the distance to the nearest other object
constexpr double kMaxGrowth = 2.0;  // of the area, from one image to the next
// Shapes that differ by less count as equal: rounding, noise, and the part of a perspective that is not affine.
constexpr double kShapeNoise = 0.02;
// No view of the reference's shape differs from it by more; measured with a plane tilted by 45 degrees that fills a
// third of the image.
constexpr double kMaxDissimilarity = 0.3;

bool contains(const Candidate& box, double u, double v) {
  return u >= box.u_min - 1 && u <= box.u_max + 1 && v >= box.v_min - 1 && v <= box.v_max + 1;
}

/** Indices of the candidates that may be the target: no specks, and none of a strange shape. */
std::vector<int> eligibleOf(const std::vector<Candidate>& candidates) {
  std::vector<int> eligible;
  for (std::size_t k = 0; k < candidates.size(); ++k)
    if (!candidates[k].speck && !(candidates[k].dissimilarity > kMaxDissimilarity))
      eligible.push_back(static_cast<int>(k));
  return eligible;
}

bool similarArea(double a, double b, double ratio) { return a <= ratio * b && b <= ratio * a; }

}  // namespace

void ObjectSelector::forget() {
  tracks_.clear();
  unsure_ = false;
  better_for_ = alone_for_ = 0;
}

const ObjectSelector::Track* ObjectSelector::target() const {
  for (const Track& track : tracks_)
    if (track.target) return &track;
  return nullptr;
}

// Nearest pairs first; a track whose reach holds two candidates takes the nearer.
void ObjectSelector::associate(const std::vector<Candidate>& candidates) {
  struct Pair {
    double distance;
    std::size_t track, candidate;
  };
  std::vector<Pair> pairs;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    tracks_[t].candidate = -1;
    double reach = std::numeric_limits<double>::infinity();
    for (std::size_t o = 0; o < tracks_.size(); ++o)
      if (o != t)
        reach = std::min(reach,
                         kMaxMove * std::hypot(tracks_[o].u_px - tracks_[t].u_px, tracks_[o].v_px - tracks_[t].v_px));
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      const double distance = std::hypot(candidates[c].u_px - tracks_[t].u_px, candidates[c].v_px - tracks_[t].v_px);
      if (candidates[c].speck && !tracks_[t].target) continue;
      if (distance < reach && similarArea(candidates[c].area_px, tracks_[t].area_px, kMaxGrowth))
        pairs.push_back({distance, t, c});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  std::vector<bool> taken(candidates.size(), false);
  for (const Pair& pair : pairs) {
    if (tracks_[pair.track].candidate >= 0 || taken[pair.candidate]) continue;
    tracks_[pair.track].candidate = static_cast<int>(pair.candidate);
    taken[pair.candidate] = true;
  }
}

bool ObjectSelector::isAnother(int candidate) const {
  return std::any_of(tracks_.begin(), tracks_.end(),
                     [candidate](const Track& track) { return !track.target && track.candidate == candidate; });
}

// True when another object was seen shortly before where this one is now.
bool ObjectSelector::coversAnother(const Candidate& candidate) const {
  return std::any_of(tracks_.begin(), tracks_.end(), [&](const Track& track) {
    return !track.target && track.candidate < 0 && track.unseen == 0 && contains(candidate, track.u_px, track.v_px);
  });
}

// The candidate that now covers the places of the target and of another object; -1: none does.
int ObjectSelector::joined(const std::vector<Candidate>& candidates) const {
  if (target() == nullptr || target()->unseen > 0) return -1;
  const int followed = target()->candidate;
  for (std::size_t k = 0; k < candidates.size(); ++k)
    if ((followed < 0 || followed == static_cast<int>(k)) && contains(candidates[k], target()->u_px, target()->v_px) &&
        coversAnother(candidates[k]))
      return static_cast<int>(k);
  return -1;
}

bool ObjectSelector::better(const Candidate& a, const Candidate& b) const {
  const Track* last = target();
  if (std::isfinite(a.dissimilarity) && !std::isnan(b.dissimilarity))
    return b.dissimilarity + kShapeNoise >= config_.switch_ratio * (a.dissimilarity + kShapeNoise);
  if (config_.component == ComponentChoice::kNearestToPrevious && last != nullptr) {
    const auto distance = [last](const Candidate& c) { return std::hypot(c.u_px - last->u_px, c.v_px - last->v_px); };
    return distance(b) >= config_.switch_ratio * distance(a);
  }
  return a.area_px >= config_.switch_ratio * b.area_px;
}

ObjectSelector::Choice ObjectSelector::best(const std::vector<Candidate>& candidates,
                                            const std::vector<int>& eligible) const {
  // The first one that is clearly better than every other.
  for (const int a : eligible) {
    const bool clear = std::all_of(eligible.begin(), eligible.end(),
                                   [&](int b) { return a == b || better(candidates[a], candidates[b]); });
    if (clear) return {a, false};
  }
  return {-1, !eligible.empty()};
}

ObjectSelector::Choice ObjectSelector::keepOrSwitch(const std::vector<Candidate>& candidates, int followed) {
  if (config_.component == ComponentChoice::kNearestToPrevious || candidates[followed].cut) {
    better_for_ = 0;
    return {followed, false};
  }
  const Choice other = best(candidates, eligibleOf(candidates));
  const bool takes_over = other.index >= 0 && !better(candidates[followed], candidates[other.index]);
  better_for_ = takes_over && other.index != followed ? better_for_ + 1 : 0;
  if (better_for_ < config_.switch_images) return {followed, false};
  better_for_ = 0;
  return other;
}

ObjectSelector::Choice ObjectSelector::acquire(const std::vector<Candidate>& candidates) {
  better_for_ = 0;
  std::vector<int> eligible = eligibleOf(candidates);
  const auto others =
      std::remove_if(eligible.begin(), eligible.end(), [this](int k) { return target() != nullptr && isAnother(k); });
  eligible.erase(others, eligible.end());
  return best(candidates, eligible);
}

// After the target has merged with another object: once there are as many objects as before, the target is the better
// one, if one is better. Or it is an object that has been alone for a while and is as large as the target was.
ObjectSelector::Choice ObjectSelector::recover(const std::vector<Candidate>& candidates) {
  const std::vector<int> all = eligibleOf(candidates);
  const bool alone =
      all.size() == 1 && similarArea(candidates[all[0]].area_px, target()->area_px, config_.switch_ratio);
  alone_for_ = alone ? alone_for_ + 1 : 0;
  Choice choice{-1, !all.empty()};
  if (alone_for_ >= config_.switch_images) choice = {all[0], false};
  if (all.size() >= before_merging_) choice = best(candidates, all);
  if (choice.index >= 0) unsure_ = false;
  return choice;
}

void ObjectSelector::remember(const std::vector<Candidate>& candidates, const Choice& choice) {
  std::vector<Track> tracks;
  if (choice.index < 0 && target() != nullptr) {  // where it was seen last
    tracks.push_back(*target());
    ++tracks.back().unseen;
  }
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const bool chosen = static_cast<int>(k) == choice.index;
    // Beside the target, everything is another; while it is gone, only what was known as another before.
    if ((candidates[k].speck && !chosen) || (choice.index < 0 && !isAnother(static_cast<int>(k)))) continue;
    tracks.push_back({candidates[k].u_px, candidates[k].v_px, candidates[k].area_px, 0, chosen, -1});
  }
  for (const Track& track : tracks_)
    if (!track.target && track.candidate < 0 && track.unseen < config_.switch_images) {
      tracks.push_back(track);
      ++tracks.back().unseen;
    }
  tracks_ = std::move(tracks);
}

ObjectSelector::Choice ObjectSelector::choose(const std::vector<Candidate>& candidates) {
  associate(candidates);
  Choice choice;
  if (unsure_) {
    choice = recover(candidates);
  } else {
    const int followed = target() == nullptr ? -1 : target()->candidate;
    if (joined(candidates) >= 0) {
      unsure_ = true;
      before_merging_ = static_cast<std::size_t>(
          std::count_if(tracks_.begin(), tracks_.end(), [](const Track& track) { return track.unseen == 0; }));
      alone_for_ = better_for_ = 0;
      choice = {-1, true};
    } else {
      choice = followed >= 0 ? keepOrSwitch(candidates, followed) : acquire(candidates);
    }
  }
  remember(candidates, choice);
  return choice;
}

}  // namespace aras_visual_servo_camera
