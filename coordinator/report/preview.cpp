#include "coordinator/report/preview.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "common/error.hpp"
#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "coordinator/report/camera.hpp"
#include "coordinator/report/own_picture.hpp"

namespace tandem::launch {
namespace {

constexpr std::size_t most_labels = 40, most_with_joints = 30;
constexpr Vec3d joint_colour{0.2, 0.22, 0.25};

// Regions that are not far away from everything else: an outlet may be anywhere.
void add_near(Extents& extents, const std::vector<Region>& regions) {
  const Extents before = extents;
  for (const Region& region : regions)
    for (const auto& [a, b] : region.lines)
      for (const Vec3d p : {a, b})
        if (before.distance(p) < 0.5 * before.size()) extents.add(p);
}

}  // namespace

std::vector<Label> labels_of(const scene::Scene& scene, const Frame& start) {
  std::vector<Label> labels;
  const auto add_regions = [&] {
    for (const Region& region : regions_of(scene))
      labels.push_back({.at = region.at, .words = region.words, .colour = region.colour, .is_point = false});
  };
  if (!scene.mbd) {
    add_regions();
    return labels;
  }
  for (std::size_t i = 0; i < scene.mbd->bodies.size(); ++i) {
    const scene::Body& body = scene.mbd->bodies[i];
    // The middle of what is drawn: a centre of mass may be far from it.
    Vec3d middle = body.pose.p_WB;
    for (const Surface& surface : start.surfaces) {
      if (surface.name != body.name || surface.fixed || surface.mesh.vertices.empty()) continue;
      middle = {};
      for (const Vec3d& vertex : surface.mesh.vertices) middle += vertex;
      middle = (1.0 / static_cast<double>(surface.mesh.vertices.size())) * middle;
    }
    labels.push_back({.at = middle,
                      .words = body.name,
                      .colour = body.colour.value_or(body_colour(i)),
                      .is_point = false});
  }
  add_regions();
  for (const scene::Joint& joint : scene.mbd->joints)
    labels.push_back({.at = joint.position, .words = joint.name, .colour = joint_colour, .is_point = true});
  return labels;
}

void draw_preview(const std::filesystem::path& out, const scene::Scene& scene, const Frame& start,
                  const std::string& title, const std::optional<ColourScale>& scale) {
  if (start.empty())
    throw Error(ErrorCode::usage, "the scene starts without spheres, walls and bodies", scene.name,
                "there is nothing to draw");
  if (start.radius.size() > most_spheres)
    throw Error(ErrorCode::usage, fmt::format("{} spheres are too many for POV-Ray", start.radius.size()),
                scene.name, fmt::format("it holds {} in memory", most_spheres));
  View view;
  view.up = upwards(scene);
  Extents extents(view.up);
  extents.add(start);
  const std::vector<Region> regions = regions_of(scene);
  add_near(extents, regions);
  view.camera = extents.camera(view.size.aspect());  // that of the scene may show a part only
  view.floor = extents.lowest() - 1e-3 * norm(view.camera.target - view.camera.eye);
  view.soft_shadows = false;
  view.title = title;
  if (scene.has_particles()) view.scale.title = scene.dem ? "spheres" : "liquid";
  if (scene.dem)
    for (const scene::ParticleGroup& group : scene.dem->particles) view.scale.names.push_back(group.name);
  if (scene.sph) view.scale.names.push_back(scene.sph->liquids.front().name);
  if (scale) view.scale = *scale;
  PictureText more{.labels = labels_of(scene, start), .regions = regions, .extents = true};
  if (more.labels.size() > most_with_joints)
    std::erase_if(more.labels, [](const Label& label) { return label.is_point; });
  if (more.labels.size() > most_labels) {
    log::warn(
        "{} names would cover the picture: it has the first {}, of bodies and then of sensors and walls",
        more.labels.size(), most_labels);
    more.labels.resize(most_labels);
  }
  // POV-Ray writes in its working folder, under a name of its own: a picture that exists stays until the new
  // one is complete.
  const std::filesystem::path folder = std::filesystem::absolute(out).parent_path();
  const std::string draft = fmt::format("{}.{}.part", out.stem().string(), getpid());
  const InterruptGuard guard;
  const bool done = render(folder, draft, start, scene, view, more);
  if (!done && interrupted())
    throw Error(ErrorCode::interrupted, "the preview was interrupted while POV-Ray was drawing",
                out.string());
  std::error_code failure;
  if (done) mark_picture(folder / (draft + ".png"));
  if (done) std::filesystem::rename(folder / (draft + ".png"), out, failure);
  if (!done || failure)
    throw Error(ErrorCode::resource,
                "the picture could not be drawn" + (failure ? ": " + failure.message() : std::string()),
                out.string(), "the warning before this says why");
}

}  // namespace tandem::launch
