#include "bind_photometric.hpp"

#include <pybind11/stl.h>

#include "aras_visual_servo_camera/photometric/photometric_extractor.hpp"
#include "bind_extractor.hpp"

namespace py = pybind11;

namespace aras_visual_servo_camera {
namespace {

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
  py::class_<PhotometricExtractor> extractor(
      module, "PhotometricExtractor",
      "Image in, parts of the photometric normal equations out. Same images, same bits.");
  extractor.def(py::init([](const py::dict& camera_info, const py::dict& config) {
                  return makeExtractor<PhotometricExtractor>(camera_info, config, "vision/photometric",
                                                             readPhotometricConfig);
                }),
                py::arg("camera_info"), py::arg("config") = py::dict(),
                R"(Args:
    camera_info: dict with width, height, K (9), D, distortion_model, as sensor_msgs/CameraInfo.
    config: the section `vision.photometric` of a scenario, see schema/photometric.yaml of this package.
Raises:
    ParameterError: every fault, one per line.)");
  bindProcess(extractor, "Features of one image, relative to the reference.",
              "PhotometricFeatures; an image without contrast is a value (target_visible False), not an error.");
  bindGoalImage(
      extractor,
      "Raises DegenerateFeature (nothing to servo on in it), ParameterError, ShapeError; there is no reference then.");
  extractor.def(
      "set_reference",
      [](PhotometricExtractor& self, const py::array& image, const std::array<double, 3>& plane) {
        self.setReference(viewOf(image), Plane{plane[0], plane[1], plane[2]});
      },
      py::arg("image"), py::arg("plane"), "The plane given as (A, B, C) of 1/Z = A x + B y + C [1/m].");
}

}  // namespace aras_visual_servo_camera
