// The multibody solver as a participant: windows and loads in, paths of the boundary bodies out.
#pragma once

#include <map>
#include <memory>
#include <optional>

#include "mbd_server/coupling/error_estimate.hpp"
#include "mbd_server/coupling/load_journal.hpp"
#include "mbd_server/coupling/make_solver.hpp"
#include "mbd_server/forces/element_force.hpp"
#include "mbd_server/io/element_observer.hpp"
#include "mbd_server/io/energy_balance.hpp"
#include "mbd_server/io/observation.hpp"
#include "mbd_server/io/state_file.hpp"
#include "mbd_server/io/tyre_bottoming.hpp"
#include "mbd_server/io/undetermined.hpp"
#include "mbd_server/solve/assembly.hpp"
#include "mbd_server/solve/equilibrium.hpp"
#include "mbd_server/step/contact_islands.hpp"
#include "mbd_server/step/dormand_prince.hpp"
#include "mbd_server/step/richardson.hpp"
#include "mbd_server/step/step_control.hpp"
#include "mbd_server/step/stiction.hpp"
#include "mbd_server/step/stop_contacts.hpp"
#include "mbd_server/time_stepping/time_stepping.hpp"

namespace tandem::mbd {

class MbdSolver final : public protocol::MotionSolver {
 public:
  protocol::Configured configure(const protocol::Configuration& configuration) override;
  // The same for a scene that is parsed already.
  // Loads that act in the search for the equilibrium of the start besides those of the scene, by body.
  using StartLoads = std::map<std::uint32_t, Wrench>;
  protocol::Configured configure(const scene::Scene& scene, const std::vector<NamedMesh>& meshes = {},
                                 const StartLoads& loads = {});
  const protocol::MotionSet& predict(const Window& window) override;
  const protocol::MotionSet& extrapolate(const Window& window) override;
  const protocol::MotionSet& advance(const protocol::LoadSet& loads) override;
  void control(const protocol::ControlSet& inputs) override;
  const protocol::TangentSet& linearise() override;
  void save() override;
  void restore() override;
  void checkpoint(const protocol::Checkpoint& file) override;
  void resume(const protocol::Checkpoint& file) override;
  const protocol::BodiesFrame& observe() override;
  protocol::Report report() override;
  std::uint64_t capabilities() const override {
    return MotionSolver::capabilities() | protocol::can_extrapolate | protocol::can_control |
           protocol::can_checkpoint | protocol::can_observe_elements | protocol::can_linearise;
  }

  const State& state() const { return state_; }

 private:
  // Created by each configure().
  struct Machine {
    Machine(const scene::Scene& scene, const std::vector<NamedMesh>& meshes, const StartLoads& loads);
    Model model;
    MachineSystem system;
    State state;  // assembled
    AssemblyReport assembly;
    std::optional<EquilibriumReport> equilibrium;  // where the machine starts in it
    GeneralizedAlpha method;
    std::optional<Richardson> extrapolation;       // of the method
    std::optional<DormandPrince> explicit_method;  // instead of the method
    StopContacts contacts;
    Stiction stiction;
    BodyContacts touching;
    ContactIslands islands;
    TimeStepping time_stepping;
    JointObserver joints;
    UndeterminedReactions undetermined;
    EnergyBalance balance;
    ElementObserver elements;
    TyreBottoming bottoming;
    std::vector<const Element*> machine_elements;  // motors and cylinders
    std::vector<std::string> joint_names;
    Integrator& integrator();
    ControlledMethod& controlled();  // whose steps an error control judges
    bool redundant() const;          // there are redundant equations that are not idle
    int degrees_of_freedom() const;  // at the last factorisation
  };

  // Steps of equal length that fill a window, or a part of one between two breaks.
  struct Steps {
    int count;
    double length;  // [s]
  };
  void warn_of_instability();
  Steps cut(double length) const { return cut(length, step_); }
  static Steps cut(double length, const std::optional<double>& step);
  void expect_begin(const Window& window) const;
  void take_loads(const protocol::LoadSet& loads);
  void jump_to_loads();
  const protocol::MotionSet& hold_accelerations(const Window& window);
  void record_begin_motion();
  void record_end_motion();
  bool sums_local_errors() const;
  void measure_local_error(double h);
  void take_step(double h, bool halved = false);
  int parts_of_impulse(double h);
  void record_travel();
  VectorXd reach() const;
  double local_error_sum() const;
  double largest_share(const std::vector<double>& errors) const;
  double nominal_steps() const;
  struct Difference {
    double share = 0;              // of the reach of the coordinate [-]
    Eigen::Index coordinate = -1;  // none: nothing is extrapolated
  };
  Difference spread_of_extrapolation();
  std::string difference_of_runs();
  void record_step(double h);
  void record_contacts();
  void take_time_step(double h);
  void record_time_step();
  void record_jump(double energy);
  void watch_energy();
  void record_energy();
  void record_turn();
  void record_cavitation(double h);
  void integrate(const Window& window);
  void integrate_until(double end, double length);
  double next_stop(double end) const;
  bool between_breaks(double steps) const;
  void cross_break();
  void record_window();
  void record_reactions(const std::vector<JointObservation>& joints);
  std::string obstacle_to_estimate();
  std::optional<double> error_of_the_way();
  ErrorEstimate measure_error();
  RunEnd run_end();
  void begin_again();
  template <class F>
  void aside(F&& repeat);
  template <class F>
  bool goes_through(F&& motion);
  std::optional<RunEnd> run_again(double end, double steps);
  void add_errors_between_breaks(const RunEnd& coarse, const State& coarse_end, double steps,
                                 const VectorXd& reach, double local_errors, ErrorEstimate& estimate);
  void compare_with_longer_steps(const RunEnd& run, double factor, double share, ErrorEstimate& estimate);
  std::optional<ErrorEstimate> compare_with_half_steps(const RunEnd& run);
  double energy_residual(double energy) const;
  double energy_scale() const;

  std::unique_ptr<Machine> machine_;
  std::optional<double> step_;          // longest requested step [s]; none: one step per window
  std::optional<StepControl> control_;  // none: fixed steps
  // While the run is repeated to measure its error.
  struct Repetition {
    enum class Halved { nothing, between_breaks, all };
    // Iterations of all runs together beyond which it ends.
    std::uint64_t iterations = UINT64_MAX;
    // Whether a step may be taken in parts where Newton's method fails for it; otherwise the run ends there.
    bool parts = true;
    // Between breaks that are at most so many steps of the run apart, its steps are kept, of which the
    // longest is `step`.
    double kept = 0;
    std::optional<double> step{};
    // Which steps are taken as two halves; between breaks: those that are kept.
    Halved halved = Halved::nothing;
  };
  static constexpr double longer_again = 19.5, longest_again = 2 * longer_again;  // steps of repetitions
  std::optional<Repetition> again_;
  LoadJournal journal_;
  std::size_t saved_windows_ = 0;  // of the journal
  double longest_step_ = 0;        // [s]
  double nominal_step_ = 0;        // in windows without breaks and contacts [s]
  double window_ = 0;              // of the scene [s]
  std::string unstable_start_;     // warning of an unstable equilibrium at the start
  double tolerance_ = 0;           // of geometric data [-]
  State state_;
  RunTotals totals_;
  SavedState saved_;                     // state and totals, for a rollback
  State predicted_;                      // state after a prediction, or state before the loads changed
  std::vector<BodyMotionState> before_;  // of the boundary bodies at the begin of the last step
  std::vector<LinkIndex> prescribed_;    // links with a prescribed motion
  std::vector<double> rates_before_;     // of these before a jump
  protocol::MotionSet motion_;
  protocol::TangentSet tangents_;
  protocol::BodiesFrame frame_;
  double error_constant_ = 0;  // of the position, of the method [-]
  VectorXd local_error_;       // of the position, of the last step (freedoms) [rad or m]
  VectorXd moved_;             // increment of the coordinates since the start (freedoms)
  bool loaded_ = false;        // by particles or by a controller
  // The steps that are being taken: breaks cut those that are four times, or `longest_again` times as long.
  bool between_close_breaks_ = false, between_breaks_ = false;
  bool resumed_ = false;                  // from a file
  double start_energy_ = 0;               // [J]
  double seconds_ = 0, cpu_seconds_ = 0;  // spent in predict and advance [s]
};

}  // namespace tandem::mbd
