#include "common/scene/validate_parts.hpp"

namespace tandem::scene {

void validate_walls(const Scene& scene, const std::string& origin) {
  const std::vector<Wall>& walls = scene.dem->walls;
  require_unique(walls, origin, "dem.walls");
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const std::string path = element("dem.walls", i);
    require_unit(walls[i].pose.q_WB, origin, path + ".orientation");
    if (const auto* plane = std::get_if<PlaneShape>(&walls[i].shape))
      require_unit(plane->normal, origin, path + ".shape.normal");
    if (const auto* box = std::get_if<BoxShape>(&walls[i].shape); box && box->open.size() == 6)
      fail(origin, path + ".shape.open", "all six faces of the box are open",
           "leave a face, or leave out the wall");
  }
}

}  // namespace tandem::scene
