#include "launch/sizing/plan.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/error.hpp"
#include "coordinator/scene/scene_spheres.hpp"
#include "dem_server/laws/step_limits.hpp"

namespace tandem::launch {
namespace {

// Largest extra time of the generic variant, on a core and on a GPU (docs/performance.md).
constexpr double generic_on_core = 1.25, generic_on_gpu = 1.2;

bool has_friction(const scene::Dem& dem) {
  return dem.contact != scene::ContactLaw::hertz_frictionless;
}

bool is_measured(const scene::Dem& dem) {
  return (dem.contact == scene::ContactLaw::hertz_mindlin || !has_friction(dem)) && !dem.force_generic &&
         !dem.rolling && !dem.twisting && dem.precision == scene::Precision::mixed &&
         std::ranges::none_of(dem.periodic, [](bool periodic) { return periodic; });
}

double cube(double x) {
  return x * x * x;
}

// The bed of the scene, in the region that its spheres have at the start.
Bed bed_of(const scene::Dem& dem, const SceneSpheres& spheres) {
  double volume = 0, largest = 0, smallest = INFINITY;
  for (const double r : spheres.start.radius) volume += 4.0 / 3 * std::numbers::pi * cube(r);
  volume /= std::max<double>(1, static_cast<double>(spheres.start.radius.size()));
  for (const SceneSpheres::Group& group : spheres.groups)
    largest = std::max(largest, group.largest), smallest = std::min(smallest, group.smallest);
  if (spheres.start.radius.empty()) volume = 4.0 / 3 * std::numbers::pi * cube(largest);
  Vec3d low = dem.domain.min, high = dem.domain.max;
  if (!spheres.start.position.empty()) {
    low = high = spheres.start.position.front();
    for (const Vec3d& x : spheres.start.position)
      for (int a = 0; a < 2; ++a) low[a] = std::min(low[a], x[a]), high[a] = std::max(high[a], x[a]);
    for (int a = 0; a < 2; ++a) low[a] -= largest, high[a] += largest;
  }
  const double skin = dem.skin.value_or(0.2 * smallest);
  const Vec3d domain = dem.domain.max - dem.domain.min;
  Bed bed;
  bed.spheres = static_cast<double>(spheres.in_all);
  bed.layer = packed_share * (high[0] - low[0]) * (high[1] - low[1]) * (2 * largest + skin) / volume;
  bed.bytes_per_ghost = (has_friction(dem) ? 48 : 32) * (dem.precision == scene::Precision::mixed ? 1 : 2);
  bed.bytes_of_cells = 4 * domain[0] * domain[1] * domain[2] / cube(2 * smallest + skin);
  return bed;
}

// As the scene, with so many spheres of the same kind in a domain of the same shape.
Bed resized(Bed bed, double spheres) {
  const double size = spheres / bed.spheres;
  bed.spheres = spheres;
  bed.layer *= std::pow(size, 2.0 / 3);
  bed.bytes_of_cells *= size;
  return bed;
}

RankKind kind_of(const scene::Dem& dem, const PlanRequest& request, Flow flow) {
  RankKind kind = request.gpus ? gpu_kind(flow, has_friction(dem)) : core_kind(flow);
  if (!is_measured(dem)) kind.us_per_sphere *= request.gpus ? generic_on_gpu : generic_on_core;
  if (dem.precision == scene::Precision::full) kind.bytes_per_sphere *= 2;
  if (request.gpus) {
    if (request.memory > 0) kind.memory = request.memory;
  } else {
    const double host = request.memory > 0 ? request.memory
                                           : static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
                                                 static_cast<double>(sysconf(_SC_PAGE_SIZE));
    kind.memory = host / request.count;
  }
  return kind;
}

std::string number(double value) {
  std::string digits = fmt::format("{:.0f}", value);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, ",");
  return digits;
}
std::string rounded_number(double value) {
  const double step = std::pow(10, std::max(0.0, std::floor(std::log10(value)) - 1));
  return number(std::floor(value / step) * step);
}
std::string bytes_text(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.3g} MB", bytes / 1e6) : fmt::format("{:.3g} GB", bytes / 1e9);
}
std::string duration(double seconds) {
  return seconds < 100    ? fmt::format("{:.3g} s", seconds)
         : seconds < 6000 ? fmt::format("{:.3g} min", seconds / 60)
                          : fmt::format("{:.3g} h", seconds / 3600);
}

std::optional<double> micro_steps(const scene::Scene& scene, const SceneSpheres& spheres) {
  const scene::Dem& dem = *scene.dem;
  if (!dem.micro_step && (dem.auto_step || !std::isfinite(spheres.critical_time))) return {};
  const double step = dem.micro_step.value_or(dem::automatic_step_share * spheres.critical_time);
  return std::ceil(scene.coupling.window / step * (1 - 1e-12)) * (scene.end_time / scene.coupling.window);
}

std::string us_text(double us) {
  return us < 1000 ? fmt::format("{:.3g} us", us) : number(us) + " us";
}

std::string limit_of(const RankCost& one, const RankCost& cost, const RankKind& kind) {
  const char* const rank = kind.gpu ? "GPU" : "rank";
  if (kind.memory > 0 && cost.memory > 0.97 * kind.memory)
    return fmt::format("memory: it does not fit, see below; give more {}s", rank);
  if (cost.halo_us == 0) return "work";
  if (cost.step_us() >= one.step_us())
    return fmt::format("messages: they take longer than the work that is saved. One {} is faster", rank);
  if (cost.step_us() > 1.1 * cost.work_us)
    return "messages and new lists of the ranks: more than a tenth of the work";
  return "work";
}

}  // namespace

std::string plan(const SceneFile& file, const PlanRequest& request) {
  if (!file.scene.dem)
    throw Error(ErrorCode::usage, "the scene has no grains, and only those are computed on several ranks",
                file.origin, "tandem describe says what the scene needs");
  const scene::Dem& dem = *file.scene.dem;
  const SceneSpheres spheres = spheres_of(file);
  if (spheres.in_all == 0) throw Error(ErrorCode::scene, "no sphere is there before end_time", file.origin);
  Bed bed = bed_of(dem, spheres);
  if (request.spheres > 0) bed = resized(bed, request.spheres);
  const char* const rank = request.gpus ? "GPU" : "rank";
  const char* const plural = request.count == 1 ? "" : "s";

  std::string text = fmt::format("{}: {} spheres on {} {}{}\n", file.scene.name, number(bed.spheres),
                                 request.count, rank, plural);
  const auto line = [&text](const char* what, const std::string& value) {
    text += fmt::format("  {:<22}{}\n", what, value);
  };
  const std::optional<double> steps = micro_steps(file.scene, spheres);
  RankCost cost, one;
  RankKind kind;
  std::string run;
  for (const Flow flow : {Flow::settled, Flow::flowing}) {
    kind = kind_of(dem, request, flow);
    cost = cost_of(bed, kind, request.count), one = cost_of(bed, kind, 1);
    const bool settled = flow == Flow::settled;
    if (settled) {
      line(fmt::format("on each {}", rank).c_str(),
           fmt::format("{} spheres, up to {} ghosts of others", number(cost.spheres), number(cost.ghosts)));
      line(fmt::format("memory of a {}", rank).c_str(),
           fmt::format("{} of {}", bytes_text(cost.memory), bytes_text(kind.memory)));
    }
    line(settled ? "micro step, at rest" : "micro step, flowing",
         request.count == 1
             ? us_text(cost.step_us())
             : fmt::format("{}: {} work, {} halo, {} agreement, {} to pack and to share out; one {} {}",
                           us_text(cost.step_us()), us_text(cost.work_us), us_text(cost.halo_us),
                           us_text(cost.agreement_us), us_text(cost.ranks_us), rank, us_text(one.step_us())));
    if (steps) run += (settled ? "" : " to ") + duration(*steps * cost.step_us() / 1e6);
  }
  line("run",
       steps ? fmt::format("{} micro steps in {}, without bodies, frames and inlets", number(*steps), run)
             : "the micro step is not known before the run: give dem.micro_step");
  line("limit", limit_of(one, cost, kind));
  std::string why;
  const double most = largest_bed(bed, kind, request.count, why);
  line("largest such bed", fmt::format("{} spheres: {}", rounded_number(most), why));
  if (!is_measured(dem))
    line("note",
         "no rate of this contact law, precision or domain was measured: times of the generic variant at "
         "most");
  line("rates", request.gpus ? "of one H100, and of ranks on two H200s (docs/cost_of_ranks.md)"
                             : "of one core of a Xeon; messages of one host (docs/cost_of_ranks.md)");
  return text;
}

}  // namespace tandem::launch
