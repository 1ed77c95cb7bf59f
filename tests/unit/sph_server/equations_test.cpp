// Equation of state, terms of a pair, limits of the step.
#include <gtest/gtest.h>

#include <cmath>

#include "sph_server/equations/pair_terms.hpp"
#include "sph_server/equations/spray.hpp"
#include "sph_server/equations/state.hpp"
#include "sph_server/equations/time_step.hpp"
#include "sph_server/equations/wall_repulsion.hpp"
#include "sph_server/equations/wall_terms.hpp"
#include "tests/support/error_of.hpp"

namespace tandem::test {
namespace {

using namespace sph;

TEST(EquationOfState, IsThatOfTait) {
  for (const double e : {-0.3, -0.01, 1e-6, 0.01, 0.2}) {
    EXPECT_NEAR(tait_pressure(e), (std::pow(1 + e, 7) - 1) / 7, 1e-14);
    EXPECT_NEAR(tait_energy(e), (std::pow(1 + e, 6) / 6 + 1 / (1 + e) - 7.0 / 6) / 7, 1e-14);
  }
  EXPECT_NEAR(tait_pressure(1e-12), 1e-12, 1e-23) << "a small compression keeps its digits";
}

TEST(PairTerms, AreAntisymmetricToTheBitAndConjugate) {
  Liquid liquid;
  liquid.viscosity = 0.3;
  liquid.artificial = 0.1;
  liquid.sound_speed = 30;
  liquid.spacing = 0.01;
  liquid.gravity = {0, 1, -9.81};
  const auto c = PairConstants<float>::of(liquid);
  const ParticleState<float> i{{0.3F, -0.1F, 0.2F}, 311, {1, 2, -9000}, 1.01e-6F},
      j{{-0.4F, 0.7F, 0.05F}, -57, {3, 0, -9900}, 0.98e-6F};
  const Vec3f d{0.004F, -0.011F, 0.007F};
  const auto of_i = pair_terms(c, d, norm2(d), i, j), of_j = pair_terms(c, -d, norm2(d), j, i);
  EXPECT_EQ(of_i.pressure, of_j.pressure) << "of d and of -d";
  EXPECT_EQ(of_i.viscous, of_j.viscous);
  // The work of the pressure is what the compression takes.
  const double mass = liquid.mass();
  const double work = mass * static_cast<double>(of_i.pressure * of_i.approach);
  const double taken =
      static_cast<double>(i.pressure * i.volume * of_i.continuity + j.pressure * j.volume * of_j.continuity);
  EXPECT_NEAR(work, -taken, 1e-5 * std::fabs(taken));
  EXPECT_LT(of_i.viscous * of_i.approach, 0) << "viscosity takes energy";
  // Diffusion moves mass from one to the other.
  EXPECT_NEAR(of_i.diffusion / j.volume, -of_j.diffusion / i.volume,
              1e-5 * std::fabs(of_i.diffusion / j.volume));
}

// Acceleration by viscosity of a particle in a cubic lattice with the velocities v(x) [m/s2].
template <class Velocity>
Vec3d viscous_acceleration(const Liquid& liquid, Velocity v) {
  const auto c = PairConstants<double>::of(liquid);
  const double volume = liquid.mass() / liquid.density, a = liquid.spacing;
  Vec3d sum;
  for (int x = -3; x <= 3; ++x)
    for (int y = -3; y <= 3; ++y)
      for (int z = -3; z <= 3; ++z) {
        const Vec3d at{a * x, a * y, a * z};
        if (norm2(at) == 0 || norm2(at) >= c.support2) continue;
        sum -= pair_terms(c, -at, norm2(at), ParticleState<double>{v(Vec3d{}), 0, {}, volume},
                          ParticleState<double>{v(at), 0, {}, volume})
                   .viscous *
               at;
      }
  return sum;
}

TEST(PairTerms, HaveTheViscosityOfALatticeInShear) {
  Liquid liquid;
  liquid.viscosity = 0.3;
  liquid.spacing = 0.1;
  liquid.sound_speed = 30;
  const double expected = liquid.viscosity / liquid.density;  // of a velocity y^2 / 2
  const double along_axes = viscous_acceleration(liquid, [](Vec3d x) {
                              return Vec3d{x.y * x.y / 2, 0, 0};
                            }).x;
  const Vec3d u = 1 / std::sqrt(2.0) * Vec3d{1, 1, 0}, w = 1 / std::sqrt(2.0) * Vec3d{1, -1, 0};
  const double along_diagonals =
      dot(viscous_acceleration(liquid, [&](Vec3d x) { return dot(x, w) * dot(x, w) / 2 * u; }), u);
  EXPECT_NEAR(along_axes / expected, 1, 1e-3);
  EXPECT_NEAR(along_diagonals / expected, 1, 0.05);
}

// Also where neighbours lack, as at a free surface.
TEST(PairTerms, HaveNoViscosityInALiquidThatTurnsLikeARigidBody) {
  Liquid liquid;
  liquid.viscosity = 0.3;
  liquid.spacing = 0.1;
  liquid.sound_speed = 30;
  const auto c = PairConstants<double>::of(liquid);
  const Vec3d w{0.3, -1.2, 2}, x{0.4, 0.1, -0.2}, y{0.45, 0.2, -0.05};
  const ParticleState<double> i{cross(w, x), 0, {}, 1e-3}, j{cross(w, y), 0, {}, 1e-3};
  const Vec3d d = x - y;
  EXPECT_LT(norm(pair_terms(c, d, norm2(d), i, j).viscous * d), 1e-15);
  // Any force is along the line between the two, and so keeps the angular momentum.
  const ParticleState<double> k{{0.7, -2, 0.3}, 0, {}, 1e-3};
  EXPECT_GT(std::fabs(pair_terms(c, d, norm2(d), i, k).viscous), 1e-3);
}

// After a step of a thousandth, which ends at a sample, a rate is not extrapolated by a factor of 500.
TEST(TimeStep, ExtrapolatesUpToTwiceTheLastStep) {
  EXPECT_EQ(extrapolation_weight(1e-3, 0), 0.5) << "the first step";
  EXPECT_EQ(extrapolation_weight(1e-3, 1e-3), 0.5);
  EXPECT_EQ(extrapolation_weight(1e-6, 1e-3), 0.5e-3);
  EXPECT_EQ(extrapolation_weight(2e-3, 1e-3), 1);
  EXPECT_EQ(extrapolation_weight(2.1e-3, 1e-3), 0);
}

TEST(Spray, BearsNoTensionAndReturnsToRest) {
  constexpr double own = 0.12;
  for (const double shadow : {0.0, 0.45, 0.9})
    EXPECT_EQ(tension_share(filled_room(0, own, shadow)), 0) << "a particle alone, also beside walls";
  EXPECT_EQ(tension_share(filled_room(0.12, own, 0.4)), 0) << "a row that leaves a wall";
  EXPECT_EQ(tension_share(filled_room(0.62, own, 0)), 1) << "a free surface";
  EXPECT_NEAR(filled_room(0.38, own, 0.5), 1, 1e-12) << "a liquid at a wall";
  EXPECT_NEAR(tension_share(0.46), 0.5, 1e-12);
  Liquid l;
  l.sound_speed = 30;
  l.spacing = 0.01;
  EXPECT_EQ(borne(l, -100, 0.25), -25);
  EXPECT_EQ(borne(l, 100, 0.25), 100) << "pressure is borne by all";
  EXPECT_NEAR(borne(l, -1e6, 1), -0.5 * 1000 * 3 * 3, 1e-9) << "the stagnation pressure at Mach 0.1";
  EXPECT_NEAR(closing_rate(l, -0.02, 0), 0.02 * 30 / (4 * 0.015), 1e-12);
  EXPECT_EQ(closing_rate(l, -0.004, 1), 0);
  EXPECT_NEAR(closing_rate(l, -0.02, 1), 0.015 * 30 / (4 * 0.015), 1e-12) << "cavitates";
  EXPECT_EQ(closing_rate(l, 0.02, 0), 0);
}

TEST(WallRepulsion, GivesAParticleNoMoreThanItBrought) {
  Liquid l;
  l.sound_speed = 30;
  l.spacing = 0.01;
  const WallRepulsion r = WallRepulsion::of(l);
  for (const double factor : {0.1, 0.25, 0.35}) {  // of h / c, steps of Adams and Bashforth
    const double dt = factor * l.h() / l.sound_speed, came = -0.1 * l.sound_speed;
    double x = r.range, v = came, last = 0;
    do {
      const double a = x < r.range ? r.of_nearest(x, v) : 0, mean = 1.5 * a - 0.5 * last;
      x += dt * (v + 0.5 * dt * mean);
      v += dt * mean;
      last = a;
    } while (x < 1.5 * r.range);
    EXPECT_LE(v, -came) << factor;
    EXPECT_GE(v, -0.85 * came) << factor;
  }
  EXPECT_EQ(r.of_nearest(0.99 * r.range, l.sound_speed), 0) << "it never pulls";
}

TEST(Crowding, RaisesTheDensityToWhatIsTooMuch) {
  Liquid l;
  l.sound_speed = 30;
  l.spacing = 0.01;
  EXPECT_EQ(crowding_rate(l, 0, 1.1), 0) << "beside walls in a flow";
  EXPECT_EQ(crowding_rate(l, 0.004, crowded + 0.003), 0);
  EXPECT_GT(crowding_rate(l, 0.004, crowded + 0.006), 0);
  EXPECT_EQ(crowding_rate(l, 0.02, 2.5), 0) << "the liquid is compressed already";
  EXPECT_EQ(crowding_rate(l, 0, 2.5), crowding_rate(l, 0, 1.2)) << "to a bound";
  EXPECT_NEAR(crowding_rate(l, 0, 2.5) * 4 * l.h() / l.sound_speed, largest_crowding, 1e-15);
}

TEST(WallRepulsion, StopsAQuarterOfTheSpeedOfSound) {
  Liquid l;
  l.sound_speed = 30;
  l.spacing = 0.01;
  const WallRepulsion r = WallRepulsion::of(l);
  double work = 0;
  for (int k = 0; k < 1000; ++k) work += r.acceleration((k + 0.5) / 1000 * r.range) * r.range / 1000;
  EXPECT_NEAR(std::sqrt(2 * work), 0.25 * l.sound_speed, 1e-6 * l.sound_speed);
  EXPECT_EQ(r.acceleration(r.range), 0);
}

// In a slot the ghosts' gradient would make of any force many times itself; the bound is that of the spectral
// radius, so that it does not depend on the axes.
TEST(GhostShare, IsBoundedInSlotsWhateverTheAxes) {
  const auto slot = [](Vec3d n) {  // -0.97 along n, -0.5 across it
    Mat3d M;
    for (int a = 0; a < 3; ++a) {
      M.row[a] = (-0.47 * n[a]) * n;
      M.row[a][a] -= 0.5;
    }
    return M;
  };
  const double share = ghost_share(0.5, 1, slot({0, 0, 1}));
  EXPECT_GT(share * 0.97, 0.8);
  EXPECT_LE(share * 0.97, 0.9 + 1e-12);
  EXPECT_NEAR(ghost_share(0.5, 1, slot({0.6, 0, 0.8})), share, 1e-12);
  EXPECT_EQ(ghost_share(0, 1, slot({0, 0, 1})), 0) << "without neighbours";
  EXPECT_EQ(ghost_share(0.5, 0.7, Mat3d{}), 1) << "a free surface";
}

TEST(StepLimits, NameTheSmallest) {
  Liquid liquid;
  liquid.sound_speed = 20;
  liquid.spacing = 0.01;
  const double h = 0.015;
  StepLimits limits = step_limits(liquid, 2, 0);
  EXPECT_DOUBLE_EQ(limits.smallest, 0.3 * h / 22);
  liquid.viscosity = 1e4;
  limits = step_limits(liquid, 2, 0);
  EXPECT_DOUBLE_EQ(limits.smallest, 0.05 * h * h * 1000 / 1e4);
  EXPECT_DOUBLE_EQ(step_limits(liquid, 0, 1e9).smallest, 0.25 * std::sqrt(h / 1e9));
}

TEST(Liquid, OfPropertiesOutOfRangeIsRefused) {
  Liquid liquid;
  liquid.spacing = 0.01;
  EXPECT_EQ(error_of([&] { expect_liquid(liquid); }),
            "scene: sound_speed: sound_speed of the liquid is 0 (give a value above 0 m/s)");
  liquid.sound_speed = 20;
  liquid.smoothing = 1;
  EXPECT_EQ(error_of([&] { expect_liquid(liquid); }),
            "scene: smoothing: smoothing of the liquid is 1 (give a value from 1.2 to 2.5)");
}

Rim rim_of(std::initializer_list<Vec3d> bodies) {
  Rim rim;
  for (const Vec3d& body : bodies) rim.sum += body;
  for (const Vec3d& body : bodies) rim.add_body(body);
  return rim;
}

TEST(Rim, IsSharedOutOverTheBodies) {
  const Vec3d one{3, 1, -2}, other{1, -1, 0.5};
  const Rim rim = rim_of({one, other});
  EXPECT_NEAR(norm(rim.share(one) + rim.share(other) - rim.sum), 0, 1e-15);
  EXPECT_EQ(rim_of({one}).share(one), one);
  // A body in front of another one, whose ghosts border on those of the first beyond its edge.
  const Vec3d behind{-1, 0, 1};
  EXPECT_EQ(rim_of({one, behind}).share(behind), Vec3d{});
  // Two bodies that join.
  EXPECT_EQ(rim_of({one, -one}).share(one), Vec3d{});
}

TEST(Walls, HaveAContinuityThatIsTheAdjointOfTheirPressure) {
  Liquid liquid;
  liquid.spacing = 0.01;
  const auto c = WallConstants::of(liquid);
  const Vec3d surface{20, -7, 3}, v{0.2, 0.5, -0.1};
  const double pressure = 900, volume = 1.02e-6;
  EXPECT_NEAR(liquid.mass() * dot(wall_pressure(c, surface, pressure, volume), v),
              -pressure * volume * wall_continuity(surface, v), 1e-15);
}

}  // namespace
}  // namespace tandem::test
