// Steps of fixed length of free bodies that touch each other, the ground, and bodies that motions move. No
// impact is resolved: the velocities at the end of a step are the minimum of a convex function
// (contact_problem.hpp), and the bodies move with them. The order of a step:
//
//   wake      bodies that sleep, where others may touch them
//   given     where motions take bodies by the end of the step
//   gather    bodies that are awake, with the velocities they would have without contacts, and their points
//   solve     the velocities at the end
//   move      bodies; points keep their springs
//   account   what contacts and the step have dissipated, the work of motions and surfaces
//   rest      which bodies fall asleep
//
// The law of a point is that of contact_force.hpp. The energy that the step itself takes is that of backward
// Euler: 1/2 (v1 - v0)^T M (v1 - v0) of the bodies that contacts push. Others fly on their parabola.
#pragma once

#include <vector>

#include "mbd_server/solve/free_bodies.hpp"
#include "mbd_server/step/body_contacts.hpp"
#include "mbd_server/time_stepping/contact_problem.hpp"
#include "mbd_server/time_stepping/step_points.hpp"

namespace tandem::mbd {

// Of the last step.
struct TimeStepAccount {
  double lost = 0;                  // by contacts, with what the step itself takes [J]
  double by_step = 0;               // the part of it that the step takes [J]
  double surface_work = 0;          // of surfaces that move along themselves [J]
  std::vector<double> motion_work;  // of the motion of each link [J] (links)
  ContactExtremes extremes;
  BodyContactCounters contacts;
  ContactProblem::Effort effort;
};

class TimeStepping {
 public:
  explicit TimeStepping(const Model& model);

  bool apply() const { return model_.contact.time_stepping; }
  void prepare(State& state) const;
  // `links`: at the state. No function of time breaks within the step.
  void step(State& state, const std::vector<LinkMotion>& links, double h);
  const TimeStepAccount& account() const { return account_; }

 private:
  // Of a body that is awake, at the begin of the step.
  struct Awake {
    int body;
    Vector3d centre, spin;  // of mass [m]; in the axes of the link [rad/s]
    Vector3d free_spin;     // of `spin` without contacts
    bool pushed = false;    // by a contact
  };

  void wake(State& state);
  void move_given(const State& state, const std::vector<LinkMotion>& links, double h);
  void gather_bodies(const State& state, const std::vector<LinkMotion>& links, double h);
  void gather_points(const State& state, const std::vector<LinkMotion>& links, double h);
  void add_point(ContactPoint& point, bool is_new, const std::vector<LinkMotion>& links, double h);
  void move_bodies(State& state, const std::vector<LinkMotion>& links, double h);
  void keep_points(State& state, const std::vector<LinkMotion>& links, double h);
  void record_work(const std::vector<LinkMotion>& links);
  void rest(State& state, double h);
  bool passes(const ContactPoint& point, const ContactProblem::Point& p, double h) const;
  bool turns(const ContactPoint& point, const std::vector<LinkMotion>& links, double h) const;
  void expect_outside(const ContactPoint& point, double depth, double time) const;

  int body_of(int shape) const;
  bool sleeps(const State& state, int body) const;
  bool moves_as_given(int shape) const;
  Vector3d given_velocity(int shape, const Vector3d& p, const std::vector<LinkMotion>& links, double h) const;
  double mass_at(int shape, const Vector3d& r, const Vector3d& n) const;
  int first(int body);
  void join(int body_a, int body_b);

  const Model& model_;
  std::vector<FreeBodies::Body> bodies_;
  std::vector<int> body_of_link_;  // none: ground, or moved by a motion (links)
  std::vector<double> radius_;     // about the centre of mass, of all shapes [m] (bodies)
  StepPoints near_;
  ContactProblem problem_;
  std::vector<Awake> awake_;            // (bodies of the problem)
  std::vector<int> place_of_;           // in the problem; none: it sleeps (bodies)
  std::vector<ContactPoint> touching_;  // (points of the problem)
  std::vector<ContactPoint> kept_;
  std::vector<StepPoints::Found> found_;
  std::vector<LinkMotion> ahead_;  // links at the end of the step
  State end_;                      // for ahead_
  std::vector<int> group_;         // a body of the same island, or itself (bodies)
  TimeStepAccount account_;
};

}  // namespace tandem::mbd
