#include "bind_tag.hpp"

#include <pybind11/stl.h>

#include "aras_visual_servo_camera/tags/tag_extractor.hpp"
#include "bind_extractor.hpp"

namespace py = pybind11;

namespace aras_visual_servo_camera {
namespace {

void bindFeatures(py::module_& module) {
  using F = TagFeatures;
  py::class_<F>(module, "TagFeatures", "Of one image; the fields are those of aras_visual_servo_msgs/TagFeatures.")
      .def(py::init<>(), "Nothing in view: every flag false, every number NaN, the lists empty.")
      .def_readwrite("target_visible", &F::target_visible)
      .def_readwrite("has_reference", &F::has_reference)
      .def_readwrite("valid", &F::valid)
      .def_readwrite("fault", &F::fault)
      .def_readwrite("family", &F::family)
      .def_readwrite("id", &F::id)
      .def_readwrite("tags", &F::tags)
      .def_readwrite("side_px", &F::side_px)
      .def_readwrite("xg", &F::xg)
      .def_readwrite("yg", &F::yg)
      .def_readwrite("point_x", &F::point_x)
      .def_readwrite("point_y", &F::point_y)
      .def_readwrite("homography", &F::homography)
      .def_readwrite("position_m", &F::position_m)
      .def_readwrite("orientation", &F::orientation)
      .def_readwrite("pose_error", &F::pose_error)
      .def_readwrite("other_pose_error", &F::other_pose_error)
      .def_readwrite("z_star_m", &F::z_star_m)
      .def_readwrite("reference_stamp_ns", &F::reference_stamp_ns);
}

}  // namespace

void bindTag(py::module_& module) {
  bindFeatures(module);
  py::class_<TagExtractor> extractor(module, "TagExtractor",
                                     "Image in, corners and pose of one AprilTag out. Same images, same bits.");
  extractor.def(py::init([](const py::dict& camera_info, const py::dict& config) {
                  return makeExtractor<TagExtractor>(camera_info, config, "vision/tag", readTagConfig);
                }),
                py::arg("camera_info"), py::arg("config") = py::dict(),
                R"(Args:
    camera_info: dict with width, height, K (9), D, distortion_model, as sensor_msgs/CameraInfo.
    config: the section `vision.tag` of a scenario, see schema/tag.yaml of this package.
Raises:
    ParameterError: every fault, one per line.)");
  bindProcess(extractor, "Features of one image, relative to the goal image.",
              "TagFeatures; a tag that is not found is a value (valid False, the reason in fault), not an error.");
  bindGoalImage(extractor, "Raises DegenerateFeature (no tag), ParameterError, ShapeError; there is no goal then.");
}

}  // namespace aras_visual_servo_camera
