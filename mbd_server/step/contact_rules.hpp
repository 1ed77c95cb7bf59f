// When contacts matter: which are faint, how near a begin is found, how long an impact lasts, and which steps
// resolve it. Reads the model and points; changes nothing.
#pragma once

#include <vector>

#include "mbd_server/contact/contact_force.hpp"
#include "mbd_server/contact/features.hpp"

namespace tandem::mbd {

// Motion of a point in contact, its normal force, its power on the links and its energy [N], [W], [J].
struct ContactExchange {
  ContactMotion motion;
  double normal = 0, power = 0, energy = 0;
  bool slides = false, rolls = false;
  // Square of the rate of the point: friction that slides is no vibration [m2/s2].
  double square(const ContactPoint& point) const;
};

// Whether the points are of many pairs of shapes.
bool is_crowd(const std::vector<ContactPoint>& points);

class ContactRules {
 public:
  static constexpr double steps_per_contact = 32;    // of the duration of an impact
  static constexpr double steps_per_vibration = 16;  // of half a period of a contact that vibrates
  static constexpr double steps_uncut = 48;          // of an impact that may begin and end within a step
  static constexpr double growth = 2;                // of the steps after a contact
  // The steps of an impact grow as its rate falls below that of a fall through a share of the size of the
  // body: to this many times.
  static constexpr double coarsest = 4;

  explicit ContactRules(const Model& model);

  // The energy that moves [J].
  void set_energy_scale(double energy) { energy_scale_ = energy; }
  double energy_scale() const { return energy_scale_; }

  // To which begins are found: stiff shapes, which their weight presses by little, have a smaller one [m].
  double tolerance(const ContactFeature& f) const;
  double tolerance() const { return tolerance_; }  // where the contact is not stiff [m]
  double round_off() const { return least_; }      // of a gap [m]

  // Square of the rate below which an impact of two shapes is faint [m2/s2].
  double faint_square(int a, int b) const;
  // Whether neither the rate of the gap nor the energy of the spring at that depth is worth a step that ends
  // there.
  bool is_faint(const ContactFeature& f, double rate, double depth) const;
  // Whether shapes that have left each other come back at the rate of a faint impact at the most. Their point
  // stays in the equations, which know when it bears again: one that begins within a step would get the
  // energy of its depth for nothing.
  bool returns_faintly(const ContactFeature& f, double gap, double rate) const;

  // Notes whether points of many pairs are in contact at the begin of the step. Only then may impacts begin
  // and end within steps, of materials that lose half of the energy: those of few bodies are cut, each at its
  // instant.
  // `crowded`: they are, in the whole scene.
  void look_at(const std::vector<ContactPoint>& points, bool crowded);
  bool crowded() const { return crowded_; }
  // Longest step within which an impact of these shapes at that rate may begin and end: it moves the body by
  // less than the least that it may weigh there would do for a small part of the impact. 0: none [s].
  double uncut_step(const ContactFeature& f, double rate) const;
  double uncut_step(const ContactPoint& point) const;
  // Whether the shapes may come into contact within a step of that length.
  bool may_begin(const ContactFeature& f, double gap, double rate, double h) const;

  bool is_within_steps(const ContactFeature& f) const { return model_.contact.within_steps(f.a, f.b); }
  // Duration of an impact as deep as the point was at the most, now or before [s].
  double period(const ContactPoint& point, double depth) const;
  // Longest step of an impact after some time, while it moves at that rate [s].
  double impact_step(const ContactPoint& point, double since, double rate) const;
  // Whether steps resolve an impact of this point: for its duration, and for as long as it bounces after
  // that.
  bool is_impact(double time, const ContactPoint& point, const ContactExchange& now) const;
  // A load that jumps makes a body vibrate on its contacts. A step that does not resolve this has another
  // energy, and dampers at the points take another part of it.
  bool vibrates(const ContactPoint& point, const ContactExchange& now) const;

 private:
  bool is_elastic(int a, int b) const;  // what steps leave out of an impact would add up
  bool may_pass(const ContactFeature& f) const;

  const Model& model_;
  double tolerance_, least_, energy_scale_ = 0;
  bool crowded_ = false;
  // Square of the rate below which an impact of that shape is faint, and the energy then; infinite: it is on
  // the ground [m2/s2], [J] (shapes).
  std::vector<double> faint_square_, faint_energy_;
  // Least mass that a point on the surface may feel: that of its body without others. Infinite: ground; 0:
  // unknown [kg] (shapes).
  std::vector<double> least_masses_;
  std::vector<double> weights_;  // of the body of each shape; infinite: ground [N] (shapes)
};

}  // namespace tandem::mbd
