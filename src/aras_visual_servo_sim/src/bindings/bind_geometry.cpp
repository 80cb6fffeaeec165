#include "bind_geometry.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

namespace py = pybind11;

namespace aras_visual_servo_sim {
namespace {

const GeometryImage& geometryOf(Simulation& simulation, const std::string& camera,
                                Distance distance = Distance::kDepth) {
  const py::gil_scoped_release release;
  return simulation.renderGeometry(simulation.cameras().index(camera), distance);
}

template <typename T>
py::array_t<T> copied(const GeometryImage& image, const std::vector<T>& values) {
  return py::array_t<T>({py::ssize_t(image.height), py::ssize_t(image.width)}, values.data());
}

}  // namespace

void bindGeometry(py::class_<Simulation>& type) {
  type.def(
          "render_depth",
          [](Simulation& self, const std::string& camera) {
            const GeometryImage& image = geometryOf(self, camera);
            return copied(image, image.depth_m);
          },
          py::arg("camera") = "camera",
          "Depth of what the centre of each pixel sees now.\n\nReturns:\n    float32 array (h, w): Z along the "
          "optical\n"
          "    axis [m], top row first, NaN where there is nothing, or where a fisheye sees what lies beside or\n"
          "    behind the camera (Z <= 0).\nRaises:\n    UnknownNameError.")
      .def(
          "render_range",
          [](Simulation& self, const std::string& camera) {
            const GeometryImage& image = geometryOf(self, camera, Distance::kRange);
            return copied(image, image.depth_m);
          },
          py::arg("camera") = "camera",
          "Distance of what the centre of each pixel sees now, in any direction.\n\nReturns:\n    float32 array (h, w) "
          "[m],\n    top row first, NaN where there is nothing.\nRaises:\n    UnknownNameError.")
      .def(
          "render_segmentation",
          [](Simulation& self, const std::string& camera) {
            const GeometryImage& image = geometryOf(self, camera);
            return copied(image, image.ids);
          },
          py::arg("camera") = "camera",
          "Which thing the centre of each pixel sees now.\n\nReturns:\n    uint16 array (h, w) of the numbers in\n"
          "    segmentation_ids, 0 where there is nothing.\nRaises:\n    UnknownNameError.")
      .def(
          "trigger", [](Simulation& self, const std::string& camera) { self.trigger(self.cameras().index(camera)); },
          py::arg("camera") = "camera",
          "Asks a camera with `triggered: true` for one frame, the next of its schedule after now.")
      .def_property_readonly(
          "dropped_frames", [](const Simulation& self) { return self.cameras().droppedFrames(); },
          "Frames passed over because of drop_probability since the last reset, of all cameras.")
      .def_property_readonly(
          "segmentation_ids", [](const Simulation& self) { return segmentationIds(self.scene()); },
          "dict name -> number of every planar model, solid and link in render_segmentation.");
}

}  // namespace aras_visual_servo_sim
