// Positions in quanta of length: distances are exact wherever the spheres are, and the quick test misses no
// contact.
#include "dem_server/contact/approach.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "dem_server/contact/parameters.hpp"

namespace tandem::dem::test {
namespace {

constexpr double radius = 0.01, skin = 0.0025;  // [m]

Parameters<float> quanta() {
  Parameters<float> p;
  p.unit = LengthUnit<float>::for_lengths(2 * (radius + skin));
  return p;
}
PositionRadius<float> placed(Vec3d x) {
  const Parameters<float> p = quanta();
  return p.placed(x, p.unit.count(radius));
}

TEST(Approach, OverlapIsThatOfDoublePrecisionFarFromTheOrigin) {
  // 1e-4 radii of overlap, 1 km away, where a single-precision coordinate resolves 6e-5 m.
  const Vec3d at{1000, -700, 300}, n = normalized(Vec3d{1, 2, -2});
  double worst = 0;
  for (const double overlap : {1e-6, 1e-5, 1e-3}) {
    const Vec3d from = at + (2 * radius - overlap) * n;
    Vec3f normal;
    const Approach<float> approach(placed(from), placed(at));
    ASSERT_TRUE(approach.touching());
    const double seen = static_cast<double>(overlap_of(approach.separation(), quanta().unit, normal));
    worst = std::max(worst, std::abs(seen - overlap));
    EXPECT_NEAR(norm(normal.as<double>() - n), 0, 2e-7);
  }
  // Both centres are rounded to 2^-35 m, and coordinates near 1 km have 1e-13 m themselves.
  std::printf("largest error of the overlap: measured %.2e m, tolerance %.1e m\n", worst, 1.5e-10);
  EXPECT_LT(worst, 1.5e-10);
}

TEST(Approach, IsOddAndSeesAcrossTheWrap) {
  const double half_range = 0.5 * std::ldexp(1.0, 32) * static_cast<double>(quanta().unit.size);
  const PositionRadius<float> a = placed({half_range - 0.004, 0, 0}), b = placed({half_range + 0.006, 0, 0});
  EXPECT_GT(a.x, 0);
  EXPECT_LT(b.x, 0);
  const Approach<float> from_a(a, b), from_b(b, a);
  EXPECT_TRUE(from_a.touching());
  Vec3f n_a, n_b;
  EXPECT_EQ(overlap_of(from_a.separation(), quanta().unit, n_a),
            overlap_of(from_b.separation(), quanta().unit, n_b));
  EXPECT_EQ(n_a, -n_b);
  EXPECT_NEAR(static_cast<double>(n_a.x), -1, 1e-7);
}

TEST(Approach, QuickTestMissesNoContactAndLetsFewOthersPass) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  int touching = 0, passed = 0;
  for (int k = 0; k < 200000; ++k) {
    const PositionRadius<float> a = placed({}),
                                b = placed(2.2 * radius * Vec3d{unit(random), unit(random), unit(random)});
    const bool touches = Approach<float>(a, b).touching(), may = Approach<float>::may_touch(a, b);
    ASSERT_TRUE(may || !touches);
    touching += touches;
    passed += may;
  }
  std::printf("%d of 200000 touch, %d pass the quick test\n", touching, passed);
  EXPECT_GT(touching, 50000);
  EXPECT_LT(passed, 1.002 * touching);
}

TEST(Approach, NearIsTouchingWithAMarginHoweverFarApart) {
  std::mt19937 random(4);
  std::uniform_int_distribution<std::int32_t> quanta(-(1 << 29), 1 << 29);
  const std::int32_t reach = 1 << 28, margin = 1 << 27;
  int near = 0;
  for (int k = 0; k < 100'000; ++k) {
    const PositionRadius<float> a{quanta(random), quanta(random), quanta(random), reach},
        b{quanta(random), quanta(random), quanta(random), reach};
    ASSERT_EQ(Approach<float>::near(a, b, margin), Approach<float>(a, b, margin).touching());
    near += Approach<float>::near(a, b, margin);
  }
  EXPECT_GT(near, 1'000);
  EXPECT_LT(near, 99'000);
  // The largest distance of positions: 3 * 2^62 quanta^2, a negative number in 64 bits.
  constexpr std::int32_t farthest = std::numeric_limits<std::int32_t>::min();
  const PositionRadius<float> here{0, 0, 0, reach};
  EXPECT_FALSE(Approach<float>::near(here, {farthest, farthest, farthest, reach}, margin));
  EXPECT_FALSE(Approach<float>::near(here, {farthest, 0, 0, reach}, margin));
  EXPECT_FALSE(Approach<float>::near(here, here, margin));
}

TEST(Approach, ParkedSphereTouchesNobody) {
  PositionRadius<float> gone = placed({});
  gone.radius = parked_radius<float>;
  EXPECT_FALSE(Approach<float>(placed({0.001, 0, 0}), gone).touching());
  EXPECT_FALSE(Approach<float>(gone, gone).touching());
  PositionRadius<double> gone_double{0, 0, 0, parked_radius<double>};
  EXPECT_FALSE(Approach<double>(PositionRadius<double>{0.001, 0, 0, radius}, gone_double).touching());
}

// Eight kinds are tabulated, nine are computed: the same spheres must get the same numbers.
TEST(Parameters, TablesGiveWhatTheFormulasGive) {
  Parameters<float> p = quanta();
  p.materials = 2;
  p.mass_per_volume[0] = 1e4F;
  p.mass_per_volume[1] = 3e4F;
  for (std::uint32_t a = 0; a < 2; ++a)
    for (std::uint32_t b = 0; b < 2; ++b)
      p.pair[a * max_materials + b].c = {1e7F * static_cast<float>(1 + a + b), 0.3F, 0.8F, 0.7F, 0.2F, 0};
  Spheres spheres;
  for (std::uint32_t k = 0; k < max_kinds; ++k) {
    spheres.material.push_back(k % 2);
    spheres.radius.push_back(radius * (1 - 0.05 * k));
    spheres.id.push_back(k);
  }
  tabulate_kinds(p, spheres);
  ASSERT_EQ(p.kinds, max_kinds);
  const std::vector<std::uint32_t> kind = kinds_of(p, spheres);
  const auto r = [&](std::uint32_t k) { return p.unit.metres(p.unit.count(spheres.radius[k])); };
  for (std::uint32_t a = 0; a < max_kinds; ++a) {
    EXPECT_EQ(p.material(kind[a]), spheres.material[a]);
    const Inertia table = p.inertia(kind[a], r(a)), formula = p.computed_inertia(spheres.material[a], r(a));
    EXPECT_EQ(table.mass, formula.mass);
    EXPECT_EQ(table.inverse_moment, formula.inverse_moment);
    for (std::uint32_t b = 0; b < max_kinds; ++b) {
      const Coefficients<float> t = p.between(kind[a], r(a), kind[b], r(b));
      const Coefficients<float> f = p.computed_pair(spheres.material[a], r(a), spheres.material[b], r(b));
      EXPECT_EQ(t.k_n, f.k_n);
      EXPECT_EQ(t.c_n, f.c_n);
      EXPECT_EQ(t.k_t, f.k_t);
      EXPECT_EQ(t.c_t, f.c_t);
      EXPECT_EQ(t.curvature, f.curvature);
    }
  }
  spheres.material.push_back(0);
  spheres.radius.push_back(radius / 2);
  spheres.id.push_back(max_kinds);
  tabulate_kinds(p, spheres);
  EXPECT_EQ(p.kinds, 0u);
}

}  // namespace
}  // namespace tandem::dem::test
