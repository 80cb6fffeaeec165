#include "bind_shapes.hpp"

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/physics/ray_caster.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"

namespace aras_visual_servo_sim {
namespace {

namespace py = pybind11;

using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Corners = py::array_t<double, py::array::c_style | py::array::forcecast>;

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

Pose poseOf(const Eigen::Matrix4d& X) {
  return {X.topRightCorner<3, 1>(), Eigen::Quaterniond(Eigen::Matrix3d(X.topLeftCorner<3, 3>())).normalized()};
}

int addMesh(RayCaster& self, int body, const Corners& corners, const Eigen::Matrix4d& X_BS) {
  if (corners.ndim() != 3 || corners.shape(1) != 3 || corners.shape(2) != 3) {
    throw ShapeError("add_mesh: corners must have the shape (n, 3, 3)");
  }
  std::vector<RayCaster::Triangle> triangles(corners.shape(0));
  const double* from = corners.data();
  for (RayCaster::Triangle& triangle : triangles) {
    for (Eigen::Vector3d& corner : triangle) {
      corner = Eigen::Map<const Eigen::Vector3d>(from);
      from += 3;
    }
  }
  return self.addMesh(body, triangles, poseOf(X_BS));
}

py::tuple castRays(const RayCaster& self, const Eigen::Vector3d& p, const Rows& directions, double nearest_m,
                   double farthest_m, bool from_inside) {
  std::vector<Eigen::Vector3d> rays;
  for (Eigen::Index k = 0; k < directions.rows(); ++k) rays.emplace_back(directions.row(k));
  const std::vector<RayCaster::Hit> hits = self.cast(p, rays, nearest_m, farthest_m, from_inside);
  py::array_t<double> distances(static_cast<py::ssize_t>(hits.size()));
  py::array_t<int> shapes(static_cast<py::ssize_t>(hits.size()));
  for (std::size_t k = 0; k < hits.size(); ++k) {
    distances.mutable_data()[k] = hits[k].distance_m;
    shapes.mutable_data()[k] = hits[k].shape;
  }
  return py::make_tuple(distances, shapes);
}

void bindRays(py::module_& module) {
  const auto add = [](RayCaster& self, int body, Geometry geometry, const Eigen::Matrix4d& X_BS) {
    return self.add(body, geometry, poseOf(X_BS));
  };
  py::class_<RayCaster>(module, "RayCaster",
                        "Where straight rays first meet shapes, as a laser scanner sees them. Boxes, cylinders, "
                        "spheres and planes are\nmet exactly, meshes at their triangles. Bodies are numbers of the "
                        "caller; X_BS (4, 4) is a shape's pose in its body.\nEach shape gets the next number from 0.")
      .def(py::init<>())
      .def(
          "add_box",
          [add](RayCaster& self, int body, const Eigen::Vector3d& size_m, const Eigen::Matrix4d& X_BS) {
            Geometry box;
            box.size_m = size_m;
            return add(self, body, box, X_BS);
          },
          py::arg("body"), py::arg("size_m"), py::arg("X_BS"), "Raises:\n    ModelError: a size that is not > 0.")
      .def(
          "add_cylinder",
          [add](RayCaster& self, int body, double radius_m, double length_m, const Eigen::Matrix4d& X_BS) {
            Geometry cylinder;
            cylinder.type = Geometry::Type::kCylinder;
            cylinder.radius_m = radius_m;
            cylinder.length_m = length_m;
            return add(self, body, cylinder, X_BS);
          },
          py::arg("body"), py::arg("radius_m"), py::arg("length_m"), py::arg("X_BS"),
          "Along z, centred.\n\nRaises:\n    ModelError: a size that is not > 0.")
      .def(
          "add_sphere",
          [add](RayCaster& self, int body, double radius_m, const Eigen::Matrix4d& X_BS) {
            Geometry sphere;
            sphere.type = Geometry::Type::kSphere;
            sphere.radius_m = radius_m;
            return add(self, body, sphere, X_BS);
          },
          py::arg("body"), py::arg("radius_m"), py::arg("X_BS"), "Raises:\n    ModelError: a radius that is not > 0.")
      .def(
          "add_plane",
          [](RayCaster& self, int body, const Eigen::Matrix4d& X_BS) { return self.addPlane(body, poseOf(X_BS)); },
          py::arg("body"), py::arg("X_BS"), "The plane z = 0 of the pose, met from either side.")
      .def("add_mesh", &addMesh, py::arg("body"), py::arg("corners"), py::arg("X_BS"),
           "Triangles, corners (n, 3, 3) counter-clockwise seen from outside [m].\n\n"
           "Raises:\n    ModelError: no triangles; ShapeError; NotFiniteError.")
      .def(
          "place", [](RayCaster& self, int body, const Eigen::Matrix4d& X_WB) { self.place(body, poseOf(X_WB)); },
          py::arg("body"), py::arg("X_WB"), "Places all shapes of a body.\n\nRaises:\n    NotFiniteError.")
      .def("cast", &castRays, py::arg("p"), py::arg("directions"), py::arg("nearest_m"), py::arg("farthest_m"),
           py::arg("from_inside") = true,
           "The first surface on each ray within a range.\n\nArgs:\n"
           "    p: (3,), where the rays begin.  directions: (n, 3), unit vectors.\n"
           "    from_inside: whether surfaces are met from behind too.\n"
           "Returns:\n    distances (n,) [m], infinite where nothing is met; numbers of the shapes (n,), -1 for none.\n"
           "Raises:\n    NotFiniteError, ParameterError: no range.");
}

}  // namespace

void bindShapes(py::module_& module) {
  module.def(
      "mesh_triangles", &meshTriangles, py::arg("path"),
      "Corners of the triangles of a mesh file (STL, DAE, OBJ and what else assimp reads), as the simulator reads\n"
      "it: (n, 3, 3) [m].\n\nRaises:\n    ModelError naming the file and what is wrong with it.");
  bindRays(module);
}

}  // namespace aras_visual_servo_sim
