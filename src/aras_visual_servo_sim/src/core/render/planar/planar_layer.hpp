#pragma once

#include <Eigen/Core>
#include <functional>
#include <tuple>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/scene/scene.hpp"
#include "render/coverage/coverage_rasterizer.hpp"
#include "render/picture/texture_sampler.hpp"
#include "render/view/view_volume.hpp"

namespace aras_visual_servo_sim {

/** The planar models of a scene as one camera sees them, back to front. */
class PlanarLayer {
 public:
  /** Projects what is in view and puts it in order. */
  void project(const CameraModel& camera, const ViewVolume& volume, const Pose& X_CW, const Scene& scene);

  /** Samples the pictures in view, as wide as the image, for images of this kind of values. @pre project() */
  template <typename Value>
  void samplePictures(const CameraModel& camera, CoverageRasterizer& rasterizer);

  /** Paints everything over image by exact coverage. @pre samplePictures() of its values */
  template <typename Value>
  void paint(const CameraModel& camera, CoverageRasterizer& rasterizer, ImageOf<Value>& image) const;

  /** Outlines, picture or board of one model. */
  struct Face {
    enum class Kind { kOutlines, kPicture, kBoard };
    const PlanarModel* model;
    Kind kind;
    Rgb color;         ///< not of pictures
    int picture = -1;  ///< of pictures: index into pictures()
  };
  /** Faces in view in the order of painting, farthest first. */
  const std::vector<Face>& faces() const { return faces_; }

  /** Visits the faces in view in the order of painting, with their plane normal_C . p = offset. */
  void forEachFace(
      const std::function<void(const Face& face, const Eigen::Vector3d& normal_C, double offset)>& visit) const;
  /** Adds the edges of a face to a fill. @param face  the one being visited by forEachFace */
  void addEdges(const Face& face, CoverageRasterizer& rasterizer) const;

  /** What a pixel that looks at a picture sees of it; pixels elsewhere are undefined. */
  template <typename Value>
  const std::vector<ImageOf<Value>>& pictures() const {
    return std::get<std::vector<ImageOf<Value>>>(pictures_);
  }

  /** Where two models overlap and neither is wholly behind the other: painting is not right there. */
  const std::vector<PixelBox>& conflicts() const { return conflicts_; }

 private:
  /** One loop of pixel coordinates: points_[begin .. end). */
  struct Loop {
    std::size_t begin, end;
  };
  struct Part {
    Face face;
    Pose X_CM;
    std::vector<Loop> loops;
  };
  void addEdges(const Part& part, CoverageRasterizer& rasterizer) const;
  struct View {
    std::vector<Part> parts;  // in the order of painting
    std::vector<Eigen::Vector3d> corners_C;
    Eigen::Vector3d normal_C;  // of the side that faces the camera
    double offset = 0.0;       // normal_C . p for points p of the plane
    PixelBox box;
  };
  View takeView();
  Part takePart(const Face& face, const Pose& X_CM);
  void giveBack(View&& view);
  bool addModel(const CameraModel& camera, const ViewVolume& volume, const Pose& X_CM, const PlanarModel& model);
  void addLoop(const CameraModel& camera, const ViewCell& cell, const Pose& X_CM, bool inside, const Polygon& outline,
               View& view, Part& part);
  void addCurve(const CameraModel& camera, const ViewCell& cell, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px, int depth);
  void sort();

  std::vector<View> views_;
  std::vector<View> spare_views_;  // of earlier frames, and their parts: their memory is used again
  std::vector<Part> spare_parts_;
  std::vector<std::size_t> order_;
  std::vector<char> must_precede_, done_;  // scratch of sort()
  std::vector<Face> faces_;
  std::vector<PixelBox> conflicts_;
  std::tuple<std::vector<Image>, std::vector<FineImage>> pictures_;  // as many of both; sampled are those asked for
  TextureSampler sampler_;
  std::vector<Eigen::Vector2d> points_;                  // pixel coordinates of all loops
  std::vector<Eigen::Vector3d> polygon_;                 // scratch
  std::vector<std::pair<const ViewCell*, bool>> cells_;  // scratch: of the model being added, and whether it is inside
};

}  // namespace aras_visual_servo_sim
