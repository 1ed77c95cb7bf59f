// The force at one point of contact between two links, and its derivatives.
//
// At depth d, the force along the normal is
//   N = k d^n (1 + c d'),   c = x / max(v, v_d / 2),   n = 1 or 3/2 (Hertz),
// and never pulls. v is the rate at which the contact began, x the number of the restitution e, for which an
// impact without loads ends with the rate e v for any k, n and mass (forces/joint_force.hpp). v_d = sqrt(2 U
// / m) is the rate at which the mass m would have the energy U = k d^(n+1) / (n+1) of the spring: a contact
// that loads press deeper than its impact did has a finite damping. m is the largest mass that a point feels
// of the bodies that press each other: where a heavy body falls on a light one that stands on a support, it
// presses both contacts.
//
// Friction is that of a spring and a damper along the surfaces, -k_t s - c_t v_t, at most mu N. s is the
// distance along the surfaces of two points that are fixed to the two links while the contact sticks
// (State::contacts). So a contact that sticks does not creep, however long it lasts.
//
// k_t is a share of the normal stiffness dN/dd of the spring, and so is k_r below. With Hertz they change
// with the depth as the radius of contact does: while the depth grows, the force gained earlier keeps its
// value; while it shrinks, the force falls with the stiffness, and the energy that this takes from the spring
// is dissipated ([Thornton2011], as for particles). Over a step from the depth d0 and the stretch s0, the
// spring has the stretch s - g s0 with g = 1 - k_t(d0) / k_t(d) > 0, or 0.
//
// Rolling friction is a moment across the normal, -k_r f - c_r w_t, at most mu_r R* N; f is the rotation of b
// relative to a across the normal, held like s by two directions that are fixed to the two links, and w_t its
// rate. 1/R* is the sum of the curvatures of the round surfaces at the point: faces, edges and corners count
// as flat. The spring is that of friction at this radius, k_r = k_t R*^2 and c_r = c_t R*^2 [Iwashita1998],
// so that it holds and slips like friction of the coefficient mu_r.
#pragma once

#include <optional>

#include "mbd_server/contact/touch.hpp"

namespace tandem::mbd {

struct ContactForce {
  Vector3d p, n;                         // point of contact [m], normal from a to b
  Vector3d force = Vector3d::Zero();     // on b; a gets the opposite [N]
  double normal = 0;                     // N [N]
  Vector3d friction = Vector3d::Zero();  // part of the force across n [N]
  Vector3d stretch = Vector3d::Zero();   // s [m]
  Vector3d last_stretch = stretch;       // s0 [m]
  Vector3d velocity = Vector3d::Zero();  // of b relative to a at p [m/s]
  double gap = 0;                        // [m]
  double energy = 0;                     // stored in both springs [J]
  bool slides = false;                   // friction is mu N
  Vector3d torque = Vector3d::Zero();    // of rolling friction, on b; a gets the opposite [N m]
  Vector3d bend = Vector3d::Zero();      // f [rad]
  Vector3d last_bend = bend;             // at the begin of the step [rad]
  Vector3d rolling = Vector3d::Zero();   // w_t [rad/s]
  bool rolls = false;                    // the moment is mu_r R* N
  double stiffer = 0;                    // g [-]
  Vector3d spring_stretch() const { return stretch - stiffer * last_stretch; }
  Vector3d spring_bend() const { return bend - stiffer * last_bend; }
  double power() const { return force.dot(velocity) + torque.dot(rolling); }  // on both links [W]
  // Change of the wrench on b in the world per displacement of a and of b, and per velocity of b relative to
  // a. Not set without derivatives.
  Matrix6d by_a, by_b, by_velocity;
};

ContactForce evaluate(const Model& model, const ContactPoint& point, const std::vector<LinkMotion>& links,
                      Derivatives derivatives = Derivatives::with);

// Springs and dampers along the surfaces at a depth: their stiffness and damping are those of the point
// times these factors. Changes are per depth.
struct AlongFactors {
  double stiffness = 1, damping = 1, stiffer = 0;
  double stiffness_change = 0, damping_change = 0, stiffer_change = 0;
};
AlongFactors along_factors(const ContactLaw& law, const ContactPoint& point, double depth);

// Radius R* of the rolling friction at a feature [m]; 0: none of its surfaces is round.
double rolling_radius(const ContactFeature& feature);

// How a point moves: what its force and its power follow from.
struct ContactMotion {
  double gap = 0, gap_rate = 0;                            // [m], [m/s]
  Vector3d stretch = Vector3d::Zero(), sliding = stretch;  // along the surfaces [m], [m/s]
  Vector3d bend = Vector3d::Zero(), rolling = bend;        // across the normal [rad], [rad/s]
  Vector3d last_stretch = stretch, last_bend = bend;       // at the begin of the step [m], [rad]
};
// Power of the force and moment at a point on the two links: negative where the point stores or dissipates
// energy [W]. `pressing` bounds friction; none: it is the normal force of that motion [N].
double power(const Model& model, const ContactPoint& point, const ContactMotion& motion,
             std::optional<double> pressing = {});
// Energy of the normal spring at that depth [J].
double normal_energy(const ContactLaw& law, double depth);
// Depth at which the spring has that force [m].
double depth_of(const ContactLaw& law, double force);
// Duration of half a period of a spring of that law at a depth [s].
double half_period(const ContactLaw& law, double mass, double depth);
// Largest depth of an impact of that mass at that rate, without damping [m].
double impact_depth(const ContactLaw& law, double mass, double rate);

}  // namespace tandem::mbd
