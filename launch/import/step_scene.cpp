#include "launch/import/step_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/error.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/utf8.hpp"
#include "launch/import/base_scene.hpp"
#include "launch/import/bodies.hpp"
#include "launch/import/step_frames.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string file_name(const std::string& product, std::size_t number) {
  std::string name;
  for (const char c : product) {
    const bool is_kept =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    name += is_kept ? c : '_';
  }
  name.resize(std::min<std::size_t>(name.size(), 60));
  return fmt::format("{}{}{}.stl", name, name.empty() ? "" : "_", number + 1);
}

// The wall's material of the scene that the bodies go into.
std::string wall_material(const StepPart& part, const ImportOptions& options) {
  const std::string name = value_for(part, options.materials);
  if (options.scene_densities.contains(name)) return name;
  std::vector<std::string> names;
  for (const auto& [material, density] : options.scene_densities) names.push_back(material);
  throw Error(ErrorCode::usage,
              name.empty() ? "part '" + printable(shortened(part.name())) + "' has no material for its walls"
                           : "there is no material '" + printable(shortened(name)) + "'",
              options.into.string(),
              name.empty() ? "give one, as in --material '*=" + names.front() + "'"
                           : suggest_name(name, names, "materials"));
}

class SceneOfStep {
 public:
  SceneOfStep(const StepImport& import, const ImportOptions& options) : import_(import), options_(options) {
    const fs::path stem = options.output.stem();
    folder_ = stem.string() + "_meshes";
  }

  Imported make() {
    Imported result;
    result.scene = base_scene(options_, options_.model.stem().string());
    Json& mbd = result.scene["mbd"];
    mbd["bodies"] = Json::array();
    for (const StepBody& body : import_.bodies.bodies) mbd["bodies"].push_back(body_of(body));
    if (Json joints = joints_of(); !joints.empty() || mbd.contains("joints"))
      mbd["joints"] = std::move(joints);
    for (const auto& [product, file] : files_)
      result.files.push_back({options_.output.parent_path() / file, import_.step.products[product].mesh});
    return result;
  }

 private:
  Json body_of(const StepBody& body) {
    Json json{{"name", body.name},
              {"mass", body.mass.mass},
              {"inertia", body.mass.inertia},
              {"position", list(body.pose.p_WB)},
              {"orientation", list(body.pose.q_WB)},
              {"shapes", Json::array()}};
    for (const std::size_t i : body.parts) json["shapes"].push_back(shape_of(body, i));
    const StepPart& heaviest = import_.step.parts[body.parts.front()];
    if (heaviest.colour) {
      json["color"] = Json::array();
      for (const double share : *heaviest.colour) json["color"].push_back(std::round(255 * share) / 255);
    }
    if (std::string assembly = assembly_of(heaviest); !assembly.empty())
      json["assembly"] = std::move(assembly);
    return json;
  }

  static std::string assembly_of(const StepPart& part) {
    std::string path;
    for (std::size_t i = 0; i + 1 < part.path.size(); ++i) {
      std::string name = printable(shortened(part.path[i]));
      std::ranges::replace(name, '/', '_');
      path += (i > 0 ? "/" : "") + name;
    }
    return path.size() > 1000 ? std::string() : path;
  }

  Json shape_of(const StepBody& body, std::size_t i) {
    const StepPart& part = import_.step.parts[i];
    const Quat back = body.pose.q_WB.conjugate();
    const std::string name =
        body.parts.size() == 1 ? body.name + "_mesh" : fmt::format("{}_mesh_{}", body.name, i + 1);
    Json json{{"name", name}, {"use", options_.into.empty() ? "graphics" : "wall"}};
    if (!options_.into.empty()) json["material"] = wall_material(part, options_);
    json["position"] = list(back.rotate(part.pose.p_WB - body.pose.p_WB));
    json["orientation"] = list((back * part.pose.q_WB).normalized());
    const std::string file = file_name(import_.step.products[part.product].name, part.product);
    files_.emplace(part.product, folder_ / file);
    json["shape"] = {{"type", "mesh"}, {"file", (folder_ / file).string()}};
    return json;
  }

  Json joints_of() const {
    Json joints = Json::array();
    const auto& bodies = import_.bodies.bodies;
    for (const StepBody& body : bodies)
      if (body.is_ground)
        joints.push_back({{"name", body.name + "_ground"},
                          {"type", "fixed"},
                          {"parent", "ground"},
                          {"child", body.name},
                          {"position", list(body.pose.p_WB)}});
    if (!options_.joints) return joints;
    for (const ProposedJoint& joint : import_.joints) {
      if (joint.confidence < options_.least_confidence) continue;
      const std::string &parent = bodies[joint.parent].name, &child = bodies[joint.child].name;
      Json json{{"name", fmt::format("{}_{}", parent.substr(0, 49), child.substr(0, 49))},
                {"type", joint.type},
                {"parent", parent},
                {"child", child},
                {"position", list(joint.point)}};
      if (joint.type != "fixed") json["axis"] = list(joint.axis);
      joints.push_back(std::move(json));
    }
    return joints;
  }

  const StepImport& import_;
  const ImportOptions& options_;
  fs::path folder_;                        // of the meshes, beside the scene
  std::map<std::size_t, fs::path> files_;  // of the products that are used
};

}  // namespace

Imported import_step(const ImportOptions& given) {
  ImportOptions options = given;
  if (options.output.empty())
    throw Error(ErrorCode::usage, "the import of a STEP file needs -o", options.model.string(),
                "the meshes are written beside the scene: give -o machine.json");
  if (!options.into.empty())
    for (const Json& material : base_scene(options, "")["dem"].value("materials", Json::array()))
      if (material.is_object() && material.contains("density") && material["density"].is_number())
        options.scene_densities[material.value("name", "")] = material["density"].get<double>();
  StepImport import{read_step(options.model, options.deviation), {}, {}};
  std::vector<std::string> notes;
  if (import.step.faults > 0)
    notes.push_back(
        fmt::format("not imported: {} entities of the file, which OpenCASCADE could not read; the first: {}. "
                    "Compare the parts and "
                    "their masses with those of the CAD program",
                    import.step.faults, printable(shortened(import.step.first_fault))));
  const std::vector<FittingFaces> fits = fitting_faces(import.step, options.model.string());
  import.bodies = bodies_of(import.step, fits, options, notes);
  if (import.bodies.bodies.empty())
    throw Error(ErrorCode::scene, "no part has a solid, only surfaces or curves", options.model.string(),
                "export solids: a mass needs a volume");
  import.joints = proposed_joints(fits, import.bodies);
  Imported imported = SceneOfStep(import, options).make();
  imported.notes = std::move(notes);
  imported.tables = step_tables(import, options);
  return imported;
}

}  // namespace tandem::launch
