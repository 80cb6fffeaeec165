#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <yaml-cpp/yaml.h>

#include <aras_visual_servo_common/fault_list.hpp>
#include <aras_visual_servo_common/python/bind_errors.hpp>
#include <aras_visual_servo_common/python/yaml_from_python.hpp>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "aras_visual_servo_camera/matching/match_extractor.hpp"
#include "aras_visual_servo_camera/photometric/photometric_extractor.hpp"
#include "aras_visual_servo_camera/tags/tag_extractor.hpp"
#include "conversions.hpp"

namespace py = pybind11;
using namespace aras_visual_servo_camera;  // NOLINT: this file is the module

namespace {

std::string repr(const MomentFeatures& f) {
  const auto number = [](double x) { return std::string(py::repr(py::float_(x))); };
  return "MomentFeatures(valid=" + std::string(f.valid ? "True" : "False") + ", area=" + number(f.area) +
         ", xg=" + number(f.xg) + ", yg=" + number(f.yg) + ", alpha=" + number(f.alpha) + ", xn=" + number(f.xn) +
         ", yn=" + number(f.yn) + ", an=" + number(f.an) + ")";
}

template <typename Features>
py::class_<Features> bindFeatures(py::module_& module, const std::string& name) {
  const std::string doc = "Of one image; the fields are those of aras_visual_servo_msgs/" + name + ".";
  return py::class_<Features>(module, name.c_str(), doc.c_str())
      .def(py::init<>(), "Nothing in view: every flag false, every number NaN, the lists empty.");
}

#define ARAS_BIND(field) features.def_readwrite(#field, &Features::field);

void bindAllFeatures(py::module_& module) {
  {
    using Features = MomentFeatures;
    auto features = bindFeatures<Features>(module, "MomentFeatures").def("__repr__", &repr);
    ARAS_MOMENT_FIELDS(ARAS_BIND)
  }
  {
    using Features = PhotometricFeatures;
    auto features = bindFeatures<Features>(module, "PhotometricFeatures");
    ARAS_PHOTOMETRIC_FIELDS(ARAS_BIND)
  }
  {
    using Features = MatchFeatures;
    auto features = bindFeatures<Features>(module, "MatchFeatures");
    ARAS_MATCH_FIELDS(ARAS_BIND)
  }
  {
    using Features = TagFeatures;
    auto features = bindFeatures<Features>(module, "TagFeatures");
    ARAS_TAG_FIELDS(ARAS_BIND)
  }
}

/** The intrinsics in a dictionary, with a warning where the lens folds inside the image. */
CameraIntrinsics intrinsicsFrom(const py::dict& camera_info) {
  const CameraIntrinsics found = readCameraInfo(aras_visual_servo_common::yamlFromPython(camera_info, "camera_info"));
  const std::string warning = found.foldWarning();
  if (!warning.empty() && PyErr_WarnEx(PyExc_UserWarning, warning.c_str(), 1) != 0) throw py::error_already_set();
  return found;
}

/** An extractor from the dictionaries of a camera_info and of a section of a scenario.
 *  @throws ParameterError  every fault of both, one per line */
template <typename Extractor, typename Settings>
std::unique_ptr<Extractor> makeExtractor(const py::dict& camera_info, const py::dict& config,
                                         const std::string& section, Settings (*read)(const YAML::Node&)) {
  using aras_visual_servo_common::yamlFromPython;
  aras_visual_servo_common::FaultList faults;
  std::optional<CameraIntrinsics> intrinsics;
  std::optional<Settings> settings;
  faults.collect([&] { intrinsics = intrinsicsFrom(camera_info); });
  faults.collect([&] { settings = read(yamlFromPython(config, section)); });
  faults.throwIfAny();
  return std::make_unique<Extractor>(*intrinsics, *settings);
}

/** What the docstrings of one extractor say. */
struct Docs {
  std::string extractor, process, returns;
};

/** The parts that all extractors have. @param section  dotted path of its settings @param with_depth  whether `process`
 *  takes a depth image */
template <typename Extractor, bool with_depth, typename Settings>
py::class_<Extractor> bindExtractor(py::module_& module, const char* name, const std::string& section,
                                    Settings (*read)(const YAML::Node&), const Docs& docs) {
  const std::string file = section.substr(section.rfind('.') + 1);
  const std::string init_doc = R"(Args:
    camera_info: dict with width, height, K (9), D, distortion_model, as sensor_msgs/CameraInfo. With binning_x,
        binning_y or roi these are of the whole sensor, and images have the size that is read out.
    config: the section `)" + section +
                               "` of a scenario, see schema/" + file + R"(.yaml of this package.
Raises:
    ParameterError: every fault of both, one per line.
Warns:
    UserWarning: the lens is not one-to-one inside the image; from which radius on.)";
  const std::string process_doc =
      docs.process + R"(

Args:
    image: uint8 or uint16, shape (h, w) grey, (h, w, 3) rgb or (h, w, 4) rgba, rows contiguous. Of uint16 white is the
        largest value of 8, 10, 12, 14 or 16 bits, whichever are enough for the images so far.
    stamp_ns: of the image; with one, `teach` finds it while it is among the last 32.
)" +
      (with_depth
           ?
           R"(    depth: float32 [m] or uint16 [mm], shape (h, w), rows contiguous: Z of the pixels, with holes of 0 or NaN; read
        where the section `depth` asks for it. One of another size, or None, is told in `depth_fault`.
)"
           : "") +
      "Returns:\n    " + docs.returns + "\nRaises:\n    ShapeError: another type, shape or size than camera_info.";
  py::class_<Extractor> extractor(module, name, docs.extractor.c_str());
  extractor
      .def(py::init([section, read](const py::dict& camera_info, const py::dict& config) {
             return makeExtractor<Extractor>(camera_info, config, section, read);
           }),
           py::arg("camera_info"), py::arg("config") = py::dict(), init_doc.c_str())
      .def("clear_reference", &Extractor::clearReference)
      .def(
          "set_camera_info",
          [](Extractor& self, const py::dict& camera_info) { self.setIntrinsics(intrinsicsFrom(camera_info)); },
          py::arg("camera_info"),
          R"(Take a camera with another lens, zoom or size, as after autofocus. The reference stays.

Where a photometric reference cannot be compared any more, features say so in `fault` and are not valid.
Raises ParameterError: every fault of camera_info, one per line.)")
      .def_property_readonly("features", &Extractor::features, py::return_value_policy::copy, "Of the last image.");
  if constexpr (with_depth) {
    extractor.def(
        "process",
        [](Extractor& self, const py::array& image, std::int64_t stamp_ns, const std::optional<py::array>& depth) {
          const DepthView view = depth ? depthOf(*depth) : DepthView{};
          return self.process(viewOf(image), stamp_ns, depth ? &view : nullptr);
        },
        py::arg("image"), py::arg("stamp_ns") = kNoStamp, py::arg("depth") = py::none(), process_doc.c_str());
  } else {
    extractor.def(
        "process",
        [](Extractor& self, const py::array& image, std::int64_t stamp_ns) {
          return self.process(viewOf(image), stamp_ns);
        },
        py::arg("image"), py::arg("stamp_ns") = kNoStamp, process_doc.c_str());
  }
  return extractor;
}

/** How an extractor whose goal is a whole image gets one. @param raises  what `set_reference` says of its errors */
template <typename Extractor>
void bindGoalImage(py::class_<Extractor>& extractor, const std::string& raises) {
  const std::string doc =
      "Make an image the goal, its optical axis meeting the plane of the target at depth z_star_m [m].\n\n" + raises;
  extractor
      .def(
          "set_reference",
          [](Extractor& self, const py::array& image, double z_star_m) { self.setReference(viewOf(image), z_star_m); },
          py::arg("image"), py::arg("z_star_m"), doc.c_str())
      .def("teach", &Extractor::teach, py::arg("stamp_ns"), py::arg("z_star_m"),
           R"(Make the image of this stamp the goal, its optical axis meeting the target's plane at depth z_star_m [m].

Raises ParameterError: it is not among the last 32 images; else as set_reference.)");
}

py::array_t<std::uint8_t> convertedImage(const MomentExtractor& extractor) {
  const ObjectMask& mask = extractor.mask();
  py::array_t<std::uint8_t> out({mask.height_px, mask.width_px});
  mask.render(out.mutable_data());
  return out;
}

void bindMoments(py::module_& module) {
  bindExtractor<MomentExtractor, true>(
      module, "MomentExtractor", "vision", readVisionConfig,
      {"Image in, moment features out. Same images, same bits.", "Features of one image.",
       "MomentFeatures; an empty view is a value (target_visible False), not an error."})
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
      .def_property_readonly("white", &MomentExtractor::white,
                             "Value of uint16 that counted as white in the last image of that type; 0 before one.")
      .def_property_readonly("converted_image", &convertedImage,
                             "What the moments saw of the last image: (h, w) uint8, weights 0..255; a copy.");
}

void bindGoalImages(py::module_& module) {
  auto photometric = bindExtractor<PhotometricExtractor, false>(
      module, "PhotometricExtractor", "vision.photometric", readPhotometricConfig,
      {"Image in, parts of the photometric normal equations out. Same images, same bits.",
       "Features of one image, relative to the reference.",
       "PhotometricFeatures; an image without contrast is a value (target_visible False), not an error."});
  bindGoalImage(
      photometric,
      "Raises DegenerateFeature (nothing to servo on in it), ParameterError, ShapeError; the reference stays then.");
  photometric.def(
      "set_reference",
      [](PhotometricExtractor& self, const py::array& image, const std::array<double, 3>& plane) {
        self.setReference(viewOf(image), Plane{plane[0], plane[1], plane[2]});
      },
      py::arg("image"), py::arg("plane"), "The plane given as (A, B, C) of 1/Z = A x + B y + C [1/m].");
  auto matches = bindExtractor<MatchExtractor, true>(
      module, "MatchExtractor", "vision.matches", readMatchingConfig,
      {"Image in, keypoints matched to those of the goal out. Same images, same bits.",
       "Features of one image, relative to the goal image.",
       "MatchFeatures; too few matches are a value (valid False, the reason in fault), not an error."});
  bindGoalImage(matches,
                "Raises DegenerateFeature (too few keypoints), ParameterError, ShapeError; the goal stays then.");
  auto tag = bindExtractor<TagExtractor, false>(
      module, "TagExtractor", "vision.tag", readTagConfig,
      {"Image in, corners and pose of one AprilTag out. Same images, same bits.",
       "Features of one image, relative to the goal image.",
       "TagFeatures; a tag that is not found is a value (valid False, the reason in fault), not an error."});
  bindGoalImage(tag, "Raises DegenerateFeature (no tag), ParameterError, ShapeError; the goal stays then.");
}

}  // namespace

/** A camera_info whose K, width and height are those of the images. */
py::dict imageInfo(const py::dict& camera_info) {
  const CameraIntrinsics image = readCameraInfo(aras_visual_servo_common::yamlFromPython(camera_info, "camera_info"));
  py::dict out = camera_info.attr("copy")();
  for (const char* key : {"binning_x", "binning_y", "roi"}) out.attr("pop")(key, py::none());
  out["width"] = image.width();
  out["height"] = image.height();
  out["K"] = std::vector<double>{image.fx(), 0.0, image.cx(), 0.0, image.fy(), image.cy(), 0.0, 0.0, 1.0};
  return out;
}

/** Normalised coordinates of pixel positions. */
py::array_t<double> undistort(const py::dict& camera_info, const py::array_t<double, py::array::c_style>& pixels) {
  const CameraIntrinsics image = readCameraInfo(aras_visual_servo_common::yamlFromPython(camera_info, "camera_info"));
  if (pixels.ndim() != 2 || pixels.shape(1) != 2)
    throw aras_visual_servo_common::ShapeError("pixels: allowed an array of shape (n, 2)");
  py::array_t<double> out({pixels.shape(0), py::ssize_t{2}});
  const auto uv = pixels.unchecked<2>();
  auto xy = out.mutable_unchecked<2>();
  for (py::ssize_t k = 0; k < pixels.shape(0); ++k) {
    const auto ray = image.undistort(uv(k, 0), uv(k, 1));
    xy(k, 0) = ray.valid ? ray.x : std::numeric_limits<double>::quiet_NaN();
    xy(k, 1) = ray.valid ? ray.y : std::numeric_limits<double>::quiet_NaN();
  }
  return out;
}

PYBIND11_MODULE(_camera, module) {
  module.doc() = "C++ core of aras_visual_servo_camera.";
  aras_visual_servo_common::bindErrors(module);
  bindAllFeatures(module);
  bindMoments(module);
  bindGoalImages(module);
  module.def("image_info", &imageInfo, py::arg("camera_info"),
             R"(The camera_info of the images themselves, for code that knows neither binning nor regions of interest.

Args:
    camera_info: dict as the extractors take it.
Returns:
    A new dict in which width, height and K are those of the images, without binning_x, binning_y and roi.
Raises:
    ParameterError: every fault of camera_info, one per line.)");
  module.def("undistort", &undistort, py::arg("camera_info"), py::arg("pixels"),
             R"(Normalised coordinates x = X/Z and y = Y/Z of positions in an image, the lens undone.

Args:
    camera_info: dict as the extractors take it.  pixels: (n, 2) u and v [px]; (0, 0) is the centre of the first pixel.
Returns:
    (n, 2) float64; NaN where no ray reaches the pixel or it is beyond the fold of the lens.
Raises:
    ParameterError: every fault of camera_info, one per line.  ShapeError: pixels of another shape.)");
  module.def("in_rgb", &inRgb, py::arg("image"), py::arg("encoding"),
             R"(The image of a camera as the extractors take it.

Args:
    image: as the camera gives it.  encoding: of sensor_msgs/image_encodings.h.
Returns:
    The same array of grey, rgb and rgba; else a new one of rgb in the same depth, (h, w, 3) uint8 or uint16. The missing
    colours of Bayer patterns and of yuv422 are interpolated linearly.
Raises:
    ShapeError: an encoding that the extractors do not take, or an image that does not have its shape and type.)");
}
