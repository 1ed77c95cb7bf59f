// Any number of ranks gives the bits of one process: positions, loads, totals. Ranks are threads here.
#include <gtest/gtest.h>

#include <algorithm>

#include "dem_server/coupling/state_hash.hpp"
#include "tests/support/boulder.hpp"
#include "tests/support/particle_run.hpp"
#include "tests/support/particle_scenes.hpp"
#include "tests/support/periodic_scene.hpp"
#include "tests/support/thread_ranks.hpp"

namespace tandem::test {
namespace {

using particles::Backend;

constexpr double dt = 2e-5;  // [s]

// What a run reports, to be compared bit by bit.
struct Result {
  std::string hash;
  std::vector<double> values;
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

struct Case {
  std::string json;
  int windows = 6;
  std::uint32_t steps = 400;
  void (*change)(particles::Spheres&) = [](particles::Spheres&) {};
  // Between two windows, on all ranks.
  void (*between)(ParticleRun&, int window, Result&) = [](ParticleRun&, int, Result&) {};
};

Result result_of(const Case& c, particles::Ranks* ranks) {
  ParticleRun run(c.json, Backend::cpu, 1, c.change, {}, ranks);
  Result result;
  for (int w = 0; w < c.windows; ++w) {
    c.between(run, w, result);
    result.add(run.advance(c.steps, dt));
  }
  result.hash = dem::state_hash(run.state());
  return result;
}

// `most_ranks` from 2 on.
Result expect_same_bits(const Case& c, unsigned most_ranks = 4) {
  const Result one = result_of(c, nullptr);
  EXPECT_GE(one.rebuilds, 3u);
  EXPECT_GT(one.contacts, 0u);
  for (unsigned size = 1; size <= most_ranks; ++size)
    on_ranks(size, [&](ThreadRanks& ranks) {
      const Result found = result_of(c, &ranks);
      if (ranks.rank() == 0) {
        EXPECT_EQ(found.hash, one.hash) << size << " ranks";
      }
      EXPECT_EQ(found.values, one.values) << "rank " << ranks.rank() << " of " << size;
      EXPECT_EQ(found.rebuilds, one.rebuilds);
    });
  return one;
}

struct Law {
  const char *name, *contact, *options;
};
void PrintTo(const Law& law, std::ostream* out) {
  *out << law.name;
}
class LawOverRanks : public testing::TestWithParam<Law> {};
INSTANTIATE_TEST_SUITE_P(
    Laws, LawOverRanks,
    testing::Values(Law{"hertz_mindlin", "hertz_mindlin", ""}, Law{"frictionless", "hertz_frictionless", ""},
                    Law{"paper", "paper", ""}, Law{"double", "hertz_mindlin", R"("precision": "double",)"},
                    Law{"frictionless_double", "hertz_frictionless", R"("precision": "double",)"},
                    Law{"hooke", "hooke", ""},
                    Law{"jkr_rolling", "jkr",
                        R"("rolling": "elastic_plastic", "twisting": "elastic_plastic",)"},
                    Law{"sjkr_double", "sjkr", R"("precision": "double", "rolling": "elastic_plastic",)"}),
    [](const auto& law) { return std::string(law.param.name); });

TEST_P(LawOverRanks, GivesTheBitsOfOneProcess) {
  expect_same_bits({falling_spheres(GetParam().contact, GetParam().options)});
}

TEST(Ranks, OfABoulderAmongSmallSpheres) {
  Case c{falling_spheres("hertz_mindlin", "", 401), 8, 25, make_boulder};
  EXPECT_GT(expect_same_bits(c).contacts, 100u);
}

TEST(Ranks, AcrossPeriodicFaces) {
  Case c{chute(nlohmann::json::object()).json(), 10, 400};
  EXPECT_GT(expect_same_bits(c).contacts, 100u);
}

TEST(Ranks, MoreThanBlocksOfCells) {
  // Most ranks have no sphere.
  expect_same_bits({falling_spheres("hertz_mindlin", "", 20), 10, 400}, 7);
}

TEST(Ranks, RestoredContinueToTheSameBits) {
  Case c{falling_spheres("hertz_mindlin")};
  c.windows = 9;
  c.between = [](ParticleRun& run, int window, Result&) {
    if (window == 4) run.engine->save();
    if (window == 7) run.engine->restore();
  };
  expect_same_bits(c, 3);
}

}  // namespace
}  // namespace tandem::test
