#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/utf8.hpp"
#include "launch/import/step_scene.hpp"

namespace tandem::launch {
namespace {

std::string colour_of(const StepPart& part) {
  if (!part.colour) return "-";
  std::string text = "#";
  for (const double share : *part.colour)
    text += fmt::format("{:02x}", static_cast<int>(std::lround(255 * share)));
  return text;
}

std::string vector_of(Vec3d v, const char* format) {
  // Rotations leave zeros of 1e-17, and negative ones.
  const auto clean = [](double x) { return std::abs(x) < 5e-7 ? 0.0 : x; };
  return fmt::format(fmt::runtime(format), clean(v.x), clean(v.y), clean(v.z));
}

void add_tree(const StepImport& import, std::string& text) {
  const auto& [step, bodies, joints] = import;
  text += fmt::format("  {:<34} {:<22} {:>12} {:<16} {:>9} {:>12} {}\n", "part", "body", "mass [kg]",
                      "density from", "triangles", "within [m]", "colour");
  std::vector<std::string> open;
  for (std::size_t i = 0; i < step.parts.size(); ++i) {
    const StepPart& part = step.parts[i];
    const std::vector<std::string> assemblies(part.path.begin(), part.path.end() - 1);
    const auto differs = std::mismatch(assemblies.begin(), assemblies.end(), open.begin(), open.end()).first;
    for (auto level = differs; level != assemblies.end(); ++level)
      text +=
          fmt::format("  {}{}\n", std::string(2 * static_cast<std::size_t>(level - assemblies.begin()), ' '),
                      printable(shortened(*level)));
    open = assemblies;
    const std::string name = std::string(2 * assemblies.size(), ' ') + printable(shortened(part.name()));
    const StepProduct& product = step.products[part.product];
    if (bodies.body_of[i] == no_body) {
      text += fmt::format("  {:<34} no solid\n", name);
      continue;
    }
    text += fmt::format("  {:<34} {:<22} {:>12.6g} {:<16} {:>9} {:>12.2g} {}\n", name,
                        bodies.bodies[bodies.body_of[i]].name, product.unit.mass * bodies.densities[i].value,
                        bodies.densities[i].source, product.mesh.triangles.size(), product.deviation,
                        colour_of(part));
  }
}

void add_joints(const StepImport& import, const ImportOptions& options, std::string& text) {
  if (import.joints.empty()) {
    text += "no joints are proposed: no cylinder or plane of one body fits one of another\n";
    return;
  }
  text += fmt::format("proposed joints; {} those with a confidence of {} or more{}\n",
                      options.joints ? "the scene has" : "--joints writes", options.least_confidence,
                      options.joints ? "" : " into the scene");
  text += fmt::format("  {:<11} {:<22} {:<22} {:<24} {:<30} {:>9} {:>10} {}\n", "type", "parent", "child",
                      "axis", "point [m]", "gap [m]", "confidence", "because of");
  for (const ProposedJoint& joint : import.joints)
    text += fmt::format("  {:<11} {:<22} {:<22} {:<24} {:<30} {:>9.1e} {:>10.2f} {}\n", joint.type,
                        import.bodies.bodies[joint.parent].name, import.bodies.bodies[joint.child].name,
                        joint.type == "fixed" ? "-" : vector_of(joint.axis, "{:.4f} {:.4f} {:.4f}"),
                        vector_of(joint.point, "{:.6f} {:.6f} {:.6f}"), joint.gap, joint.confidence,
                        joint.reason);
}

}  // namespace

std::string step_tables(const StepImport& import, const ImportOptions& options) {
  std::string text =
      fmt::format("{}: {} parts of {} shapes, {} bodies; lengths in {}\n", options.model.filename().string(),
                  import.step.parts.size(), import.step.products.size(), import.bodies.bodies.size(),
                  import.step.unit.empty() ? "an unknown unit, taken as mm" : import.step.unit);
  add_tree(import, text);
  add_joints(import, options, text);
  return text;
}

}  // namespace tandem::launch
