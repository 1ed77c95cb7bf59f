#include "launch/coordinator/scene_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "common/input_file.hpp"
#include "common/scene/columns.hpp"
#include "common/scene/document.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/particle_file.hpp"
#include "common/scene/schema_check.hpp"
#include "common/utf8.hpp"
#include "dem_server/laws/step_limits.hpp"
#include "launch/coordinator/geometry_review.hpp"
#include "launch/mesh_import/mesh_import.hpp"

namespace tandem::launch {
namespace {

// Writes the overrides into the text. The scene must be right as it stands: an option hides no error of the
// value that it replaces, nor of the checks. A run that is shortened cannot evaluate the checks, which need
// the whole run: they are left out.
void apply(const Overrides& overrides, SceneFile& file) {
  if (!overrides.end_time && !overrides.scheme && !overrides.window && !overrides.equilibrium) return;
  scene::check_schema(scene::read_document(file.text, file.origin), file.origin);
  auto json = nlohmann::ordered_json::parse(file.text);
  if (overrides.end_time) {
    const double end = json["end_time"].get<double>();
    if (*overrides.end_time < end && json.erase("checks") > 0)
      file.warnings.push_back(fmt::format(
          "the checks of the scene are left out: this run ends before the scene's end_time; they take "
          "--end-time {:.6g}",
          end));
    json["end_time"] = *overrides.end_time;
  }
  if (overrides.scheme) json["coupling"]["scheme"] = *overrides.scheme;
  if (overrides.window) json["coupling"]["window"] = *overrides.window;
  if (overrides.equilibrium) {
    if (!json.contains("mbd"))
      throw Error(ErrorCode::usage, "--equilibrium: the scene has no machine", file.origin, "leave it out");
    json["mbd"]["start"] = "equilibrium";
  }
  file.text = json.dump(2);
}

void import_files(const scene::Dem& dem, const std::filesystem::path& folder, SceneFile& file) {
  for (const scene::Wall& wall : dem.walls)
    if (const auto* mesh = std::get_if<scene::MeshShape>(&wall.shape)) {
      file.meshes.push_back({wall.name, import_mesh(scene::resolve_file(mesh->file, folder), mesh->scale)});
      file.mesh_facts.push_back({wall.name, mesh->file, mesh->scale, facts_of(file.meshes.back().mesh)});
    }
  for (const scene::ParticleGroup& group : dem.particles)
    if (const auto* fill = std::get_if<scene::FileFill>(&group.fill)) {
      const std::filesystem::path path = scene::resolve_file(fill->file, folder);
      file.files.push_back({group.name, read_input(path, {.largest = largest_particle_file})});
      if (!group.fixed)
        dem::check_micro_step(dem, file.origin, group.material,
                              scene::read_particle_file(file.files.back().text, path.string()).radii,
                              path.string());
    }
}

}  // namespace

SceneFile read_scene(const std::filesystem::path& path, const Overrides& overrides) {
  SceneFile file;
  file.origin = path.string();
  file.text = read_input(path, {.largest = largest_text, .hint = "give the path of a scene"});
  apply(overrides, file);
  file.scene = scene::parse(file.text, file.origin);
  scene::validate(file.scene, file.origin);
  scene::validate_files(file.scene, file.origin, path.parent_path());
  if (file.scene.dem) dem::check_micro_step(*file.scene.dem, file.origin);
  for (std::string& warning : scene::warnings(file.scene)) file.warnings.push_back(std::move(warning));
  if (file.scene.dem) import_files(*file.scene.dem, path.parent_path(), file);
  review_geometry(file);
  if (file.scene.mbd && !scene::control_inputs(*file.scene.mbd).empty())
    file.notes.push_back(fmt::format("a run needs --controller PROGRAM, which gives the control inputs {}",
                                     fmt::join(scene::control_inputs(*file.scene.mbd), ", ")));
  const auto note_server = [&](const char* key, const std::string& command) {
    if (!command.empty())
      file.notes.push_back(
          fmt::format("{} names a program of its own, '{}', which a run starts with "
                      "--allow-scene-servers only",
                      key, printable_line(shortened(command))));
  };
  if (file.scene.mbd) note_server("mbd.server", file.scene.mbd->server);
  if (file.scene.dem) note_server("dem.server", file.scene.dem->server);
  return file;
}

}  // namespace tandem::launch
