#include "coordinator/scene/scene_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/input_file.hpp"
#include "common/scene/columns.hpp"
#include "common/scene/document.hpp"
#include "common/scene/parameters.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/particle_file.hpp"
#include "common/scene/plain_text.hpp"
#include "common/scene/schema_check.hpp"
#include "common/scene/shape_mesh.hpp"
#include "common/utf8.hpp"
#include "coordinator/mesh_import/mesh_import.hpp"
#include "coordinator/scene/geometry_review.hpp"
#include "coordinator/scene/liquid_domain.hpp"
#include "coordinator/scene/liquid_fill.hpp"
#include "coordinator/scene/placement.hpp"
#include "dem_server/laws/step_limits.hpp"

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

// Of round shapes in pictures and frames.
constexpr int drawn_segments = 64;

bool is_there(const std::string& wall, const SceneFile& file) {
  return std::ranges::find(file.meshes, wall, &protocol::NamedMesh::name) != file.meshes.end();
}

TriangleMesh mesh_in_file(const std::filesystem::path& file, const scene::Geometry& geometry) {
  const double scale = scene::scale_of(geometry);
  TriangleMesh mesh = import_mesh(file, scale);
  const Vec3d unit = scene::units_of(geometry);
  if (unit.x == scale && unit.y == scale && unit.z == scale) return mesh;
  for (Vec3d& p : mesh.vertices)
    for (int k = 0; k < 3; ++k) p[k] *= unit[k] / scale;
  return mesh;
}

// Reads the files of the shapes, and leaves the triangles of those that bodies are made of in the order of
// the shapes. The triangles of the others, which may be many, are in file.meshes only.
std::vector<TriangleMesh> import_meshes(const std::filesystem::path& folder, SceneFile& file) {
  std::vector<TriangleMesh> meshes(file.scene.shapes.size());
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const scene::Shape& shape = file.scene.shapes[i];
    const std::string& name = scene::file_of(shape.geometry);
    if (name.empty()) continue;
    const double scale = scene::scale_of(shape.geometry);
    file.inputs.push_back(scene::resolve_file(name, folder));
    meshes[i] = mesh_in_file(file.inputs.back(), shape.geometry);
    if (shape.use != scene::ShapeUse::wall || scene::is_made_of_facets(shape.geometry)) continue;
    if (is_there(shape.name, file)) continue;  // it is of grains and of the liquid
    file.mesh_facts.push_back(
        {shape.name, name, scale, facts_of(meshes[i]), scene::stretch_of(shape.geometry)});
    if (shape.is_of_body)
      file.meshes.push_back({shape.name, meshes[i]});
    else
      file.meshes.push_back({shape.name, std::move(meshes[i])});
  }
  return meshes;
}

void make_facets(const std::vector<TriangleMesh>& in_files, SceneFile& file) {
  for (std::size_t i = 0; i < in_files.size(); ++i) {
    const scene::Shape& shape = file.scene.shapes[i];
    if (shape.use != scene::ShapeUse::wall) continue;
    if (const double deviation = scene::deviation_of_facets(shape.geometry);
        deviation > 0 && scene::is_made_of_facets(shape.geometry))
      file.notes.push_back(
          fmt::format("wall \"{}\" is a {} of flat faces, which are up to {:.3g} m inside the round surface",
                      shape.name, scene::name_of(shape.geometry), deviation));
    if (scene::is_made_of_facets(shape.geometry) && !is_there(shape.name, file))
      file.meshes.push_back({shape.name, scene::mesh_of(shape, in_files[i], drawn_segments, file.origin)});
  }
}

// Triangles of the files of mbd.contact.ground, in the order of its shapes.
std::vector<TriangleMesh> import_ground(const std::filesystem::path& folder, SceneFile& file) {
  std::vector<TriangleMesh> meshes;
  if (!file.scene.contact) return meshes;
  for (const scene::Shape& shape : file.scene.contact->ground) {
    TriangleMesh& mesh = meshes.emplace_back();
    const std::string& name = scene::file_of(shape.geometry);
    if (name.empty()) continue;
    file.inputs.push_back(scene::resolve_file(name, folder));
    mesh = mesh_in_file(file.inputs.back(), shape.geometry);
  }
  return meshes;
}

// What the solver receives of shapes of contact with a file: triangles, and of a hull its corners.
void send_contact_meshes(const std::vector<TriangleMesh>& in_files,
                         const std::vector<TriangleMesh>& of_ground, SceneFile& file) {
  const auto send = [&](const scene::Shape& shape, const TriangleMesh& in_file) {
    if (shape.use == scene::ShapeUse::contact && !scene::file_of(shape.geometry).empty())
      file.meshes.push_back({scene::contact_mesh_name(file.scene, shape),
                             scene::mesh_of(shape, in_file, drawn_segments, file.origin)});
  };
  for (std::size_t i = 0; i < in_files.size(); ++i) send(file.scene.shapes[i], in_files[i]);
  for (std::size_t i = 0; i < of_ground.size(); ++i) send(file.scene.contact->ground[i], of_ground[i]);
}

// Shapes that are no walls, in frames whose origin is the centre of mass; those of contact of the ground are
// in the world.
void draw(const std::vector<TriangleMesh>& in_files, const std::vector<TriangleMesh>& of_ground,
          SceneFile& file) {
  for (std::size_t i = 0; i < in_files.size(); ++i) {
    const scene::Shape& shape = file.scene.shapes[i];
    if (shape.use != scene::ShapeUse::wall && scene::is_bounded(shape.geometry))
      file.drawn.push_back(
          {shape.body, shape.name,
           transformed(scene::mesh_of(shape, in_files[i], drawn_segments, file.origin), shape.pose)});
  }
  for (std::size_t i = 0; i < of_ground.size(); ++i)
    if (const scene::Shape& shape = file.scene.contact->ground[i]; scene::is_bounded(shape.geometry))
      file.drawn.push_back(
          {ground, shape.name,
           transformed(scene::mesh_of(shape, of_ground[i], drawn_segments, file.origin), shape.pose)});
}

// Replaces shapes, orientations and poses by what solvers know.
void make_plain(const std::filesystem::path& folder, SceneFile& file) {
  const std::vector<TriangleMesh> in_files = import_meshes(folder, file),
                                  of_ground = import_ground(folder, file);
  if (file.scene.is_plain) {
    send_contact_meshes(in_files, of_ground, file);
    draw(in_files, of_ground, file);
    return;
  }
  make_facets(in_files, file);
  send_contact_meshes(in_files, of_ground, file);
  file.shaped = scene::take_mass_from_shapes(file.scene, in_files, file.origin, file.warnings);
  draw(in_files, of_ground, file);
  file.text = scene::plain_text(file.text, file.scene, file.origin);
  file.scene = scene::parse(file.text, file.origin);
}

void import_particles(const scene::Dem& dem, const std::filesystem::path& folder, SceneFile& file) {
  for (const scene::ParticleGroup& group : dem.particles)
    if (const auto* fill = std::get_if<scene::FileFill>(&group.fill)) {
      const std::filesystem::path path = scene::resolve_file(fill->file, folder);
      file.inputs.push_back(path);
      file.files.push_back({group.name, read_input(path, {.largest = largest_particle_file})});
      if (!group.fixed)
        dem::check_micro_step(dem, file.origin, group.material,
                              scene::read_particle_file(file.files.back().text, path.string()).radii,
                              path.string());
    }
}

}  // namespace

SceneFile read_scene(const std::filesystem::path& path, const Overrides& overrides,
                     const std::optional<SettleOn>& on) {
  SceneFile file;
  file.origin = path.string();
  file.inputs.push_back(path);
  file.text = read_input(path, {.largest = largest_text, .hint = "give the path of a scene"});
  file.parameters = scene::put_in_parameters(file.text, overrides.set, file.origin);
  apply(overrides, file);
  file.given = file.text;
  file.scene = scene::parse(file.text, file.origin);
  scene::validate(file.scene, file.origin);
  scene::validate_files(file.scene, file.origin, path.parent_path());
  if (file.scene.dem) dem::check_micro_step(*file.scene.dem, file.origin);
  for (std::string& warning : scene::warnings(file.scene)) file.warnings.push_back(std::move(warning));
  make_plain(path.parent_path(), file);
  if (file.scene.sph) surround_liquid(file);
  if (file.scene.dem) import_particles(*file.scene.dem, path.parent_path(), file);
  review_geometry(file);
  if (on) place_fills(path.parent_path(), file, *on);
  if (on) fill_liquids(file, *on);
  if (file.scene.mbd && !scene::control_inputs(*file.scene.mbd).empty())
    file.notes.push_back(fmt::format("a run needs --controller PROGRAM, which gives the control inputs {}",
                                     fmt::join(scene::control_inputs(*file.scene.mbd), ", ")));
  const auto note_server = [&](const char* key, const char* own, const std::string& command) {
    if (!command.empty() && command != own)
      file.notes.push_back(
          fmt::format("{} names a program of its own, '{}', which a run starts with "
                      "--allow-scene-servers only",
                      key, printable_line(shortened(command))));
  };
  if (file.scene.mbd) note_server("mbd.server", "mbd_server", file.scene.mbd->server);
  if (file.scene.dem) note_server("dem.server", "dem_server", file.scene.dem->server);
  if (file.scene.sph) note_server("sph.server", "sph_server", file.scene.sph->server);
  if (file.scene.dem && file.scene.sph)
    file.notes.emplace_back(
        "grains and liquid do not feel each other: both act on the same walls, and each is computed as if "
        "the "
        "other was not there");
  return file;
}

}  // namespace tandem::launch
