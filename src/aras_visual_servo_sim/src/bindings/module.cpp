#include <pybind11/pybind11.h>

#include <aras_visual_servo_common/python/bind_errors.hpp>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/render/opengl_renderer.hpp"
#include "bind_shapes.hpp"
#include "bind_simulation.hpp"

namespace {

std::string openGlDescription(const std::string& gl) {
  using aras_visual_servo_sim::OpenGlRenderer;
  if (gl != "osmesa" && gl != "egl") {
    throw aras_visual_servo_sim::ParameterError("gl: found '" + gl + "', allowed osmesa, egl");
  }
  return OpenGlRenderer(gl == "egl" ? OpenGlRenderer::Platform::kEgl : OpenGlRenderer::Platform::kOsmesa).description();
}

}  // namespace

PYBIND11_MODULE(_sim, module) {
  module.doc() = "Binding of the simulator core; use the package aras_visual_servo_sim.";
  aras_visual_servo_common::bindErrors(module);
  aras_visual_servo_sim::bindSimulation(module);
  aras_visual_servo_sim::bindShapes(module);
  module.def("opengl_description", &openGlDescription, pybind11::arg("gl") = "osmesa",
             "What draws the images of cameras with `renderer: opengl`, and its version, for example 'llvmpipe (LLVM\n"
             "15.0.6, 256 bits), 4.5 (Core Profile) Mesa 22.3.6'.\n\n"
             "Args:\n    gl: 'osmesa' or 'egl'.\nRaises:\n    RenderError: there is no OpenGL; ParameterError.");
}
