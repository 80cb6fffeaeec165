#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>

#include "aras_visual_servo_sim/render/renderer.hpp"

namespace aras_visual_servo_sim {

/** Renderer without a graphics library, for machines without a GPU or a display: pixels are means over their squares.
 *
 *  Planar models are drawn by exact area coverage (CoverageRasterizer). Only where a body comes into view, or where the
 *  order of two planar models cannot be told, tiles of the image are painted from triangles, with 64 samples in each
 *  pixel that sees more than one thing. Not thread-safe; one object may serve many cameras. */
class CoverageRenderer : public Renderer {
 public:
  enum class Path {
    kAutomatic,  ///< as described above
    kSampled     ///< everything in view from triangles: for tests and comparisons
  };

  explicit CoverageRenderer(Path path = Path::kAutomatic);
  ~CoverageRenderer() override;
  CoverageRenderer(CoverageRenderer&&) noexcept;
  CoverageRenderer& operator=(CoverageRenderer&&) noexcept;

  /** How much work the last frame was, for tests and benchmarks. */
  struct Statistics {
    int triangles = 0;       ///< in view, after culling, clipping and cutting for the lens
    int tiles = 0;           ///< of 8 x 8 pixels, painted from triangles
    int sampled_pixels = 0;  ///< of these tiles, with 64 samples
  };
  const Statistics& statistics() const;

 private:
  void doRender(const CameraModel& camera, const Pose& X_WC, const Scene& scene, const Out& out) override;

  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/** What the coverage renderer does not draw of a scene, and whose it is: names of bodies and lights, an empty one for
 * the scene itself. What a thing has at its default is not listed. */
using Undrawn = std::map<std::string, std::set<std::string>>;

Undrawn undrawnByCoverage(const Scene& scene);

/** "emissive of lamp, screen; fog": for messages. */
std::string textOf(const Undrawn& undrawn);

}  // namespace aras_visual_servo_sim
