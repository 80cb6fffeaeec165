#include "bind_meshes.hpp"

#include <pybind11/numpy.h>

#include <string>

#include "aras_visual_servo_sim/scene/mesh_loader.hpp"

namespace aras_visual_servo_sim {
namespace {

namespace py = pybind11;

py::array_t<float> meshTriangles(const std::string& path) {
  const MeshPtr mesh = loadMesh(path);
  py::array_t<float> corners({mesh->triangles.size(), std::size_t{3}, std::size_t{3}});
  float* out = corners.mutable_data();
  for (const auto& triangle : mesh->triangles) {
    for (const std::uint32_t corner : triangle) {
      for (int axis = 0; axis < 3; ++axis) *out++ = mesh->points[corner][axis];
    }
  }
  return corners;
}

}  // namespace

void bindMeshes(py::module_& module) {
  module.def(
      "mesh_triangles", &meshTriangles, py::arg("path"),
      "Corners of the triangles of a mesh file (STL, DAE, OBJ and what else assimp reads), as the simulator reads\n"
      "it: (n, 3, 3) [m].\n\nRaises:\n    ModelError naming the file and what is wrong with it.");
}

}  // namespace aras_visual_servo_sim
