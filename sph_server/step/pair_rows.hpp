// The sums of one particle over its neighbours on a CPU: neighbours are gathered into columns with one row
// per pair, so that a compiler can evaluate several rows at once. The terms are those of all back ends
// (equations/pair_terms.hpp), inlined into the loop over rows, and the sums have the bits of
// SumPairs::of_lane.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "sph_server/step/pair_sums.hpp"

namespace tandem::sph {

// Not with sanitizers: they instrument the function that selects the clone, which runs at program start
// before they are initialised.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__SANITIZE_ADDRESS__)
#define TANDEM_WIDE_ROWS __attribute__((target_clones("default", "arch=x86-64-v3")))
#else
#define TANDEM_WIDE_ROWS
#endif

template <bool shifting>
class PairRows {
 public:
  using Sums = PairSums<float, shifting>;

  // The sums of all lanes, added up as (0 + 1) + (2 + 3).
  Sums of(const SumPairs<float, shifting>& pairs, std::uint32_t i) {
    Sums lane_sums[lanes];
    std::fill_n(addends_, lanes, 0u);
    const ListView<Neighbour>& list = pairs.liquid.neighbours;
    const ParticleState<float> self = pairs.liquid.state[i];
    for (std::uint32_t n = list.start[i]; n < list.end[i];) {
      const std::uint32_t end = std::min<std::uint32_t>(list.end[i], n + most_rows);
      gather(pairs, i, n, end);
      evaluate(pairs, self, lane_sums[0]);
      add_to_lanes(lane_sums);
      n = end;
    }
    for (const std::uint32_t addends : addends_)
      lane_sums[0].burst |= addends > particles::most_addends ? 1u : 0u;
    lane_sums[0].add(lane_sums[1]);
    lane_sums[2].add(lane_sums[3]);
    lane_sums[0].add(lane_sums[2]);
    return lane_sums[0];
  }

 private:
  static constexpr std::uint32_t most_rows = 256;  // a multiple of the lanes, at most ExactSum's addends
  struct Columns {
    alignas(32) float at[most_rows];
    float& operator[](std::size_t row) { return at[row]; }
    float operator[](std::size_t row) const { return at[row]; }
  };
  struct VectorColumns {
    Columns x, y, z;
    void put(std::size_t row, Vec3f v) {
      x[row] = v.x;
      y[row] = v.y;
      z[row] = v.z;
    }
    Vec3f operator[](std::size_t row) const { return {x[row], y[row], z[row]}; }
  };

  void gather(const SumPairs<float, shifting>& pairs, std::uint32_t i, std::uint32_t begin,
              std::uint32_t end) {
    const particles::PositionRadius<float> here = pairs.liquid.position[i];
    const std::uint32_t first = pairs.liquid.neighbours.start[i];
    count_ = 0;
    for (std::uint32_t n = begin; n < end; ++n) {
      const Neighbour neighbour = pairs.liquid.neighbours.entry[n];
      const std::uint32_t j = neighbour.index();
      const Vec3f d = pairs.apart(here, pairs.liquid.position[j], neighbour.image());
      const float r2 = norm2(d);
      if (r2 >= pairs.pair.support2) continue;
      const ParticleState<float>& other = pairs.liquid.state[j];
      d_.put(count_, d);
      r2_[count_] = r2;
      v_.put(count_, other.v);
      pressure_[count_] = other.pressure;
      slope_.put(count_, other.slope);
      volume_[count_] = other.volume;
      lane_[count_++] = static_cast<std::uint8_t>((n - first) % lanes);
    }
  }

  // What does not depend on the order is added to `sum`, the rest becomes columns.
  void evaluate(const SumPairs<float, shifting>& pairs, const ParticleState<float>& self, Sums& sum) {
    std::uint32_t high[5]{}, low[5]{}, burst = 0;
    evaluate_rows(pairs.pair, pairs.of_acceleration, pairs.of_rate, self, high, low, burst);
    const auto value = [&](int k, const particles::AddendScale<float>& scale) {
      return particles::ExactSum<float>(high[k], low[k]).value(scale, static_cast<std::uint32_t>(count_));
    };
    for (int a = 0; a < 3; ++a) sum.acceleration[a] += value(a, pairs.of_acceleration);
    sum.continuity += value(3, pairs.of_rate);
    sum.diffusion += value(4, pairs.of_rate);
    sum.burst |= burst;
  }

  TANDEM_WIDE_ROWS [[gnu::flatten]] void evaluate_rows(const PairConstants<float>& pair,
                                                       const particles::AddendScale<float>& of_acceleration,
                                                       const particles::AddendScale<float>& of_rate,
                                                       const ParticleState<float>& self,
                                                       std::uint32_t (&high)[5], std::uint32_t (&low)[5],
                                                       std::uint32_t& burst) {
    // Locals, since columns could overlap what references name.
    const PairConstants<float> c = pair;
    const particles::AddendScale<float> scale = of_acceleration, rate = of_rate;
    const ParticleState<float> own = self;
    std::uint32_t h0 = 0, h1 = 0, h2 = 0, h3 = 0, h4 = 0, l0 = 0, l1 = 0, l2 = 0, l3 = 0, l4 = 0, beyond = 0;
    for (std::size_t row = 0; row < count_; ++row) {
      const Vec3f d = d_[row];
      const ParticleState<float> other{v_[row], pressure_[row], slope_[row], volume_[row]};
      const PairTerms<float> t = pair_terms(c, d, r2_[row], own, other);
      const float factor = t.pressure + t.viscous;
      add(factor * d.x, scale, h0, l0);
      add(factor * d.y, scale, h1, l1);
      add(factor * d.z, scale, h2, l2);
      add(t.continuity, rate, h3, l3);
      add(t.diffusion, rate, h4, l4);
      beyond |= is_beyond(t, factor, c, scale, rate) ? 1u : 0u;
      viscous_.x[row] = t.viscous * d.x;
      viscous_.y[row] = t.viscous * d.y;
      viscous_.z[row] = t.viscous * d.z;
      power_[row] = t.viscous * t.approach;
      filled_[row] = volume_[row] * t.kernel;
      if constexpr (shifting) {
        Crowding<float, true> one;
        one.add(c, d, t, volume_[row]);
        crowding_.x[row] = one.gradient.x;
        crowding_.y[row] = one.gradient.y;
        crowding_.z[row] = one.gradient.z;
        deformation_[row] = one.deformation;
      }
    }
    const std::uint32_t highs[5] = {h0, h1, h2, h3, h4}, lows[5] = {l0, l1, l2, l3, l4};
    std::copy(highs, highs + 5, high);
    std::copy(lows, lows + 5, low);
    burst = beyond;
  }
  // See ExactSum::add().
  static void add(float x, const particles::AddendScale<float>& scale, std::uint32_t& high,
                  std::uint32_t& low) {
    const float rounded = x + scale.coarse, rest = x - (rounded - scale.coarse);
    high += std::bit_cast<std::uint32_t>(rounded);
    low += std::bit_cast<std::uint32_t>(rest + scale.fine);
  }

  void add_to_lanes(Sums (&sum)[lanes]) {
    for (std::size_t row = 0; row < count_; ++row) {
      Sums& s = sum[lane_[row]];
      ++addends_[lane_[row]];
      s.viscous += viscous_[row];
      s.viscous_power += power_[row];
      s.filled += filled_[row];
      if constexpr (shifting) {
        s.crowding.gradient += crowding_[row];
        s.crowding.deformation += deformation_[row];
      }
    }
  }

  std::size_t count_ = 0;
  std::uint32_t addends_[lanes]{};  // so far
  VectorColumns d_, v_, slope_, viscous_, crowding_;
  Columns r2_, pressure_, volume_, power_, filled_, deformation_;
  std::uint8_t lane_[most_rows];
};

}  // namespace tandem::sph
