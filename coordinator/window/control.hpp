// The control inputs of a run: sends the sensor values to the controller, and its answer to the actuators and
// to control.csv.
#pragma once

#include <memory>

#include "coordinator/results/signals.hpp"
#include "coordinator/scene/options.hpp"
#include "coordinator/window/controller.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

class Control {
 public:
  // Starts the program of the options where there is no `controller`. Throws Error{usage} where there is
  // neither. The scene must outlive this object, and have control inputs.
  Control(const scene::Scene& scene, const RunOptions& options, Controller* controller);

  // For the window that begins now. `loads` are those of the previous window; null without particles.
  const protocol::ControlSet& request(Nanoseconds now, const protocol::BodiesFrame& bodies,
                                      const protocol::LoadSet* loads);

 private:
  const std::vector<double>& read_sensors(const protocol::BodiesFrame& bodies,
                                          const protocol::LoadSet* loads);

  const scene::Scene& scene_;
  std::unique_ptr<ControllerProgram> program_;
  Controller* controller_;
  std::vector<std::size_t> places_;  // column indices of the sensors: of bodies, joints, elements
  std::vector<double> row_, sensors_;
  protocol::ControlSet inputs_;
  Signals file_;
};

// Null where the scene has no control inputs; throws Error{usage} where a controller is given nevertheless.
std::unique_ptr<Control> make_control(const scene::Scene& scene, const RunOptions& options,
                                      Controller* controller);

}  // namespace tandem::launch
