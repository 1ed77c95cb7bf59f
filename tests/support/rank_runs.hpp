// Runs of a particle engine on any number of ranks, which are threads here, to be compared bit by bit.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "dem_server/coupling/state_hash.hpp"
#include "tests/support/particle_run.hpp"
#include "tests/support/particle_scenes.hpp"
#include "tests/support/tested_backend.hpp"
#include "tests/support/thread_ranks.hpp"

namespace tandem::test {

inline constexpr double rank_dt = 2e-5;  // [s]

// What a run reports, to be compared bit by bit.
struct RankResult {
  std::string hash;
  std::vector<double> values;
  std::vector<double> frame;                           // on rank 0
  std::uint64_t rebuilds = 0, contacts = 0, lost = 0;  // contacts: the most after a window

  void add(const Vec3d& v) { values.insert(values.end(), {v.x, v.y, v.z}); }
  void add(const dem::WindowOutcome& o) {
    for (const Wrench& load : o.load) add(load.force), add(load.torque);
    for (const dem::Totals& t : {o.begin, o.end}) {
      add(t.momentum);
      values.insert(values.end(), {t.mass, t.kinetic_energy, static_cast<double>(t.contacts)});
    }
    add(o.lost_momentum), add(o.gravity_impulse);
    values.insert(values.end(), {o.max_overlap_ratio, o.max_speed, o.skin, static_cast<double>(o.window.used),
                                 static_cast<double>(o.window.lost)});
    values.insert(values.end(), o.wall_means.begin(), o.wall_means.end());
    values.insert(values.end(), o.belt_pull.begin(), o.belt_pull.end());
    rebuilds = o.window.rebuilds, lost = o.window.lost;
    contacts = std::max(contacts, o.end.contacts);
  }
};

// Of falling_spheres().
struct LawOfRanks {
  const char *name, *contact, *options;
};
inline void PrintTo(const LawOfRanks& law, std::ostream* out) {
  *out << law.name;
}

// Enough to be on four ranks.
inline std::string few_spheres(const std::string& law, const std::string& options = "") {
  return falling_spheres(law, options, std::min(300, falling_count));
}

struct RankCase {
  std::string json;
  int windows = 6;
  std::uint32_t steps = 400;
  void (*change)(particles::Spheres&) = [](particles::Spheres&) {};
  // Between two windows, on all ranks.
  void (*between)(ParticleRun&, int window, RankResult&) = [](ParticleRun&, int, RankResult&) {};
  std::vector<std::vector<std::int64_t>> weights = {};  // of the ranks, window after window
};

inline RankResult result_of(const RankCase& c, ThreadRanks* ranks) {
  ParticleRun run(c.json, tested_backend(), 1, c.change, {}, ranks);
  RankResult result;
  for (int w = 0; w < c.windows; ++w) {
    c.between(run, w, result);
    if (ranks != nullptr && !c.weights.empty())
      ranks->set_weights(c.weights[static_cast<std::size_t>(w) % c.weights.size()]);
    result.add(run.advance(c.steps, rank_dt));
  }
  result.hash = dem::state_hash(run.state());
  return result;
}

inline RankResult expect_same_bits(const RankCase& c, const std::vector<unsigned>& sizes = {2, 3}) {
  const RankResult one = result_of(c, nullptr);
  EXPECT_GE(one.rebuilds, 3u);
  EXPECT_GT(one.contacts, 0u);
  for (const unsigned size : sizes)
    on_ranks(size, [&](ThreadRanks& ranks) {
      const RankResult found = result_of(c, &ranks);
      if (ranks.rank() == 0) {
        EXPECT_EQ(found.hash, one.hash) << size << " ranks";
        EXPECT_EQ(found.frame, one.frame) << size << " ranks";
      }
      EXPECT_EQ(found.values, one.values) << "rank " << ranks.rank() << " of " << size;
      EXPECT_EQ(found.rebuilds, one.rebuilds);
    });
  return one;
}

}  // namespace tandem::test
