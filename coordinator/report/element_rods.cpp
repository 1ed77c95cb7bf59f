#include "coordinator/report/element_rods.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tandem::launch {
namespace {

// Share of the cylinder's length at the start that its barrel has.
constexpr double barrel_share = 0.6;

struct Rods {
  const scene::Scene& scene;
  const Frame& frame;
  double size;
  std::vector<Rod> rods;

  // A point of a body, given in the world at the start, in the last frame.
  std::optional<Vec3d> now(BodyId body, Vec3d point) const {
    if (body == ground) return point;
    const scene::Body& at = scene.mbd->bodies.at(body.value);
    for (const Surface& surface : frame.surfaces)
      if (surface.name == at.name && surface.frame)
        return surface.frame->point(at.pose.q_WB.conjugate().rotate(point - at.pose.p_WB));
    return {};
  }
  void add(Rod::Of of, Vec3d a, Vec3d b, double radius) {
    if (norm(b - a) > 1e-9 * size) rods.push_back({of, a, b, radius});
  }

  void operator()(const scene::Rope& rope) {
    for (std::size_t k = 1; k < rope.points.size(); ++k) {
      const auto a = now(rope.points[k - 1].body, rope.points[k - 1].point),
                 b = now(rope.points[k].body, rope.points[k].point);
      if (a && b) add(Rod::Of::rope, *a, *b, 1e-3 * size);
    }
  }
  void operator()(const scene::Cylinder& cylinder) {
    const auto a = now(cylinder.body_a, cylinder.point_a), b = now(cylinder.body_b, cylinder.point_b);
    if (!a || !b) return;
    const double length = norm(*b - *a), start = norm(cylinder.point_b - cylinder.point_a);
    double radius = 5e-3 * size;
    if (cylinder.hydraulics) radius = std::sqrt(cylinder.hydraulics->bore_area / std::numbers::pi);
    const double barrel = std::min(barrel_share * start, length);
    add(Rod::Of::barrel, *a, *a + barrel * normalized(*b - *a), radius);
    add(Rod::Of::piston_rod, *a, *b, 0.5 * radius);
  }
  template <class Other>
  void operator()(const Other& other) {
    if constexpr (requires { other.point_a; }) {
      const auto a = now(other.body_a, other.point_a), b = now(other.body_b, other.point_b);
      if (a && b) add(Rod::Of::spring, *a, *b, 2e-3 * size);
    }
  }
};

}  // namespace

std::vector<Rod> element_rods(const scene::Scene& scene, const Frame& frame, double size) {
  Rods rods{scene, frame, size, {}};
  if (scene.mbd)
    for (const scene::Force& force : scene.mbd->forces) std::visit(rods, force);
  return rods.rods;
}

}  // namespace tandem::launch
