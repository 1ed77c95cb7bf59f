// Moments against relative rotation.
//
// Rolling: an elastic-plastic spring and a dashpot, model C of [Ai2011], on the rotation phi about axes
// across the normal:
//   M = -k_r phi - c_r w,   |k_r phi| <= mu_r R* p,   k_r = 9/4 k_n (mu_r R*)^2,   c_r = 2 eta_r sqrt(I* k_r)
// and c_r <= I*/(21 dt). p is the elastic force that limits friction and k_n the secant stiffness of the
// normal force. 1/I* is the sum of the inverse inertias of both spheres about their contact (7/5 m r^2 each).
// There is no dashpot while the limit acts. The law is incremental: while k_n grows, the moment gained
// earlier keeps its value, so phi shrinks. It deviates from [Ai2011] while k_n shrinks: the moment falls with
// it, as in laws/hertz.hpp, so that no work is gained.
//
// Twisting: [Marshall2009] eq. 32-34. The contact area of radius a rotates on Mindlin's springs and slides as
// a whole at the moment that Coulomb's limit allows:
//   M = -k_t a^2/2 phi_n - c_t a^2/2 w_n,   |M| <= 2/3 a mu p
// This moment keeps its value, too, while its stiffness k_t a^2/2 grows.
#pragma once

#include "dem_server/laws/coefficients.hpp"
#include "dem_server/laws/history.hpp"

namespace tandem::dem {

// Rolling moment on i [N m]. `rate` is the angular velocity of i relative to j, `inertia` is I* [kg m2].
struct RollingResistance {
  // An explicit dashpot that stops a sphere in less than half a micro step makes it oscillate with growing
  // amplitude. I* is 7/2 of the inertia about the centre. With this bound each of 12 contacts has 1/6 of the
  // damping that stops the sphere in one step.
  static constexpr int most_damped = 21;

  template <class Real>
  TANDEM_HD Vec3<Real> operator()(const Contact<Real>& c, const ContactForce<Real>& f, Vec3<Real> rate,
                                  const RollingConstants<Real>& k, Real inertia, Vec3<Real>& rolled) const {
    const Vec3<Real> across = rate - dot(rate, c.n) * c.n;
    const Real lever = k.friction * c.r_eff, stiffness = Real(2.25) * f.k_n * lever * lever;
    // Selects values instead of branching, so that the CPU evaluates several contacts at once.
    const bool acts = stiffness > 0;
    constexpr Real finer = finer_angles<Real>;
    rolled = rotate_spring(rolled, c, f.previous_stiffness2, f.current_stiffness2, finer) + c.dt * across;
    // Compares angles, because squares of the moments of small spheres are beyond the range of single
    // precision.
    const Real most = finer * (lever * f.elastic_force / stiffness), size2 = norm2(finer * rolled);
    const bool slides = size2 > most * most;
    rolled *= slides ? most / std::sqrt(size2) : Real(1);
    if (!acts) rolled = {};
    const Real wanted = 2 * k.damping * std::sqrt(inertia) * std::sqrt(stiffness),
               carried = inertia / (most_damped * c.dt), damping = wanted < carried ? wanted : carried;
    return -stiffness * rolled - (acts && !slides ? damping : Real(0)) * across;
  }
};

// Twisting moment on i along n [N m].
struct TwistingResistance {
  template <class Real>
  TANDEM_HD Real operator()(const Contact<Real>& c, const ContactForce<Real>& f, Vec3<Real> rate,
                            Real friction, Real& twisted) const {
    const Real about = dot(rate, c.n), radius2 = c.r_eff * f.hertz_overlap, half = radius2 / 2;
    if (f.previous_hertz_overlap < f.hertz_overlap)
      twisted *= f.previous_hertz_overlap / f.hertz_overlap *
                 std::sqrt(f.previous_stiffness2 / f.current_stiffness2);
    twisted += c.dt * about;
    const Real moment = -(half * f.k_t * twisted + half * f.c_t * about);
    const Real limit = Real(2) / 3 * std::sqrt(radius2) * friction * f.elastic_force;
    if (moment <= limit && -moment <= limit) return moment;
    // Sliding: the spring keeps the angle that carries the limit without the dashpot.
    const Real reached = moment > 0 ? limit : -limit;
    twisted = f.k_t > 0 ? -reached / (half * f.k_t) : Real(0);
    return reached;
  }
};

}  // namespace tandem::dem
