#include "facet.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace aras_visual_servo_sim {

bool Facet::place(const std::array<Eigen::Vector3d, 3>& p) {
  areal.row(0) = p[1].cross(p[2]);
  areal.row(1) = p[2].cross(p[0]);
  areal.row(2) = p[0].cross(p[1]);
  const double determinant = areal.row(0).dot(p[0]);
  constexpr double kLeast = 1e-100;  // its inverse, and products with it, stay finite
  if (!(std::abs(determinant) > kLeast)) return false;
  areal /= determinant;
  plane = areal.colwise().sum();
  return true;
}

bool Facet::placeWithEdges(const std::array<Eigen::Vector3d, 3>& p) {
  if (!place(p)) return false;
  const double side = p[0].dot(p[1].cross(p[2])) < 0.0 ? -1.0 : 1.0;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d normal = p[k].cross(p[(k + 1) % 3]);
    const double length = normal.norm();
    if (!(length > 0.0)) return false;
    edges[k] = side / length * normal;
  }
  return true;
}

Eigen::Vector3d Facet::weights(const Eigen::Vector3d& ray) const {
  const Eigen::Vector3d b = (areal * ray).cwiseMax(0.0);
  const double sum = b.sum();
  return sum > 0.0 ? Eigen::Vector3d(b / sum) : Eigen::Vector3d::Constant(1.0 / 3.0);
}

Eigen::Vector3d Facet::color(const Eigen::Vector3d& ray) const {
  if (one_color) return rgb[0].cast<double>();
  const Eigen::Vector3d w = weights(ray);
  return w[0] * rgb[0].cast<double>() + w[1] * rgb[1].cast<double>() + w[2] * rgb[2].cast<double>();
}

bool Facet::texel(const Eigen::Vector3d& ray, Eigen::Vector2d& point) const {
  const Eigen::Vector3d b = areal * ray;
  const double sum = b.sum();
  constexpr double kGrazing = 1e-9;  // sine of the angle to the plane: beyond, texture coordinates mean nothing
  if (!(sum > kGrazing * plane.norm() * ray.norm())) return false;
  point = (b[0] * texels[0] + b[1] * texels[1] + b[2] * texels[2]) / sum;
  return true;
}

}  // namespace aras_visual_servo_sim
