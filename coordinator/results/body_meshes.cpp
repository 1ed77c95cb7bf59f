#include "coordinator/results/body_meshes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

void append(TriangleMesh& mesh, const TriangleMesh& part) {
  const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& [a, b, c] : part.triangles) mesh.triangles.push_back({a + offset, b + offset, c + offset});
}

Vec3d to_world(const Pose& pose, Vec3d p) {
  return pose.p_WB + pose.q_WB.rotate(p);
}
Vec3d to_body(const Pose& pose, Vec3d p) {
  return pose.q_WB.conjugate().rotate(p - pose.p_WB);
}

// The part of the plane through `point` with `normal` that is in `domain`: a square that covers it, clipped
// by the six faces [Sutherland1974].
TriangleMesh plane_in_domain(Vec3d point, Vec3d normal, const scene::Box& domain) {
  const Vec3d middle = 0.5 * (domain.min + domain.max);
  const Vec3d centre = middle - dot(middle - point, normal) * normal;
  const Vec3d helper = std::abs(normal.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const double reach = norm(domain.max - domain.min);
  const Vec3d u = reach * normalized(cross(normal, helper));
  const Vec3d v = cross(normal, u);
  std::vector<Vec3d> polygon = {centre - u - v, centre + u - v, centre + u + v, centre - u + v};

  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      const double limit = side > 0 ? domain.max[axis] : domain.min[axis];
      std::vector<Vec3d> kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3d a = polygon[i], b = polygon[(i + 1) % polygon.size()];
        const double inside_a = side * (limit - a[axis]), inside_b = side * (limit - b[axis]);
        if (inside_a >= 0) kept.push_back(a);
        if ((inside_a >= 0) != (inside_b >= 0))
          kept.push_back(a + inside_a / (inside_a - inside_b) * (b - a));
      }
      polygon = std::move(kept);
    }
  }
  TriangleMesh mesh;
  mesh.vertices = std::move(polygon);
  for (std::uint32_t i = 2; i < mesh.vertices.size(); ++i) mesh.triangles.push_back({0, i - 1, i});
  return mesh;
}

const TriangleMesh& mesh_of(const scene::Wall& wall, const std::vector<protocol::NamedMesh>& meshes) {
  for (const protocol::NamedMesh& named : meshes) {
    if (named.name == wall.name) return named.mesh;
  }
  throw Error(ErrorCode::internal, "no mesh came with wall \"" + wall.name + "\"", "results");
}

// The part of an endless cylinder about its z axis for which the axis is inside the domain extended by the
// radius.
TriangleMesh cylinder_in_domain(double radius, const Pose& pose, const scene::Box& domain, int segments) {
  const Vec3d axis = pose.q_WB.rotate({0, 0, 1});
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  for (int a = 0; a < 3; ++a) {
    const double from = domain.min[a] - radius - pose.p_WB[a], to = domain.max[a] + radius - pose.p_WB[a];
    if (axis[a] == 0) {
      if (from > 0 || to < 0) return {};
      continue;
    }
    low = std::max(low, std::min(from / axis[a], to / axis[a]));
    high = std::min(high, std::max(from / axis[a], to / axis[a]));
  }
  if (!(low < high)) return {};
  return transformed(cylinder_mesh(radius, high - low, segments, {"+z", "-z"}),
                     {{0, 0, (low + high) / 2}, {}});
}

// In the frame of the wall.
TriangleMesh cylinder_wall(const scene::CylinderShape& cylinder, const Pose& in_world,
                           const scene::Box& domain, int segments) {
  if (!cylinder.height) return cylinder_in_domain(cylinder.radius, in_world, domain, segments);
  return cylinder_mesh(cylinder.radius, *cylinder.height, cylinder.segments.value_or(segments),
                       cylinder.open);
}

// Edges a, b, c of a homogeneous box about its principal axes: a^2 = 6 (I_b + I_c - I_a) / m, and cyclically.
TriangleMesh inertia_box(const scene::Body& body) {
  const auto& [xx, yy, zz, xy, xz, yz] = body.inertia;
  Eigen::Matrix3d inertia;
  inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(inertia);
  const Eigen::Vector3d moments = principal.eigenvalues();
  Vec3d edges;
  for (int i = 0; i < 3; ++i) {
    edges[i] = std::sqrt(std::max(0.0, 6 * (moments.sum() - 2 * moments[i]) / body.mass));
  }
  // A rod or a plate has zero thickness; a hundredth of its length makes it visible.
  const double least = 0.01 * std::max({edges.x, edges.y, edges.z});
  for (int i = 0; i < 3; ++i) edges[i] = std::max(edges[i], least);
  Eigen::Matrix3d axes = principal.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  TriangleMesh mesh = box_mesh(edges);
  for (Vec3d& vertex : mesh.vertices) {
    const Eigen::Vector3d turned = axes * Eigen::Vector3d(vertex.x, vertex.y, vertex.z);
    vertex = {turned.x(), turned.y(), turned.z()};
  }
  return mesh;
}

// Walls of the ground with a colour of their own are surfaces for themselves.
TriangleMesh walls_of(BodyId body, const scene::Scene& scene,
                      const std::vector<protocol::NamedMesh>& meshes) {
  TriangleMesh mesh;
  for (const scene::Wall& wall : scene.walls()) {
    if (wall.body == body && !wall.colour) append(mesh, wall_mesh(wall, scene, meshes, round_segments));
  }
  return mesh;
}

// The space that surfaces take at the start, together with the domain of the particles.
scene::Box space_of(const std::vector<BodyMesh>& all, const scene::Scene& scene) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  scene::Box box{{inf, inf, inf}, {-inf, -inf, -inf}};
  if (scene.has_particles()) box = scene.domain();
  for (const BodyMesh& body : all) {
    const Pose pose = body.body == ground ? Pose{} : scene.mbd->bodies.at(body.body.value).pose;
    for (const Vec3d& vertex : body.mesh.vertices) {
      const Vec3d p = to_world(pose, vertex);
      for (int i = 0; i < 3; ++i)
        box.min[i] = std::min(box.min[i], p[i]), box.max[i] = std::max(box.max[i], p[i]);
    }
  }
  return box;
}

// A rectangle of the plane that covers the projection of the box and a margin about it; empty where the plane
// is far away.
TriangleMesh plane_below(Vec3d point, Vec3d normal, const scene::Box& box) {
  constexpr double margin = 0.25, farthest = 10;  // over the size of the box
  const Vec3d middle = 0.5 * (box.min + box.max), half = 0.5 * (box.max - box.min);
  const double size = norm(box.max - box.min), distance = dot(middle - point, normal);
  if (!(std::abs(distance) < farthest * size)) return {};
  // Along an axis of the world where the normal is across it.
  const Vec3d helper = std::abs(normal.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = normalized(helper - dot(helper, normal) * normal), v = cross(normal, u);
  const auto reach = [&](Vec3d along) {
    return std::abs(along.x) * half.x + std::abs(along.y) * half.y + std::abs(along.z) * half.z +
           margin * size;
  };
  const Vec3d centre = middle - distance * normal, a = reach(u) * u, b = reach(v) * v;
  return {{centre - a - b, centre + a - b, centre + a + b, centre - a + b}, {{0, 1, 2}, {0, 2, 3}}};
}

// A plane in the world.
struct Plane {
  Vec3d point, normal;
  Plane(const scene::PlaneShape& shape, const Pose& pose)
      : point(to_world(pose, shape.point)), normal(normalized(pose.q_WB.rotate(shape.normal))) {}
  bool operator==(const Plane& other) const {
    constexpr double tiny = 1e-9;
    return norm(normal - other.normal) < tiny &&
           std::abs(dot(point - other.point, normal)) <= tiny * (norm(point) + norm(other.point));
  }
};

bool is_wall(const Plane& plane, const scene::Scene& scene) {
  return std::ranges::any_of(scene.walls(), [&](const scene::Wall& wall) {
    const auto* shape = std::get_if<scene::PlaneShape>(&wall.shape);
    return wall.body == ground && shape && Plane(*shape, wall.pose) == plane;
  });
}

// `all`: everything else.
void append_planes(const scene::Scene& scene, const std::vector<BodyMesh>& all, TriangleMesh& mesh) {
  if (!scene.contact) return;
  std::vector<BodyMesh> others = all;
  others.push_back({ground, contact_ground, mesh});
  const scene::Box space = space_of(others, scene);
  // Of two surfaces at the same place the renderer would draw an arbitrary one.
  const double below = 1e-4 * norm(space.max - space.min);
  for (const scene::Shape& shape : scene.contact->ground) {
    const auto* given = std::get_if<scene::PlaneShape>(&shape.geometry);
    if (!given) continue;
    Plane plane(*given, shape.pose);
    if (is_wall(plane, scene)) plane.point = plane.point - below * plane.normal;
    append(mesh, scene.has_particles() ? plane_in_domain(plane.point, plane.normal, space)
                                       : plane_below(plane.point, plane.normal, space));
  }
}

}  // namespace

TriangleMesh wall_mesh(const scene::Wall& wall, const scene::Scene& scene,
                       const std::vector<protocol::NamedMesh>& meshes, int segments) {
  if (const auto* box = std::get_if<scene::BoxShape>(&wall.shape)) {
    return transformed(box_mesh(box->size, box->open), wall.pose);
  }
  if (std::holds_alternative<scene::MeshShape>(wall.shape))
    return transformed(mesh_of(wall, meshes), wall.pose);

  if (const auto* sphere = std::get_if<scene::SphereShape>(&wall.shape))
    return transformed(sphere_mesh(sphere->radius, segments), wall.pose);

  const Pose body = wall.body == ground ? Pose{} : scene.mbd->bodies.at(wall.body.value).pose;
  const Pose in_world{to_world(body, wall.pose.p_WB), body.q_WB * wall.pose.q_WB};
  if (const auto* cylinder = std::get_if<scene::CylinderShape>(&wall.shape))
    return transformed(cylinder_wall(*cylinder, in_world, scene.domain(), segments), wall.pose);

  const auto& plane = std::get<scene::PlaneShape>(wall.shape);
  const Vec3d point = to_world(body, to_world(wall.pose, plane.point));
  const Vec3d normal = normalized(body.q_WB.rotate(wall.pose.q_WB.rotate(plane.normal)));
  TriangleMesh mesh = plane_in_domain(point, normal, scene.domain());
  for (Vec3d& vertex : mesh.vertices) vertex = to_body(body, vertex);
  return mesh;
}

std::vector<BodyMesh> body_meshes(const scene::Scene& scene, const std::vector<protocol::NamedMesh>& meshes,
                                  const std::vector<BodyMesh>& shapes) {
  std::vector<BodyMesh> all;
  if (TriangleMesh mesh = walls_of(ground, scene, meshes); !mesh.triangles.empty()) {
    all.push_back({ground, scene.body_name(ground), std::move(mesh)});
  }
  for (const scene::Wall& wall : scene.walls())
    if (wall.colour)
      if (TriangleMesh mesh = wall_mesh(wall, scene, meshes, round_segments); !mesh.triangles.empty())
        all.push_back({ground, coloured_wall + wall.name, std::move(mesh)});
  const std::size_t bodies = scene.mbd ? scene.mbd->bodies.size() : 0;
  for (std::uint32_t i = 0; i < bodies; ++i) {
    TriangleMesh mesh = walls_of({i}, scene, meshes);
    for (const BodyMesh& shape : shapes)
      if (shape.body == BodyId{i}) append(mesh, shape.mesh);
    if (mesh.triangles.empty()) mesh = inertia_box(scene.mbd->bodies[i]);
    all.push_back({{i}, scene.mbd->bodies[i].name, std::move(mesh)});
  }
  TriangleMesh road;
  for (const BodyMesh& shape : shapes)
    if (shape.body == ground) append(road, shape.mesh);
  append_planes(scene, all, road);
  if (!road.triangles.empty()) {
    const auto bodies_from = std::ranges::find_if(all, [](const BodyMesh& m) { return m.body != ground; });
    all.insert(bodies_from, {ground, contact_ground, std::move(road)});
  }
  return all;
}

}  // namespace tandem::launch
