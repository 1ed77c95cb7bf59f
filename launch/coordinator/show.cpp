#include "launch/coordinator/show.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/utf8.hpp"
#include "launch/coordinator/kept_scene.hpp"
#include "launch/coordinator/scene_file.hpp"
#include "launch/coordinator/scene_spheres.hpp"
#include "launch/report/own_picture.hpp"
#include "launch/report/preview.hpp"
#include "launch/results/body_meshes.hpp"
#include "launch/run_folder/run_state.hpp"
#include "sph_server/coupling/liquid_start.hpp"

namespace tandem::launch {
namespace {

// What the first frame of a run has: bodies at their poses of the scene, spheres as the fills make them.
Frame start_of(const SceneFile& file) {
  Frame frame;
  for (const BodyMesh& body : body_meshes(file.scene, file.meshes, file.drawn)) {
    const bool fixed = body.body == ground;
    const Pose pose = fixed ? Pose{} : file.scene.mbd->bodies.at(body.body.value).pose;
    Surface surface{body.name, fixed, transformed(body.mesh, pose)};
    if (!fixed) surface.frame = placed_frame(body.mesh.vertices, surface.mesh.vertices);
    frame.surfaces.push_back(std::move(surface));
  }
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

}  // namespace

void preview(const std::filesystem::path& scene, std::filesystem::path out, const Overrides& overrides) {
  if (!out.empty() && out.extension() != ".png")
    throw Error(ErrorCode::usage, "'" + out.string() + "' is no name for a picture", "--output",
                "let it end with .png");
  if (out.empty()) out = scene.stem().string() + "_preview.png";
  expect_own_or_new(out);
  const SceneFile file = read_scene(scene, overrides);
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
