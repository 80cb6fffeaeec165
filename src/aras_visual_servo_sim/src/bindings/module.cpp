#include <aras_visual_servo_common/python/bind_errors.hpp>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/render/opengl_renderer.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"
#include "bindings.hpp"

namespace {

using aras_visual_servo_sim::MeshPtr;

pybind11::array_t<float> meshTriangles(const std::string& path) {
  const MeshPtr mesh = aras_visual_servo_sim::loadMesh(path);
  pybind11::array_t<float> corners({mesh->triangles.size(), std::size_t{3}, std::size_t{3}});
  float* out = corners.mutable_data();
  for (const auto& triangle : mesh->triangles) {
    for (const std::uint32_t corner : triangle) {
      for (int axis = 0; axis < 3; ++axis) *out++ = mesh->points[corner][axis];
    }
  }
  return corners;
}

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
  aras_visual_servo_sim::bindWorld(module);
  module.def(
      "mesh_triangles", &meshTriangles, pybind11::arg("path"),
      "Corners of the triangles of a mesh file (STL, DAE, OBJ and what else assimp reads), as the simulator reads\n"
      "it: (n, 3, 3) [m].\n\nRaises:\n    ModelError naming the file and what is wrong with it.");
  module.def("opengl_description", &openGlDescription, pybind11::arg("gl") = "osmesa",
             "What draws the images of cameras with `renderer: opengl`, and its version, for example 'llvmpipe (LLVM\n"
             "15.0.6, 256 bits), 4.5 (Core Profile) Mesa 22.3.6'.\n\n"
             "Args:\n    gl: 'osmesa' or 'egl'.\nRaises:\n    RenderError: there is no OpenGL; ParameterError.");
}
