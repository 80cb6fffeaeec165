#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <aras_visual_servo_common/python/bind_errors.hpp>
#include <cmath>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "bind_extractor.hpp"
#include "bind_matches.hpp"
#include "bind_photometric.hpp"
#include "bind_tag.hpp"

namespace py = pybind11;
using namespace aras_visual_servo_camera;  // NOLINT: this file is the module

namespace {

std::string repr(const MomentFeatures& f) {
  const auto number = [](double x) { return std::string(py::repr(py::float_(x))); };
  return "MomentFeatures(valid=" + std::string(f.valid ? "True" : "False") + ", area=" + number(f.area) +
         ", xg=" + number(f.xg) + ", yg=" + number(f.yg) + ", alpha=" + number(f.alpha) + ", xn=" + number(f.xn) +
         ", yn=" + number(f.yn) + ", an=" + number(f.an) + ")";
}

void bindFeatures(py::module_& module) {
  py::class_<MomentFeatures>(module, "MomentFeatures",
                             "Features of one image; the fields are those of aras_visual_servo_msgs/MomentFeatures.")
      .def(py::init<>(), "Nothing in view: every flag false, every number NaN, the lists empty.")
      .def_readwrite("target_visible", &MomentFeatures::target_visible)
      .def_readwrite("touches_border", &MomentFeatures::touches_border)
      .def_readwrite("symmetric", &MomentFeatures::symmetric)
      .def_readwrite("has_reference", &MomentFeatures::has_reference)
      .def_readwrite("valid", &MomentFeatures::valid)
      .def_readwrite("ambiguous", &MomentFeatures::ambiguous)
      .def_readwrite("components", &MomentFeatures::components)
      .def_readwrite("area", &MomentFeatures::area)
      .def_readwrite("xg", &MomentFeatures::xg)
      .def_readwrite("yg", &MomentFeatures::yg)
      .def_readwrite("alpha", &MomentFeatures::alpha)
      .def_readwrite("xn", &MomentFeatures::xn)
      .def_readwrite("yn", &MomentFeatures::yn)
      .def_readwrite("an", &MomentFeatures::an)
      .def_readwrite("z_star_m", &MomentFeatures::z_star_m)
      .def_readwrite("area_star", &MomentFeatures::area_star)
      .def_readwrite("reference_stamp_ns", &MomentFeatures::reference_stamp_ns)
      .def_readwrite("orientation_condition", &MomentFeatures::orientation_condition)
      .def_readwrite("asymmetry", &MomentFeatures::asymmetry)
      .def_readwrite("moment_names", &MomentFeatures::moment_names)
      .def_readwrite("m", &MomentFeatures::m)
      .def_readwrite("mu", &MomentFeatures::mu)
      .def_readwrite("point_x", &MomentFeatures::point_x)
      .def_readwrite("point_y", &MomentFeatures::point_y)
      .def_readwrite("point_z", &MomentFeatures::point_z)
      .def_readwrite("depth_fault", &MomentFeatures::depth_fault)
      .def_readwrite("ray_x", &MomentFeatures::ray_x)
      .def_readwrite("ray_y", &MomentFeatures::ray_y)
      .def_readwrite("ray_z", &MomentFeatures::ray_z)
      .def_readwrite("kernel_x", &MomentFeatures::kernel_x)
      .def_readwrite("kernel_y", &MomentFeatures::kernel_y)
      .def("__repr__", &repr);
}

py::array_t<std::uint8_t> convertedImage(const MomentExtractor& extractor) {
  const ObjectMask& mask = extractor.mask();
  py::array_t<std::uint8_t> out({mask.height_px, mask.width_px});
  mask.render(out.mutable_data());
  return out;
}

void bindExtractor(py::module_& module) {
  py::class_<MomentExtractor> extractor(module, "MomentExtractor",
                                        "Image in, moment features out. Same images, same bits.");
  extractor.def(py::init([](const py::dict& camera_info, const py::dict& config) {
                  return makeExtractor<MomentExtractor>(camera_info, config, "vision", readVisionConfig);
                }),
                py::arg("camera_info"), py::arg("config"),
                R"(Args:
    camera_info: dict with width, height, K (9), D, distortion_model, as sensor_msgs/CameraInfo.
    config: the `vision` section of a scenario, see schema/vision.yaml of this package.
Raises:
    ParameterError: every fault of both, one per line.)");
  bindDepthProcess(extractor, "Features of one image.",
                   "MomentFeatures; an empty view is a value (target_visible False), not an error.");
  extractor
      .def(
          "set_reference",
          [](MomentExtractor& self, double z_star_m, double area_star, double alpha_star) {
            self.setReference(z_star_m, area_star, alpha_star);
          },
          py::arg("z_star_m"), py::arg("area_star"), py::arg("alpha_star"),
          R"(The reference by its numbers: depth [m], m00 [-], orientation [rad].

Third-order moments are then learnt from the first asymmetric view, taken to lie within 90 degrees of alpha_star.
Raises ParameterError unless z_star_m and area_star are > 0 and all are finite.)")
      .def(
          "set_reference",
          [](MomentExtractor& self, double z_star_m, const py::object& features) {
            self.setReference(z_star_m, toFeatures(features));
          },
          py::arg("z_star_m"), py::arg("features"),
          R"(Make a view the reference, seen from depth z_star_m [m].

features: MomentFeatures or the ROS message. Raises DegenerateFeature if it is not valid.)")
      .def("teach", &MomentExtractor::teach, py::arg("stamp_ns"), py::arg("z_star_m"),
           R"(Make the image of this stamp the reference, seen from depth z_star_m [m].

Raises ParameterError: it is not among the last 32 images; DegenerateFeature: its features are not valid.)")
      .def("forget_previous", &MomentExtractor::forgetPrevious,
           "Use nothing of earlier images (after a reset of time); the reference stays.")
      .def_property_readonly("converted_image", &convertedImage,
                             "What the moments saw of the last image: (h, w) uint8, weights 0..255; a copy.");
}

}  // namespace

PYBIND11_MODULE(_camera, module) {
  module.doc() = "C++ core of aras_visual_servo_camera.";
  aras_visual_servo_common::bindErrors(module);
  bindFeatures(module);
  bindExtractor(module);
  module.def("in_rgb", &inRgb, py::arg("image"), py::arg("encoding"),
             R"(The image of a camera as the extractors take it.

Args:
    image: as the camera gives it.  encoding: of sensor_msgs/image_encodings.h.
Returns:
    The same array; of bgr8 and of the four Bayer patterns of 8 bits, whose missing colours are interpolated linearly, a
    new one of rgb8, (h, w, 3) uint8.
Raises:
    ShapeError: an encoding that the extractors do not take, or an image that does not have its shape and type.)");
  bindPhotometric(module);
  bindMatches(module);
  bindTag(module);
}
