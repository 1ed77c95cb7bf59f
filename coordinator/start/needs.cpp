#include "coordinator/start/needs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/scene/columns.hpp"
#include "common/scene/element_columns.hpp"
#include "common/scene/parse.hpp"
#include "common/utf8.hpp"
#include "coordinator/schemes/schemes.hpp"

namespace tandem::launch {
namespace {

using protocol::Role;

std::uint64_t bits_of(const std::vector<Need>& needs) {
  std::uint64_t bits = 0;
  for (const Need& need : needs) bits |= need.capability;
  return bits;
}

// Sensors and checks that use the results of elements.
void add_needs_of_elements(const scene::Scene& scene, std::vector<Need>& needs) {
  if (!scene.mbd) return;
  const std::vector<std::string> columns = scene::element_columns(scene);
  const auto add = [&](const std::string& signal, const std::string& by) {
    if (std::ranges::find(columns, signal) != columns.end() || signal.starts_with("summary.elements."))
      needs.push_back({protocol::can_observe_elements, by + " '" + signal + "'", "leave out that " + by});
  };
  for (const std::string& sensor : scene.mbd->sensors) add(sensor, "sensor");
  for (const scene::Check& check : scene.checks) {
    add(check.of, "check of");
    add(check.expected_of, "check against");
  }
}

std::vector<Need> needs_of_mbd(const scene::Scene& scene) {
  std::vector<Need> needs;
  add_needs_of_elements(scene, needs);
  if (scene.mbd && !scene::control_inputs(*scene.mbd).empty())
    needs.push_back({protocol::can_control, "an actuator with an input",
                     "give the actuators a function of time instead of an input"});
  if (!scene.has_particles()) return needs;
  const scene::Coupling& how = scene.coupling;
  const std::string scheme = fmt::format("scheme '{}'", name(how.scheme));
  // The path of a window is predicted by `predict`, or by `extrapolate` where it is quadratic.
  if (how.path == scene::PathShape::quadratic)
    needs.push_back({protocol::can_extrapolate, "coupling.path 'quadratic'", "leave out coupling.path"});
  else if (how.scheme != scene::Scheme::mbd_first)
    needs.push_back({protocol::can_predict, scheme, ""});
  if (how.load == scene::LoadShape::linear)
    needs.push_back({protocol::can_extrapolate, "coupling.load 'linear'", "leave out coupling.load"});
  if (how.scheme == scene::Scheme::implicit || how.scheme == scene::Scheme::linear_implicit)
    needs.push_back({protocol::can_rollback, scheme, ""});
  if (how.adaptive)
    needs.push_back({protocol::can_rollback, "coupling.adaptive", "leave out coupling.adaptive"});
  return needs;
}

// Of a solver with particles, with those of its own outputs.
std::vector<Need> needs_of_load_solver(const scene::Scene& scene, const std::vector<Need>& own) {
  std::vector<Need> needs{{protocol::can_window_mean, "every scene with particles", ""}};
  needs.insert(needs.end(), own.begin(), own.end());
  if (!scene.mbd) return needs;
  const scene::Coupling& how = scene.coupling;
  const std::string scheme = fmt::format("scheme '{}'", name(how.scheme));
  needs.push_back({protocol::can_interpolate, "every scene with bodies", ""});
  if (how.scheme == scene::Scheme::linear_implicit) needs.push_back({protocol::can_linearise, scheme, ""});
  if (how.scheme == scene::Scheme::implicit) needs.push_back({protocol::can_rollback, scheme, ""});
  if (how.adaptive)
    needs.push_back({protocol::can_rollback, "coupling.adaptive", "leave out coupling.adaptive"});
  return needs;
}

std::vector<Need> needs_of_dem(const scene::Scene& scene) {
  std::vector<Need> needs;
  const auto add = [&](protocol::Capability capability, const std::string& by, const std::string& remedy) {
    needs.push_back({capability, by, remedy});
  };
  if (!scene.dem->sensors.empty()) add(protocol::can_measure, "dem.sensors", "leave out dem.sensors");
  for (const scene::SphereField field : {scene::SphereField::contact_count, scene::SphereField::mean_stress})
    if (const std::string_view name = scene::sphere_field_names[static_cast<std::size_t>(field)];
        scene.output.has(field))
      add(protocol::can_observe_contacts, fmt::format("output.fields '{}'", name),
          fmt::format("leave '{}' out of output.fields", name));
  if (!scene.output.contacts.empty())
    add(protocol::can_observe_contacts, "output.contacts", "leave out output.contacts");
  if (!scene.output.wall_fields.empty())
    add(protocol::can_observe_walls, "output.wall_fields", "leave out output.wall_fields");
  return needs_of_load_solver(scene, needs);
}

std::vector<Need> needs_of_sph(const scene::Scene& scene) {
  std::vector<Need> needs;
  if (!scene.sph->sensors.empty())
    needs.push_back({protocol::can_measure, "sph.sensors", "leave out sph.sensors"});
  return needs_of_load_solver(scene, needs);
}

bool valid(const scene::Scene& scene) {
  try {
    scene::validate(scene, "");
    return true;
  } catch (const Error&) {
    return false;
  }
}

void add_once(std::vector<std::string>& list, const std::string& text) {
  if (!text.empty() && std::ranges::find(list, text) == list.end()) list.push_back(text);
}

}  // namespace

std::vector<Need> needs_of(Role role, const scene::Scene& scene) {
  switch (role) {
    case Role::mbd:
      return needs_of_mbd(scene);
    case Role::dem:
      return needs_of_dem(scene);
    case Role::sph:
      break;
  }
  return needs_of_sph(scene);
}
std::uint64_t needed_of(Role role, const scene::Scene& scene) {
  return bits_of(needs_of(role, scene));
}

std::string in_words(protocol::Capability capability) {
  switch (capability) {
    case protocol::can_predict:
      return "a predicted path (predict)";
    case protocol::can_rollback:
      return "rollback (save and restore)";
    case protocol::can_interpolate:
      return "walls that follow the path of their body inside a window";
    case protocol::can_window_mean:
      return "loads that are means over a window";
    case protocol::can_linearise:
      return "the stiffness of the contacts (linearise)";
    case protocol::can_extrapolate:
      return "loads and paths of second order (extrapolate, and loads that are linear in time)";
    case protocol::can_control:
      return "control inputs (control)";
    case protocol::can_checkpoint:
      return "restart files (checkpoint and resume)";
    case protocol::can_observe_elements:
      return "results of motors, cylinders and other elements";
    case protocol::can_measure:
      return "measures of the particles (sensors)";
    case protocol::can_observe_contacts:
      return "the contacts of the spheres in frames";
    case protocol::can_snapshot:
      return "frames that are prepared during the next window (snapshot)";
    case protocol::can_respond:
      return "responses to changes of velocity (added mass)";
    case protocol::can_observe_liquid:
      return "pressure and density of the liquid in frames";
    case protocol::can_observe_walls:
      return "the forces on triangles of walls in frames";
  }
  return "an unknown capability";
}

std::vector<std::string> possible_schemes(const scene::Scene& scene, const std::vector<Offer>& offers) {
  std::vector<std::string> names;
  for (const scene::Scheme scheme :
       {scene::Scheme::parallel, scene::Scheme::mbd_first, scene::Scheme::dem_first,
        scene::Scheme::linear_implicit, scene::Scheme::implicit}) {
    scene::Scene other = scene;
    other.coupling.scheme = scheme;
    // Its settings belong to scheme `implicit`, and leave with it.
    if (scheme != scene::Scheme::implicit) other.coupling.iteration.reset();
    const bool offered = std::ranges::all_of(offers, [&](const Offer& offer) {
      return (needed_of(offer.role, other) & ~offer.capabilities) == 0;
    });
    if (offered && valid(other)) names.emplace_back(name(scheme));
  }
  return names;
}

void expect_capabilities(const scene::Scene& scene, const std::vector<Need>& besides,
                         const std::vector<Offer>& offers) {
  std::vector<std::string> sentences, remedies;
  bool of_scheme = false;        // whether another scheme may help
  scene::Scene without = scene;  // the scene without the settings that have to be left out
  for (const Offer& offer : offers) {
    std::vector<Need> needs = needs_of(offer.role, scene);
    needs.insert(needs.end(), besides.begin(), besides.end());
    for (const Need& need : needs) {
      if (offer.capabilities & need.capability) continue;
      add_once(sentences, fmt::format("{} needs {}, which {} does not offer", need.by,
                                      in_words(need.capability), printable(shortened(offer.program))));
      add_once(remedies, need.remedy);
      of_scheme |= need.by.starts_with("scheme ");
      if (need.by.starts_with("coupling.adaptive")) without.coupling.adaptive.reset();
      if (need.by.starts_with("coupling.path")) without.coupling.path = scene::PathShape::linear;
      if (need.by.starts_with("coupling.load")) without.coupling.load = scene::LoadShape::mean;
    }
  }
  if (sentences.empty()) return;
  if (of_scheme) {
    const std::vector<std::string> schemes = possible_schemes(without, offers);
    if (!schemes.empty())
      remedies.push_back(fmt::format("these schemes are possible: {}", fmt::join(schemes, ", ")));
    else if (remedies.empty())
      remedies.emplace_back("no scheme is possible with these solvers: use another one");
  }
  if (remedies.empty()) remedies.emplace_back("use another solver");
  throw UnmetNeed(ErrorCode::scene, fmt::format("{}", fmt::join(sentences, "; ")), {},
                  fmt::format("{}", fmt::join(remedies, "; ")));
}

}  // namespace tandem::launch
