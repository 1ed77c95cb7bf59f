// What the multibody side adds to summary.json, as JSON text.
#pragma once

#include <string>

#include "common/scene/model.hpp"
#include "mbd_server/model/model.hpp"
#include "mbd_server/solve/assembly.hpp"
#include "mbd_server/step/stop_contacts.hpp"

namespace tandem::mbd {

std::string configured_facts(const Model& model, const scene::Scene& scene, const AssemblyReport& assembly);

struct RunFigures {
  std::string state_hash;
  StepCounters counters;
  StopCounters stops;
  double solver_seconds = 0, solver_cpu_seconds = 0;       // in predict and advance [s]
  double constraint_violation = 0;                         // [-]
  double start_energy = 0, end_energy = 0, load_work = 0;  // [J]
  bool conservative = false;                               // energy changes by the work of the loads alone
};
std::string report_facts(const RunFigures& figures);

}  // namespace tandem::mbd
