#include "bind_matches.hpp"

#include <pybind11/stl.h>

#include <aras_visual_servo_common/fault_list.hpp>
#include <aras_visual_servo_common/python/yaml_from_python.hpp>
#include <optional>

#include "aras_visual_servo_camera/matching/match_extractor.hpp"
#include "conversions.hpp"

namespace py = pybind11;

namespace aras_visual_servo_camera {
namespace {

using aras_visual_servo_common::FaultList;
using aras_visual_servo_common::yamlFromPython;

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
      .def_readwrite("as_goal_x", &F::as_goal_x)
      .def_readwrite("as_goal_y", &F::as_goal_y)
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
  py::class_<MatchExtractor>(module, "MatchExtractor",
                             "Image in, keypoints matched to those of the goal out. Same images, same bits.")
      .def(py::init([](const py::dict& camera_info, const py::dict& config) {
             FaultList faults;
             std::optional<CameraIntrinsics> intrinsics;
             std::optional<MatchingConfig> settings;
             faults.collect([&] { intrinsics = readCameraInfo(yamlFromPython(camera_info, "camera_info")); });
             faults.collect([&] { settings = readMatchingConfig(yamlFromPython(config, "vision/matches")); });
             faults.throwIfAny();
             return std::make_unique<MatchExtractor>(*intrinsics, *settings);
           }),
           py::arg("camera_info"), py::arg("config") = py::dict(),
           R"(Args:
    camera_info: dict with width, height, K (9), D, distortion_model, as sensor_msgs/CameraInfo.
    config: the section `vision.matches` of a scenario, see schema/matches.yaml of this package.
Raises:
    ParameterError: every fault, one per line.)")
      .def(
          "process",
          [](MatchExtractor& self, const py::array& image, std::int64_t stamp_ns) {
            return self.process(viewOf(image), stamp_ns);
          },
          py::arg("image"), py::arg("stamp_ns") = kNoStamp,
          R"(Features of one image, relative to the goal image.

Args:
    image: uint8, shape (h, w) grey, (h, w, 3) rgb or (h, w, 4) rgba, rows contiguous.
    stamp_ns: of the image; with one, `teach` finds it while it is among the last 32.
Returns:
    MatchFeatures; too few matches are a value (valid False, the reason in fault), not an error.
Raises:
    ShapeError: another type, shape or size than camera_info.)")
      .def(
          "set_reference",
          [](MatchExtractor& self, const py::array& image, double z_star_m) {
            self.setReference(viewOf(image), z_star_m);
          },
          py::arg("image"), py::arg("z_star_m"),
          R"(Make an image the goal, its optical axis meeting the plane of the target at depth z_star_m [m].

Raises DegenerateFeature (too few keypoints), ParameterError, ShapeError; there is no goal then.)")
      .def("teach", &MatchExtractor::teach, py::arg("stamp_ns"), py::arg("z_star_m"),
           R"(Make the image of this stamp the goal, its optical axis meeting the target's plane at depth z_star_m [m].

Raises ParameterError: it is not among the last 32 images; else as set_reference.)")
      .def("clear_reference", &MatchExtractor::clearReference)
      .def_property_readonly("features", &MatchExtractor::features, py::return_value_policy::copy,
                             "Of the last image.");
}

}  // namespace aras_visual_servo_camera
