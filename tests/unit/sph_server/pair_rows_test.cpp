#include "sph_server/step/pair_rows.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>
#include <vector>

namespace tandem::sph {
namespace {

template <bool shifting>
void expect_the_bits_of_lanes(std::uint32_t count, double artificial) {
  Liquid liquid;
  liquid.spacing = 0.01;
  liquid.sound_speed = 20;
  liquid.viscosity = 0.3;
  liquid.artificial = artificial;
  std::mt19937 random(count);
  std::uniform_real_distribution<float> u(-1, 1);
  SumPairs<float, shifting> pairs;
  pairs.pair = PairConstants<float>::of(liquid);
  pairs.apart.unit = particles::LengthUnit<float>::for_lengths(1);
  const auto range = particles::Quantum::for_range(1e12);
  pairs.of_acceleration = particles::AddendScale<float>::of(range, 1e8);
  pairs.of_rate = particles::AddendScale<float>::of(range, 1e6);
  std::vector<particles::PositionRadius<float>> position(count);
  std::vector<ParticleState<float>> state(count);
  std::vector<Neighbour> entry;
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto place = [&] { return pairs.apart.unit.count(0.032 * static_cast<double>(u(random))); };
    position[k] = {place(), place(), place(), 0};
    state[k] = {{u(random), u(random), u(random)}, 1000 * u(random), {u(random), u(random), -9810}, 1e-6F};
    if (k > 0) entry.emplace_back(k, particles::Image{0});
  }
  position[0] = {};
  const std::uint32_t start[1] = {0}, end[1] = {count - 1};
  pairs.liquid.position = position.data();
  pairs.liquid.state = state.data();
  pairs.liquid.neighbours = {start, end, entry.data()};

  auto expected = pairs.of_lane(0, 0), others = pairs.of_lane(0, 2);
  expected.add(pairs.of_lane(0, 1));
  others.add(pairs.of_lane(0, 3));
  expected.add(others);
  const auto found = std::make_unique<PairRows<shifting>>()->of(pairs, 0);
  for (int a = 0; a < 3; ++a) EXPECT_EQ(found.acceleration[a], expected.acceleration[a]);
  EXPECT_EQ(found.continuity, expected.continuity);
  EXPECT_EQ(found.diffusion, expected.diffusion);
  EXPECT_EQ(found.viscous, expected.viscous);
  EXPECT_EQ(found.viscous_power, expected.viscous_power);
  EXPECT_EQ(found.filled, expected.filled);
  EXPECT_EQ(found.burst, expected.burst);
  if constexpr (shifting) {
    EXPECT_EQ(found.crowding.gradient, expected.crowding.gradient);
    EXPECT_EQ(found.crowding.deformation, expected.crowding.deformation);
  }
  if (count > 100) {
    EXPECT_NE(found.acceleration[0], 0);
  }
}

TEST(PairRows, HaveTheBitsOfTheLanes) {
  for (const std::uint32_t count : {2u, 3u, 150u, 257u, 1500u})
    for (const double artificial : {0.0, 0.1}) {
      expect_the_bits_of_lanes<false>(count, artificial);
      expect_the_bits_of_lanes<true>(count, artificial);
    }
}

}  // namespace
}  // namespace tandem::sph
