// How far particles and walls may move before lists may miss something: their skins. Lists reach beyond the
// support by the skins of both of a pair. Where the liquid or a wall is fast, skins are wide, so that lists
// serve for several steps; elsewhere they are narrow, so that lists hold few pairs that are out of reach.
#pragma once

#include <cmath>
#include <cstdint>

#include "common/error.hpp"
#include "common/scene/fault.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/grid/cell_grid.hpp"
#include "particles/state/centre.hpp"
#include "sph_server/equations/liquid.hpp"
#include "sph_server/equations/time_step.hpp"
#include "sph_server/neighbours/walls_view.hpp"

namespace tandem::sph {

inline constexpr double least_skin = 0.05, widest_skin = 0.3;  // [spacings]

struct SkinRule {
  double least = 0, widest = 0;  // [m]
  double time = 0;               // for which lists are to serve [s]

  // shortest_period: along an axis of the domain, infinite without one [m]. Error{scene} where it is so short
  // that lists would have a particle twice. Wide skins need three times the reach: cells are as large as the
  // reach in vast domains, and a period has three at least.
  static SkinRule of(const Liquid& l, double shortest_period);
  TANDEM_HD float at_speed(double speed) const {
    return static_cast<float>(std::fmin(widest, least + time * speed));
  }
};

inline SkinRule SkinRule::of(const Liquid& l, double shortest_period) {
  constexpr double steps = 8;  // of the longest ones
  const double R = l.support(), half_reach = 0.5 * (shortest_period / 2 - R),
               third_reach = 0.5 * (shortest_period / 3 - R);
  const double widest = std::fmin(
      widest_skin * l.spacing, std::fmax(third_reach, std::fmin(0.5 * widest_skin * l.spacing, half_reach)));
  if (!(widest >= least_skin * l.spacing))
    throw Error(ErrorCode::scene,
                "the domain is " + scene::rounded(shortest_period) + " m long along a periodic axis",
                "domain", "give it " + scene::rounded(2 * (R + 2 * least_skin * l.spacing)) + " m or more");
  return {least_skin * l.spacing, widest, steps * step_limits(l, 0, 0).sound};
}

// How far the lists of each particle reach.
struct Reaches {
  double support = 0;           // [m]
  const float* skin = nullptr;  // of each particle [m]
  const float* near = nullptr;  // widest skin of the particles that may be its neighbours [m]
  float walls = 0;              // skin of the walls [m]
  static constexpr double rounding = 1 + 1e-6;

  TANDEM_HD double to_neighbours(std::uint32_t i) const { return rounding * (support + skin[i] + near[i]); }
  // To those that may come within the support, and those that may be before a neighbour.
  TANDEM_HD double to_facets(std::uint32_t i) const {
    return rounding * (support + skin[i] + std::fmax(near[i], walls));
  }
};

// The speed of a particle, or that of a wall near it if this is larger.
template <class Real>
struct MeasureSpeed {
  const particles::VelocityKind<Real>* velocity = nullptr;
  const particles::FinePart<Real>* fine = nullptr;
  const Vec3d* x = nullptr;  // [m]
  WallsView walls;
  Vec3d frame;             // velocity relative to which speeds count [m/s]
  float* speed = nullptr;  // of each particle [m/s]

  TANDEM_HD void operator()(std::uint32_t i) const {
    particles::FinePart<Real> rest{};
    if constexpr (particles::has_fine_part<Real>) rest = fine[i];
    double squared = norm2(particles::velocity_of(velocity[i], rest) - frame);
    for (std::uint32_t body = 0; body < walls.bodies; ++body) {
      if (!walls.may_be_near(body, x[i])) continue;
      const particles::BodyPose& pose = walls.pose[body];
      squared = std::fmax(squared, norm2(pose.v + cross(pose.w, x[i] - pose.p) - frame));
    }
    speed[i] = static_cast<float>(std::sqrt(squared));
  }
};

// The largest value of the particles in each cell, 0 in empty ones.
struct LargestInCell {
  const std::uint32_t* cell_start = nullptr;
  const std::uint32_t* cell_particle = nullptr;
  const float* value = nullptr;  // of each particle
  float* largest = nullptr;      // of each cell

  TANDEM_HD void operator()(std::uint32_t cell) const {
    float most = 0;
    for (std::uint32_t k = cell_start[cell]; k < cell_start[cell + 1]; ++k)
      most = std::fmax(most, value[cell_particle[k]]);
    largest[cell] = most;
  }
};

// The largest value in the cells up to `span` from that of a particle.
struct LargestNear {
  particles::CellGrid grid;
  const Vec3d* x = nullptr;        // [m]
  const float* largest = nullptr;  // of each cell

  TANDEM_HD float operator()(std::uint32_t i, std::int32_t span) const {
    std::int32_t home[3];
    for (int a = 0; a < 3; ++a) home[a] = grid.along(x[i][a], a);
    float most = 0;
    for (std::int32_t z = home[2] - span; z <= home[2] + span; ++z)
      for (std::int32_t y = home[1] - span; y <= home[1] + span; ++y)
        for (std::int32_t along = home[0] - span; along <= home[0] + span; ++along) {
          std::int32_t cell[3]{along, y, z};
          particles::Image image = 0;
          if (grid.exists<true>(cell[0], 0, image) && grid.exists<true>(cell[1], 1, image) &&
              grid.exists<true>(cell[2], 2, image))
            most = std::fmax(most, largest[grid.number(cell[0], cell[1], cell[2])]);
        }
    return most;
  }
};

// A particle that is slow may be hit by a fast one, or by a wall: its skin follows the largest speed near it.
struct ChooseSkin {
  LargestNear speeds;
  SkinRule rule;
  float* skin = nullptr;
  TANDEM_HD void operator()(std::uint32_t i) const { skin[i] = rule.at_speed(speeds(i, 1)); }
};
struct FindNearSkin {
  LargestNear skins;
  std::int32_t span = 1;  // cells that the reach spans
  float* near = nullptr;
  TANDEM_HD void operator()(std::uint32_t i) const { near[i] = skins(i, span); }
};

// For how long at least a particle stays within its skin [s]. moved: from where it was when the lists were
// built [m]; acceleration: bound of it [m/s2].
TANDEM_HD inline double time_within(double skin, double moved, double speed, double acceleration) {
  const double room = skin - moved;
  if (room <= 0) return 0;
  return 2 * room / (speed + std::sqrt(speed * speed + 2 * acceleration * room));
}

}  // namespace tandem::sph
