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
// the order of bodies and points. Newton's method finds it with a factorisation by blocks of bodies and a
// line search. The bound of friction is mu times the normal impulse: with one bound for each minimum
// (Tresca's friction), the bounds of the next minimum follow from the impulses of the last one
// [Panagiotopoulos1975], until they change the impulses no more. So a body that slides is not lifted, as with
// a friction cone in one minimum.
#pragma once

#include <cstdint>
#include <vector>

#include "mbd_server/time_stepping/block_cholesky.hpp"

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
    bool slides = false;
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
  struct Slope {  // minus the change of the impulse with the velocity
    double normal = 0;
    Matrix3d all = Matrix3d::Zero();
  };

  void connect();
  Vector3d velocity_at(const Point& p, const std::vector<Vector6d>& v) const;
  void evaluate_at(Point& p, const Vector3d& velocity, Slope* slope) const;
  double evaluate();  // returns the norm of the gradient over that of the momenta
  void minimise(double tolerance, Effort& effort);
  void find_direction();
  double step_length() const;
  void bound_friction();

  double h_ = 0;
  std::vector<BlockCholesky::Pair> pairs_;
  std::vector<int> pair_of_;  // of the bodies of a point; none: one is given (points)
  std::vector<Slope> slopes_;
  std::vector<Vector6d> v_, gradient_, direction_;  // (bodies)
  BlockCholesky matrix_;
};

}  // namespace tandem::mbd
