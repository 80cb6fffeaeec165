#include <exception>
#include <string>
#include <tuple>
#include <vector>

#include "bindings.hpp"

namespace aras_visual_servo_sim {
namespace {

/** A Frame whose image is an array; what else it holds becomes arrays when it is asked for. */
struct PythonFrame {
  py::array image;
  FrameState state;
};

/** Read-only array over what a camera has; keeps the world alive. */
py::array viewOf(const py::dtype& type, const std::vector<py::ssize_t>& shape, const void* data,
                 const py::object& world) {
  py::array view(type, shape, data, world);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

py::array viewOf(const Image& image, const py::object& world) {
  std::vector<py::ssize_t> shape = {image.height, image.width};
  if (image.channels() > 1) shape.push_back(image.channels());
  const py::dtype type = isDeep(image.encoding) ? py::dtype::of<std::uint16_t>() : py::dtype::of<std::uint8_t>();
  return viewOf(type, shape, image.data.data(), world);
}

py::array viewOf(const GeometryImage& image, const py::object& world) {
  return viewOf(py::dtype::of<float>(), {image.height, image.width}, image.depth_m.data(), world);
}

const Image& drawn(World& world, int camera) {
  const py::gil_scoped_release release;
  return world.render(camera);
}

py::array render(const py::object& self, const std::string& camera) {
  auto& world = self.cast<World&>();
  return viewOf(drawn(world, world.cameras().index(camera)), self);
}

PythonFrame frame(const py::object& self, const std::string& camera) {
  auto& world = self.cast<World&>();
  const int index = world.cameras().index(camera);
  return {viewOf(drawn(world, index), self), world.frameState(index)};
}

py::dict modelPoses(const FrameState& state) {
  py::dict poses;
  for (const auto& [name, X_WM] : state.models) poses[name.c_str()] = X_WM.matrix();
  return poses;
}

py::dict frameState(const World& world, const std::string& camera) {
  const FrameState state = world.frameState(world.cameras().index(camera));
  return py::dict("stamp_ns"_a = state.stamp_ns, "joint_positions"_a = state.q, "joint_velocities"_a = state.v,
                  "camera_pose"_a = state.X_WC.matrix(), "camera_twist"_a = state.V_WC_C,
                  "model_poses"_a = modelPoses(state));
}

const GeometryImage& geometryOf(World& world, const std::string& camera, Distance distance = Distance::kDepth) {
  const py::gil_scoped_release release;
  return world.renderGeometry(world.cameras().index(camera), distance);
}

template <typename T>
py::array_t<T> copied(const GeometryImage& image, const std::vector<T>& values) {
  return py::array_t<T>({py::ssize_t(image.height), py::ssize_t(image.width)}, values.data());
}

/** Frames by the names of their cameras. @param wanted  name -> whether the image, whether the depth is wanted */
py::dict takeFrames(const py::object& self, const std::vector<std::tuple<std::string, bool, bool>>& wanted) {
  auto& world = self.cast<World&>();
  std::vector<FrameWanted> frames;
  for (const auto& [camera, image, depth] : wanted) frames.push_back({world.cameras().index(camera), image, depth});
  {
    const py::gil_scoped_release release;
    world.takeFrames(frames);
  }
  py::dict taken;
  for (const FrameWanted& frame : frames) {
    const Camera& camera = world.cameras()[frame.camera];
    const py::str name(world.cameras().names()[frame.camera]);
    try {
      if (frame.failed) std::rethrow_exception(frame.failed);
      py::object image = py::none(), depth = py::none();
      if (frame.image) image = viewOf(camera.image, self);
      if (frame.geometry) depth = viewOf(camera.geometry, self);
      taken[name] = py::make_tuple(image, depth);
    } catch (const ArasError& error) {
      taken[name] = py::str(error.what());
    }
  }
  return taken;
}

void bindFrame(py::module_& module) {
  py::class_<PythonFrame>(module, "Frame",
                          "An image of a camera and what was true when it was exposed. Never changes,\n"
                          "but for the content of its image.")
      .def_property_readonly(
          "stamp_ns", [](const PythonFrame& self) { return self.state.stamp_ns; },
          "Simulated time of the exposure, int [ns].")
      .def_readonly("image", &PythonFrame::image,
                    "Array (h, w, 3) of rgb8, bgr8, rgb16, else (h, w), top row first; uint16 of rgb16 and mono16,\n"
                    "else uint8; a read-only view without a copy, its content valid until the next render of this\n"
                    "camera.")
      .def_property_readonly(
          "joint_positions", [](const PythonFrame& self) -> Eigen::VectorXd { return self.state.q; },
          "(n,) float64 [m or rad], in the order of Simulation.joint_names (sorted by name).")
      .def_property_readonly(
          "joint_velocities", [](const PythonFrame& self) -> Eigen::VectorXd { return self.state.v; },
          "(n,) float64 [m/s or rad/s].")
      .def_property_readonly(
          "camera_pose", [](const PythonFrame& self) { return self.state.X_WC.matrix(); }, "X_WC, (4, 4).")
      .def_property_readonly(
          "camera_twist", [](const PythonFrame& self) -> Twist { return self.state.V_WC_C; },
          "V_WC_C, (6,): [v; w] [m/s; rad/s].")
      .def_property_readonly(
          "model_poses", [](const PythonFrame& self) { return modelPoses(self.state); },
          "dict of name -> X_WM, (4, 4), of the models and solids of the scene.");
}

}  // namespace

void bindFrames(py::module_& module, WorldClass& type) {
  bindFrame(module);
  type.def(
          "camera_encoding",
          [](const World& self, const std::string& camera) {
            return self.cameras()[self.cameras().index(camera)].model().config().encoding;
          },
          py::arg("camera") = "camera", "One of those that the key `encoding` may be, as \"mono8\".")
      .def("frame", &frame, py::arg("camera") = "camera",
           "Renders as render does, and returns the image with what was true when it was exposed.\n\n"
           "Raises:\n    UnknownNameError, RenderError.")
      .def("frame_state", &frameState, py::arg("camera") = "camera",
           "What was true when the image of this camera was exposed: of the frame taken last at the present tick if "
           "the\n"
           "camera has latency, else of the present. Nothing is drawn.\n\n"
           "Returns:\n    dict of stamp_ns [ns], joint_positions (n,) [m or rad], joint_velocities (n,), camera_pose\n"
           "    X_WC (4, 4), camera_twist V_WC_C (6,), model_poses: dict of name -> X_WM (4, 4).")
      .def("render", &render, py::arg("camera") = "camera",
           "What the camera sees now; at a frame of a camera with exposure_s the mean over it; where a frame of a\n"
           "camera with latency_s was taken, that frame.\n\n"
           "Returns:\n    array (h, w, 3) of rgb8, bgr8, rgb16, else (h, w), top row first; uint16 of rgb16 and "
           "mono16, else\n"
           "    uint8; a read-only view without a copy, its content valid until the next render of this camera.\n"
           "Raises:\n    UnknownNameError, RenderError.");
  type.def(
      "take_frames", &takeFrames, py::arg("wanted"),
      "Takes frames that are due now and draws them: as step_to_image, render and render_depth of one camera after\n"
      "another do, with the same run hash, but large images at the same time where there are processors.\n\n"
      "Args:\n    wanted: list of (camera, whether its image, whether its depth is wanted).\n"
      "Returns:\n    dict of camera -> (image as of render, depth as of render_depth, a read-only view too), each None "
      "if\n"
      "    it is not wanted; in their place, str, why it could not be drawn.\n"
      "Raises:\n    UnknownNameError, ParameterError: no frame of it is due; nothing is taken then.");
  type.def(
          "render_depth",
          [](World& self, const std::string& camera) {
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
          [](World& self, const std::string& camera) {
            const GeometryImage& image = geometryOf(self, camera, Distance::kRange);
            return copied(image, image.depth_m);
          },
          py::arg("camera") = "camera",
          "Distance of what the centre of each pixel sees now, in any direction.\n\nReturns:\n    float32 array (h, w) "
          "[m],\n    top row first, NaN where there is nothing.\nRaises:\n    UnknownNameError.")
      .def(
          "render_segmentation",
          [](World& self, const std::string& camera) {
            const GeometryImage& image = geometryOf(self, camera);
            return copied(image, image.ids);
          },
          py::arg("camera") = "camera",
          "Which thing the centre of each pixel sees now.\n\nReturns:\n    uint16 array (h, w) of the numbers in\n"
          "    segmentation_ids, 0 where there is nothing.\nRaises:\n    UnknownNameError.")
      .def(
          "trigger", [](World& self, const std::string& camera) { self.trigger(self.cameras().index(camera)); },
          py::arg("camera") = "camera",
          "Asks a camera with `triggered: true` for one frame, the next of its schedule after now.")
      .def_property_readonly(
          "dropped_frames", [](const World& self) { return self.cameras().droppedFrames(); },
          "Frames passed over because of drop_probability since the last reset, of all cameras.")
      .def_property_readonly(
          "segmentation_ids", [](const World& self) { return segmentationIds(self.scene()); },
          "dict name -> number of every planar model, solid and link in render_segmentation.");
}

}  // namespace aras_visual_servo_sim
