#include "coordinator/run/half_steps.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/scene/parse.hpp"

namespace tandem::launch {

void expect_repeatable(const RunOptions& options, const scene::Scene& scene, bool controller_in_program) {
  const auto refuse = [](const char* problem, const char* hint) {
    throw Error(ErrorCode::usage, problem, "--estimate richardson", hint);
  };
  if (!scene.mbd)
    refuse("measures the step of the multibody part, and the scene has none", "leave the option out");
  if (options.attach)
    refuse("runs the scene twice, and servers started by hand leave after the first run",
           "leave --attach out");
  if (!options.restart.empty())
    refuse("would not see the error of the run that --restart continues from",
           "run the scene from its start");
  if (controller_in_program)
    refuse("runs the scene twice, and the controller of the calling program is not started anew",
           "give the controller as a command");
}

SceneFile with_half_steps(const SceneFile& file) {
  const scene::Integrator& settings = file.scene.mbd->integrator;
  const double window = file.scene.coupling.window, step = settings.step.value_or(window);
  auto json = nlohmann::ordered_json::parse(file.text);
  auto& integrator = json["mbd"]["integrator"];
  if (settings.error_tolerance) {
    integrator["step"] = step / 2;
    integrator["error_tolerance"] = *settings.error_tolerance / 16;
  } else {
    // The solver takes a whole number of steps per window. The margin prevents round-off from adding one.
    integrator["step"] = window / (2 * std::ceil(window / step * (1 - 1e-9)));
  }
  if (file.scene.has_particles()) {
    json["output"]["particles"] = false;
    for (const char* of_spheres : {"fields", "wall_fields", "contacts"}) json["output"].erase(of_spheres);
  }
  SceneFile half = file;
  half.text = json.dump(2);
  half.scene = scene::parse(half.text, half.origin);
  return half;
}

RunOptions for_half_steps(const RunOptions& options) {
  RunOptions half = options;
  half.folder = options.folder / "half_steps";
  half.estimate = Estimate::standard;
  half.checkpoint_every = 0;
  half.record.clear();
  return half;
}

}  // namespace tandem::launch
