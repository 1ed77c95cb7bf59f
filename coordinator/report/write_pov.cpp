#include "coordinator/report/pov_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "common/log.hpp"
#include "coordinator/report/pov_labels.hpp"
#include "coordinator/report/pov_writer.hpp"
#include "coordinator/report/tool.hpp"
#include "coordinator/results/body_meshes.hpp"

namespace tandem::launch {
namespace {

constexpr Vec3d ground_tint{0.72, 0.78, 0.84}, contact_ground_tint{0.62, 0.60, 0.56};

// Letters keep their size in pixels in pictures smaller than the usual one, down to half of it.
double overlay_height(const PictureSize& size) {
  return std::clamp(size.height, PictureSize{}.height / 2, PictureSize{}.height);
}

Vec3d ground_colour(const Surface& surface, const scene::Scene& scene) {
  if (!surface.name.starts_with(coloured_wall)) return ground_tint;
  const std::string name = surface.name.substr(coloured_wall.size());
  for (const scene::Wall& wall : scene.walls())
    if (wall.name == name && wall.colour) return *wall.colour;
  return ground_tint;
}

void draw_surfaces(PovWriter& pov, const Frame& frame, const scene::Scene& scene,
                   const std::vector<LegendEntry>& legend, Vec3d eye) {
  const std::vector<Vec3d> points = points_to_see(frame);
  for (const Surface& surface : frame.surfaces) {
    if (surface.mesh.triangles.empty()) continue;
    std::vector<Patch> patches = patches_of(surface.mesh);
    if (surface.name == contact_ground) {
      pov.ground(surface, patches, contact_ground_tint);
      continue;
    }
    count_hidden(patches, surface.mesh, points, eye);
    Vec3d tint = ground_colour(surface, scene);
    if (!surface.fixed) {
      const auto entry = std::ranges::find(legend, surface.name, &LegendEntry::name);
      tint = entry == legend.end() ? body_colour(0) : entry->colour;
    }
    pov.surface(surface, patches, tint);
  }
}

}  // namespace

std::vector<LegendEntry> body_legend(const scene::Scene& scene) {
  std::vector<LegendEntry> entries;
  if (scene.mbd)
    for (std::size_t i = 0; i < scene.mbd->bodies.size(); ++i)
      entries.push_back({scene.mbd->bodies[i].name, scene.mbd->bodies[i].colour.value_or(body_colour(i))});
  return entries;
}

void write_pov(std::ostream& out, const Frame& frame, const scene::Scene& scene, const View& view,
               const PictureText& more) {
  PovWriter pov(out, view);
  pov.stage();
  pov.spheres(frame);
  if (frame.liquid_surface) pov.liquid(*frame.liquid_surface);
  const std::vector<LegendEntry> legend = body_legend(scene);
  draw_surfaces(pov, frame, scene, legend, view.camera.eye);
  pov.elements(element_rods(scene, frame, pov.size()));
  pov.arrows(belt_arrows(scene, frame));
  for (const Region& region : more.regions)
    for (const auto& [a, b] : region.lines) pov.rod(a, b, 8e-4 * pov.size(), region.colour);

  Overlay overlay(out, pov.local(view.camera.eye), view.camera.target - view.camera.eye, view.camera.up,
                  view.camera.field_of_view, view.size.aspect(), overlay_height(view.size),
                  0.1 * pov_eye_distance);
  std::vector<Rectangle> taken;
  if (more.extents) taken = draw_extents(pov, overlay, frame, view.up);
  draw_labels(pov, overlay, more.labels, std::move(taken));
  // Where bodies have their names beside them, a legend would only hide what is behind it.
  draw_legend(overlay, view.title, more.labels.empty() ? legend : std::vector<LegendEntry>{});
  if (frame.has_particles()) draw_scale(overlay, view.scale);
}

bool render(const std::filesystem::path& folder, const std::string& name, const Frame& frame,
            const scene::Scene& scene, const View& view, const PictureText& more) {
  const std::filesystem::path text = folder / (name + ".pov"), log_file = folder / (name + ".log");
  std::ofstream out(text);
  write_pov(out, frame, scene, view, more);
  out.close();
  if (!out) {
    log::warn("no picture: {} cannot be written", text.string());
    return false;
  }
  // Debian allows POV-Ray to write in its working folder only.
  const bool done = run_tool(
      {.program = "povray",
       .package = "povray",
       .arguments = {"+I" + name + ".pov", "+O" + name + ".png", fmt::format("+W{}", view.size.width),
                     fmt::format("+H{}", view.size.height), "+A0.25", "+AM2", "+R2", "-D", "-GA"},
       .folder = folder,
       .log = std::filesystem::absolute(log_file),
       .patience = std::chrono::seconds(300)});
  std::filesystem::remove(text);  // its numbers are in the HDF5 files
  std::error_code ignored;
  if (!done)
    for (const char* part : {".png", ".pov-state"}) std::filesystem::remove(folder / (name + part), ignored);
  return done;
}

}  // namespace tandem::launch
