// The velocities at the end of a step as the minimum of a convex function [Castro2022], [Castro2023]:
//
//   l(v) = 1/2 (v - v*)^T M (v - v*) + sum over points of l_c(J v)
//
// v* are the velocities without contacts. The gradient of l_c is minus the impulse of a point, which depends
// on the relative velocity v_c at the end of the step of length h. With the depth d and the stretch s of the
// friction spring at the begin of the step, and the rate v_n of the gap:
//
//   normal:  h k max(0, d - h v_n) max(0, 1 - c v_n)   spring and damper of contact_force.hpp at the end
//   friction: - h k_t (s + h v_t), and no larger than a bound
//
// Both fall with the velocity, so that the function is convex and has one minimum, which does not depend on
// the order of bodies and points. Newton's method finds it with conjugate gradients, or a factorisation by
// blocks of bodies where the matrix is stiff, and a line search. The bound of friction is mu times the normal
// impulse: with one bound for each minimum (Tresca's friction), the bounds of the next minimum follow from
// the impulses of the last one [Panagiotopoulos1975], until they change the impulses no more. So a body that
// slides is not lifted, as with a friction cone in one minimum. Near the end each minimum leaves half of the
// misfit of the one before, and Newton's method with bounds that follow the normal impulses leaves a
// hundredth: it is tried there, and goes back to minima where it fails.
#pragma once

#include <cstdint>
#include <vector>

#include "mbd_server/time_stepping/block_cholesky.hpp"
#include "mbd_server/time_stepping/conjugate_gradients.hpp"

namespace tandem::mbd {

class ContactProblem {
 public:
  // Velocities are those of the centre of mass: [w; v], world axes.
  struct Body {
    double mass;       // [kg]
    Matrix3d inertia;  // about the centre of mass, world axes [kg m2]
    Vector6d free;     // v*
    Vector6d v;        // first guess; afterwards the solution
  };
  struct Point {
    int a, b;                          // bodies; none: it moves as given
    Vector3d n;                        // from a to b
    Vector3d r_a, r_b;                 // from the centres of mass [m]
    Vector3d given;                    // relative velocity of what moves as given [m/s]
    double depth;                      // d [m]
    Vector3d stretch;                  // s, across n [m]
    double stiffness, damping, along;  // k [N/m], c [s/m], k_t [N/m]
    double friction;                   // mu
    double bound;  // of the friction impulse: first guess; afterwards that of the solution [N s]
    // Of the solution.
    Vector3d velocity = Vector3d::Zero();  // of b relative to a at the point [m/s]
    double normal = 0;                     // impulse [N s]
    Vector3d tangential = Vector3d::Zero();
    Vector3d impulse() const { return normal * n + tangential; }  // on b [N s]
  };
  struct Effort {
    std::uint64_t iterations = 0, factorisations = 0, minima = 0;
    bool settled = true;  // whether the bounds of friction fit the normal impulses
  };

  std::vector<Body> bodies;
  std::vector<Point> points;

  // The solution is within 1e-6 of the momenta or impulses.
  Effort solve(double h);

 private:
  // Of a point.
  struct Impulse {
    double normal = 0;
    Vector3d tangential = Vector3d::Zero();
    // Minus the change with the velocity.
    double normal_slope = 0;
    Matrix3d slope = Matrix3d::Zero();
    Vector3d slip = Vector3d::Zero();  // direction of friction that slides
  };
  enum class Slopes { without, with };
  enum class Bounds { kept, fitted };

  void connect();
  Vector3d velocity_at(const Point& p, const std::vector<Vector6d>& v) const;
  // Normal impulse [N s].
  double normal_at(const Point& p, const Vector3d& velocity) const;
  template <Slopes slopes>
  Impulse impulse_at(const Point& p, const Vector3d& velocity) const;
  void evaluate(Bounds bounds = Bounds::kept);
  bool fit_bounds(Effort& effort);
  void minimise(double tolerance, Effort& effort);
  void assemble();
  void find_direction(Effort& effort);
  double step_length() const;

  double h_ = 0;
  std::vector<int> pair_of_;                        // of the bodies of a point; none: one is given (points)
  std::vector<Impulse> impulses_;                   // (points)
  std::vector<Vector6d> v_, gradient_, direction_;  // (bodies)
  double misfit_ = 0;                               // norm of the gradient over that of the momenta
  BlockMatrix matrix_;
  ConjugateGradients iterative_;
  BlockCholesky direct_;
  bool is_stiff_ = false;  // the matrix of this step, for conjugate gradients
};

}  // namespace tandem::mbd
