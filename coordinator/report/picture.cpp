// The picture of the last frame.
#include "common/error.hpp"
#include "common/log.hpp"
#include "coordinator/report/camera.hpp"
#include "coordinator/report/liquid_surface.hpp"
#include "coordinator/report/pov_scene.hpp"
#include "coordinator/report/report.hpp"

namespace tandem::launch {
namespace {

bool draw(const std::filesystem::path& folder, const scene::Scene& scene) {
  Frame frame = read_last_frame(folder);
  if (frame.empty()) {
    log::warn(scene.has_particles() && !scene.output.particles
                  ? "no picture: frames have no spheres (output.particles), and there is no body to draw"
                  : "no picture: the run has written no frame");
    return false;
  }
  if (frame.radius.size() > most_spheres) {
    log::warn("no picture: {} spheres are more than POV-Ray holds in memory ({}); ParaView opens {}",
              frame.radius.size(), most_spheres, (folder / "particles.xdmf").string());
    return false;
  }
  View view;
  view.up = upwards(scene);
  Extents extents(view.up);
  extents.add(frame);
  view.camera = scene.output.camera.value_or(extents.camera(view.size.aspect()));
  view.floor = extents.lowest() - 1e-3 * norm(view.camera.target - view.camera.eye);
  ScaleRange range;
  range.add(frame.value);
  view.scale = range.from_zero("speed [m/s]");
  log::info("drawing picture.png with POV-Ray, which takes some seconds; --no-picture leaves it out");
  return render(folder, "picture", with_liquid_surface(std::move(frame), folder), scene, view);
}

}  // namespace

bool render_picture(const std::filesystem::path& folder, const scene::Scene& scene) {
  try {
    return draw(folder, scene);
  } catch (const Error& error) {
    log::warn("no picture: {}", error.what());
    return false;
  }
}

}  // namespace tandem::launch
