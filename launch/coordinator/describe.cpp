#include "launch/coordinator/describe.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/overloaded.hpp"
#include "common/scene/shape_mesh.hpp"
#include "common/utf8.hpp"
#include "dem_server/laws/step_limits.hpp"
#include "launch/coordinator/describe_elements.hpp"
#include "launch/coordinator/schemes.hpp"

namespace tandem::launch {
namespace {

using namespace scene;

std::string text(Vec3d v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}

// Left-aligned columns as wide as their widest cell.
class Table {
 public:
  explicit Table(std::string title, std::vector<std::string> head)
      : title_(std::move(title)), rows_{std::move(head)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  std::string print() const {
    if (rows_.size() == 1) return {};
    std::vector<std::size_t> width(rows_[0].size());
    for (const auto& row : rows_)
      for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
    std::string out = "\n" + title_ + "\n";
    for (const auto& row : rows_) {
      std::string line = " ";
      for (std::size_t i = 0; i < row.size(); ++i) line += fmt::format(" {:<{}}", row[i], width[i]);
      line.erase(line.find_last_not_of(' ') + 1);
      out += line + "\n";
    }
    return out;
  }

 private:
  std::string title_;
  std::vector<std::vector<std::string>> rows_;
};

struct JointKind {
  const char* name;
  int freedom;
};

JointKind kind(const Joint& joint) {
  const bool prescribed = joint.motion.has_value();
  switch (joint.type) {
    case JointType::fixed:
      return {"fixed", 0};
    case JointType::revolute:
      return prescribed ? JointKind{"revolute, prescribed", 0} : JointKind{"revolute", 1};
    case JointType::prismatic:
      return prescribed ? JointKind{"prismatic, prescribed", 0} : JointKind{"prismatic", 1};
    case JointType::spherical:
      return {"spherical", 3};
    case JointType::free:
      return {"free", 6};
    case JointType::cylindrical:
      return {"cylindrical", 2};
    case JointType::universal:
      return {"universal", 2};
    case JointType::planar:
      return {"planar", 3};
    case JointType::screw:
      return {"screw", 1};
    case JointType::distance:
      return {"distance", 5};
  }
  return {"unknown", 0};
}

// The bodies in the assemblies of a CAD program, as a tree; empty where the scene has none.
std::string assemblies_of(const Mbd& mbd) {
  if (std::ranges::all_of(mbd.bodies, [](const Body& body) { return body.assembly.empty(); })) return {};
  std::string out = "\nassemblies\n";
  std::vector<std::string> open;
  for (const Body& body : mbd.bodies) {
    std::vector<std::string> path;
    for (std::size_t at = 0; at < body.assembly.size();) {
      const std::size_t end = std::min(body.assembly.find('/', at), body.assembly.size());
      path.push_back(body.assembly.substr(at, end - at));
      at = end + 1;
    }
    std::size_t level = 0;
    while (level < path.size() && level < open.size() && path[level] == open[level]) ++level;
    for (; level < path.size(); ++level)
      out += fmt::format("  {}{}\n", std::string(2 * level, ' '), printable(path[level]));
    open = path;
    out += fmt::format("  {}- {}, {:.6g} kg\n", std::string(2 * path.size(), ' '), body.name, body.mass);
  }
  return out;
}

// The criterion of Gruebler and Kutzbach: 6 for each body, less the equations of joints and couplers.
// Redundant equations make the number too small.
std::string freedom_by_counting(const Mbd& mbd) {
  const int of_bodies = 6 * static_cast<int>(mbd.bodies.size());
  int equations = static_cast<int>(mbd.couplers.size());
  for (const Joint& joint : mbd.joints) equations += 6 - kind(joint).freedom;
  const std::string count = fmt::format("6 for each of {} bodies, less {} equations of joints and couplers",
                                        mbd.bodies.size(), equations);
  if (of_bodies < equations)
    return fmt::format(
        "at least 0: {} give {}, so that at least {} equations are redundant or contradict others; "
        "only the solver can tell",
        count, of_bodies - equations, equations - of_bodies);
  return fmt::format("at least {}: {}; redundant equations would make it more", of_bodies - equations, count);
}

// The number that the solver has determined in the initial pose.
std::string freedom_of(const DryRun& started) {
  const protocol::MbdFacts& facts = started.facts.mbd;
  if (!facts.dof) return "not reported by " + started.mbd_program;
  std::string line = std::to_string(*facts.dof);
  const auto redundant = facts.redundant_equations.value_or(std::vector<std::string>{});
  if (redundant.empty()) return line;
  constexpr std::size_t most = 6;
  line +=
      fmt::format("; redundant equations of closed loops, {}: {}", redundant.size(),
                  fmt::join(redundant.begin(), redundant.begin() + std::min(most, redundant.size()), "; "));
  return line + (redundant.size() > most ? fmt::format("; and {} more", redundant.size() - most) : "");
}

// Mass, centre of mass and inertia of the bodies whose mass follows from their shapes.
std::string describe_shaped(const SceneFile& file) {
  Table table("mass from shapes", {"body", "shapes", "mass [kg]", "centre of mass in the body's frame [m]",
                                   "inertia xx, yy, zz, xy, xz, yz [kg m2]"});
  for (const ShapedBody& body : file.shaped) {
    const auto& I = body.mass.inertia;
    table.add(
        {file.scene.body_name(body.body), std::to_string(body.shapes), fmt::format("{:.6g}", body.mass.mass),
         text(body.mass.centre),
         fmt::format("{:.6g}, {:.6g}, {:.6g}, {:.6g}, {:.6g}, {:.6g}", I[0], I[1], I[2], I[3], I[4], I[5])});
  }
  return table.print();
}

std::string describe_contact(const Scene& scene) {
  Table table("shapes that touch", {"shape", "body", "geometry", "material"});
  const auto add = [&](const Shape& shape) {
    if (shape.use == ShapeUse::contact)
      table.add({shape.name, scene.body_name(shape.body), name_of(shape.geometry),
                 scene.contact->materials[static_cast<std::size_t>(shape.contact_material)].name});
  };
  std::ranges::for_each(scene.shapes, add);
  std::ranges::for_each(scene.contact->ground, add);

  const auto names = [&](const std::vector<ContactSide>& sides) {
    std::string list;
    for (const ContactSide& side : sides)
      list += (list.empty() ? "" : ", ") + scene.body_name(side.body) +
              (side.shape.empty() ? "" : "/" + side.shape);
    return list.empty() ? "all others" : list;
  };
  Table outputs("outputs of contacts", {"name", "forces on", "from"});
  for (const ContactOutput& output : scene.contact->outputs)
    outputs.add({output.name, names(output.on), names(output.from)});
  return table.print() + outputs.print();
}

std::string describe_mbd(const SceneFile& file, const DryRun* started) {
  const Scene& scene = file.scene;
  const Mbd& mbd = *scene.mbd;
  std::vector<bool> jointed(mbd.bodies.size());

  Table bodies("bodies", {"name", "mass [kg]", "position [m]"});
  for (const Body& body : mbd.bodies)
    bodies.add({body.name, fmt::format("{:.6g}", body.mass), text(body.pose.p_WB)});

  Table joints("joints", {"name", "type", "parent", "child", "position [m]", "freedom"});
  for (const Joint& joint : mbd.joints) {
    const JointKind what = kind(joint);
    joints.add({joint.name, what.name, scene.body_name(joint.parent), scene.body_name(joint.child),
                text(joint.position), std::to_string(what.freedom)});
    jointed[joint.child.value] = true;
  }
  const auto free_bodies = std::count(jointed.begin(), jointed.end(), false);

  Table forces("forces", {"name", "type", "between", "stiffness", "damping"});
  for (const Force& force : mbd.forces) {
    std::visit(
        Overloaded{
            [&](const SpringDamper& f) {
              forces.add({f.name, "spring-damper",
                          scene.body_name(f.body_a) + " and " + scene.body_name(f.body_b),
                          fmt::format("{:.6g} N/m", f.stiffness), fmt::format("{:.6g} N s/m", f.damping)});
            },
            [&](const RotationalSpringDamper& f) {
              forces.add({f.name, "rotational spring-damper", mbd.joints[f.joint.value].name,
                          fmt::format("{:.6g} N m/rad", f.stiffness),
                          fmt::format("{:.6g} N m s/rad", f.damping)});
            },
            [&](const Bushing& f) {
              forces.add({f.name, "bushing", scene.body_name(f.body_a) + " and " + scene.body_name(f.body_b),
                          "6x6", "6x6"});
            },
            [&](const BodyLoad& f) {
              const bool pushes = f.kind == BodyLoad::Kind::force;
              forces.add({f.name, pushes ? "force" : "torque", scene.body_name(f.body), "", ""});
            },
            [&](const Tyre& f) {
              forces.add({f.name, "tyre", mbd.joints[f.joint.value].name,
                          fmt::format("{:.6g} N/m", f.stiffness), fmt::format("{:.6g} N s/m", f.damping)});
            },
            [&](const Rope& f) {
              std::vector<std::string> along;
              for (const RopePoint& point : f.points) along.push_back(scene.body_name(point.body));
              forces.add({f.name, "rope", fmt::format("{}", fmt::join(along, ", ")),
                          fmt::format("{:.6g} N/m", f.axial_stiffness / f.length),
                          fmt::format("{:.6g} s/m", f.damping)});
            },
            [&](const Actuator& f) {
              const std::string drive = f.input.empty() ? "actuator" : "actuator, input " + f.input;
              forces.add({f.name, drive, mbd.joints[f.joint.value].name, "", ""});
            },
            [&](const Motor& f) {
              const std::string drive = f.input.empty() ? "motor" : "motor, input " + f.input;
              forces.add({f.name, drive, mbd.joints[f.joint.value].name, "", ""});
            },
            [&](const Cylinder& f) {
              const std::string kind = f.hydraulics ? "hydraulic cylinder" : "cylinder";
              forces.add({f.name, f.input.empty() ? kind : kind + ", input " + f.input,
                          scene.body_name(f.body_a) + " and " + scene.body_name(f.body_b), "",
                          fmt::format("{:.6g} N s/m", f.damping)});
            },
            [&](const auto& f) {
              forces.add({f.name, f.type, scene.body_name(f.body_a) + " and " + scene.body_name(f.body_b), "",
                          fmt::format("{:.6g} N s/m", f.damping)});
            }},
        force);
  }
  return bodies.print() + assemblies_of(mbd) + describe_shaped(file) +
         (scene.contact ? describe_contact(scene) : "") + joints.print() + forces.print() +
         describe_elements(scene) +
         fmt::format("\ndegrees of freedom: {}\nfree bodies: {}\n",
                     started ? freedom_of(*started) : freedom_by_counting(mbd), free_bodies);
}

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

}  // namespace

std::string remarks(const SceneFile& file, const DryRun* started, const std::string& indent) {
  std::string lines;
  const auto add = [&](const char* kind, const std::vector<std::string>& sentences) {
    for (const std::string& sentence : sentences) lines += fmt::format("{}{}: {}\n", indent, kind, sentence);
  };
  add("warning", file.warnings);
  if (started) add("warning", started->warnings());
  add("note", file.notes);
  add("note", file.log);
  return lines;
}

std::string describe(const SceneFile& file, const DryRun* started) {
  const Scene& scene = file.scene;
  std::string out = scene.name + (scene.description.empty() ? "" : ": " + scene.description) + "\n";
  Table parameters("parameter", {"name", "value", "unit"});
  for (const Parameter& p : file.parameters)
    parameters.add({p.name, fmt::format("{:.10g}", p.value), p.unit});
  out += parameters.print();
  if (scene.mbd) out += describe_mbd(file, started);
  if (scene.dem) out += describe_dem(file, started);
  if (scene.sph) out += describe_sph(file, started);
  out += fmt::format("\nrun: {:.6g} s in {:.0f} windows of {:.6g} s", scene.end_time,
                     std::ceil(scene.end_time / scene.coupling.window - 1e-9), scene.coupling.window);
  if (scene.mbd && scene.has_particles())
    out += fmt::format(", scheme {}", launch::name(scene.coupling.scheme));
  out += fmt::format("; {} checks\n", scene.checks.size());
  const std::string lines = remarks(file, started);
  return lines.empty() ? out : out + "\n" + lines;
}

}  // namespace tandem::launch
