// Free bodies in groups that cannot touch each other within a step: islands. Each island takes steps of its
// own through the whole step, so that an impact shortens the steps of its island only.
//
// Islands follow from what may touch: bodies with a point in contact, and those of which two features may
// meet within the step at the rates of its begin. Afterwards each body has a largest rate; where it is larger
// than was assumed, pairs are looked for again, and islands that may have met are taken together and repeat
// the step. An island is a machine of its own (island_model()) with the method, the contacts and the matrix
// of any other one, so that no rule of contact is written twice.
//
// An island that has been at rest for a while sleeps: it takes no step, and its bodies keep their places and
// their points of contact, without rates. It wakes where a body that does not sleep may touch one of it.
//
// Every quantity of the method is that of a body, but for the length of its last step and the longest step
// that contacts allow: the state keeps these two, and the time at rest, for each body (State::island_steps).
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "mbd_server/solve/free_bodies.hpp"
#include "mbd_server/step/body_contacts.hpp"

namespace tandem::mbd {

class ContactIslands {
 public:
  ContactIslands(const Model& model, double rho_inf, const NewtonSettings& newton);
  ~ContactIslands();

  // Whether the model is one of free bodies only, and of so many that islands are worth their search.
  bool apply() const { return !bodies_.empty(); }
  // At the start, when the method has started there.
  void prepare(State& state) const;
  // Takes a step of length h, in which no function of time breaks. `system`: at its last residual(), which is
  // that of the state. What the islands count and lose is added to `method` and `touching`.
  void step(State& state, const MachineSystem& system, double h, double energy_scale,
            GeneralizedAlpha& method, BodyContacts& touching);
  // Local errors of the position in the last step, summed over the steps of its island (freedoms) [rad or m].
  const VectorXd& local_errors() const { return local_errors_; }

 private:
  struct Island;
  using Bodies = std::vector<int>;  // of an island, ascending

  void assume_rates(const std::vector<LinkMotion>& links, double h);
  void connect_contacts(const State& state);
  void connect_near(const std::vector<LinkMotion>& links, double h);
  std::vector<Bodies> groups();
  int first(int body);
  void join(int shape_a, int shape_b);
  int body_of(int shape) const;
  Island& island(const Bodies& bodies);
  void gather(const State& state, Island& island) const;
  bool integrate(const State& begin, double h, double energy_scale, Island& island);
  void scatter(const Island& island, State& state);
  bool sleeps(const State& state, const Bodies& bodies) const;
  void keep_asleep(const Bodies& bodies, State& state);
  double time_at_rest(const Island& island, const State& before) const;
  bool note_rates(const Island& island, double h);

  const Model& model_;
  double rho_inf_;
  NewtonSettings newton_;
  double error_constant_;
  std::vector<FreeBodies::Body> bodies_;
  std::vector<int> body_of_link_;  // none: ground (links)
  std::vector<int> group_;         // a body of the same island, or itself (bodies)
  std::vector<double> travel_;     // assumed largest way of a point of the shape in the step [m] (shapes)
  std::vector<NearPair> pairs_;
  std::vector<ContactFeature> features_;
  bool crowded_ = false;
  std::vector<ContactPoint> contacts_;  // at the begin of the step
  std::vector<std::vector<std::size_t>>
      contacts_of_;  // those of a body with the ground or later ones (bodies)
  VectorXd local_errors_;
  std::map<Bodies, std::unique_ptr<Island>> islands_;  // of this step and the last one
};

}  // namespace tandem::mbd
