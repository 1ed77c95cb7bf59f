#include <cmath>
#include <cstdio>

#include "common/error.hpp"
#include "particles/io/fill.hpp"
#include "particles/io/overlaps.hpp"

namespace tandem::particles {
namespace {

constexpr int most_sweeps = 2000;
constexpr double most_of_radius = 1;  // limit of a sphere's total move [-]
// Limit of a move for one pair in one sweep, because the cells are those of the sweep's begin
constexpr double sweep_of_radius = 0.25;

Vec3d limited(Vec3d move, double radius) {
  const double length = norm(move), most = sweep_of_radius * radius;
  return length > most ? (most / length) * move : move;
}

class Relaxation {
 public:
  Relaxation(Fill& fill, const Surface& surface, const scene::Scene& scene)
      : fill_(fill),
        surface_(surface),
        scene_(scene),
        periods_(periods_of(*scene.dem)),
        start_(fill.position) {}

  StartRelaxation run() {
    StartRelaxation result;
    result.worst = sweep(false);
    for (double worst = result.worst; worst > start_overlap_limit; ++result.sweeps) {
      if (result.sweeps == most_sweeps) give_up(worst_sphere_, "still overlaps after all sweeps", others);
      sweep(true);
      worst = sweep(false);
    }
    for (std::size_t i = 0; i < start_.size(); ++i) {
      const double move = norm(fill_.position[i] - start_[i]);
      if (!(move > 0)) continue;
      ++result.moved;
      fill_.position[i] = periods_.wrapped(fill_.position[i]);
      result.largest_move = std::max(result.largest_move, move);
      expect_inside(i);
    }
    return result;
  }

 private:
  // Returns the largest overlap, relative to the smaller radius; with `part`, also separates overlapping
  // pairs.
  double sweep(bool part) {
    double worst = 0;
    const auto note = [&](double ratio, std::size_t i) {
      if (ratio > worst) worst = ratio, worst_sphere_ = i;
    };
    const SphereCells cells(fill_, periods_);
    for (std::size_t i = 0; i < fill_.position.size(); ++i)
      cells.for_partners(i, [&](std::size_t j, Vec3d shift) {
        const Vec3d line = fill_.position[i] + shift - fill_.position[j];
        const double reach = fill_.radius[i] + fill_.radius[j], distance = norm(line);
        if (distance >= reach) return;
        note((reach - distance) / std::min(fill_.radius[i], fill_.radius[j]), i);
        if (!part) return;
        // Spheres at one position are separated along x.
        const Vec3d apart = distance > 0 ? (1 / distance) * line : Vec3d{1, 0, 0};
        const double mass_i = mass(i), mass_j = mass(j), overlap = reach - distance;
        move(i, (overlap * mass_j / (mass_i + mass_j)) * apart, others);
        move(j, (-overlap * mass_i / (mass_i + mass_j)) * apart, others);
      });
    for (std::size_t body = 0; body < surface_.grids.size(); ++body) {
      const Pose pose = start_pose(surface_.boundary_bodies[body], scene_);
      for (std::size_t i = 0; i < fill_.position.size(); ++i) {
        Vec3d out;
        // Of several facets only the deepest moves the sphere, because flat walls have many facets
        double deepest = 0;
        for_wall_overlaps(fill_, i, surface_, body, pose,
                          [&](const WallContact& contact, Vec3d normal, double ratio) {
                            note(ratio, i);
                            if (-contact.gap > deepest) deepest = -contact.gap, out = deepest * normal;
                          });
        if (part && deepest > 0) move(i, out, wall);
      }
    }
    return worst;
  }

  double mass(std::size_t i) const {
    const double r = fill_.radius[i];
    return scene_.dem->materials[fill_.material[i]].density * r * r * r;
  }

  // Obstacle that prevents a separation, for the error.
  struct Obstacle {
    const char *position, *remedy;
  };
  static constexpr Obstacle others{
      "among overlapping ones",
      "there is no room for all: fewer or smaller spheres, or a start that was left to settle"};
  static constexpr Obstacle wall{"in a wall", "move the group or the wall, or use fewer or smaller spheres"};

  void move(std::size_t i, Vec3d by, const Obstacle& from) {
    fill_.position[i] += limited(by, fill_.radius[i]);
    if (norm(fill_.position[i] - start_[i]) > most_of_radius * fill_.radius[i])
      give_up(i, "would have to move by more than its radius", from);
  }

  // Otherwise later errors would name a position that is in no file.
  void expect_inside(std::size_t i) const {
    const scene::Box& domain = scene_.dem->domain;
    const Vec3d from = start_[i], to = fill_.position[i];
    for (int a = 0; a < 3; ++a) {
      if (scene_.dem->periodic[static_cast<std::size_t>(a)] ||
          (to[a] >= domain.min[a] && to[a] <= domain.max[a]))
        continue;
      char text[256];
      std::snprintf(
          text, sizeof text,
          "sphere %zu, which starts at (%.6g, %.6g, %.6g) m among overlapping ones or in a wall, was "
          "moved out of the domain by start_overlap \"relax\", to (%.6g, %.6g, %.6g) m",
          i, from.x, from.y, from.z, to.x, to.y, to.z);
      refuse(i, text, "enlarge dem.domain, or move what overlaps there apart");
    }
  }

  [[noreturn]] void give_up(std::size_t i, const char* why, const Obstacle& obstacle) const {
    char text[200];
    std::snprintf(text, sizeof text, "sphere %zu, which starts at (%.6g, %.6g, %.6g) m %s, %s", i,
                  start_[i].x, start_[i].y, start_[i].z, obstacle.position, why);
    refuse(i, text, obstacle.remedy);
  }

  [[noreturn]] void refuse(std::size_t i, const char* problem, const char* remedy) const {
    const std::size_t group = fill_.group[i];
    throw Error(ErrorCode::scene, problem,
                "dem.particles[" + std::to_string(group) + "] '" + scene_.dem->particles[group].name + "'",
                remedy);
  }

  Fill& fill_;
  const Surface& surface_;
  const scene::Scene& scene_;
  const Periods periods_;
  const std::vector<Vec3d> start_;  // [m]
  std::size_t worst_sphere_ = 0;
};

}  // namespace

StartRelaxation relax_start(Fill& fill, const Surface& surface, const scene::Scene& scene) {
  if (fill.position.empty()) return {};
  check_numbers(fill, *scene.dem);
  return Relaxation(fill, surface, scene).run();
}

}  // namespace tandem::particles
