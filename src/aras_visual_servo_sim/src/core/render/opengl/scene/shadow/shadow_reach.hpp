#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"
#include "render/opengl/view/pinhole_view.hpp"
#include "render/view/pixel_box.hpp"
#include "shadow_view.hpp"

namespace aras_visual_servo_sim {

/** The pixels that something inside this box, in pixels, may touch. */
PixelBox pixelsAbout(const Eigen::Array2d& low, const Eigen::Array2d& high, const PinholeView& view);

/** A few parts of a picture that hold all that was added: what lies close together is taken together, for each part
 *  costs about as much as drawing some pixels more. */
class PixelParts {
 public:
  /** @param within  nothing beyond it is wanted */
  explicit PixelParts(const PixelBox& within) : within_(within) {}

  void add(const PixelBox& part);
  /** Takes together those that share pixels with this, if that adds fewer pixels than it saves.
   *  @param saved_px  by each part less */
  void join(const PixelBox& part, double saved_px);
  const std::vector<PixelBox>& parts() const { return parts_; }
  /** Of the parts, those that overlap counted twice [px]. */
  double area() const;

 private:
  PixelBox within_;
  std::vector<PixelBox> parts_;
};

/** What a picture shows of the faces of the box about a mesh, and where that is on the map of a directional light. */
class SeenMesh {
 public:
  /** @param of_camera  the map's coordinates of points in C */
  SeenMesh(const TriangleMesh& mesh, const Eigen::Matrix4d& X_CS, const Eigen::Matrix4d& of_camera,
           const PinholeView& view);

  /** The part of the picture that the mesh can cover. */
  PixelBox covered(double near_m) const;
  /** All that can be seen of the mesh is in it. Empty: nothing can. */
  const MapBox& box() const { return box_; }
  /** The part of the picture in which the mesh can lie in the shadow of a caster. @param caster  its box on the map */
  PixelBox shadowOf(const MapBox& caster, double near_m) const;

 private:
  /** A point in C and where it is on the map. */
  struct Corner {
    Eigen::Vector3d p_C;
    Eigen::Vector3d on_map;
  };
  /** A convex polygon with few corners. */
  class Outlined {
   public:
    void add(const Corner& corner) {
      if (count_ < kMost) corners_[count_++] = corner;
    }
    const Corner* begin() const { return corners_.data(); }
    const Corner* end() const { return corners_.data() + count_; }
    /** What of it lies where `beyond`, linear in the corner, is not positive. */
    template <typename Beyond>
    Outlined clipped(const Beyond& beyond) const;

   private:
    static constexpr int kMost = 16;  // of a face 4, each of nine cuts adds one
    std::array<Corner, kMost> corners_;
    int count_ = 0;
  };

  std::array<Outlined, 6> faces_;
  bool about_eye_ = false;
  MapBox box_;
  const PinholeView& view_;
};

/** The part of a picture that a mesh can cover. @param X_CS  pose of the mesh in C  @param near_m  of the camera */
PixelBox coveredPart(const TriangleMesh& mesh, const Eigen::Matrix4d& X_CS, const PinholeView& view, double near_m);

}  // namespace aras_visual_servo_sim
