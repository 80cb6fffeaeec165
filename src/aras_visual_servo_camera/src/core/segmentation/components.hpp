#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace aras_visual_servo_camera {

/** Pixels u_begin <= u < u_end of row v that belong to one component. */
struct Run {
  int v, u_begin, u_end;
  int component;  // index into ComponentFinder::components()
};

/** Pixels that touch each other at a side or a corner. */
struct Component {
  std::int64_t area_px = 0, sum_u = 0, sum_v = 0;
  int u_min = 0, u_max = 0, v_min = 0, v_max = 0;
};

/** Connected components (8 neighbours) of the pixels with (grey ^ flip) <= level, from runs: linear in their number. */
class ComponentFinder {
 public:
  void process(const std::uint8_t* image, std::size_t step, int width, int height, std::uint8_t flip,
               std::uint8_t level);

  const std::vector<Run>& runs() const { return runs_; }  // sorted by v, then u
  const std::vector<Component>& components() const { return components_; }

 private:
  void scanRow(const std::uint8_t* row, int v, int width, std::uint8_t flip, std::uint8_t level);
  void joinRows(std::size_t above, std::size_t below, std::size_t end);
  int root(int run);

  std::vector<Run> runs_;
  std::vector<int> parent_;
  std::vector<Component> components_;
  std::vector<std::uint8_t> inside_;
};

}  // namespace aras_visual_servo_camera
