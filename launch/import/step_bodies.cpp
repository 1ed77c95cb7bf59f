#include "launch/import/step_bodies.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

#include "common/error.hpp"
#include "common/scene/material_library.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/reserved_names.hpp"
#include "common/utf8.hpp"
#include "launch/import/step_frames.hpp"

namespace tandem::launch {
namespace {

std::string path_of(const StepPart& part, std::size_t levels) {
  return fmt::format(
      "{}", fmt::join(part.path.begin(), part.path.begin() + static_cast<std::ptrdiff_t>(levels), "/"));
}

bool fits_pattern(const std::string& pattern, const std::string& name) {
  return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

// How many names of the path, from the outermost, end at the first assembly or part that the pattern matches;
// 0: none.
std::size_t matched_level(const std::string& pattern, const StepPart& part) {
  for (std::size_t level = 1; level <= part.path.size(); ++level)
    if (fits_pattern(pattern, part.path[level - 1]) || fits_pattern(pattern, path_of(part, level)))
      return level;
  return 0;
}

void expect_matches(const std::string& option, const std::string& pattern, const StepFile& step) {
  if (std::any_of(step.parts.begin(), step.parts.end(),
                  [&](const StepPart& part) { return matches(pattern, part); }))
    return;
  std::set<std::string> names;
  for (const StepPart& part : step.parts) names.insert(part.path.begin(), part.path.end());
  throw Error(ErrorCode::usage, "no part or assembly is named '" + printable(shortened(pattern)) + "'",
              option, suggest_name(pattern, {names.begin(), names.end()}, "parts and assemblies"));
}

StepDensity density_of(const StepPart& part, const ImportOptions& options) {
  if (const std::string text = value_for(part, options.densities); !text.empty()) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (*end != '\0' || !(value > 0) || !std::isfinite(value))
      throw Error(ErrorCode::usage, "'" + printable(shortened(text)) + "' is no density", "--density",
                  "give a number > 0 in kg/m3, as in --density 'bolt*=7850'");
    return {value, "--density"};
  }
  const std::string wanted = value_for(part, options.materials);
  const std::string name = wanted.empty() ? part.material : wanted;
  if (name.empty()) return {};
  if (const auto found = options.scene_densities.find(name); found != options.scene_densities.end())
    return {found->second, name};
  const scene::LibraryMaterial* material = scene::find_library_material(name);
  if (material && !material->viscosity) return {material->density, name};
  if (wanted.empty()) return {};  // the file's own word, which may be in any language
  if (material)
    throw Error(
        ErrorCode::usage, "'" + name + "' is a liquid, which no body can be of", "--material",
        "give a solid of docs/materials.md, such as --material steel, or the density of the part, as in "
        "--density 'tank*=1000'");
  throw Error(ErrorCode::usage, "there is no material '" + printable(shortened(name)) + "' in the library",
              "--material",
              suggest_name(name, scene::library_solids(), "materials") +
                  "; docs/materials.md lists them, and --density takes a number");
}

// Parts of each body while they are put together: the smallest number stands for all.
class Groups {
 public:
  explicit Groups(std::size_t parts) : of_(parts) {
    for (std::size_t i = 0; i < parts; ++i) of_[i] = i;
  }
  void join(std::size_t a, std::size_t b) {
    const std::size_t kept = std::min(of_[a], of_[b]), gone = std::max(of_[a], of_[b]);
    std::replace(of_.begin(), of_.end(), gone, kept);
  }
  std::size_t of(std::size_t part) const { return of_[part]; }

 private:
  std::vector<std::size_t> of_;
};

// Assemblies that match become one body each; parts that match by their own name become one body together.
void merge(const StepFile& step, const std::string& pattern, Groups& groups,
           std::vector<std::string>& names) {
  expect_matches("--merge", pattern, step);
  std::map<std::string, std::size_t> first;  // part of each assembly
  for (std::size_t i = 0; i < step.parts.size(); ++i) {
    const StepPart& part = step.parts[i];
    const std::size_t level = matched_level(pattern, part);
    if (level == 0 || step.products[part.product].unit.mass == 0) continue;
    const bool is_part = level == part.path.size();
    const auto [other, is_new] = first.try_emplace(is_part ? "" : path_of(part, level), i);
    if (!is_part) names[i] = part.path[level - 1];
    if (!is_new) groups.join(other->second, i);
  }
}

// Small parts go to the heaviest large part that they touch, if need be by way of other small ones.
void fuse(const StepFile& step, const std::vector<FittingFaces>& fits, const std::vector<double>& mass,
          double size, Groups& groups, std::vector<std::string>& notes) {
  std::vector<bool> is_loose(step.parts.size());
  for (std::size_t i = 0; i < is_loose.size(); ++i)
    is_loose[i] = mass[i] > 0 && step.products[step.parts[i].product].size() < size;
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<std::size_t> best(step.parts.size(), no_body);
    for (const FittingFaces& fit : fits) {
      if (fit.kind == FittingFaces::Kind::hole_on_hole) continue;
      for (const auto& [small, other] : {std::pair{fit.a, fit.b}, {fit.b, fit.a}})
        if (is_loose[small] && !is_loose[other] &&
            (best[small] == no_body || mass[other] > mass[best[small]]))
          best[small] = other;
    }
    for (std::size_t i = 0; i < best.size(); ++i)
      if (best[i] != no_body) {
        groups.join(i, best[i]);
        is_loose[i] = false;
        changed = true;
      }
  }
  for (std::size_t i = 0; i < is_loose.size(); ++i)
    if (is_loose[i])
      notes.push_back(fmt::format("not fused: part '{}' touches no larger part",
                                  printable(shortened(step.parts[i].name()))));
}

// Letters, digits, _ and -, at most 90 of them, no reserved name, and different from all others.
std::string unique_name(const std::string& given, const std::string& otherwise, std::set<std::string>& used,
                        std::vector<std::string>& notes) {
  std::string name;
  for (const char c : given) {
    const bool is_kept =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    if (is_kept)
      name += c;
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  name.resize(std::min<std::size_t>(name.size(), 90));
  if (name.empty()) name = otherwise;
  const std::string stem = name;
  const bool is_reserved =
      std::ranges::find(scene::reserved_body_names(), name) != scene::reserved_body_names().end();
  if (is_reserved) name = stem + "_1";
  for (int n = 2; !used.insert(name).second; ++n) name = fmt::format("{}_{}", stem, n);
  if (is_reserved)
    notes.push_back(fmt::format("renamed: the body of part '{}' is '{}', because '{}' is a reserved name",
                                printable(shortened(given)), name, stem));
  return name;
}

void weigh(const StepFile& step, const std::vector<StepDensity>& densities, StepBody& body) {
  const Pose axes = step.parts[body.parts.front()].pose;
  std::vector<MassProperties> solids;
  for (const std::size_t i : body.parts) {
    const StepPart& part = step.parts[i];
    MassProperties solid = step.products[part.product].unit;
    solid.mass *= densities[i].value;
    for (double& element : solid.inertia) element *= densities[i].value;
    const Quat back = axes.q_WB.conjugate();
    solids.push_back(
        placed(solid, {back.rotate(part.pose.p_WB - axes.p_WB), (back * part.pose.q_WB).normalized()}));
  }
  body.mass = sum(solids);
  body.pose = {to_world(axes, body.mass.centre), axes.q_WB};
}

}  // namespace

PatternValue pattern_value(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos) return {"*", text};
  return {text.substr(0, equals), text.substr(equals + 1)};
}

bool matches(const std::string& pattern, const StepPart& part) {
  return matched_level(pattern, part) > 0;
}

std::string value_for(const StepPart& part, const std::vector<std::string>& options) {
  std::string value;
  for (const std::string& option : options)
    if (const PatternValue one = pattern_value(option); matches(one.pattern, part)) value = one.value;
  return value;
}

StepBodies bodies_of(const StepFile& step, const std::vector<FittingFaces>& fits,
                     const ImportOptions& options, std::vector<std::string>& notes) {
  for (const auto& [option, values] :
       {std::pair{"--density", options.densities}, {"--material", options.materials}})
    for (const std::string& value : values) expect_matches(option, pattern_value(value).pattern, step);
  StepBodies result;
  std::vector<double> mass;
  std::vector<std::string> names, without;
  for (const StepPart& part : step.parts) {
    const double volume = step.products[part.product].unit.mass;
    result.densities.push_back(density_of(part, options));
    mass.push_back(volume * result.densities.back().value);
    names.push_back(part.name());
    if (volume == 0)
      notes.push_back(fmt::format("not imported: part '{}' has no solid", printable(shortened(part.name()))));
    else if (mass.back() == 0)
      without.push_back("'" + printable(shortened(part.name())) + "'");
  }
  if (!without.empty()) {
    const std::size_t shown = std::min<std::size_t>(without.size(), 5);
    throw Error(
        ErrorCode::usage,
        fmt::format("{} of {} parts have no density: {}{}", without.size(), step.parts.size(),
                    fmt::join(without.begin(), without.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
                    shown < without.size() ? ", ..." : ""),
        options.model.string(),
        "give it by a material of docs/materials.md, as in --material steel or --material 'bolt*=brass', or "
        "as a "
        "number of kg/m3, as in --density 'rod=2700'");
  }
  Groups groups(step.parts.size());
  for (const std::string& pattern : options.merge) merge(step, pattern, groups, names);
  if (options.fuse_smaller_than > 0) fuse(step, fits, mass, options.fuse_smaller_than, groups, notes);

  result.body_of.assign(step.parts.size(), no_body);
  std::map<std::size_t, std::size_t> number;  // body of each group
  for (std::size_t i = 0; i < step.parts.size(); ++i) {
    if (mass[i] == 0) continue;
    const auto [body, is_new] = number.try_emplace(groups.of(i), result.bodies.size());
    if (is_new) result.bodies.emplace_back();
    result.bodies[body->second].parts.push_back(i);
    result.body_of[i] = body->second;
  }
  std::set<std::string> used;
  for (StepBody& body : result.bodies) {
    std::stable_sort(body.parts.begin(), body.parts.end(),
                     [&](std::size_t a, std::size_t b) { return mass[a] > mass[b]; });
    body.name = unique_name(names[body.parts.front()], "part", used, notes);
    weigh(step, result.densities, body);
  }
  for (const std::string& pattern : options.ground) {
    expect_matches("--ground", pattern, step);
    for (StepBody& body : result.bodies)
      for (const std::size_t i : body.parts) body.is_ground |= matches(pattern, step.parts[i]);
  }
  return result;
}

}  // namespace tandem::launch
