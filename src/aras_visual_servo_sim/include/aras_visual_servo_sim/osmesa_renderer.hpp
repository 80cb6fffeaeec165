#pragma once

#include <memory>

#include "aras_visual_servo_sim/renderer.hpp"

namespace aras_visual_servo_sim {

/** Renderer for machines without a GPU or a display.
 *
 *  Planar models are drawn by exact area coverage (CoverageRasterizer). Only where a body comes into view, or where the
 *  order of two planar models cannot be told, tiles of the image are drawn again by OSMesa: once at pixel centres, and
 *  with 8 x 8 samples a pixel where that shows an edge. The OSMesa context is made when first needed, so scenes
 *  without bodies in view never load it. Not thread-safe; one object may serve many cameras. */
class OsmesaRenderer : public Renderer {
 public:
  enum class Path {
    kAutomatic,  ///< as described above
    kGl          ///< everything in view through OSMesa: for tests and comparisons
  };

  explicit OsmesaRenderer(Path path = Path::kAutomatic);
  ~OsmesaRenderer() override;
  OsmesaRenderer(OsmesaRenderer&&) noexcept;
  OsmesaRenderer& operator=(OsmesaRenderer&&) noexcept;

  /** What the last frame took: to test and to measure. */
  struct Statistics {
    bool used_gl = false;
    int triangles = 0;           ///< in view, after culling and clipping
    int gl_tiles = 0;            ///< 8 x 8 pixel tiles taken from OSMesa
    int supersampled_tiles = 0;  ///< of these, with 8 x 8 samples a pixel
  };
  const Statistics& statistics() const;

 private:
  void doRender(const CameraModel& camera, const Pose& X_WC, const Scene& scene, Image& out) override;

  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace aras_visual_servo_sim
