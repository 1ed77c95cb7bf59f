#include "coordinator/run/describe.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/overloaded.hpp"
#include "common/scene/shape_mesh.hpp"
#include "common/utf8.hpp"
#include "coordinator/run/describe_elements.hpp"
#include "coordinator/run/describe_particles.hpp"
#include "coordinator/run/text_table.hpp"
#include "coordinator/schemes/schemes.hpp"
#include "dem_server/laws/step_limits.hpp"

namespace tandem::launch {
namespace {

using namespace scene;
using namespace tables;

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
