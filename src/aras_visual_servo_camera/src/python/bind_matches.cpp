#include "bind_matches.hpp"

#include <pybind11/stl.h>

#include "aras_visual_servo_camera/matching/match_extractor.hpp"
#include "bind_extractor.hpp"

namespace py = pybind11;

namespace aras_visual_servo_camera {
namespace {

void bindFeatures(py::module_& module) {
  using F = MatchFeatures;
  py::class_<F>(module, "MatchFeatures", "Of one image; the fields are those of aras_visual_servo_msgs/MatchFeatures.")
      .def(py::init<>(), "Nothing in view: every flag false, every number NaN, the lists empty.")
      .def_readwrite("target_visible", &F::target_visible)
      .def_readwrite("has_reference", &F::has_reference)
      .def_readwrite("valid", &F::valid)
      .def_readwrite("fault", &F::fault)
      .def_readwrite("detector", &F::detector)
      .def_readwrite("keypoints", &F::keypoints)
      .def_readwrite("goal_keypoints", &F::goal_keypoints)
      .def_readwrite("matches", &F::matches)
      .def_readwrite("inliers", &F::inliers)
      .def_readwrite("rms_px", &F::rms_px)
      .def_readwrite("xg", &F::xg)
      .def_readwrite("yg", &F::yg)
      .def_readwrite("point_x", &F::point_x)
      .def_readwrite("point_y", &F::point_y)
      .def_readwrite("point_z", &F::point_z)
      .def_readwrite("depth_fault", &F::depth_fault)
      .def_readwrite("as_goal_x", &F::as_goal_x)
      .def_readwrite("as_goal_y", &F::as_goal_y)
      .def_readwrite("as_goal_z", &F::as_goal_z)
      .def_readwrite("homography", &F::homography)
      .def_readwrite("match_x", &F::match_x)
      .def_readwrite("match_y", &F::match_y)
      .def_readwrite("match_goal_x", &F::match_goal_x)
      .def_readwrite("match_goal_y", &F::match_goal_y)
      .def_readwrite("z_star_m", &F::z_star_m)
      .def_readwrite("reference_stamp_ns", &F::reference_stamp_ns);
}

}  // namespace

void bindMatches(py::module_& module) {
  bindFeatures(module);
  py::class_<MatchExtractor> extractor(module, "MatchExtractor",
                                       "Image in, keypoints matched to those of the goal out. Same images, same bits.");
  extractor.def(py::init([](const py::dict& camera_info, const py::dict& config) {
                  return makeExtractor<MatchExtractor>(camera_info, config, "vision/matches", readMatchingConfig);
                }),
                py::arg("camera_info"), py::arg("config") = py::dict(),
                R"(Args:
    camera_info: dict with width, height, K (9), D, distortion_model, as sensor_msgs/CameraInfo.
    config: the section `vision.matches` of a scenario, see schema/matches.yaml of this package.
Raises:
    ParameterError: every fault, one per line.)");
  bindDepthProcess(extractor, "Features of one image, relative to the goal image.",
                   "MatchFeatures; too few matches are a value (valid False, the reason in fault), not an error.");
  bindGoalImage(extractor,
                "Raises DegenerateFeature (too few keypoints), ParameterError, ShapeError; there is no goal then.");
}

}  // namespace aras_visual_servo_camera
