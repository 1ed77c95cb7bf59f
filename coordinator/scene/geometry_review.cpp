#include "coordinator/scene/geometry_review.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include "common/scene/shape_mesh.hpp"
#include "coordinator/scene/contact_sizes.hpp"

namespace tandem::launch {
namespace {

using namespace scene;

// Sizes that differ from their surroundings by more than these factors may have a wrong unit: a confusion of
// m and mm is a factor of 1000, which is found for parts from a third of the domain down to a fiftieth of it,
// or up to three times the domain.
constexpr double suspiciously_wide = 20, suspiciously_small = 1.0 / 300;
// Small parts in mm exceed the domain by a smaller factor; then no part of them is inside the domain.
constexpr double wider_than_likely = 3;
// Flywheels behind gears may represent a large remote inertia; mm2 instead of m2 makes a radius of gyration a
// thousand times too long.
constexpr double suspicious_gyration = 100;

double largest(Vec3d v) {
  return std::max({v.x, v.y, v.z});
}

std::string place_text(Vec3d v) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x, v.y, v.z);
}

// The smallest and largest radius of spheres that the scene itself gives.
struct Radii {
  double smallest = std::numeric_limits<double>::infinity(), largest = 0;
};

Radii radii_of(const Dem& dem) {
  Radii radii;
  for (const ParticleGroup& group : dem.particles) {
    if (group.radius_max == 0) continue;  // the radii are in its file
    radii.smallest = std::min(radii.smallest, group.radius_min);
    radii.largest = std::max(radii.largest, group.radius_max);
  }
  return radii;
}

// ---- units

const Wall& wall_of(const ImportedMesh& mesh, const std::vector<Wall>& walls) {
  return *std::ranges::find(walls, mesh.wall, &Wall::name);
}

// Whether the bounding box of some triangle, in the pose of the start, intersects the domain.
bool reaches(const TriangleMesh& mesh, const Wall& wall, const Scene& scene) {
  const Pose body = wall.body == ground ? Pose{} : scene.mbd->bodies[wall.body.value].pose;
  const Pose placed{body.p_WB + body.q_WB.rotate(wall.pose.p_WB), body.q_WB * wall.pose.q_WB};
  const auto [min, max] = scene.domain();
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& triangle) {
    Vec3d corners[3];
    for (int i = 0; i < 3; ++i) corners[i] = placed.p_WB + placed.q_WB.rotate(mesh.vertices[triangle[i]]);
    const auto& [a, b, c] = corners;
    for (int k = 0; k < 3; ++k)
      if (std::max({a[k], b[k], c[k]}) < min[k] || std::min({a[k], b[k], c[k]}) > max[k]) return false;
    return true;
  });
}

void review_unit(const ImportedMesh& mesh, bool is_fixed, bool is_there, double domain, double diameter,
                 std::vector<std::string>& warnings) {
  const double width = largest(mesh.facts.size());
  const std::string what =
      fmt::format("wall \"{}\" is {:.3g} m wide, by {} with a scale of {}, in a domain of {:.3g} m",
                  mesh.wall, width, mesh.file, scene::scale_text(mesh.scale, mesh.stretch), domain);
  const std::string nowhere = is_there ? "" : ", and no part of it is in the domain at the start";
  if (width > suspiciously_wide * domain || (!is_there && width > wider_than_likely * domain)) {
    const bool in_cm = width <= 50 * domain && width >= suspiciously_wide * domain;
    warnings.push_back(what + nowhere + ": " +
                       (in_cm
                            ? fmt::format("is the file in cm? then give \"scale\": {:.6g}", 1e-2 * mesh.scale)
                            : question_of_scale(width, suspiciously_wide * domain, mesh.scale)));
  } else if (width < suspiciously_small * domain || width < diameter) {
    const std::string why =
        width < diameter ? fmt::format(", less than the smallest sphere's diameter of {:.3g} m", diameter)
                         : "";
    warnings.push_back(fmt::format("{}{}{}: is a factor of 1000 missing? then give \"scale\": {:.6g}", what,
                                   why, nowhere, 1e3 * mesh.scale));
  } else if (!is_there && is_fixed) {
    warnings.push_back(what + nowhere + ": it acts on no sphere; check its position and scale");
  }
}

// Extent of the positions of bodies and joints.
Vec3d extent_of(const Mbd& mbd) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Vec3d min{inf, inf, inf}, max{-inf, -inf, -inf};
  const auto add = [&](Vec3d p) {
    for (int k = 0; k < 3; ++k) {
      min[k] = std::min(min[k], p[k]);
      max[k] = std::max(max[k], p[k]);
    }
  };
  for (const Body& body : mbd.bodies) add(body.pose.p_WB);
  for (const Joint& joint : mbd.joints) add(joint.position);
  return mbd.bodies.empty() ? Vec3d{} : max - min;
}

void review_units(const SceneFile& file, std::vector<std::string>& warnings) {
  const Scene& scene = file.scene;
  const double machine = scene.mbd ? largest(extent_of(*scene.mbd)) : 0;
  if (scene.has_particles()) {
    const Box box = scene.domain();
    const double domain = largest(box.max - box.min);
    const double smallest = scene.dem ? radii_of(*scene.dem).smallest : Radii().smallest;
    const std::vector<Wall> walls = scene.walls();
    for (std::size_t i = 0; i < file.mesh_facts.size(); ++i) {
      const ImportedMesh& mesh = file.mesh_facts[i];
      const Wall& wall = wall_of(mesh, walls);
      const bool is_there = reaches(file.meshes[i].mesh, wall, scene);
      review_unit(mesh, wall.body == ground, is_there, domain, std::isfinite(smallest) ? 2 * smallest : 0,
                  warnings);
    }
    const std::string what = fmt::format(
        "the machine is {:.3g} m wide, by the places of its bodies and joints, in a domain of {:.3g} m",
        machine, domain);
    if (machine > suspiciously_wide * domain)
      warnings.push_back(what + ": are they in mm? then multiply them by 1e-3");
    else if (machine > 0 && machine < suspiciously_small * domain)
      warnings.push_back(what + ": is either given in another unit than m? then multiply it by 1e3 or 1e-3");
  }
  review_contact_sizes(file, machine, warnings);
  if (machine == 0) return;
  std::size_t heavy = 0;
  std::string first;
  for (const Body& body : scene.mbd->bodies) {
    const double moment = std::max({body.inertia[0], body.inertia[1], body.inertia[2]});
    const double gyration = std::sqrt(moment / body.mass);
    if (gyration > suspicious_gyration * machine && ++heavy == 1)
      first = fmt::format(
          "body \"{}\" has a radius of gyration of {:.3g} m, by its inertia of {:.3g} kg m2, in a machine "
          "of {:.3g} m",
          body.name, gyration, moment, machine);
  }
  if (heavy > 0)
    warnings.push_back(fmt::format("{}{}: is the inertia in kg mm2? then multiply it by 1e-6", first,
                                   heavy == 1 ? "" : fmt::format(", and {} others are like it", heavy - 1)));
}

// ---- holes

bool looks_missing(const Opening& opening, const MeshFacts& facts) {
  // A gap of zero width is a corner on the edge of another triangle.
  if (opening.width < 1e-4 * opening.length) return false;
  const bool one_triangle = opening.edges == 3 && facts.triangles > 3;
  return one_triangle || (opening.edges <= 6 && opening.extent < 0.05 * facts.diagonal());
}

// What a surface holds.
struct Held {
  std::string what;      // "spheres", "liquid"
  std::string narrow;    // of holes that it does not pass
  double narrowest = 0;  // hole that it passes [m]
  double tight = 0;      // gap of corners that it does not notice [m]
};
Held spheres(double diameter) {
  return {"spheres", fmt::format("too narrow for the smallest sphere, of {:.3g} m", diameter), diameter, 0};
}
Held liquid(double spacing) {
  return {"liquid", fmt::format("less than a spacing of the liquid, of {:.3g} m", spacing), spacing,
          1e-4 * spacing};
}

void review_surface(const ImportedMesh& mesh, const Held& held, SceneFile& file) {
  const MeshFacts& facts = mesh.facts;
  const auto missing = [&](const Opening& opening) { return looks_missing(opening, facts); };
  const auto holes = std::count_if(facts.openings.begin(), facts.openings.end(), missing);
  if (holes > 0) {
    const Opening& widest = *std::find_if(facts.openings.begin(), facts.openings.end(), missing);
    const std::string what = fmt::format(
        "wall \"{}\" has {} in its mesh {}, as if triangles were missing; {} is {:.3g} m wide, at {} in the "
        "frame of "
        "the shape",
        mesh.wall, holes == 1 ? "a hole" : fmt::format("{} holes", holes), mesh.file,
        holes == 1 ? "it" : "the widest", widest.width, place_text(widest.at));
    if (widest.width < held.narrowest)
      file.notes.push_back(what + ": " + held.narrow);
    else
      file.warnings.push_back(what + ": " + held.what +
                              " can pass through; close it in the program that made the mesh");
  }
  if (const auto open = static_cast<std::ptrdiff_t>(facts.openings.size()) - holes; open > 0) {
    const Opening& widest = *std::find_if_not(facts.openings.begin(), facts.openings.end(), missing);
    file.notes.push_back(fmt::format(
        "wall \"{}\" is not closed: its mesh {} has {} of {} edges, {:.3g} m wide, "
        "at {} in the frame of "
        "the shape",
        mesh.wall, mesh.file, open == 1 ? "an opening" : fmt::format("{} openings, the widest", open),
        widest.edges, widest.width, place_text(widest.at)));
  }
  // The solver joins corners within 2.5e-7 of the largest coordinate.
  double reach = 0;
  for (int k = 0; k < 3; ++k) reach = std::max({reach, std::abs(facts.min[k]), std::abs(facts.max[k])});
  if (facts.widest_gap > std::max(2.5e-7 * reach, held.tight))
    file.notes.push_back(fmt::format(
        "{} edges of wall \"{}\" nearly meet others, with corners up to {:.2g} m apart, at {} in "
        "the frame of the "
        "shape: each side acts as a wall of its own; join such corners (weld, merge by distance) "
        "in the program "
        "that made {}",
        facts.unjoined_edges, mesh.wall, facts.widest_gap, place_text(facts.unjoined_at), mesh.file));
}

// ---- triangles per sphere

// More triangles than this within a radius of the contact point are expensive, where the mesh has that many.
constexpr double many_within_radius = 300;
constexpr std::size_t many_in_all = 10'000;
// Measured with 1 and 10 million triangles on one core of an AMD EPYC: a cell of the walls' grid lists the
// triangles within its range, about nine times as many as are within a radius.
constexpr double compared_per_within = 9, seconds_per_comparison = 1e-8;

void review_fineness(const ImportedMesh& mesh, double radius, std::vector<std::string>& warnings) {
  const MeshFacts& facts = mesh.facts;
  if (radius == 0 || facts.triangles < many_in_all) return;
  const double of_triangle = facts.area / static_cast<double>(facts.triangles);
  const double within = std::numbers::pi * radius * radius / of_triangle;
  if (within < many_within_radius) return;
  // Equilateral triangles with sides of one radius.
  // The command works on the file before it is stretched.
  const auto& [x, y, z] = mesh.stretch;
  const double most = std::max({x, y, z}), least = std::min({x, y, z});
  const double enough = std::max(12.0, facts.area / (std::sqrt(3.0) / 4 * radius * radius));
  warnings.push_back(fmt::format(
      "wall \"{}\" has {} triangles, with sides of some {:.2g} m, for spheres of radius {:.3g} m: one at the "
      "wall is compared with some {:.2g} of them, {:.2g} us of a core in every micro step; sides of about "
      "the "
      "radius are enough, {:.2g} triangles: tandem mesh coarsen {} -o coarse.stl --deviation {:.2g}{}{}",
      mesh.wall, facts.triangles, std::sqrt(4 / std::sqrt(3.0) * of_triangle), radius,
      compared_per_within * within, 1e6 * seconds_per_comparison * compared_per_within * within, enough,
      mesh.file, radius / 100 / most, mesh.scale == 1 ? "" : fmt::format(" --scale {:.6g}", mesh.scale),
      most == 1 && least == 1 ? "" : ", and keep the stretch"));
}

// ---- contact of bodies

std::size_t index_of(BodyId body, const Mbd& mbd) {
  return body == ground ? mbd.bodies.size() : body.value;
}

// For each body, and in the last element for the ground, a representative of the bodies welded to it by fixed
// joints.
std::vector<std::size_t> welded(const Mbd& mbd) {
  std::vector<std::size_t> group(mbd.bodies.size() + 1);
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (const Joint& joint : mbd.joints) {
    if (joint.type != JointType::fixed) continue;
    const std::size_t kept = group[index_of(joint.parent, mbd)], gone = group[index_of(joint.child, mbd)];
    std::replace(group.begin(), group.end(), gone, kept);
  }
  return group;
}

void review_contact(const Scene& scene, std::vector<std::string>& notes) {
  if (!scene.mbd || !scene.has_particles()) return;
  const Mbd& mbd = *scene.mbd;
  const std::vector<std::size_t> group = welded(mbd);
  const auto group_of = [&](BodyId body) { return group[index_of(body, mbd)]; };
  // Joints determine the relative motion of the bodies that they connect.
  std::set<std::pair<std::size_t, std::size_t>> connected;
  for (const Joint& joint : mbd.joints)
    if (joint.type != JointType::free && joint.type != JointType::distance)
      connected.insert(std::minmax(group_of(joint.parent), group_of(joint.child)));

  // Bodies whose shapes touch each other (mbd.contact).
  std::set<std::size_t> touching;
  if (scene.contact && !scene.contact->ground.empty()) touching.insert(group_of(ground));
  for (const Shape& shape : scene.shapes)
    if (shape.use == ShapeUse::contact) touching.insert(group_of(shape.body));
  const auto touch = [&](BodyId a, BodyId b) {
    if (!scene.contact || !touching.contains(group_of(a)) || !touching.contains(group_of(b))) return false;
    return std::none_of(scene.contact->ignore.begin(), scene.contact->ignore.end(), [&](const auto& pair) {
      return std::minmax(group_of(pair[0]), group_of(pair[1])) == std::minmax(group_of(a), group_of(b));
    });
  };

  // The first wall of each group, starting with the ground's.
  const std::vector<Wall> all = scene.walls();
  std::map<std::size_t, const Wall*> walls;
  for (const Wall& wall : all) walls.try_emplace(group_of(wall.body), &wall);
  std::vector<const Wall*> movers;
  for (const auto& [key, wall] : walls) movers.push_back(wall);
  std::stable_partition(movers.begin(), movers.end(),
                        [&](const Wall* wall) { return group_of(wall->body) == group_of(ground); });

  std::size_t pairs = 0;
  std::string first;
  for (std::size_t a = 0; a < movers.size(); ++a)
    for (std::size_t b = a + 1; b < movers.size(); ++b) {
      const Wall &other = *movers[a], &mover = *movers[b];
      if (connected.contains(std::minmax(group_of(other.body), group_of(mover.body)))) continue;
      if (touch(other.body, mover.body)) continue;
      if (++pairs > 1) continue;
      first = fmt::format(
          "body \"{}\" can pass through wall \"{}\" of {}", scene.body_name(mover.body), other.name,
          other.body == ground ? "the ground" : "body \"" + scene.body_name(other.body) + "\"");
    }
  if (pairs == 0) return;
  const std::string others =
      pairs == 1 ? "" : fmt::format(", and so for {} other pair{}", pairs - 1, pairs == 2 ? "" : "s");
  notes.push_back(
      "walls act on spheres only: " + first + others +
      "; shapes with \"use\": \"contact\" (mbd.contact), limits of joints, bushings and springs can "
      "hold bodies apart");
}

}  // namespace

void review_geometry(SceneFile& file) {
  review_units(file, file.warnings);
  if (file.scene.dem) {
    const Radii radii = radii_of(*file.scene.dem);
    for (const ImportedMesh& mesh : file.mesh_facts) {
      review_surface(mesh, spheres(std::isfinite(radii.smallest) ? 2 * radii.smallest : 0), file);
      review_fineness(mesh, radii.largest, file.warnings);
    }
  } else if (file.scene.sph) {
    for (const ImportedMesh& mesh : file.mesh_facts)
      review_surface(mesh, liquid(file.scene.sph->spacing), file);
  }
  review_contact(file.scene, file.notes);
}

nlohmann::ordered_json to_json(const std::vector<ImportedMesh>& meshes) {
  auto list = nlohmann::ordered_json::array();
  for (const ImportedMesh& mesh : meshes) {
    const MeshFacts& f = mesh.facts;
    nlohmann::ordered_json volume;  // null where the surface is not closed
    if (f.volume) volume = *f.volume;
    list.push_back({{"wall", mesh.wall},
                    {"file", mesh.file},
                    {"scale", mesh.scale},
                    {"stretch", {mesh.stretch.x, mesh.stretch.y, mesh.stretch.z}},
                    {"size_m", {f.size().x, f.size().y, f.size().z}},
                    {"triangles", f.triangles},
                    {"open_edges", f.open_edges},
                    {"openings", f.openings.size()},
                    {"non_manifold_edges", f.non_manifold_edges},
                    {"inverted_edges", f.inverted_edges},
                    {"area_m2", f.area},
                    {"volume_m3", volume}});
  }
  return list;
}

}  // namespace tandem::launch
