#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/coverage_rasterizer.hpp"
#include "osmesa_canvas.hpp"

namespace aras_visual_servo_sim {

/** Redraws square tiles of an image from projected triangles: at pixel centres first, then with 8 x 8 samples a pixel
 *  each tile in which that picture shows an edge.
 *
 *  A straight edge that crosses a pixel always separates its centre from that of one of its four neighbours, so no
 *  edge escapes but those of things thinner than a pixel. Tiles to be sampled are gathered in an atlas, with triangles
 *  cut to each tile, so that one drawing call does many of them. */
class TilePainter {
 public:
  static constexpr int kTile = 8;     ///< [px]
  static constexpr int kSamples = 8;  ///< along each axis of a pixel

  /** Starts a frame: no tile is marked. */
  void begin(int width, int height);
  void markAll();
  void mark(const PixelBox& box);
  /** Marks what the triangles may touch. */
  void mark(const std::vector<Vertex>& vertices);

  /** Draws the marked tiles.
   *  @param pictures     their pixels take the place of black vertices numbered TriangleList::pictureNumber(index)
   *  @param supersample  false: pixel centres only */
  void paint(const std::vector<Vertex>& vertices, const Rgb& background, const std::vector<Image>& pictures,
             bool supersample, Image& image);

  int markedTiles() const { return marked_tiles_; }
  int supersampledTiles() const { return supersampled_tiles_; }

 private:
  PixelBox tilesOf(const Vertex* triangle) const;
  template <typename Visit>
  void forEachTile(const Vertex* triangle, const Visit& visit) const;
  bool showsEdge(const std::uint32_t* picture, int tile_u, int tile_v) const;
  void copyTile(const std::uint32_t* picture, int tile_u, int tile_v, Image& image) const;
  void sortIntoTiles(const std::vector<Vertex>& vertices, const std::vector<int>& tiles);
  void paintAtlas(const std::vector<Vertex>& vertices, const std::vector<int>& tiles, std::size_t first,
                  std::size_t last, const Rgb& background, Image& image);
  void addToAtlas(const Vertex* triangle, int tile, int slot);
  void filterTile(const std::uint32_t* atlas, int slot, int tile, Image& image) const;

  const Image* pictureOf(std::uint8_t number) const;
  void addPictures(const std::uint32_t* samples, int u, int v, double* rgb) const;

  const std::vector<Image>* pictures_ = nullptr;
  int width_ = 0, height_ = 0;
  int tiles_u_ = 0, tiles_v_ = 0;
  int marked_tiles_ = 0, supersampled_tiles_ = 0;
  std::vector<char> marked_;
  std::vector<int> slot_of_tile_;                  // -1: not sampled
  std::vector<std::uint32_t> starts_, triangles_;  // triangles of each sampled tile, one after the other
  std::vector<Vertex> atlas_vertices_;
  std::map<std::pair<int, int>, std::unique_ptr<OsmesaCanvas>> canvases_;  // by size of the image
  std::unique_ptr<OsmesaCanvas> atlas_;
};

}  // namespace aras_visual_servo_sim
