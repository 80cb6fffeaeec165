#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/scene/scene.hpp"
#include "curved_patch.hpp"
#include "render/view/view_volume.hpp"

namespace aras_visual_servo_sim {

/** The round shapes of a scene as one camera sees them: their parts, and the tiles of the image that each may touch. */
class CurvedList {
 public:
  struct Entry {
    CurvedPatch patch;
    std::size_t body;  ///< index into the scene's bodies
  };

  /** Starts a frame. */
  void begin(const CameraModel& camera, const ViewVolume& volume);
  /** Adds what may be in view of the bodies' round shapes, and sorts it into tiles. @return false if nothing is */
  bool addBodies(const Scene& scene, const Pose& X_CW);

  const std::vector<Entry>& entries() const { return entries_; }
  /** Entries that a tile (CameraModel::blockCones has their order) may see; none in tiles beyond tiles(). */
  const std::uint32_t* begin(int tile) const { return sorted_.data() + starts_[tile]; }
  const std::uint32_t* end(int tile) const { return sorted_.data() + starts_[tile + 1]; }
  int tiles() const { return starts_.empty() ? 0 : static_cast<int>(starts_.size()) - 1; }

 private:
  void addShape(const Shape& shape, const Pose& X_CS, const Eigen::Vector3d& light_C, std::size_t body);
  void sort();

  const CameraModel* camera_ = nullptr;
  const ViewVolume* volume_ = nullptr;
  std::vector<Entry> entries_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> touched_;  // tile, entry
  std::vector<std::uint32_t> near_tiles_;                         // scratch
  std::vector<std::uint32_t> starts_, next_, sorted_;
};

}  // namespace aras_visual_servo_sim
