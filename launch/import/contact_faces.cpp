#include "launch/import/contact_faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "common/error.hpp"
#include "common/utf8.hpp"
#include "launch/import/step_frames.hpp"

namespace tandem::launch {
namespace {

constexpr double same_direction = 1e-4, same_normal = 1e-3;  // [rad]
constexpr double same_axis = 1e-3, same_radius = 5e-3;       // of the radius
constexpr double same_plane = 1e-4;                          // of the smaller part
constexpr double least_share = 0.01;

// Cylindrical faces of a part around one axis, over the same length: two halves are one.
struct Ring {
  Vec3d point, axis;  // in the world
  double radius, begin, end, angle;
  bool is_hole;
};

bool is_one_ring(const Ring& ring, const Ring& other) {
  const double shorter = std::min(ring.end - ring.begin, other.end - other.begin);
  const double offset = norm(cross(ring.axis, other.point - ring.point));
  return ring.is_hole == other.is_hole && std::abs(ring.radius - other.radius) <= 1e-6 * ring.radius &&
         norm(cross(ring.axis, other.axis)) <= same_direction && offset <= same_axis * ring.radius &&
         std::min(ring.end, other.end) - std::max(ring.begin, other.begin) > 0.5 * shorter;
}

// `ring` along the axis of `other`.
Ring aligned(Ring ring, const Ring& other) {
  const double shift = dot(ring.point - other.point, other.axis);
  if (dot(ring.axis, other.axis) < 0) {
    ring.axis = -1.0 * ring.axis;
    ring.begin = -std::exchange(ring.end, -ring.begin);
  }
  ring.begin += shift;
  ring.end += shift;
  ring.point = ring.point - shift * other.axis;
  return ring;
}

std::vector<Ring> rings_of(const StepProduct& product, const Pose& pose) {
  std::vector<Ring> rings;
  for (const StepFace& face : product.faces) {
    if (face.is_plane || !(face.end > face.begin)) continue;
    const Ring ring{to_world(pose, face.point),
                    pose.q_WB.rotate(face.direction),
                    face.radius,
                    face.begin,
                    face.end,
                    face.angle,
                    face.is_hole};
    const auto same = std::find_if(rings.begin(), rings.end(), [&](const Ring& other) {
      return is_one_ring(aligned(ring, other), other);
    });
    if (same == rings.end())
      rings.push_back(ring);
    else
      same->angle = std::min(same->angle + ring.angle, 2 * std::numbers::pi);
  }
  return rings;
}

void fit_rings(const std::vector<Ring>& rings_a, const std::vector<Ring>& rings_b, const FittingFaces& pair,
               std::vector<FittingFaces>& found) {
  for (const Ring& a : rings_a)
    for (const Ring& other : rings_b) {
      if (!a.is_hole && !other.is_hole) continue;
      if (norm(cross(a.axis, other.axis)) > same_direction ||
          norm(cross(a.axis, other.point - a.point)) > same_axis * a.radius ||
          std::abs(a.radius - other.radius) > same_radius * a.radius)
        continue;
      const Ring b = aligned(other, a);
      const double begin = std::max(a.begin, b.begin), end = std::min(a.end, b.end);
      const double shorter = std::min(a.end - a.begin, b.end - b.begin);
      FittingFaces fit = pair;
      fit.point = a.point + 0.5 * (begin + end) * a.axis;
      fit.direction = a.axis;
      fit.radius = std::min(a.radius, b.radius);
      fit.angle = std::min(a.angle, b.angle);
      if (a.is_hole && b.is_hole) {
        // Nothing is between the two, or a pin that is not in the file.
        if (begin - end > a.radius) continue;
        fit.kind = FittingFaces::Kind::hole_on_hole;
      } else {
        fit.kind = FittingFaces::Kind::pin_in_hole;
        fit.gap = a.is_hole ? a.radius - b.radius : b.radius - a.radius;
        fit.share = (end - begin) / shorter;
        if (fit.share < least_share) continue;
      }
      found.push_back(fit);
    }
}

struct PlaneFace {
  Vec3d point, normal;
  double area;
  std::vector<std::array<Vec3d, 3>> triangles;
  Bounds bounds;
};

std::vector<PlaneFace> planes_of(const StepProduct& product, const Pose& pose, const Bounds& region) {
  std::vector<PlaneFace> planes;
  for (const StepFace& face : product.faces) {
    if (!face.is_plane) continue;
    PlaneFace plane{to_world(pose, face.point), pose.q_WB.rotate(face.direction), face.area, {}, {}};
    for (std::size_t t = face.first; t < face.first + face.count; ++t) {
      std::array<Vec3d, 3> corners;
      for (std::size_t i = 0; i < 3; ++i) {
        corners[i] = to_world(pose, product.mesh.vertices[product.mesh.triangles[t][i]]);
        plane.bounds.add(corners[i]);
      }
      plane.triangles.push_back(corners);
    }
    if (plane.bounds.overlaps(region, 0)) planes.push_back(std::move(plane));
  }
  return planes;
}

bool is_inside(const std::array<Vec3d, 3>& corners, Vec3d normal, Vec3d x) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d side = corners[(i + 1) % 3] - corners[i];
    if (dot(cross(side, x - corners[i]), normal) < 0) return false;
  }
  return true;
}

// Area of `face` that lies on `other`, by some hundred points of equal weight in each triangle, and its
// middle.
struct CommonArea {
  double area = 0;
  Vec3d middle;
};
CommonArea common_area(const PlaneFace& face, const PlaneFace& other) {
  const int points = face.triangles.size() > 32 ? 4 : 16;  // along a side
  CommonArea common;
  for (const auto& [a, b, c] : face.triangles) {
    const double weight = 0.5 * norm(cross(b - a, c - a)) / (points * points);
    // A triangle divided into points^2 equal ones, upright and inverted: their centres.
    for (int i = 0; i < points; ++i)
      for (int k = 0; k < 2 * (points - i) - 1; ++k) {
        const double u = (i + (k % 2 == 0 ? 1 : 2) / 3.0) / points,
                     v = (k / 2 + (k % 2 == 0 ? 1 : 2) / 3.0) / points;
        const Vec3d x = a + u * (b - a) + v * (c - a);
        const bool meets =
            std::any_of(other.triangles.begin(), other.triangles.end(),
                        [&](const auto& triangle) { return is_inside(triangle, other.normal, x); });
        if (!meets) continue;
        common.area += weight;
        common.middle = common.middle + weight * x;
      }
  }
  if (common.area > 0) common.middle = (1 / common.area) * common.middle;
  return common;
}

void fit_planes(const std::vector<PlaneFace>& planes_a, const std::vector<PlaneFace>& planes_b,
                double distance, const FittingFaces& pair, std::vector<FittingFaces>& found) {
  for (const PlaneFace& a : planes_a)
    for (const PlaneFace& b : planes_b) {
      if (norm(a.normal + b.normal) > same_normal || !a.bounds.overlaps(b.bounds, distance)) continue;
      const double gap = dot(b.point - a.point, a.normal);
      if (std::abs(gap) > distance) continue;
      const bool a_is_smaller = a.area <= b.area;
      const CommonArea common = a_is_smaller ? common_area(a, b) : common_area(b, a);
      FittingFaces fit = pair;
      fit.kind = FittingFaces::Kind::plane_on_plane;
      fit.share = common.area / std::min(a.area, b.area);
      if (fit.share < least_share) continue;
      fit.point = common.middle;
      fit.direction = a.normal;
      fit.gap = gap;
      found.push_back(fit);
    }
}

}  // namespace

// Their faces are compared within some minutes.
constexpr std::size_t most_near = 1'000'000;

std::vector<FittingFaces> fitting_faces(const StepFile& step, const std::string& where) {
  std::vector<Bounds> bounds;
  std::vector<std::vector<Ring>> rings;
  for (const StepPart& part : step.parts) {
    const StepProduct& product = step.products[part.product];
    Bounds& box = bounds.emplace_back();
    for (const Vec3d& vertex : product.mesh.vertices) box.add(to_world(part.pose, vertex));
    rings.push_back(rings_of(product, part.pose));
  }
  // Parts in the order of their lowest x: each can touch those only that begin before it ends.
  std::vector<std::size_t> order(step.parts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    return std::pair(bounds[a].low.x, a) < std::pair(bounds[b].low.x, b);
  });
  std::vector<std::pair<std::size_t, std::size_t>> near;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t k = i + 1; k < order.size(); ++k) {
      const std::size_t a = std::min(order[i], order[k]), b = std::max(order[i], order[k]);
      const StepProduct& one = step.products[step.parts[order[i]].product];
      const StepProduct& other = step.products[step.parts[order[k]].product];
      if (bounds[order[k]].low.x > bounds[order[i]].high.x + 0.02 * one.size()) break;
      if (one.unit.mass == 0 || other.unit.mass == 0) continue;
      if (!bounds[a].overlaps(bounds[b], 0.02 * std::min(one.size(), other.size()))) continue;
      if (near.size() == most_near)
        throw Error(
            ErrorCode::scene,
            fmt::format("more than {} pairs of its {} parts are so near that they may touch, such as '{}' "
                        "and '{}': the parts lie in each other",
                        most_near, step.parts.size(), printable(shortened(step.parts[a].name())),
                        printable(shortened(step.parts[b].name()))),
            where, "export each part once, at its place, or fewer parts");
      near.emplace_back(a, b);
    }
  std::ranges::sort(near);
  std::vector<FittingFaces> found;
  for (const auto& [a, b] : near) {
    const StepProduct &one = step.products[step.parts[a].product],
                      &other = step.products[step.parts[b].product];
    const double distance = same_plane * std::min(one.size(), other.size());
    const FittingFaces pair{.kind = {}, .a = a, .b = b, .point = {}, .direction = {}};
    fit_rings(rings[a], rings[b], pair, found);
    const Bounds region = common(bounds[a], bounds[b], distance);
    fit_planes(planes_of(one, step.parts[a].pose, region), planes_of(other, step.parts[b].pose, region),
               distance, pair, found);
  }
  return found;
}

}  // namespace tandem::launch
