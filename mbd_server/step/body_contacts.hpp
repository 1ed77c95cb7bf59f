// Contacts between bodies. As stops of joints (stop_contacts.hpp), they are events of the motion:
//
// - a step that would pass the begin of a contact is repeated so that it ends there, to 1e-10 of the size of
//   the system, and to 1 % of the depth under the weight of the body; a step that would pass an end is
//   repeated so that it ends there to 1 % of its length: a force that falls to zero within a step would give
//   more impulse than it has;
// - for the duration of an impact, and for some more while the point bounces, steps are a part of that
//   duration, and grow after it; they do so again where loads make a contact vibrate, and a longer step is
//   repeated;
// - a contact is faint that begins or ends at a rate at which bodies that are pressed together flicker: no
//   step ends there, and no impact is resolved. A point that leaves at such a rate stays among the contacts,
//   without a force, while it may come back at no more than it;
// - where impacts are not resolved (BodyContactModel::within_steps), no contact cuts or shortens a step: one
//   that may begin within a step is among its points, without a force until it bears, and error control finds
//   the length that the change of the force needs;
// - after each step, friction that slides moves the ends of its spring (contact_force.hpp), so that the
//   spring has the force with which the step ended.
#pragma once

#include <compare>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "mbd_server/contact/contact_force.hpp"
#include "mbd_server/solve/machine_system.hpp"
#include "mbd_server/step/generalized_alpha.hpp"
#include "mbd_server/step/stiction.hpp"
#include "mbd_server/step/stop_contacts.hpp"

namespace tandem::mbd {

struct BodyContactCounters {
  std::uint64_t contacts = 0;  // points that came into contact
  std::uint64_t steps = 0;     // taken with a point in contact
};

// Of the points in contact at the end of a step; shapes are indices in the model.
struct ContactExtremes {
  double force = 0;        // largest normal force of a point [N]
  double depth_share = 0;  // largest depth over that from the surface to the middle of the thinner shape [-]
  int shape_a = none, shape_b = none;  // of that depth
};

// Energy of the contacts at the start that no load holds: it throws bodies apart.
struct ReleasedAtStart {
  double energy = 0;                  // [J]
  double largest = 0;                 // of one point, whose data follow [J]
  double depth = 0, depth_share = 0;  // [m]; over that to the middle of the thinner shape [-]
  int shape_a = none, shape_b = none;
};

class BodyContacts {
 public:
  // Takes one step of at most the given length of the state, and returns its length [s].
  using Stride = std::function<double(double)>;

  // A step that is repeated takes back what `stops` and `stiction` have counted in it.
  BodyContacts(const Model& model, GeneralizedAlpha& method, MachineSystem& system, const State& state,
               StopContacts& stops, Stiction& stiction);

  // Sets the contacts of a state at the start: shapes that overlap or touch there are in contact.
  void prepare(State& state);
  // Finds what is released at the start, when the method has started there.
  void note_start(State& state, double h);
  const ReleasedAtStart& released() const { return released_; }
  // The requested step, up to which steps grow again after a contact [s], and the energy that moves [J].
  void begin(double requested, double energy_scale) {
    requested_ = requested;
    energy_scale_ = energy_scale;
  }
  // Takes one step of at most h that passes no begin of a contact. Returns its length [s].
  double step(State& state, double h, const Stride& stride);

  const BodyContactCounters& counters() const { return counters_; }
  // Energy that contacts have dissipated since the last call [J].
  double take_lost() { return std::exchange(lost_, 0.0); }
  // Calls f(energy, account) with the shares of the outputs in it [J].
  template <class F>
  void take_lost_of_outputs(F&& f) {
    for (std::size_t i = 0; i < lost_of_.size(); ++i)
      f(std::exchange(lost_of_[i], 0.0), model_.contact.outputs[i].account);
  }
  // Of the last step.
  const ContactExtremes& extremes() const { return extremes_; }
  // Impulse of the contacts on each boundary body in the last step: torque about its centre of mass, force
  // [N m s], [N s] (6 x boundary bodies). The momentum of a free body changes by it to rounding, because it
  // is that of the algorithmic wrench (State::contact_wrench).
  const Eigen::Matrix<double, 6, Eigen::Dynamic>& impulses() const { return impulses_; }

 private:
  // Distance of the shapes at a point [m], [m/s] (points).
  struct Gap {
    double value = 0, rate = 0;
    // Of a ball that touches a mesh: the distance of what is nearest to it now less that of the feature that
    // the step holds [m], and since when these differ [s].
    double off = 0, since = 0;
  };
  // Motion of a point in contact, its normal force, its power on the links and its energy [N], [W], [J].
  struct Exchange {
    ContactMotion motion;
    double normal = 0, power = 0, energy = 0;
    bool slides = false, rolls = false;
    double square(const ContactPoint& point) const;
  };
  static Exchange exchange_of(const ContactForce& f);
  double work(const ContactPoint& point, const Exchange& begin, const Exchange& end, double h) const;

  enum class Change {
    begins,   // a contact
    returns,  // the shapes overlap within the step only
    ends,     // a contact
    follows   // another part of a mesh is nearest
  };
  struct Passage {
    double time = 0;  // estimate, from the begin of the step [s]
    Change change = Change::begins;
    std::size_t candidate = 0;
  };

  // A feature that touches or may touch within the step.
  struct Candidate {
    ContactFeature feature;
    Eigen::Index point = -1;  // of State::contacts; -1: it does not touch
    double tolerance = 0;     // of its gap [m]
  };
  using Gaps = std::vector<Gap>;

  // A ball near a mesh: its `watch` and the features with which it touches.
  struct Watch {
    std::size_t candidate = 0;
    std::vector<std::size_t> held{};     // candidates
    double reach = 0, depth = 0;         // [m]
    Vector3d centre = Vector3d::Zero();  // of the ball at the begin of the step, in the frame of the mesh [m]
  };

  void find(State& state, double h);
  double same_foot(const ContactFeature& feature) const;
  void measure_watch(const std::vector<ContactFeature>& found, Gap& gap) const;
  std::optional<ContactFeature> uncovered(const Watch& watch, std::vector<ContactFeature>& found,
                                          Gaps* gaps) const;
  void enter_watched(Watch& watch, bool at_start);
  void expect_in_front(const ContactFeature& back, bool at_start) const;
  [[noreturn]] void fail_from_behind(const ContactFeature& feature, bool at_start) const;
  Vector3d on_mesh(const ContactFeature& watch) const;
  bool went_through() const;
  void expect_progress(double h, double taken, const std::optional<Passage>& first);
  void expect_outside() const;
  void expect_round_side(const ContactFeature& feature, double gap) const;
  bool follow(State& state, const ContactFeature& feature, Eigen::Index point);
  double tolerance(const ContactFeature& feature) const;
  void shorten(State& state, const ContactPoint& point);
  double faint_square(int a, int b) const;
  bool is_faint(const ContactFeature& feature, double rate, double depth) const;
  // A point in contact of a pair of shapes.
  struct OfPair {
    int a, b;
    Eigen::Index point;
    auto operator<=>(const OfPair&) const = default;
  };
  using Range = std::span<const OfPair>;
  Range of_pair(int a, int b) const;
  void match(const State& state, Range points);
  void keep(State& state, const std::vector<Eigen::Index>& columns);
  bool returns_faintly(const ContactFeature& feature, double gap, double rate) const;
  void measure(State& state, Gaps& gaps);
  std::optional<Passage> passed(double h) const;
  void expect_apart(const State& state, double share, ErrorCode code, const char* what,
                    const char* hint) const;
  void go_back(State& state);
  double repeat(State& state, double h, const Stride& stride);
  double cut(State& state, double h, const Passage& first, const Stride& stride);
  bool enter_all(State& state, double ahead = 0, bool at_start = false);
  // A candidate that comes into contact [m/s], [kg].
  struct Entry {
    std::size_t candidate;
    double rate, mass = 0, mass_a = 0, mass_b = 0;
    bool faint = false;
  };
  int machine_of(int shape) const;
  void find_masses();
  void find_pressing_masses(State& state);
  void enter(State& state, const Entry& entry, Eigen::Index index);
  // Largest overlap at the start, as a share of the thinner shape: loads at rest press shapes by less.
  static constexpr double start_overlap = 0.1;
  static constexpr double steps_per_contact = 32;    // of the duration of an impact
  static constexpr double steps_per_vibration = 16;  // of half a period of a contact that vibrates
  static constexpr double growth = 2;                // of the steps after a contact
  double period(const ContactPoint& point, double depth) const;
  double impact_step(const ContactPoint& point, double since, double rate) const;
  // Sets the directions of the rolling spring, given in the world, on the two links.
  static void set_rolling_spring(const Vector3d& on_a, const Vector3d& on_b, const LinkMotion& a,
                                 const LinkMotion& b, ContactPoint& point);
  bool accept(State& state, double h);
  void make_ready(State& state, double h);
  void aim_springs(State& state, double h) const;
  void aim_rolling_springs(State& state, double h) const;
  double move_spring(const ContactForce& f, ContactPoint& point) const;
  double move_rolling_spring(const ContactForce& f, ContactPoint& point) const;
  void lose(double energy, int shape_a, int shape_b);
  using Wrenches = Eigen::Matrix<double, 6, Eigen::Dynamic>;  // on boundary bodies (6 x boundary bodies)
  void record(const State& state, std::vector<Exchange>& at, Wrenches& wrenches);
  void start_method(State& state);
  void integrate_wrenches(State& state, double h);
  double longest_step(const State& state, double h) const;
  bool is_within_steps(const ContactPoint& point) const {
    return model_.contact.within_steps(point.feature.a, point.feature.b);
  }
  bool vibrates(const ContactPoint& point, const Exchange& now) const;
  bool is_impact(const State& state, const ContactPoint& point, const Exchange& now) const;
  double resolving_step(const State& state, double h) const;
  double shortest_period(const State& state) const;

  const Model& model_;
  GeneralizedAlpha& method_;
  MachineSystem& system_;
  StopContacts& stops_;
  Stiction& stiction_;
  StopContacts::Mark stops_before_;
  StictionCounters stiction_before_;
  ShortenedSteps shortened_before_;
  double requested_ = 0, energy_scale_ = 0;
  double tolerance_ = 0;  // of a gap, where the contact is not stiff [m]
  double least_ = 0;      // round-off of a gap [m]
  BodyContactCounters counters_;
  double lost_ = 0;              // [J]
  std::vector<double> lost_of_;  // share of each output [J]
  ContactExtremes extremes_;
  ReleasedAtStart released_;
  // Square of the rate below which an impact of that shape is faint, and the energy then; none: it is on the
  // ground [m2/s2], [J] (shapes).
  std::vector<double> faint_square_, faint_energy_;
  std::vector<double> weights_;   // of the body of each shape; infinite: ground [N] (shapes)
  std::vector<int> boundary_of_;  // boundary body of each shape; none: it has none (shapes)
  bool records_impulses_ = false;
  Wrenches at_begin_wrench_, at_end_wrench_, impulses_;
  State before_;
  std::vector<NearPair> pairs_;
  std::vector<ContactFeature> features_;
  std::vector<Candidate> candidates_;
  std::vector<Watch> watches_;
  int stalled_ = 0;      // steps in a row without length
  bool turned_ = false;  // a ball has come to another part of a mesh, with another normal
  std::vector<OfPair> by_pair_;
  // That a feature of the pair continues a point in contact, and how far they are apart [m].
  struct Match {
    double distance;
    std::size_t feature;
    Eigen::Index point;
    auto operator<=>(const Match&) const = default;
  };
  std::vector<Match> matches_;
  std::vector<Eigen::Index> point_of_;  // negative: it does not touch (features_)
  std::vector<Entry> entries_;
  std::vector<std::size_t> now_;               // entries that share a solution
  std::vector<int> machine_of_link_;           // none: ground (links)
  std::vector<bool> busy_;                     // (links)
  std::vector<int> pressed_with_;              // a machine, or itself (links)
  std::vector<double> pressing_;               // [kg] (links)
  Gaps gaps_before_, gaps_;                    // (candidates)
  std::vector<Exchange> at_begin_, at_end_;    // (points in contact)
  VectorXd unit_, response_, dlambda_, zero_;  // wrenches of unit forces at points, and their effect
};

}  // namespace tandem::mbd
