#include "sph_server/io/inlets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace tandem::sph {
namespace {

// Middles of squares of one spacing in a rectangle of whole spacings, or those in a disc.
std::vector<Vec3d> sites_of(const scene::LiquidInlet& inlet, double spacing) {
  std::vector<Vec3d> sites;
  const auto* disc = std::get_if<scene::DiscShape>(&inlet.shape);
  const auto* rectangle = std::get_if<scene::RectangleShape>(&inlet.shape);
  const auto count = [&](double edge) { return static_cast<int>(std::round(edge / spacing)); };
  const int nx = disc ? 2 * static_cast<int>(std::ceil(disc->radius / spacing)) : count(rectangle->x),
            ny = disc ? nx : count(rectangle->y);
  const double dx = disc ? spacing : rectangle->x / nx, dy = disc ? spacing : rectangle->y / ny;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Vec3d x{(i + 0.5 - 0.5 * nx) * dx, (j + 0.5 - 0.5 * ny) * dy, 0};
      if (!disc || norm2(x) < disc->radius * disc->radius) sites.push_back(x);
    }
  return sites;
}

TriangleMesh piston_of(const scene::LiquidInlet& inlet) {
  TriangleMesh mesh;
  if (const auto* rectangle = std::get_if<scene::RectangleShape>(&inlet.shape)) {
    const double x = 0.5 * rectangle->x, y = 0.5 * rectangle->y;
    mesh.vertices = {{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
  }
  constexpr std::uint32_t corners = 24;
  const double radius = std::get<scene::DiscShape>(inlet.shape).radius;
  mesh.vertices.push_back({});
  for (std::uint32_t k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    mesh.triangles.push_back({0, k + 1, (k + 1) % corners + 1});
  }
  return mesh;
}

}  // namespace

// How far the piston is in front of the inlet [thicknesses of a layer]. A wall that the inlet lies on is
// hidden by the piston, and would act as well if both were in one plane.
constexpr double piston_in_front = 1e-4;

double Inlet::end() const {
  return of.end.value_or(std::numeric_limits<double>::infinity());
}

double Inlet::due(std::uint64_t layer) const {
  // Windows begin and end at whole nanoseconds.
  return std::round((of.start + (static_cast<double>(layer) + 1) * thickness / of.speed()) * 1e9) / 1e9;
}

std::uint64_t Inlet::layers_until(double time) const {
  const double last = std::min(time, end()), way = of.speed() * (last - of.start);
  auto layers = static_cast<std::uint64_t>(std::max(0.0, std::round(way / thickness)));
  if (layers > 0 && due(layers - 1) > last) --layers;
  return layers;
}

particles::BodyPose Inlet::pose(double time, std::uint64_t layers) const {
  const Mat3d R = of.pose.q_WB.matrix();
  const double way = of.speed() * (std::clamp(time, of.start, std::max(of.start, end())) - of.start) -
                     (static_cast<double>(layers) - piston_in_front) * thickness;
  const bool moves = time >= of.start && time < end();
  const Vec3d along = R * Vec3d{0, 0, 1};
  return {of.pose.p_WB + way * along, R, (moves ? of.speed() : 0) * along, {}};
}

std::vector<Inlet> inlets_of(const scene::Sph& sph) {
  std::vector<Inlet> inlets;
  for (const scene::LiquidInlet& of : sph.inlets) {
    Inlet& inlet = inlets.emplace_back();
    inlet.of = of;
    inlet.site = sites_of(of, sph.spacing);
    inlet.thickness =
        static_cast<double>(inlet.site.size()) * sph.spacing * sph.spacing * sph.spacing / of.area();
    inlet.piston = piston_of(of);
  }
  return inlets;
}

}  // namespace tandem::sph
