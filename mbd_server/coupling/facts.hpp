// What the multibody side reports, as the text of a message.
#pragma once

#include <optional>
#include <string>

#include "common/scene/model.hpp"
#include "mbd_server/coupling/error_estimate.hpp"
#include "mbd_server/io/run_totals.hpp"
#include "mbd_server/io/tyre_bottoming.hpp"
#include "mbd_server/io/undetermined.hpp"
#include "mbd_server/model/model.hpp"
#include "mbd_server/solve/assembly.hpp"
#include "mbd_server/step/body_contacts.hpp"
#include "mbd_server/step/stop_contacts.hpp"

namespace tandem::mbd {

// `undetermined`: components of each joint's reaction that are undetermined at the start (joints).
std::string configured_facts(const Model& model, const scene::Scene& scene, const AssemblyReport& assembly,
                             const std::vector<Components>& undetermined);

struct RunFigures {
  std::string state_hash;
  StepCounters counters;
  StopCounters stops;
  std::optional<BodyContactCounters> body_contacts;  // none: the scene has no mbd.contact
  ShortenedSteps shortened;
  double solver_seconds = 0, solver_cpu_seconds = 0;  // in predict and advance [s]
  // Sum of the local errors of the position over all steps of fixed length; none where no step has a fixed
  // length.
  std::optional<double> local_error_sum;         // [-]
  double constraint_violation = 0;               // [-]
  double start_energy = 0, end_energy = 0;       // [J]
  double energy_residual = 0, energy_scale = 0;  // of the balance, see energy_balance.hpp [J]
  int degrees_of_freedom = 0;
  double size = 1;                 // of the machine [m]
  double periods_per_step = 0;     // of the fastest harmonic function, in the longest step [-]
  std::string unstable_start;      // the warning of an unstable equilibrium at the start; empty: it is stable
  std::string most_loaded_joint;   // empty: there is none
  std::string sharpest_turn_loop;  // name of its closure; empty: there is none
  std::string cavitated;           // name of the first cylinder that cavitated; empty: none has
  std::string deepest_contact;     // names of its two shapes; empty: none touched
  std::optional<TyreBottoming::Longest> bottomed;  // none: the scene has no tyre or no mbd.contact
  ReleasedAtStart released;
  std::string released_by;  // names of the two shapes that release most; empty: none overlap at the start
  std::vector<ElementObservation> elements;
  RunTotals totals;
  ErrorEstimate error;
};
std::string report_facts(const RunFigures& figures);

}  // namespace tandem::mbd
