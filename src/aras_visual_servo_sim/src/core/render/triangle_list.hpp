#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/scene.hpp"
#include "osmesa_canvas.hpp"
#include "planar_layer.hpp"
#include "view_volume.hpp"

namespace aras_visual_servo_sim {

/** Projects bodies and planar models to triangles in pixels: culled, clipped, lit, cut small enough for the lens. */
class TriangleList {
 public:
  void begin(const CameraModel& camera, const ViewVolume& volume);
  /** Adds what is in view of the bodies. @return false if nothing is */
  bool addBodies(const Scene& scene, const Pose& X_CW);
  /** Object number of a planar model's picture, of index 0 .. kMostPictures - 1. */
  static std::uint8_t pictureNumber(int index) { return static_cast<std::uint8_t>(1 + index); }
  static constexpr int kMostPictures = 64;

  /** Adds the planar models, each face a hair nearer than what it is painted over; pictures in black, to be replaced by
   *  their number. @throws RenderError when more than kMostPictures pictures are in view */
  void addPlanar(const PlanarLayer& planar, const Pose& X_CW);

  /** For each body in view: where its vertices end, and its index in the scene. */
  const std::vector<std::pair<std::size_t, std::size_t>>& bodies() const { return bodies_; }
  /** Plane of triangle k in the camera's frame: plane . ray = 1 / Z for the point on a ray (x, y, 1). */
  const Eigen::Vector3d& plane(std::size_t k) const { return planes_[plane_of_[k]]; }
  /** Three for each triangle. */
  const std::vector<Vertex>& vertices() const { return vertices_; }

 private:
  /** Corner on its way through lens and cutting: normalised coordinates and inverse depth in the frame of its cell,
   *  colour, pixel. */
  struct Corner {
    Eigen::Vector2d xy;
    double inverse_z;
    Eigen::Vector3f rgb;
    Eigen::Vector2d px;
  };
  using Points = std::array<Eigen::Vector3d, 3>;
  using Colors = std::array<Eigen::Vector3f, 3>;

  void addShape(const Shape& shape, const Pose& X_CS, const Eigen::Vector3d& light_C, std::uint8_t number);
  void addTriangle(const Points& points_C, const Colors& colors, const ViewCell& cell, bool inside, std::uint8_t number,
                   double bias);
  Corner corner(const Eigen::Vector3d& p_C, const Eigen::Vector3f& rgb) const;
  double slack(const Pose& X_CM) const;
  double bend(const Corner& from, const Corner& to, const Eigen::Vector2d& middle_px) const;
  void cut(const Corner& a, const Corner& b, const Corner& c, std::uint8_t number, double bias, int depth);
  Vertex vertex(const Corner& corner, std::uint8_t number, double bias) const;

  const CameraModel* camera_ = nullptr;
  const ViewVolume* volume_ = nullptr;
  const ViewCell* cell_ = nullptr;  // of the triangle being added
  std::vector<Vertex> vertices_;
  std::vector<std::pair<std::size_t, std::size_t>> bodies_;
  std::vector<Eigen::Vector3d> planes_;
  std::vector<std::uint32_t> plane_of_;
  std::vector<Eigen::Vector3d> points_, polygon_;        // scratch
  std::vector<Eigen::Vector3f> colors_;                  // scratch
  std::vector<std::pair<const ViewCell*, bool>> cells_;  // scratch: of the shape or face, and whether it is inside
};

}  // namespace aras_visual_servo_sim
