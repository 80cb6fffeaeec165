#pragma once

#include <array>
#include <vector>

namespace aras_visual_servo_camera::testing {

struct Point2 {
  double x, y;
};
using Polygon = std::vector<Point2>;

/** Exact raw moments of a simple polygon, positive whatever its winding, in the sequence of moments.hpp; order <= 8.
 *  Green: m_ij = closed integral of x^(i+1) y^j / (i+1) dy; along an edge that is a polynomial, which Gauss and
 * Legendre's 8 points integrate exactly to degree 15. */
std::vector<double> polygonMoments(const Polygon& polygon, int order);

/** The same about the polygon's centroid, computed there: no cancellation. */
std::vector<double> polygonCentredMoments(const Polygon& polygon, int order);

/** A pose of the camera over a target plane: rotation about z, then tilts, then the target's position in C. */
struct View {
  double x_m, y_m, z_m, yaw_rad, tilt_x_rad, tilt_y_rad;
};

/** The target's outline (metres, its own plane) in normalised coordinates of the camera. */
Polygon project(const Polygon& outline_m, const View& view);

/** Outlines around their centroid: an asymmetric blob, an elongated rectangle, a triangle; `size_m` wide. */
Polygon blob(double size_m);
Polygon rectangle(double width_m, double height_m);
Polygon triangle(double size_m);
Polygon ellipse(double a, double b, double angle_rad, Point2 centre, int corners);

}  // namespace aras_visual_servo_camera::testing
