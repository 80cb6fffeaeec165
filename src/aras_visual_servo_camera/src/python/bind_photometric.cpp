#include "bind_photometric.hpp"

#include <pybind11/stl.h>

#include <aras_visual_servo_common/fault_list.hpp>
#include <aras_visual_servo_common/python/yaml_from_python.hpp>
#include <optional>

#include "aras_visual_servo_camera/photometric/photometric_extractor.hpp"
#include "conversions.hpp"

namespace py = pybind11;

namespace aras_visual_servo_camera {
namespace {

using aras_visual_servo_common::FaultList;
using aras_visual_servo_common::yamlFromPython;

void bindFeatures(py::module_& module) {
  using F = PhotometricFeatures;
  py::class_<F>(module, "PhotometricFeatures",
                "Of one image; the fields are those of aras_visual_servo_msgs/PhotometricFeatures.")
      .def(py::init<>(), "Nothing in view: every flag false, every number NaN, the lists empty.")
      .def_readwrite("target_visible", &F::target_visible)
      .def_readwrite("has_reference", &F::has_reference)
      .def_readwrite("valid", &F::valid)
      .def_readwrite("fault", &F::fault)
      .def_readwrite("interaction", &F::interaction)
      .def_readwrite("level", &F::level)
      .def_readwrite("levels", &F::levels)
      .def_readwrite("pixels", &F::pixels)
      .def_readwrite("rms", &F::rms)
      .def_readwrite("cost", &F::cost)
      .def_readwrite("H", &F::H)
      .def_readwrite("b", &F::b)
      .def_readwrite("condition", &F::condition)
      .def_readwrite("motion_px", &F::motion_px)
      .def_readwrite("z_star_m", &F::z_star_m)
      .def_readwrite("reference_hash", &F::reference_hash)
      .def_readwrite("reference_stamp_ns", &F::reference_stamp_ns);
}

}  // namespace

void bindPhotometric(py::module_& module) {
  bindFeatures(module);
  py::class_<PhotometricExtractor>(module, "PhotometricExtractor",
                                   "Image in, parts of the photometric normal equations out. Same images, same bits.")
      .def(py::init([](const py::dict& camera_info, const py::dict& config) {
             FaultList faults;
             std::optional<CameraIntrinsics> intrinsics;
             std::optional<PhotometricConfig> settings;
             faults.collect([&] { intrinsics = readCameraInfo(yamlFromPython(camera_info, "camera_info")); });
             faults.collect([&] { settings = readPhotometricConfig(yamlFromPython(config, "vision/photometric")); });
             faults.throwIfAny();
             return std::make_unique<PhotometricExtractor>(*intrinsics, *settings);
           }),
           py::arg("camera_info"), py::arg("config") = py::dict(),
           R"(Args:
    camera_info: dict with width, height, K (9), D, distortion_model, as sensor_msgs/CameraInfo.
    config: the section `vision.photometric` of a scenario, see schema/photometric.yaml of this package.
Raises:
    ParameterError: every fault, one per line.)")
      .def(
          "process",
          [](PhotometricExtractor& self, const py::array& image, std::int64_t stamp_ns) {
            return self.process(viewOf(image), stamp_ns);
          },
          py::arg("image"), py::arg("stamp_ns") = kNoStamp,
          R"(Features of one image, relative to the reference.

Args:
    image: uint8, shape (h, w) grey, (h, w, 3) rgb or (h, w, 4) rgba, rows contiguous.
    stamp_ns: of the image; with one, `teach` finds it while it is among the last 32.
Returns:
    PhotometricFeatures; an image without contrast is a value (target_visible False), not an error.
Raises:
    ShapeError: another type, shape or size than camera_info.)")
      .def(
          "set_reference",
          [](PhotometricExtractor& self, const py::array& image, double z_star_m) {
            self.setReference(viewOf(image), z_star_m);
          },
          py::arg("image"), py::arg("z_star_m"),
          R"(Make an image the goal, its optical axis meeting the plane of the target at depth z_star_m [m].

Raises DegenerateFeature (nothing to servo on in it), ParameterError, ShapeError; there is no reference then.)")
      .def(
          "set_reference",
          [](PhotometricExtractor& self, const py::array& image, const std::array<double, 3>& plane) {
            self.setReference(viewOf(image), Plane{plane[0], plane[1], plane[2]});
          },
          py::arg("image"), py::arg("plane"), "The plane given as (A, B, C) of 1/Z = A x + B y + C [1/m].")
      .def("teach", &PhotometricExtractor::teach, py::arg("stamp_ns"), py::arg("z_star_m"),
           R"(Make the image of this stamp the goal, its optical axis meeting the target's plane at depth z_star_m [m].

Raises ParameterError: it is not among the last 32 images; else as set_reference.)")
      .def("clear_reference", &PhotometricExtractor::clearReference)
      .def_property_readonly("features", &PhotometricExtractor::features, py::return_value_policy::copy,
                             "Of the last image.");
}

}  // namespace aras_visual_servo_camera
