#include "coordinator/verdict/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tandem::launch {

Figures of_run(std::optional<double> value) {
  if (!value) return std::nullopt;
  return std::vector<Figure>{{whole_run, *value}};
}

Figures share(std::optional<double> part, std::optional<double> whole) {
  if (!part || !whole) return std::nullopt;
  return of_run(*part == 0 ? 0 : std::abs(*part) / *whole);
}

double figure_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>()
                                                     : std::numeric_limits<double>::quiet_NaN();
}

std::string of_entry(const Json& entry) {
  return entry.value("of", "");
}

Figures figures_of(const RunFigures& run, const char* list, const char* key, std::string (*of)(const Json&)) {
  const auto found = run.summary.find(list);
  if (found == run.summary.end()) return std::nullopt;
  std::vector<Figure> figures;
  for (const Json& entry : *found) figures.push_back({of(entry), figure_of(entry, key)});
  return figures;
}

const Json& entry_of(const RunFigures& run, const char* list, const std::string& of,
                     std::string (*name)(const Json&)) {
  return *std::ranges::find_if(run.summary[list], [&](const Json& entry) { return name(entry) == of; });
}

std::string finer_step(const scene::Scene& scene, double factor) {
  const scene::Integrator* const integrator = scene.mbd ? &scene.mbd->integrator : nullptr;
  factor = std::isfinite(factor) ? std::max(factor, 1e-4) : 1e-4;
  if (integrator != nullptr && integrator->error_tolerance)
    return fmt::format("use mbd.integrator.error_tolerance = {:.2g} (now {:.2g})",
                       factor * *integrator->error_tolerance, *integrator->error_tolerance);
  const double step = integrator != nullptr && integrator->step ? *integrator->step : scene.coupling.window;
  return fmt::format(
      "use mbd.integrator.step = {:.2g} s (now {:.2g}), or let the error choose it with "
      "mbd.integrator.error_tolerance = 1e-6",
      0.9 * std::sqrt(factor) * step, step);
}

}  // namespace tandem::launch
