// Any number of ranks gives the bits of one process: positions, loads, totals. Ranks are threads here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <nlohmann/json.hpp>

#include "dem_server/coupling/ranked_solver.hpp"
#include "dem_server/coupling/state_hash.hpp"
#include "dem_server/engine/rank_share.hpp"
#include "tests/support/boulder.hpp"
#include "tests/support/periodic_scene.hpp"
#include "tests/support/rank_runs.hpp"
#include "tests/support/solver_run.hpp"
#include "tests/support/tool_scene.hpp"

namespace tandem::test {
namespace {

class LawOverRanks : public testing::TestWithParam<LawOfRanks> {};
INSTANTIATE_TEST_SUITE_P(
    Laws, LawOverRanks,
    testing::Values(
        LawOfRanks{"hertz_mindlin", "hertz_mindlin", ""},
        LawOfRanks{"frictionless", "hertz_frictionless", ""}, LawOfRanks{"paper", "paper", ""},
        LawOfRanks{"double", "hertz_mindlin", R"("precision": "double",)"},
        LawOfRanks{"frictionless_double", "hertz_frictionless", R"("precision": "double",)"},
        LawOfRanks{"hooke", "hooke", ""},
        LawOfRanks{"jkr_rolling", "jkr", R"("rolling": "elastic_plastic", "twisting": "elastic_plastic",)"},
        LawOfRanks{"sjkr_double", "sjkr", R"("precision": "double", "rolling": "elastic_plastic",)"}),
    [](const auto& law) { return std::string(law.param.name); });

TEST_P(LawOverRanks, GivesTheBitsOfOneProcess) {
  expect_same_bits({few_spheres(GetParam().contact, GetParam().options), 4, 400}, {3});
}

TEST(Ranks, OfABoulderAmongSmallSpheres) {
  RankCase c{falling_spheres("hertz_mindlin", "", 401), 8, 25, make_boulder};
  EXPECT_GT(expect_same_bits(c).contacts, 100u);
}

TEST(Ranks, AcrossPeriodicFaces) {
  RankCase c{chute(nlohmann::json::object()).json(), 10, 400};
  EXPECT_GT(expect_same_bits(c).contacts, 100u);
}

TEST(Ranks, MoreThanBlocksOfCells) {
  // Most ranks have no sphere.
  expect_same_bits({falling_spheres("hertz_mindlin", "", 20), 10, 200}, {1, 7});
}

TEST(Ranks, WithUnevenSharesThatChange) {
  RankCase c{few_spheres("hertz_mindlin"), 8, 400};
  c.weights = {{1, 1, 1}, {10, 1, 1}, {1, 0, 5}, {0, 0, 1}, {3, 20, 1}};
  expect_same_bits(c, {3});
}

// Close spheres below, others far apart above. The first lists share out the spheres, the second ones their
// pairs.
TEST(Ranks, ShareTheWork) {
  const auto stacked = [](particles::Spheres& s) {
    std::size_t k = 0;
    const auto fill = [&](int across, double spacing, double from, std::size_t end) {
      for (int layer = 0; k < end; ++layer)
        for (int at = 0; at < across * across && k < end; ++at)
          s.position[k++] = {-0.09 + spacing * (at % across), -0.09 + spacing * (at / across),
                             from + spacing * layer};
    };
    std::ranges::fill(s.radius, 0.008);
    fill(11, 0.0165, 0.06, 1100);
    fill(6, 0.032, 0.25, s.size());
  };
  on_ranks(2, [&](ThreadRanks& ranks) {
    ParticleRun run(falling_spheres("hertz_mindlin", "", 1600), tested_backend(), 1, stacked, {}, &ranks);
    run.advance(1, rank_dt);
    const double by_spheres = run.engine->rank_imbalance();
    run.advance(1, rank_dt, 1);
    const double by_pairs = run.engine->rank_imbalance();
    ranks.set_weights({3, 1});
    run.advance(1, rank_dt, 1);
    if (ranks.rank() == 0)
      std::printf(
          "  work of the busier rank: %.3f of the mean by spheres, %.3f by pairs; expected 1, tolerance "
          "0.06\n",
          by_spheres, by_pairs);
    EXPECT_GT(by_spheres, 1.2);
    EXPECT_NEAR(by_pairs, 1, 0.06);
    EXPECT_NEAR(run.engine->rank_imbalance(), 1.5, 0.09);
  });
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
  RankCase c{few_spheres("hertz_mindlin")};
  c.windows = 9;
  c.between = [](ParticleRun& run, int window, RankResult&) {
    if (window == 4) run.engine->save();
    if (window == 7) run.engine->restore();
  };
  expect_same_bits(c, {3});
}

// Spheres that leave through an outlet, and later come in at the top, where other ranks have their cells.
TEST(Ranks, WithSpheresThatGoOutAndComeIn) {
  RankCase c{few_spheres("hertz_mindlin"), 12, 150, [](particles::Spheres& s) { s.waiting = 40; }};
  c.between = [](ParticleRun& run, int window, RankResult& result) {
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
  std::string json = few_spheres("hertz_mindlin");
  const std::string domain = R"("min": [-0.3, -0.3, -0.1])";
  json.replace(json.find(domain), domain.size(), R"("min": [-0.3, -0.3, 0.045])");
  EXPECT_GT(expect_same_bits({json, 10, 400}).lost, 10u);
}

TEST(Ranks, MeasureRegions) {
  RankCase c{few_spheres("hertz_mindlin")};
  c.between = [](ParticleRun& run, int, RankResult& result) {
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
  RankCase c{few_spheres("hertz_mindlin")};
  c.between = [](ParticleRun& run, int window, RankResult& result) {
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
          few_spheres("hertz_mindlin"), tested_backend(), 1,
          [](particles::Spheres& s) {
            s.velocity[40] = {0, 0, 1e9};
          },
          {}, size > 1 ? &ranks : nullptr);
      try {
        run.advance(10, rank_dt);
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
  nlohmann::json scene = nlohmann::json::parse(few_spheres("hertz_mindlin"));
  for (const char* wall : {"box", "plate", "floor"})
    scene["dem"]["sensors"].push_back({{"name", wall}, {"wall", wall}});
  scene["output"]["wall_fields"] = {"plate", "box"};
  RankCase c{scene.dump()};
  c.between = [](ParticleRun& run, int, RankResult& result) {
    const std::vector<double>& fields = run.engine->wall_fields();
    result.values.insert(result.values.end(), fields.begin(), fields.end());
  };
  expect_same_bits(c, {3});
}

TEST(Ranks, SumTheDissipatedEnergy) {
  nlohmann::json scene =
      nlohmann::json::parse(few_spheres("hertz_mindlin", R"("rolling": "elastic_plastic",)"));
  scene["output"]["dissipation"] = true;
  RankCase c{scene.dump()};
  c.between = [](ParticleRun& run, int window, RankResult& result) {
    const std::vector<double> energy = run.engine->dissipated();
    for (const double part : energy) EXPECT_TRUE(window < 4 || part > 0);
    result.values.insert(result.values.end(), energy.begin(), energy.end());
  };
  expect_same_bits(c, {3});
}

// From the frame at the start on, for which lists are built that the run does without.
TEST(Ranks, SendTheContactsOfSpheresAndBodies) {
  nlohmann::json scene = nlohmann::json::parse(few_spheres("hertz_mindlin"));
  scene["output"]["fields"] = {"contact_count", "mean_stress"};
  scene["output"]["contacts"] = {"ground"};
  RankCase c{scene.dump()};
  c.between = [](ParticleRun& run, int window, RankResult& result) {
    const std::vector<particles::BodyPose> poses{{{}, Quat{}.matrix(), {}, {}}};
    const std::vector<std::uint8_t> wanted{1};
    dem::ContactsFrame frame;
    run.engine->download({poses, rank_dt}, frame);
    std::uint32_t contacts = 0;
    for (std::size_t i = 0; i < frame.count.size(); ++i) {
      contacts += frame.count[i];
      result.frame.insert(result.frame.end(), {static_cast<double>(frame.count[i]), frame.mean_stress[i]});
    }
    const std::vector<dem::BodyContact> of_ground = run.engine->body_contacts({poses, rank_dt}, wanted);
    for (const dem::BodyContact& at : of_ground)
      result.frame.insert(result.frame.end(), {static_cast<double>(at.sphere), at.point.x, at.point.y,
                                               at.point.z, at.force.x, at.force.y, at.force.z});
    if (window == 5 && !frame.count.empty()) {
      EXPECT_GT(contacts, 50u);
      EXPECT_GT(of_ground.size(), 5u);
    }
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
  SolverRun run(rain_on_a_tool(), "tool.json", 1, tested_backend_name(), std::move(solver));
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

TEST(RankedSolver, PredictsTheMemoryOfAHost) {
  if (tested_backend() == particles::Backend::cuda) GTEST_SKIP() << "each rank has the memory of its device";
  const nlohmann::json scene = rain_on_a_tool();
  const auto predicted = [&](std::unique_ptr<protocol::LoadSolver> solver) {
    return SolverRun(scene, "test.json", 1, tested_backend_name(), std::move(solver))
        .configured["dem_memory_predicted_MB"]
        .get<double>();
  };
  const double one = predicted(dem::make_solver());
  on_ranks(2, [&](ThreadRanks& ranks) {
    const double together = predicted(dem::make_solver_of_rank(ranks));
    ranks.per_host = 1;
    const double alone = predicted(dem::make_solver_of_rank(ranks));
    EXPECT_DOUBLE_EQ(together, 2 * alone);
    EXPECT_GT(together, one) << "the cells of the domain twice";
    EXPECT_LT(alone, one);
  });
}

TEST(RankedSolver, WarnsOfFewSpheresOnSeveralGpus) {
  EXPECT_THAT(dem::warn_of_few_spheres(200'000, 2), testing::HasSubstr("200000 spheres are few for 2 GPUs"));
  EXPECT_EQ(dem::warn_of_few_spheres(1'000'000, 2), "");
  EXPECT_EQ(dem::warn_of_few_spheres(250'000, 8), "");
}

TEST(RankedSolver, RefusesUnlikePrograms) {
  for (const bool alike : {true, false})
    on_ranks(3, [&](ThreadRanks& ranks) {
      const std::uint64_t digest = !alike && ranks.rank() == 2 ? 7 : 6;
      if (alike)
        EXPECT_NO_THROW(dem::expect_same_program(ranks, digest));
      else
        EXPECT_THROW(dem::expect_same_program(ranks, digest), Error);
    });
}

TEST(RankedSolver, IsOneParticipantWithTheSameBits) {
  const unsigned size = tested_backend() == particles::Backend::cuda ? particles::cuda_devices() : 3;
  if (size < 2) GTEST_SKIP() << "each rank needs a device";
  std::string hash;
  const std::vector<double> expected = seen_of(dem::make_solver(), hash);
  on_ranks(size, [&](ThreadRanks& ranks) {
    if (ranks.rank() > 0) return dem::follow(ranks, *dem::make_solver_of_rank(ranks));
    std::string found;
    EXPECT_EQ(seen_of(std::make_unique<dem::LeadingSolver>(ranks, dem::make_solver_of_rank(ranks)), found),
              expected);
    EXPECT_EQ(found, hash);
  });
}

}  // namespace
}  // namespace tandem::test
