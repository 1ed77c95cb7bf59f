#include "coordinator/window/control.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/scene/columns.hpp"
#include "coordinator/results/rows.hpp"

namespace tandem::launch {
namespace {

std::vector<std::string> with_time(std::vector<std::string> names) {
  names.insert(names.begin(), "time");
  return names;
}

}  // namespace

Control::Control(const scene::Scene& scene, const RunOptions& options, Controller* controller)
    : scene_(scene),
      controller_(controller),
      sensors_(scene.mbd->sensors.size()),
      file_(options.folder / "control.csv", with_time(scene::control_inputs(*scene.mbd))) {
  if (!controller_) {
    if (options.controller.empty())
      throw Error(ErrorCode::usage,
                  fmt::format("nothing gives the control inputs of the scene: {}",
                              fmt::join(scene::control_inputs(*scene.mbd), ", ")),
                  {}, "add --controller PROGRAM; docs/control.md says what it has to do");
    program_ = std::make_unique<ControllerProgram>(options.controller, scene, options.patience,
                                                   options.folder / "run.log");
    controller_ = program_.get();
  }
  const std::vector<std::string> columns = scene::all_columns(scene);
  for (const std::string& name : scene.mbd->sensors)
    places_.push_back(
        static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin()));
}

const protocol::ControlSet& Control::request(Nanoseconds now, const protocol::BodiesFrame& bodies,
                                             const protocol::LoadSet* loads) {
  inputs_.time = now;
  inputs_.values = controller_->inputs(now, read_sensors(bodies, loads));
  row_.assign(1, to_seconds(now));
  row_.insert(row_.end(), inputs_.values.begin(), inputs_.values.end());
  file_.append(row_);
  return inputs_;
}

const std::vector<double>& Control::read_sensors(const protocol::BodiesFrame& bodies,
                                                 const protocol::LoadSet* loads) {
  row_.clear();
  add_body_values(scene_, &bodies, loads, row_);
  add_joint_values(bodies, row_);
  row_.insert(row_.end(), bodies.elements.begin(), bodies.elements.end());
  if (loads) row_.insert(row_.end(), loads->sensors.begin(), loads->sensors.end());
  for (std::size_t i = 0; i < places_.size(); ++i) sensors_[i] = row_.at(places_[i]);
  return sensors_;
}

std::unique_ptr<Control> make_control(const scene::Scene& scene, const RunOptions& options,
                                      Controller* controller) {
  if (scene.mbd && !scene::control_inputs(*scene.mbd).empty())
    return std::make_unique<Control>(scene, options, controller);
  if (controller || !options.controller.empty())
    throw Error(ErrorCode::usage, "the scene has no control inputs", "--controller",
                "leave it out, or give actuators of the scene an \"input\"");
  return nullptr;
}

}  // namespace tandem::launch
