// The control inputs of a run: sensors go to the controller, its answer to the actuators and into
// control.csv.
#pragma once

#include <memory>

#include "launch/coordinator/controller.hpp"
#include "launch/coordinator/options.hpp"
#include "launch/results/signals.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

class Control {
 public:
  // Starts the program of the options where there is no `controller`. Error{usage} where there is neither.
  // The scene must outlive this, and have control inputs.
  Control(const scene::Scene& scene, const RunOptions& options, Controller* controller);

  // For the window that begins now. `loads` are those of the window before; nullptr without particles.
  const protocol::ControlSet& ask(Nanoseconds now, const protocol::BodiesFrame& bodies,
                                  const protocol::LoadSet* loads);

 private:
  const std::vector<double>& read_sensors(const protocol::BodiesFrame& bodies,
                                          const protocol::LoadSet* loads);

  const scene::Scene& scene_;
  std::unique_ptr<ControllerProgram> program_;
  Controller* controller_;
  std::vector<std::size_t> places_;  // of the sensors among the columns of bodies, then those of joints
  std::vector<double> row_, sensors_;
  protocol::ControlSet inputs_;
  Signals file_;
};

// Null where the scene has no control inputs; Error{usage} where there is a controller all the same.
std::unique_ptr<Control> make_control(const scene::Scene& scene, const RunOptions& options,
                                      Controller* controller);

}  // namespace tandem::launch
