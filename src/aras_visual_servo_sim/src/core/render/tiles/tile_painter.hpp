#pragma once

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "render/curved/curved_list.hpp"
#include "render/picture/texture_area.hpp"
#include "render/pixels/pixel_samples.hpp"
#include "render/triangles/triangle_list.hpp"
#include "render/view/pixel_rays.hpp"
#include "tile_bins.hpp"
#include "tile_colors.hpp"
#include "tile_curved.hpp"
#include "tile_fronts.hpp"
#include "tile_sight.hpp"

namespace aras_visual_servo_sim {

/** Paints the marked tiles of an image from projected triangles and curved patches, nearest on top: a pixel is the mean
 * over its square.
 *
 *  A pixel wholly covered by one surface in front of all others has that surface's colour in its middle. Where several
 *  are seen, or the background, PixelSamples says how much of it each triangle has. Edges shared by triangles have each
 *  sample on one side of them only; edges beyond which a surface goes on smoothly are no reason to sample. */
class TilePainter {
 public:
  /** What the last frame took. */
  struct Statistics {
    int tiles = 0;           ///< painted
    int sampled_pixels = 0;  ///< in which more than one thing is seen
  };

  /** What is painted, and what its pixels see of planar models' pictures. */
  template <typename Value>
  struct Canvas {
    ImageOf<Value>* image;
    const std::vector<ImageOf<Value>>* pictures;
  };
  using AnyCanvas = std::variant<Canvas<std::uint8_t>, Canvas<std::uint16_t>>;

  /** @param bins      marked, and triangles sorted into them
   *  @param curved    sorted into tiles too
   *  @param canvas    planar models and background are painted already: where the mark is kBodies, pixels that see no
   *                   body are left alone */
  void paint(const CameraModel& camera, const TriangleList& triangles, const CurvedList& curved, const TileBins& bins,
             const Rgb& background, const AnyCanvas& canvas);

  const Statistics& statistics() const { return statistics_; }

 private:
  static constexpr int kTile = TileBins::kTile;
  static constexpr int kPixels = kTile * kTile;

  /** A candidate that a pixel may see. */
  struct Fragment {
    std::uint32_t candidate;
    int next;            // of the same pixel, -1: none
    float nearest;       // upper bound of near_m / Z
    bool smooth;         // no edges cross the pixel but seams
    std::int32_t sight;  // of a triangle: bits of TileSight
  };
  /** A candidate that a pixel sees, as far as the bounds of depths tell. */
  struct Seen {
    std::uint32_t candidate;
    std::int32_t sight;
  };

  void paintTile(int tile);
  bool paintFronts();
  template <typename Value>
  bool paintFronts(const Canvas<Value>& canvas);
  bool shade(const Facet& facet, TileColors& colors);
  void setUpFlat();
  void setUpBent();
  void collect(std::uint32_t candidate);
  PixelBox touchedBy(const TileTriangle& candidate) const;
  bool isInside(const TileTriangle& candidate, int pixel) const;
  PixelSamples::Triangle about(const TileTriangle& candidate, int pixel, std::int32_t sight) const;
  void collectCenters(std::uint32_t candidate);
  void addCurved(int tile);
  void collectCurved(std::uint32_t candidate);
  void collectCurvedCenters(std::uint32_t candidate);
  void addFragment(int pixel, std::uint32_t candidate, float nearest, bool smooth, std::int32_t sight);
  void putInFront(int pixel, std::uint32_t candidate, float farthest, float nearest);
  void paintPixel(int pixel);
  template <typename Value>
  Eigen::Vector3d seenOf(const ImageOf<Value>& picture, int pixel) const;
  int smoothFront(int pixel) const;
  void samplePixel(int pixel, double* rgb);
  Eigen::Vector3d colorOf(std::uint32_t candidate, int pixel, const PixelSamples::Share& share);
  Eigen::Vector3d colorOf(const CurvedPatch& patch, int pixel, const PixelSamples::Share& share);
  Eigen::Vector3d textureOf(const CurvedPatch& patch, int pixel, const PixelSamples::Share& share);
  Eigen::Vector3d textureOf(const TileTriangle& candidate, int pixel, const PixelSamples::Share& share);

  const CameraModel* camera_ = nullptr;
  const TriangleList* list_ = nullptr;
  const CurvedList* curved_list_ = nullptr;
  const TileBins* bins_ = nullptr;
  AnyCanvas canvas_;
  Rgb background_;
  Statistics statistics_;

  // Of the tile being painted.
  PixelBox box_;
  bool keep_ = false;
  std::vector<TileTriangle> candidates_;
  std::vector<TileCurved> curved_;  // candidates too, numbered on from those
  bool isCurved(std::uint32_t candidate) const { return candidate >= candidates_.size(); }
  const TileCurved& curvedOf(std::uint32_t candidate) const { return curved_[candidate - candidates_.size()]; }
  const CurvedPatch& patchOf(const TileCurved& curved) const { return curved_list_->entries()[curved.entry].patch; }
  TileFronts fronts_;
  TileColors colors_, facet_colors_;
  TileTexture texture_;
  std::vector<Fragment> fragments_;
  std::vector<Seen> seen_;  // scratch: of one pixel
  PixelSamples samples_;    // scratch
  TextureArea texture_area_;
  std::vector<Eigen::Vector2d> outline_;  // scratch: of what a pixel sees of a triangle
  std::array<PixelRays, kPixels> rays_;
  TileRays rounded_;  // the same
  RayCone cone_;
  TileSight sight_;                   // of one candidate
  std::array<float, kPixels> ahead_;  // near_m / Z of what lies on the near plane
  std::array<int, kPixels> first_;    // fragment of each pixel, -1: none
  std::array<int, kPixels> front_;    // candidate that covers the pixel, the one whose farthest point is nearest
  std::array<float, kPixels> floor_;  // that point: what lies wholly behind it is not seen
  std::array<float, kPixels> front_nearest_;
};

}  // namespace aras_visual_servo_sim
