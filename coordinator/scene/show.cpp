#include "coordinator/scene/show.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/utf8.hpp"
#include "coordinator/report/own_picture.hpp"
#include "coordinator/report/preview.hpp"
#include "coordinator/results/body_meshes.hpp"
#include "coordinator/run_folder/run_state.hpp"
#include "coordinator/scene/kept_scene.hpp"
#include "coordinator/scene/scene_file.hpp"
#include "coordinator/scene/scene_spheres.hpp"
#include "sph_server/coupling/liquid_start.hpp"

namespace tandem::launch {

Frame surfaces_at_start(const SceneFile& file) {
  Frame frame;
  for (const BodyMesh& body : body_meshes(file.scene, file.meshes, file.drawn)) {
    const bool fixed = body.body == ground;
    const Pose pose = fixed ? Pose{} : file.scene.mbd->bodies.at(body.body.value).pose;
    Surface surface{body.name, fixed, transformed(body.mesh, pose)};
    if (!fixed) surface.frame = placed_frame(body.mesh.vertices, surface.mesh.vertices);
    frame.surfaces.push_back(std::move(surface));
  }
  return frame;
}

namespace {

// What the first frame of a run has: bodies at their poses of the scene, spheres as the fills make them.
Frame start_of(const SceneFile& file) {
  Frame frame = surfaces_at_start(file);
  const auto add = [&frame](Vec3d p, double radius, std::size_t group) {
    frame.position.insert(frame.position.end(), {p.x, p.y, p.z});
    frame.radius.push_back(radius);
    frame.value.push_back(static_cast<double>(group));
  };
  if (file.scene.dem) {
    const particles::Fill fill = spheres_of(file).start;
    for (std::size_t i = 0; i < fill.radius.size(); ++i) add(fill.position[i], fill.radius[i], fill.group[i]);
  }
  if (!file.scene.sph) return frame;
  const scene::Sph& sph = *file.scene.sph;
  const std::size_t group = file.scene.dem ? file.scene.dem->particles.size() : 0;
  for (const Vec3d p : sph::start_of_liquid(file.scene, file.meshes, sph::places_in(file.files)).position)
    add(p, 0.5 * sph.spacing, group);
  return frame;
}

// Throws Error{usage} for a picture that may not be written.
std::filesystem::path checked_picture(std::filesystem::path out, const std::filesystem::path& otherwise) {
  if (!out.empty() && out.extension() != ".png")
    throw Error(ErrorCode::usage, "'" + out.string() + "' is no name for a picture", "--output",
                "let it end with .png");
  if (out.empty()) out = otherwise;
  expect_own_or_new(out);
  return out;
}

}  // namespace

std::filesystem::path unsettled_picture(const std::filesystem::path& scene) {
  return scene.stem().string() + "_unsettled.png";
}

void preview_unsettled(const std::filesystem::path& scene, std::filesystem::path out,
                       const Overrides& overrides) {
  out = checked_picture(std::move(out), unsettled_picture(scene));
  SettleOn on;
  on.picture = out;
  try {
    const SceneFile file = read_scene(scene, overrides, on);
    if (!file.settled)
      throw Error(ErrorCode::usage, "the scene has no dem.settle: its spheres do not settle before the start",
                  scene.string(), "add dem.settle, or leave out --unsettled");
    const particles::Fill fill = spheres_of(file).start;
    Frame bed = surfaces_at_start(file);
    ScaleRange range;
    for (std::size_t i = 0; i < fill.radius.size(); ++i) {
      bed.position.insert(bed.position.end(), {fill.position[i].x, fill.position[i].y, fill.position[i].z});
      bed.radius.push_back(fill.radius[i]);
      bed.value.push_back(norm(fill.velocity[i]));
    }
    range.add(bed.value);
    draw_preview(out, file.scene, bed,
                 fmt::format("{}   {} spheres at rest", file.scene.name, bed.radius.size()),
                 range.from_zero("speed [m/s]"));
    fmt::print(
        "{}: all spheres settle, in {:.4g} s of simulated time, to a mean kinetic energy of {:.4g} J\n",
        out.string(), file.settled->time, file.settled->kinetic_energy);
  } catch (const Error& error) {
    if (!error.where().ends_with("dem.settle") || !exists(out)) throw;
    fmt::print("{}: {}\n", out.string(), error.problem());
  }
}

void preview(const std::filesystem::path& scene, std::filesystem::path out, const Overrides& overrides) {
  out = checked_picture(std::move(out), scene.stem().string() + "_preview.png");
  SettleOn on;
  on.picture = unsettled_picture(scene);
  const SceneFile file = read_scene(scene, overrides, on);
  const Frame start = start_of(file);
  std::string title = file.scene.name;
  if (!start.radius.empty())
    title += fmt::format("   {} {}", start.radius.size(), file.scene.sph ? "particles" : "spheres");
  draw_preview(out, file.scene, start, title);
  fmt::print("{}: the start of {}\n", out.string(), file.scene.name);
}

void movie(const std::filesystem::path& folder, const std::filesystem::path& scene,
           const MovieOptions& options) {
  const RunState run = read_run(folder);
  if (run.status.empty())
    throw Error(ErrorCode::usage, "holds no run", folder.string(), "give the --out folder of a run");
  std::filesystem::path file = scene;
  if (file.empty()) file = scene_of_run(folder, run.summary);
  if (scene.empty() && !exists(file))
    throw Error(ErrorCode::usage, "the scene of this run is not at '" + file.string() + "' any more",
                folder.string(), "tell where it is: --scene FILE");
  Overrides overrides;
  const auto parameters = run.summary.find("parameters");
  if (parameters != run.summary.end())
    for (const auto& [name, parameter] : parameters->items())
      overrides.set[name] = parameter.at("value").get<double>();
  // The frames have the spheres: none are placed here.
  const SceneFile drawn = read_scene(file, overrides, std::nullopt);
  const std::string name = run.summary.value("scene", "");
  if (!name.empty() && drawn.scene.name != name)
    throw Error(ErrorCode::usage,
                "the run is of the scene '" + printable(shortened(name)) + "', and this is '" +
                    drawn.scene.name + "'",
                file.string(), "give the scene of the run");
  make_movie(folder, drawn.scene, options);
}

}  // namespace tandem::launch
