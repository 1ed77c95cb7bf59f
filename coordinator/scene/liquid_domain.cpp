#include "coordinator/scene/liquid_domain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "common/scene/fault.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/shape_mesh.hpp"

namespace tandem::launch {
namespace {

using namespace scene;

constexpr double inf = std::numeric_limits<double>::infinity();

void extend(Box& box, Vec3d x) {
  for (int a = 0; a < 3; ++a) {
    box.min[a] = std::min(box.min[a], x[a]);
    box.max[a] = std::max(box.max[a], x[a]);
  }
}
double widest(const Box& box) {
  const Vec3d size = box.max - box.min;
  return std::max({size.x, size.y, size.z});
}

// Around a wall at the start; empty for one without an end.
Box around(const Wall& wall, const SceneFile& file) {
  Box box{{inf, inf, inf}, {-inf, -inf, -inf}};
  const Pose body = wall.body == ground ? Pose{} : file.scene.mbd->bodies[wall.body.value].pose;
  const auto add = [&](const TriangleMesh& mesh) {
    for (const Vec3d& v : transformed(transformed(mesh, wall.pose), body).vertices) extend(box, v);
  };
  const auto named = std::ranges::find(file.meshes, wall.name, &protocol::NamedMesh::name);
  if (named != file.meshes.end()) {
    add(named->mesh);
    return box;
  }
  Shape shape;
  shape.name = wall.name;
  shape.geometry = std::visit([](const auto& s) -> Geometry { return s; }, wall.shape);
  constexpr int segments = 16;
  if (is_bounded(shape.geometry)) add(mesh_of(shape, {}, segments, file.origin));
  return box;
}

// The body that the domain follows.
BodyId followed(const Sph& sph, const std::map<BodyId, Box>& walls) {
  const bool has_plane = std::ranges::any_of(
      sph.walls, [](const Wall& wall) { return std::holds_alternative<PlaneShape>(wall.shape); });
  if (!sph.inlets.empty() || has_plane || walls.empty() || walls.contains(ground)) return ground;
  return std::ranges::max_element(walls, {}, [](const auto& w) { return widest(w.second); })->first;
}

}  // namespace

void surround_liquid(SceneFile& file) {
  Sph& sph = *file.scene.sph;
  if (sph.domain_is_given) return;
  std::map<BodyId, Box> walls;  // of the bodies
  Box all{{inf, inf, inf}, {-inf, -inf, -inf}};
  for (const Wall& wall : sph.walls) {
    const Box box = around(wall, file);
    if (!(box.min.x <= box.max.x)) continue;
    Box& of_body = walls.try_emplace(wall.body, box).first->second;
    for (const Vec3d corner : {box.min, box.max}) {
      extend(of_body, corner);
      extend(all, corner);
    }
  }
  for (const auto& fill : sph.liquids.front().fill)
    if (const Box* box = std::get_if<Box>(&fill))
      for (const Vec3d corner : {box->min, box->max}) extend(all, corner);
  for (const LiquidInlet& inlet : sph.inlets) extend(all, inlet.pose.p_WB);
  const double margin = widest(all);
  if (!(margin > 0))
    fail(file.origin, "sph", "no domain follows: there is neither a wall with an end nor a box of liquid",
         "give sph.domain");
  // Few digits, so that the scene that the servers receive reads well.
  const double unit = std::pow(10.0, std::floor(std::log10(margin)) - 2);
  nlohmann::ordered_json low = nlohmann::ordered_json::array(), high = low;
  for (int a = 0; a < 3; ++a) {
    low.push_back(unit * std::floor((all.min[a] - margin) / unit));
    high.push_back(unit * std::ceil((all.max[a] + margin) / unit));
  }
  const BodyId body = sph.follows ? *sph.follows : followed(sph, walls);
  nlohmann::ordered_json text = nlohmann::ordered_json::parse(file.text);
  nlohmann::ordered_json& domain = text["sph"]["domain"];
  domain["min"] = low;
  domain["max"] = high;
  if (body != ground) domain["follows"] = file.scene.body_name(body);
  file.text = text.dump(2);
  file.scene = parse(file.text, file.origin);
  validate(file.scene, file.origin);
  const Box& box = file.scene.sph->domain;
  file.notes.push_back(
      fmt::format("the liquid has a domain from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, "
                  "{:.6g}) m{}, since sph.domain gives none",
                  box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z,
                  body == ground ? "" : ", which follows '" + file.scene.body_name(body) + "'"));
}

}  // namespace tandem::launch
