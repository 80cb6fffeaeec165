#pragma once

#include <Eigen/Core>

namespace aras_visual_servo {

/** The answer to a quadratic program.
 *
 *  Where `feasible` is false, no x keeps all rows, and x is where the solver found that out. */
struct QuadraticAnswer {
  Eigen::VectorXd x;            //!< (n)
  Eigen::VectorXd multipliers;  //!< (m), >= 0, zero for a row that does not hold x back
  int iterations = 0;           //!< rows taken up or given back
  bool feasible = false;
};

/** Minimises 1/2 x' H x + g' x under A x >= b, exactly, by the dual active-set method.
 *
 *  It begins at the minimum without rows and takes up one violated row after another, so a program in which no row
 *  binds costs one Cholesky factorisation, and one without a feasible x is recognised.
 *  @param H  (n, n), symmetric, positive definite; its lower triangle is read
 *  @param g  (n)   @param A  (m, n)   @param b  (m); -inf for a row that never binds
 *  @throws ShapeError, NotFiniteError (also where H is not positive definite)
 *  @see D. Goldfarb, A. Idnani, "A numerically stable dual method for solving strictly convex quadratic programs",
 *       Mathematical Programming 27, 1983. */
QuadraticAnswer solveProgram(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::MatrixXd& A,
                             const Eigen::VectorXd& b);

}  // namespace aras_visual_servo
