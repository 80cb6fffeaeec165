#include "segmentation/components.hpp"

#include <algorithm>
#include <cstring>

namespace aras_visual_servo_camera {
namespace {

// Most rows of most images hold nothing. Those of one grey are found by a comparison, the others by a reduction that is
// vectorised.
bool anyInside(const std::uint8_t* row, int width, std::uint8_t flip, std::uint8_t level) {
  if ((row[0] ^ flip) > level && std::memcmp(row, row + 1, width - 1) == 0) return false;
  std::uint8_t least = 255;
  for (int u = 0; u < width; ++u) least = std::min<std::uint8_t>(least, row[u] ^ flip);
  return least <= level;
}

int findByte(const std::vector<std::uint8_t>& bytes, int begin, int end, int value) {
  const void* at = std::memchr(bytes.data() + begin, value, end - begin);
  return at == nullptr ? end : static_cast<int>(static_cast<const std::uint8_t*>(at) - bytes.data());
}

}  // namespace

void ComponentFinder::scanRow(const std::uint8_t* row, int v, int width, std::uint8_t flip, std::uint8_t level) {
  if (!anyInside(row, width, flip, level)) return;
  std::uint8_t* const inside = inside_.data();
  for (int u = 0; u < width; ++u) inside[u] = (row[u] ^ flip) <= level;
  for (int u = findByte(inside_, 0, width, 1); u < width;) {
    const int end = findByte(inside_, u, width, 0);
    const int run = static_cast<int>(runs_.size());
    runs_.emplace_back() = {v, u, end, run};
    u = findByte(inside_, end, width, 1);
  }
}

int ComponentFinder::root(int run) {
  while (parent_[run] != run) run = parent_[run] = parent_[parent_[run]];
  return run;
}

void ComponentFinder::joinRows(std::size_t above, std::size_t below, std::size_t end) {
  for (std::size_t a = above, b = below; a < below && b < end;) {
    if (runs_[a].u_begin <= runs_[b].u_end && runs_[b].u_begin <= runs_[a].u_end) {
      const int ra = root(static_cast<int>(a)), rb = root(static_cast<int>(b));
      parent_[std::max(ra, rb)] = std::min(ra, rb);
    }
    if (runs_[a].u_end < runs_[b].u_end) {
      ++a;
    } else {
      ++b;
    }
  }
}

void ComponentFinder::process(const std::uint8_t* image, std::size_t step, int width, int height, std::uint8_t flip,
                              std::uint8_t level) {
  runs_.clear();
  parent_.clear();
  components_.clear();
  inside_.resize(width);
  std::size_t above = 0;
  int above_row = -2;
  for (int v = 0; v < height; ++v) {
    const std::size_t below = runs_.size();
    scanRow(image + v * step, v, width, flip, level);
    if (runs_.size() == below) continue;
    for (std::size_t k = below; k < runs_.size(); ++k) parent_.push_back(static_cast<int>(k));
    if (above_row == v - 1) joinRows(above, below, runs_.size());
    above = below;
    above_row = v;
  }

  for (std::size_t k = 0; k < runs_.size(); ++k) {  // a root is its component's first run
    Run& run = runs_[k];
    const int first = root(static_cast<int>(k));
    if (first == static_cast<int>(k)) {
      run.component = static_cast<int>(components_.size());
      components_.push_back({0, 0, 0, run.u_begin, run.u_end - 1, run.v, run.v});
    } else {
      run.component = runs_[first].component;
    }
    Component& c = components_[run.component];
    const std::int64_t n = run.u_end - run.u_begin;
    c.area_px += n;
    c.sum_u += n * (run.u_begin + run.u_end - 1) / 2;
    c.sum_v += n * run.v;
    c.u_min = std::min(c.u_min, run.u_begin);
    c.u_max = std::max(c.u_max, run.u_end - 1);
    c.v_max = run.v;
  }
}

}  // namespace aras_visual_servo_camera
