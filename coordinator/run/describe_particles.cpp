#include "coordinator/run/describe_particles.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "common/overloaded.hpp"
#include "common/scene/shape_mesh.hpp"
#include "common/utf8.hpp"
#include "coordinator/run/text_table.hpp"
#include "dem_server/laws/step_limits.hpp"

namespace tandem::launch {
namespace {

using namespace scene;
using namespace tables;

std::string shape(const Wall& wall) {
  return std::visit(
      Overloaded{[](const PlaneShape& s) { return "plane, normal " + text(s.normal); },
                 [](const BoxShape& s) { return "box " + text(s.size); },
                 [](const CylinderShape& s) {
                   return fmt::format("cylinder, radius {:.6g}, ", s.radius) +
                          (s.height ? fmt::format("height {:.6g}", *s.height) : "endless");
                 },
                 [](const SphereShape& s) { return fmt::format("sphere, radius {:.6g}", s.radius); },
                 [](const MeshShape& s) { return "mesh " + s.file; }},
      wall.shape);
}

std::string belt(const Wall& wall) {
  return wall.surface_velocity ? ", surface moves along " + text(wall.surface_velocity->direction) : "";
}

// Source and number of the spheres of a group.
std::pair<std::string, std::string> source(const decltype(ParticleGroup::fill)& fill) {
  const auto number = [](const std::optional<std::uint64_t>& count, const char* otherwise) {
    return count.has_value() ? std::to_string(*count) : otherwise;
  };
  using Source = std::pair<std::string, std::string>;
  return std::visit(Overloaded{[&](const LatticeFill& f) -> Source {
                                 return {f.lattice + " lattice", number(f.count, "as many as fit")};
                               },
                               [&](const InletFill& f) -> Source {
                                 return {f.rate ? fmt::format("inlet, {:.6g} /s", *f.rate)
                                                : fmt::format("inlet, {:.6g} kg/s", *f.mass_rate),
                                         number(f.count, "until the end")};
                               },
                               [](const PackingFill&) -> Source {
                                 return {"packing", "as many as asked for"};
                               },
                               [](const RunFill& f) -> Source {
                                 return {"run " + f.folder, "as many as the frame has"};
                               },
                               [](const FileFill& f) -> Source {
                                 return {"file " + f.file, "as many as the file has"};
                               }},
                    fill);
}

std::string describe_meshes(const std::vector<ImportedMesh>& meshes) {
  Table table("meshes", {"wall", "file", "scale", "size [m]", "triangles", "open edges", "openings",
                         "non-manifold edges", "inverted edges", "area [m2]", "volume [m3]"});
  for (const ImportedMesh& mesh : meshes) {
    const MeshFacts& f = mesh.facts;
    const Vec3d& s = mesh.stretch;
    const std::string stretch = s.x == 1 && s.y == 1 && s.z == 1 ? "" : " x " + text(s);
    table.add({mesh.wall, mesh.file, fmt::format("{:.6g}{}", mesh.scale, stretch), text(f.size()),
               std::to_string(f.triangles), std::to_string(f.open_edges), std::to_string(f.openings.size()),
               std::to_string(f.non_manifold_edges), std::to_string(f.inverted_edges),
               fmt::format("{:.6g}", f.area), f.volume ? fmt::format("{:.6g}", *f.volume) : "-"});
  }
  return table.print();
}

// What the particle solver has reported of the scene; figures that it has not are left out.
std::string particle_facts(const DryRun& started) {
  const protocol::DemFacts& facts = started.facts.dem;
  std::vector<std::string> parts;
  const auto number = [&](const auto& value, auto format) {
    if (value) parts.push_back(fmt::format(fmt::runtime(format), *value));
  };
  number(facts.spheres, "{} spheres in all");
  if (facts.backend)
    parts.push_back("on " + *facts.backend + (facts.device ? " (" + *facts.device + ")" : ""));
  number(facts.micro_step, "micro step {:.6g} s");
  number(facts.steps_per_window, "{} in a window");
  number(facts.predicted_memory, "{:.3g} MB");
  if (parts.empty()) return "spheres and micro step are not reported by " + started.dem_program;
  return fmt::format("{}", fmt::join(parts, ", "));
}

Table table_of(const char* title, const std::vector<Outlet>& outlets) {
  Table table(title, {"name", "region [m]"});
  for (const Outlet& outlet : outlets)
    table.add({outlet.name,
               std::visit(Overloaded{[](const Box& box) { return text(box.min) + " .. " + text(box.max); },
                                     [](const HalfSpace& beyond) {
                                       return "beyond " + text(beyond.point) + ", normal " +
                                              text(beyond.normal);
                                     }},
                          outlet.region)});
  return table;
}

}  // namespace

std::string describe_dem(const SceneFile& file, const DryRun* started) {
  const Scene& scene = file.scene;
  const Dem& dem = *scene.dem;
  Table groups("particles",
               {"group", "material", "radius [m]", "from", "spheres", "mass [kg]", "void fraction"});
  for (const ParticleGroup& group : dem.particles) {
    const auto placed = std::ranges::find(file.placed, group.name, &PlacedGroup::group);
    if (placed != file.placed.end()) {
      groups.add({group.name, dem.materials[group.material.value].name,
                  fmt::format("{:.6g} .. {:.6g}", placed->smallest, placed->largest), placed->from,
                  std::to_string(placed->spheres), fmt::format("{:.6g}", placed->mass),
                  placed->void_fraction ? fmt::format("{:.4g}", *placed->void_fraction) : "-"});
      continue;
    }
    auto [from, count] = source(group.fill);
    if (group.fixed) count += ", fixed";
    groups.add({group.name, dem.materials[group.material.value].name,
                fmt::format("{:.6g} .. {:.6g}", group.radius_min, group.radius_max), from, count, "-", "-"});
  }
  const Table outlets = table_of("outlets", dem.outlets);
  Table sensors("sensors", {"name", "body", "region [m]", "flow"});
  for (const ParticleSensor& sensor : dem.sensors) {
    if (!sensor.wall.empty()) {
      const auto wall = std::ranges::find(dem.walls, sensor.wall, &Wall::name);
      sensors.add({sensor.name, scene.body_name(wall->body), "wall " + sensor.wall, ""});
      continue;
    }
    const std::string region =
        std::visit(Overloaded{[](const BoxShape& box) { return "box " + text(box.size); },
                              [](const CylinderShape& cylinder) {
                                return fmt::format("cylinder, radius {:.6g}, height {:.6g}", cylinder.radius,
                                                   *cylinder.height);
                              }},
                   sensor.shape);
    sensors.add({sensor.name, scene.body_name(sensor.body), region + " at " + text(sensor.pose.p_WB),
                 sensor.flow_axis ? std::string(1, "xyz"[*sensor.flow_axis]) : ""});
  }

  Table walls("walls", {"name", "body", "material", "shape [m]"});
  for (const Wall& wall : dem.walls)
    walls.add({wall.name, scene.body_name(wall.body), dem.materials[wall.material.value].name,
               shape(wall) + belt(wall)});

  Table pairs("contacts", {"materials", "restitution", "friction"});
  for (const Pair& pair : dem.pairs) {
    pairs.add({dem.materials[pair.a.value].name + " - " + dem.materials[pair.b.value].name,
               fmt::format("{:.4g}", pair.restitution), fmt::format("{:.4g}", pair.friction)});
  }

  const double critical = tandem::dem::critical_time(dem);
  std::string steps = fmt::format(
      "\nmicro step: {}", dem.micro_step ? fmt::format("{:.6g} s", *dem.micro_step) : "chosen by the solver");
  steps += fmt::format(", critical time {:.6g} s", critical);
  if (dem.micro_step) {
    steps += fmt::format(" (share {:.3g}), at least {} micro steps per window", *dem.micro_step / critical,
                         std::ceil(scene.coupling.window / *dem.micro_step));
  }
  if (started) steps += "\nsolver: " + particle_facts(*started);
  return groups.print() + outlets.print() + sensors.print() + walls.print() +
         describe_meshes(file.mesh_facts) + pairs.print() + steps + "\n";
}

// What the solver of the liquid has reported of the scene.
// window, end_time: of the scene [s].

namespace {

std::string liquid_facts(const DryRun& started, double window, double end_time) {
  const protocol::SphFacts& facts = started.facts.sph;
  std::vector<std::string> parts;
  if (facts.particles) parts.push_back(fmt::format("{} particles", *facts.particles));
  if (facts.backend) parts.push_back("on " + *facts.backend);
  if (facts.sound_speed) parts.push_back(fmt::format("speed of sound {:.6g} m/s", *facts.sound_speed));
  if (facts.longest_step) parts.push_back(fmt::format("step {:.6g} s", *facts.longest_step));
  if (facts.steps_per_window) parts.push_back(fmt::format("{} in a window", *facts.steps_per_window));
  if (facts.predicted_memory) parts.push_back(fmt::format("{:.3g} MB", *facts.predicted_memory));
  if (facts.wall_facets) parts.push_back(fmt::format("{} triangles of walls", *facts.wall_facets));
  if (facts.beside_walls) parts.push_back(fmt::format("{} particles beside them", *facts.beside_walls));
  if (facts.rates_seconds && facts.steps_per_window) {
    const double steps = static_cast<double>(*facts.steps_per_window) * std::ceil(end_time / window);
    parts.push_back(fmt::format("at least {:.2g} s for the {:.3g} steps of the run",
                                *facts.rates_seconds * steps, steps));
  }
  if (parts.empty()) return "particles and step are not reported by " + started.sph_program;
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string fill_of_liquid(const std::variant<Box, LiquidInside>& fill) {
  if (const auto* box = std::get_if<Box>(&fill)) return "box " + text(box->min) + " .. " + text(box->max);
  const auto& inside = std::get<LiquidInside>(fill);
  return "inside " + inside.wall +
         (inside.level    ? fmt::format(" up to {:.6g}", *inside.level)
          : inside.volume ? fmt::format(", {:.6g} m3", *inside.volume)
                          : fmt::format(", {:.6g} kg", *inside.mass));
}

const char* kind_of(LiquidSensor::Kind kind) {
  switch (kind) {
    case LiquidSensor::Kind::region:
      return "region";
    case LiquidSensor::Kind::load:
      return "load";
    case LiquidSensor::Kind::level:
      return "level";
    case LiquidSensor::Kind::pressure:
      break;
  }
  return "pressure";
}

}  // namespace

std::string describe_sph(const SceneFile& file, const DryRun* started) {
  const Scene& scene = file.scene;
  const Sph& sph = *scene.sph;
  Table liquids("liquid", {"name", "density [kg/m3]", "viscosity [Pa s]", "fill [m]"});
  for (const Liquid& liquid : sph.liquids)
    for (const auto& fill : liquid.fill)
      liquids.add({liquid.name, fmt::format("{:.6g}", liquid.density),
                   fmt::format("{:.6g}", liquid.viscosity), fill_of_liquid(fill)});
  for (const Liquid& liquid : sph.liquids)
    if (liquid.fill.empty())
      liquids.add({liquid.name, fmt::format("{:.6g}", liquid.density),
                   fmt::format("{:.6g}", liquid.viscosity), "none at the start"});
  Table sensors("sensors of the liquid", {"name", "type", "body", "place [m]"});
  for (const LiquidSensor& sensor : sph.sensors)
    sensors.add({sensor.name, kind_of(sensor.kind),
                 sensor.wall.empty() ? scene.body_name(sensor.body) : "wall " + sensor.wall,
                 text(sensor.pose.p_WB)});
  Table walls("walls of the liquid", {"name", "body", "shape [m]"});
  for (const Wall& wall : sph.walls) walls.add({wall.name, scene.body_name(wall.body), shape(wall)});
  Table inlets("inlets of the liquid", {"name", "position [m]", "area [m2]", "velocity [m/s]"});
  for (const LiquidInlet& inlet : sph.inlets)
    inlets.add({inlet.name, text(inlet.pose.p_WB), fmt::format("{:.6g}", inlet.area()),
                fmt::format("{:.6g}", inlet.speed())});
  return liquids.print() + inlets.print() + table_of("outlets of the liquid", sph.outlets).print() +
         sensors.print() + walls.print() + (scene.dem ? "" : describe_meshes(file.mesh_facts)) +
         fmt::format("\nspacing: {:.6g} m\n", sph.spacing) +
         (started ? "solver: " + liquid_facts(*started, scene.coupling.window, scene.end_time) + "\n" : "");
}

}  // namespace tandem::launch
