#include "bind_program.hpp"

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>

#include "quadratic_program.hpp"

namespace py = pybind11;
using namespace aras_visual_servo;  // NOLINT: this file is a part of the module

void bindProgram(py::module_& module) {
  module.def(
      "solve_program",
      [](const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
        QuadraticAnswer answer = solveProgram(H, g, A, b);
        return py::make_tuple(answer.x, answer.multipliers, answer.iterations, answer.feasible);
      },
      py::arg("H"), py::arg("g"), py::arg("A"), py::arg("b"),
      "Minimise x' H x / 2 + g' x under A x >= b, exactly: dual active set (Goldfarb and Idnani, 1983).\n\n"
      "Args:\n    H: (n, n), symmetric, positive definite.  g: (n,).  A: (m, n).  b: (m,), -inf for a row that never\n"
      "    binds.\n"
      "Returns:\n    (x, (n,); multipliers, (m,), >= 0; iterations; whether there is an x that keeps all rows).\n"
      "Raises:\n    ShapeError, NotFiniteError, the latter also where H is not positive definite.");
}
