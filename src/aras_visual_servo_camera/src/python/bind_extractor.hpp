#pragma once

#include <pybind11/stl.h>
#include <yaml-cpp/yaml.h>

#include <aras_visual_servo_common/fault_list.hpp>
#include <aras_visual_servo_common/python/yaml_from_python.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "conversions.hpp"

namespace aras_visual_servo_camera {

/** An extractor from the dictionaries of a camera_info and of a section of a scenario.
 *  @param section  its path, for errors  @param read  the settings of its YAML
 *  @throws ParameterError  every fault of both, one per line */
template <typename Extractor, typename Settings>
std::unique_ptr<Extractor> makeExtractor(const pybind11::dict& camera_info, const pybind11::dict& config,
                                         const std::string& section, Settings (*read)(const YAML::Node&)) {
  using aras_visual_servo_common::yamlFromPython;
  aras_visual_servo_common::FaultList faults;
  std::optional<CameraIntrinsics> intrinsics;
  std::optional<Settings> settings;
  faults.collect([&] { intrinsics = readCameraInfo(yamlFromPython(camera_info, "camera_info")); });
  faults.collect([&] { settings = read(yamlFromPython(config, section)); });
  faults.throwIfAny();
  return std::make_unique<Extractor>(*intrinsics, *settings);
}

/** What every extractor does with an image, but for `process`. */
template <typename Extractor>
void bindFeaturesOf(pybind11::class_<Extractor>& extractor) {
  extractor.def("clear_reference", &Extractor::clearReference)
      .def_property_readonly("features", &Extractor::features, pybind11::return_value_policy::copy,
                             "Of the last image.");
}

/** The docstring of `process`. @param first, returns  sentences of it. @param more  lines about further arguments */
inline std::string processDoc(const std::string& first, const std::string& returns, const std::string& more) {
  return first + R"(

Args:
    image: uint8, shape (h, w) grey, (h, w, 3) rgb or (h, w, 4) rgba, or uint16 of the first two, rows contiguous.
    stamp_ns: of the image; with one, `teach` finds it while it is among the last 32.
)" + more +
         R"(Returns:
    )" + returns +
         R"(
Raises:
    ShapeError: another type, shape or size than camera_info.)";
}

/** `process` and what comes of it. @param first, returns  sentences of its docstring */
template <typename Extractor>
void bindProcess(pybind11::class_<Extractor>& extractor, const std::string& first, const std::string& returns) {
  extractor.def(
      "process",
      [](Extractor& self, const pybind11::array& image, std::int64_t stamp_ns) {
        return self.process(viewOf(image), stamp_ns);
      },
      pybind11::arg("image"), pybind11::arg("stamp_ns") = kNoStamp, processDoc(first, returns, "").c_str());
  bindFeaturesOf(extractor);
}

/** The same of an extractor that can use a depth image. */
template <typename Extractor>
void bindDepthProcess(pybind11::class_<Extractor>& extractor, const std::string& first, const std::string& returns) {
  const std::string depth =
      R"(    depth: float32 [m] or uint16 [mm], shape (h, w), rows contiguous: Z of the pixels, with holes of 0 or NaN; read
        where the section `depth` asks for it. One of another size, or None, is told in `depth_fault`.
)";
  extractor.def(
      "process",
      [](Extractor& self, const pybind11::array& image, std::int64_t stamp_ns,
         const std::optional<pybind11::array>& depth) {
        const DepthView view = depth ? depthOf(*depth) : DepthView{};
        return self.process(viewOf(image), stamp_ns, depth ? &view : nullptr);
      },
      pybind11::arg("image"), pybind11::arg("stamp_ns") = kNoStamp, pybind11::arg("depth") = pybind11::none(),
      processDoc(first, returns, depth).c_str());
  bindFeaturesOf(extractor);
}

/** How an extractor whose goal is a whole image gets one. @param raises  what `set_reference` says of its errors */
template <typename Extractor>
void bindGoalImage(pybind11::class_<Extractor>& extractor, const std::string& raises) {
  const std::string doc =
      "Make an image the goal, its optical axis meeting the plane of the target at depth z_star_m [m].\n\n" + raises;
  extractor
      .def(
          "set_reference",
          [](Extractor& self, const pybind11::array& image, double z_star_m) {
            self.setReference(viewOf(image), z_star_m);
          },
          pybind11::arg("image"), pybind11::arg("z_star_m"), doc.c_str())
      .def("teach", &Extractor::teach, pybind11::arg("stamp_ns"), pybind11::arg("z_star_m"),
           R"(Make the image of this stamp the goal, its optical axis meeting the target's plane at depth z_star_m [m].

Raises ParameterError: it is not among the last 32 images; else as set_reference.)");
}

}  // namespace aras_visual_servo_camera
