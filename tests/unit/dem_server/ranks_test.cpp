// Any number of ranks gives the bits of one process: positions, loads, totals. Ranks are threads here.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <nlohmann/json.hpp>

#include "dem_server/coupling/ranked_solver.hpp"
#include "dem_server/coupling/state_hash.hpp"
#include "dem_server/engine/rank_share.hpp"
#include "tests/support/boulder.hpp"
#include "tests/support/particle_run.hpp"
#include "tests/support/particle_scenes.hpp"
#include "tests/support/periodic_scene.hpp"
#include "tests/support/solver_run.hpp"
#include "tests/support/thread_ranks.hpp"
#include "tests/support/tool_scene.hpp"

namespace tandem::test {
namespace {

using particles::Backend;

constexpr double dt = 2e-5;  // [s]

// What a run reports, to be compared bit by bit.
struct Result {
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

struct Case {
  std::string json;
  int windows = 6;
  std::uint32_t steps = 400;
  void (*change)(particles::Spheres&) = [](particles::Spheres&) {};
  // Between two windows, on all ranks.
  void (*between)(ParticleRun&, int window, Result&) = [](ParticleRun&, int, Result&) {};
  std::vector<std::vector<std::int64_t>> weights = {};  // of the ranks, window after window
};

Result result_of(const Case& c, ThreadRanks* ranks) {
  ParticleRun run(c.json, Backend::cpu, 1, c.change, {}, ranks);
  Result result;
  for (int w = 0; w < c.windows; ++w) {
    c.between(run, w, result);
    if (ranks != nullptr && !c.weights.empty())
      ranks->set_weights(c.weights[static_cast<std::size_t>(w) % c.weights.size()]);
    result.add(run.advance(c.steps, dt));
  }
  result.hash = dem::state_hash(run.state());
  return result;
}

Result expect_same_bits(const Case& c, const std::vector<unsigned>& sizes = {2, 3}) {
  const Result one = result_of(c, nullptr);
  EXPECT_GE(one.rebuilds, 3u);
  EXPECT_GT(one.contacts, 0u);
  for (const unsigned size : sizes)
    on_ranks(size, [&](ThreadRanks& ranks) {
      const Result found = result_of(c, &ranks);
      if (ranks.rank() == 0) {
        EXPECT_EQ(found.hash, one.hash) << size << " ranks";
        EXPECT_EQ(found.frame, one.frame) << size << " ranks";
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
  expect_same_bits({falling_spheres(GetParam().contact, GetParam().options), 5, 400}, {2, 4});
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
  expect_same_bits({falling_spheres("hertz_mindlin", "", 20), 10, 200}, {1, 7});
}

TEST(Ranks, WithUnevenSharesThatChange) {
  Case c{falling_spheres("hertz_mindlin"), 8, 400};
  c.weights = {{1, 1, 1}, {10, 1, 1}, {1, 0, 5}, {0, 0, 1}, {3, 20, 1}};
  expect_same_bits(c, {3});
}

TEST(CellShares, AreInProportionToTheWeights) {
  const std::vector<std::int64_t> spheres(100, 12);  // in each block
  const auto blocks = [&](const std::vector<std::int64_t>& weights) {
    const dem::CellShares shares(spheres, weights);
    std::vector<std::uint32_t> found;
    for (unsigned rank = 0; rank < weights.size(); ++rank) {
      const particles::Range cells = shares.of(rank);
      found.push_back((cells.end - cells.begin) / dem::CellShares::cells_per_block);
      if (cells.begin < cells.end) {
        EXPECT_EQ(shares.owner(cells.begin), rank);
        EXPECT_EQ(shares.owner(cells.end - 1), rank);
      }
    }
    return found;
  };
  using Blocks = std::vector<std::uint32_t>;
  EXPECT_EQ(blocks({1}), Blocks{100});
  EXPECT_EQ(blocks({1, 1, 1, 1}), (Blocks{25, 25, 25, 25}));
  EXPECT_EQ(blocks({1, 3}), (Blocks{25, 75}));
  EXPECT_EQ(blocks({1, 0, 1}), (Blocks{50, 0, 50}));
  EXPECT_EQ(blocks({0, 1}), (Blocks{0, 100}));
}

TEST(Ranks, RestoredContinueToTheSameBits) {
  Case c{falling_spheres("hertz_mindlin")};
  c.windows = 9;
  c.between = [](ParticleRun& run, int window, Result&) {
    if (window == 4) run.engine->save();
    if (window == 7) run.engine->restore();
  };
  expect_same_bits(c, {3});
}

// Spheres that leave through an outlet, and later come in at the top, where other ranks have their cells.
TEST(Ranks, WithSpheresThatGoOutAndComeIn) {
  Case c{falling_spheres("hertz_mindlin"), 12, 150, [](particles::Spheres& s) { s.waiting = 40; }};
  c.between = [](ParticleRun& run, int window, Result& result) {
    if (window == 6)
      result.values.push_back(
          static_cast<double>(run.engine->remove({{-0.3, -0.3, -0.1}, {0.0, 0.3, 0.8}, {}, false})));
    if (window < 3 || window > 10) return;
    std::vector<dem::Arrival> arrivals;
    const auto first =
        static_cast<std::uint32_t>(run.spheres.size() - run.spheres.waiting) + 5u * (window - 3);
    for (std::uint32_t k = 0; k < 5; ++k)
      arrivals.push_back(
          {first + k, {{-0.08 + 0.03 * k, 0.01 * window, 0.5}, run.spheres.radius[first + k]}, {0, 0, -2}});
    std::vector<particles::BodyPose> poses(run.surface.boundary_bodies.size());
    std::vector<dem::Ball> balls{{{0, 0, 0.1}, 0.02}, {{0.05, 0.05, 0.7}, 0.01}};
    for (const dem::Arrival& a : arrivals) balls.push_back(a.ball);
    for (const std::uint8_t taken : run.engine->find_overlapping(balls, poses))
      result.values.push_back(taken);
    run.engine->insert(arrivals);
  };
  expect_same_bits(c);
}

TEST(Ranks, WithSpheresThatLeaveTheDomain) {
  std::string json = falling_spheres("hertz_mindlin");
  const std::string domain = R"("min": [-0.3, -0.3, -0.1])";
  json.replace(json.find(domain), domain.size(), R"("min": [-0.3, -0.3, 0.045])");
  EXPECT_GT(expect_same_bits({json, 10, 400}).lost, 10u);
}

TEST(Ranks, MeasureRegions) {
  Case c{falling_spheres("hertz_mindlin")};
  c.between = [](ParticleRun& run, int, Result& result) {
    const dem::MeasuredRegion region{{0, 0, 0.2}, {}, {0.1, 0.08, 0.15}, false, {0, 0, 1}, {}};
    for (const dem::RegionSums& sums : run.engine->measure({&region, 1})) {
      result.add(sums.moment), result.add(sums.momentum);
      result.values.insert(result.values.end(), {static_cast<double>(sums.count), sums.mass, sums.volume,
                                                 sums.kinetic_energy, sums.flow_momentum});
    }
  };
  expect_same_bits(c, {3});
}

TEST(Ranks, KeepASnapshot) {
  Case c{falling_spheres("hertz_mindlin")};
  c.between = [](ParticleRun& run, int window, Result& result) {
    static thread_local dem::SphereFrame frame;
    if (window == 3) run.engine->snapshot();
    if (window == 5) {
      run.engine->read_snapshot(frame);
      // The frame is on rank 0; the others compare nothing of it.
      if (!frame.id.empty()) result.frame.assign(frame.position.begin(), frame.position.end());
    }
  };
  expect_same_bits(c, {3});
}

// A fault on one rank is found on all of them, with the name of the sphere.
TEST(Ranks, EndTogetherWhereASphereIsTooFast) {
  for (const unsigned size : {1u, 3u}) {
    std::atomic<unsigned> found = 0;
    on_ranks(size, [&](ThreadRanks& ranks) {
      ParticleRun run(
          falling_spheres("hertz_mindlin"), Backend::cpu, 1,
          [](particles::Spheres& s) {
            s.velocity[40] = {0, 0, 1e9};
          },
          {}, size > 1 ? &ranks : nullptr);
      try {
        run.advance(10, dt);
      } catch (const dem::SphereError& error) {
        const std::size_t expected = ranks.rank() == 0 || size == 1 ? run.spheres.size() : 0;
        EXPECT_EQ(error.before.size(), expected);
        found += error.id == 40 ? 1 : 0;
      }
    });
    EXPECT_EQ(found, size);
  }
}

TEST(Ranks, SumWhatActsOnWalls) {
  nlohmann::json scene = nlohmann::json::parse(falling_spheres("hertz_mindlin"));
  for (const char* wall : {"box", "plate", "floor"})
    scene["dem"]["sensors"].push_back({{"name", wall}, {"wall", wall}});
  scene["output"]["wall_fields"] = {"plate", "box"};
  Case c{scene.dump()};
  c.between = [](ParticleRun& run, int, Result& result) {
    const std::vector<double>& fields = run.engine->wall_fields();
    result.values.insert(result.values.end(), fields.begin(), fields.end());
  };
  expect_same_bits(c, {3});
}

// A domain that follows a tool, with an inlet and an outlet. The tool cuts through the spheres.
nlohmann::json rain_on_a_tool() {
  const nlohmann::json rain = {
      {"name", "rain"},
      {"material", "m"},
      {"radius", {0.008, 0.012}},
      {"fill", {{"type", "inlet"}, {"min", {0.3, 0, 0.2}}, {"max", {0.5, 0.1, 0.3}}, {"rate", 800}}}};
  nlohmann::json scene =
      tool_scene({{"outlets",
                   {{{"name", "drain"},
                     {"region", {{"type", "plane"}, {"point", {0.1, 0, 0}}, {"normal", {-1, 0, 0}}}}}}},
                  {"domain", {{"min", {-0.2, -1, -0.01}}, {"max", {1.5, 1, 1}}, {"follows", "tool"}}}});
  scene["dem"]["particles"].push_back(rain);
  scene["mbd"]["bodies"][0]["position"] = {0.4, 0.05, 0.15};
  return scene;
}

// What the coordinator sees of such a run, with windows taken back.
std::vector<double> seen_of(std::unique_ptr<protocol::LoadSolver> solver, std::string& hash) {
  SolverRun run(rain_on_a_tool(), "tool.json", 1, "cpu", std::move(solver));
  std::vector<double> seen;
  double stiffest = 0;  // along z
  const auto advance = [&] {
    const auto pose = [](Nanoseconds t) {
      return Pose{Vec3d{0.4 + to_seconds(t), 0.05, 0.15 - 0.8 * to_seconds(t)},
                  exp({0, 0, 3 * to_seconds(t)})};
    };
    protocol::BodyMotion tool;
    tool.begin_pose = pose(run.now), tool.end_pose = pose(run.now + SolverRun::window);
    tool.begin_twist = tool.end_twist = {{1, 0, -0.8}, {0, 0, 3}};
    run.advance_window({tool});
    seen.insert(seen.end(), {run.open.x, run.open.y, run.open.z, run.exchanged});
    for (const protocol::BodyTangent& body : run.solver->linearise().bodies) {
      seen.insert(seen.end(), body.stiffness.begin(), body.stiffness.end());
      stiffest = std::max(stiffest, body.stiffness[14]);
    }
  };
  for (int w = 0; w < 60; ++w) advance();
  run.solver->save();
  const Nanoseconds then = run.now;
  for (int w = 0; w < 30; ++w) advance();
  run.solver->restore();
  run.now = then;
  for (int w = 0; w < 60; ++w) advance();
  run.solver->snapshot();
  const protocol::ParticlesFrame& frame = run.solver->read_snapshot();
  seen.insert(seen.end(), frame.position.begin(), frame.position.end());
  hash = run.hash();
  EXPECT_GT(stiffest, 0) << "the tool touches spheres";
  return seen;
}

TEST(RankedSolver, IsOneParticipantWithTheSameBits) {
  std::string hash;
  const std::vector<double> expected = seen_of(dem::make_solver(), hash);
  on_ranks(3, [&](ThreadRanks& ranks) {
    if (ranks.rank() > 0) return dem::follow(ranks, *dem::make_solver_of_rank(ranks));
    std::string found;
    EXPECT_EQ(seen_of(std::make_unique<dem::LeadingSolver>(ranks, dem::make_solver_of_rank(ranks)), found),
              expected);
    EXPECT_EQ(found, hash);
  });
}

}  // namespace
}  // namespace tandem::test
