#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/scene/scene.hpp"
#include "facet.hpp"
#include "render/planar/planar_layer.hpp"
#include "render/view/view_volume.hpp"

namespace aras_visual_servo_sim {

/** Projects bodies and planar models to triangles: culled and lit. Without a lens they are clipped, and triangles in
 *  pixels. Through a lens, where their edges bend, each stays one facet with its edges as planes of rays, and what is
 *  known of its place in the image are the tiles it may touch. */
class TriangleList {
 public:
  /** @param lit  whether the triangles get their colours; else, without a lens, they have a plane() and no facet() */
  void begin(const CameraModel& camera, const ViewVolume& volume, bool lit = true);
  /** Adds what is in view of the bodies, round shapes left out: CurvedList has them. @return false if nothing is */
  bool addBodies(const Scene& scene, const Pose& X_CW);
  /** Adds the planar models, each face slightly nearer than the faces that it is painted over. */
  void addPlanar(const PlanarLayer& planar, const Pose& X_CW);

  /** For each body in view: where its triangles end, and its index in the scene. */
  const std::vector<std::pair<std::size_t, std::size_t>>& bodies() const { return bodies_; }
  std::size_t size() const { return hasFacets() ? facet_of_.size() : planes_.size(); }
  /** Whether triangles are known by vertices(), else by spans(). */
  bool isFlat() const { return camera_->lens() == CameraModel::Lens::kNone; }
  /** Three for each triangle, oriented either way. */
  const std::vector<Vertex>& vertices() const { return vertices_; }
  /** Tiles first <= u < last of a row of tiles that a triangle may touch; in the triangles' order. */
  struct Span {
    std::uint32_t triangle;
    int row, first, last;
  };
  const std::vector<Span>& spans() const { return spans_; }
  /** Pixels, of the image or beyond it, that triangle k may touch. @pre not isFlat() */
  const PixelBox& extent(std::size_t k) const { return extents_[k]; }
  /** What triangle k is a part of. */
  const Facet& facet(std::size_t k) const { return facets_[facet_of_[k]]; }
  /** Plane of triangle k in the camera's frame: plane . ray = 1 / Z for the point on a ray (x, y, 1). */
  const Eigen::Vector3d& plane(std::size_t k) const { return hasFacets() ? facet(k).plane : planes_[k]; }

 private:
  /** Corner on its way through lens and cutting: normalised coordinates in the frame of its cell, and pixel. */
  struct Corner {
    Eigen::Vector2d xy;
    Eigen::Vector2d px;
  };
  using Points = std::array<Eigen::Vector3d, 3>;
  using Seams = std::array<bool, 3>;  // of the edges from corner k to k + 1: see Vertex

  bool hasFacets() const { return lit_ || !isFlat(); }
  void addShape(const Shape& shape, const Pose& X_CS, const Eigen::Vector3d& light_C);
  void addPlane(const Points& points_C);
  bool isSeen(const Points& points_C, const ViewCell& cell, bool inside) const;
  /** Projects a triangle as it is seen in cells_. @param of  the facet that it is, its place yet to be set */
  void addTriangle(const Points& points_C, const Seams& seams, const Facet& of);
  std::size_t addSeen(const Points& points_C, const Facet& facet);
  Corner corner(const Eigen::Vector3d& p_C) const;
  void addVertices(const std::array<Corner, 3>& corners, const Seams& seams);
  void addSpans();
  bool addSpanOfOneRow(int rows, int columns);
  void bendEdge(const Corner& from, const Corner& to, int depth);
  void widenRows(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  void widenExtent(double margin);

  bool lit_ = true;
  const CameraModel* camera_ = nullptr;
  const ViewVolume* volume_ = nullptr;
  const ViewCell* cell_ = nullptr;  // of the triangle being added
  std::vector<Vertex> vertices_;
  std::vector<std::pair<std::size_t, std::size_t>> bodies_;
  std::vector<Facet> facets_;
  std::vector<Eigen::Vector3d> planes_;  // of the triangles that have no facets
  std::uint32_t surfaces_ = 0;
  std::vector<std::uint32_t> facet_of_;
  std::vector<Eigen::Vector3d> points_, polygon_;  // scratch
  std::vector<char> polygon_seams_;                // scratch: of the edge from each corner of polygon_ to the next
  std::vector<Eigen::Vector3f> colors_;            // scratch
  std::vector<Corner> corners_;                    // scratch
  std::vector<Span> spans_;
  std::vector<PixelBox> extents_;
  PixelBox extent_;                              // of the triangle being added
  Eigen::Array2d low_, high_;                    // of the outline [px]
  double margin_ = 0.0;                          // by which it is taken to be larger [px]
  std::vector<std::pair<double, double>> rows_;  // scratch: columns that an outline spans in each row of tiles [px]
  int first_row_ = 0, last_row_ = 0;             // of the outline: first <= row < last
  std::vector<char> drawn_;                      // scratch: of a mesh's triangles
  std::vector<std::pair<const ViewCell*, bool>> cells_;  // scratch: of the shape or face, and whether it is inside
};

}  // namespace aras_visual_servo_sim
