// The layers of particles/ (base, geometry, grid, state) carry another particle solver than the one of
// grains: here spheres without any force, in a box that repeats itself along x.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "particles/base/thread_pool.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/grid/cell_grid.hpp"
#include "particles/state/centre.hpp"
#include "particles/state/sphere_arrays.hpp"

namespace tandem::test {
namespace {

using namespace particles;

constexpr double radius = 0.01;  // [m]

class FreeFlight {
 public:
  FreeFlight(const scene::Box& domain, const Periods& periods, const std::vector<Vec3d>& x,
             const std::vector<Vec3d>& v)
      : periods_(periods),
        unit_(LengthUnit<float>::for_lengths(4 * radius)),
        centres_(CentreUnit<float>::for_range(unit_, 1, 4)),
        grid_(make_cell_grid(domain, periods, 2.5 * radius, most_cells(x.size()))),
        position_(x.size()),
        velocity_(x.size()),
        fine_(x.size()) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      position_[i].radius = unit_.count(radius);
      centres_.split(centres_.of(x[i]), position_[i], fine_[i]);
      set_velocity(v[i], velocity_[i], fine_[i]);
    }
    spheres_.count = static_cast<std::uint32_t>(x.size());
    spheres_.position[0] = position_.data();
    spheres_.velocity[0] = velocity_.data();
    spheres_.fine = fine_.data();
  }

  void step(double dt) {
    pool_.run([&](unsigned thread) {
      for (std::uint32_t i = thread; i < spheres_.count; i += pool_.size()) {
        PositionRadius<float>& position = spheres_.position[0][i];
        FinePart<float>& fine = spheres_.fine[i];
        auto centre = centres_.joined(position, fine);
        centre += centres_.of(dt * velocity_of(spheres_.velocity[0][i], fine));
        centres_.split(centres_.wrapped(centre, periods_), position, fine);
      }
    });
  }

  Vec3d centre(std::uint32_t i) const {
    return centres_.metres(centres_.joined(spheres_.position[0][i], spheres_.fine_part(i)));
  }
  // Spheres by cells: those of cell c are order[start[c]] to order[start[c + 1] - 1].
  void sort(std::vector<std::uint32_t>& start, std::vector<std::uint32_t>& order) const {
    start.assign(grid_.total + 1, 0);
    std::vector<std::uint32_t> cell(spheres_.count);
    for (std::uint32_t i = 0; i < spheres_.count; ++i) {
      const Vec3d x = centre(i);
      cell[i] = grid_.number(grid_.along(x.x, 0), grid_.along(x.y, 1), grid_.along(x.z, 2));
      ++start[cell[i] + 1];
    }
    for (std::uint32_t c = 0; c < grid_.total; ++c) start[c + 1] += start[c];
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    order.resize(spheres_.count);
    for (std::uint32_t i = 0; i < spheres_.count; ++i) order[next[cell[i]]++] = i;
  }

 private:
  Periods periods_;
  LengthUnit<float> unit_;
  CentreUnit<float> centres_;
  CellGrid grid_;
  ThreadPool pool_{2};
  std::vector<PositionRadius<float>> position_;
  std::vector<VelocityKind<float>> velocity_;
  std::vector<FinePart<float>> fine_;
  SphereArrays<float> spheres_;
};

TEST(ParticleFloors, CarrySpheresThatFlyFreely) {
  const scene::Box domain{{0, 0, 0}, {0.4, 0.4, 0.4}};
  Periods periods;
  periods.min = domain.min;
  periods.length = {0.4, 0, 0};
  const std::vector<Vec3d> x{{0.1, 0.2, 0.3}, {0.39, 0.2, 0.1}, {0.2, 0.05, 0.2}},
      v{{1, 0, 0}, {0.3, 0.1, 0.05}, {-7, 0.01, 0}};
  FreeFlight flight(domain, periods, x, v);
  const double dt = 1e-4;
  const int steps = 10'000;
  for (int k = 0; k < steps; ++k) flight.step(dt);
  double worst = 0;
  for (std::uint32_t i = 0; i < x.size(); ++i) {
    Vec3d expected = x[i] + (steps * dt) * v[i];
    expected.x -= 0.4 * std::floor(expected.x / 0.4);
    worst = std::max(worst, norm(periods.shortest(flight.centre(i) - expected)));
  }
  std::printf("  after %d steps off by %.1e m, tolerance 1e-10 m\n", steps, worst);
  EXPECT_LT(worst, 1e-10);

  std::vector<std::uint32_t> start, order;
  flight.sort(start, order);
  EXPECT_EQ(start.back(), x.size());
  EXPECT_EQ(order.size(), x.size());
}

}  // namespace
}  // namespace tandem::test
