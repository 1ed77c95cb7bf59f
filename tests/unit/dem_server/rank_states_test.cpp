// The state that ranks write is the same for any number of them, to the byte, and any number continues from
// it.
#include <gtest/gtest.h>

#include "tests/support/boulder.hpp"
#include "tests/support/periodic_scene.hpp"
#include "tests/support/rank_runs.hpp"

namespace tandem::test {
namespace {

struct Continued {
  Arrays state;     // in the middle, on rank 0
  RankResult rest;  // of the second half
};

// Runs a case; with `from`, only its second half from that state.
Continued continued(const RankCase& c, ThreadRanks* ranks, const Arrays* from) {
  ParticleRun run(c.json, tested_backend(), 1, c.change, {}, ranks);
  Continued all;
  RankResult first;
  const int half = c.windows / 2;
  for (int w = from != nullptr ? half : 0; w < c.windows; ++w) {
    RankResult& result = w < half ? first : all.rest;
    if (w == half) {
      if (from != nullptr)
        run.engine->read([&](const std::string& name) { return from->at(name); });
      else
        all.state = written(run);
    }
    c.between(run, w, result);
    result.add(run.advance(c.steps, rank_dt));
  }
  all.rest.hash = dem::state_hash(run.state());
  return all;
}

void expect_same_states(const RankCase& c, const std::vector<unsigned>& sizes = {2, 3}) {
  const Continued one = continued(c, nullptr, nullptr);
  EXPECT_GT(one.rest.contacts, 0u);
  Arrays expected;  // without the spare room of one process's arrays
  on_ranks(1, [&](ThreadRanks& ranks) { expected = continued(c, &ranks, nullptr).state; });
  EXPECT_EQ(continued(c, nullptr, &expected).rest.values, one.rest.values);
  for (const unsigned size : sizes)
    on_ranks(size, [&](ThreadRanks& ranks) {
      const Continued whole = continued(c, &ranks, nullptr), again = continued(c, &ranks, &one.state);
      EXPECT_EQ(again.rest.values, one.rest.values) << "rank " << ranks.rank() << " of " << size;
      EXPECT_EQ(again.rest.rebuilds, one.rest.rebuilds);
      if (ranks.rank() > 0) {
        EXPECT_TRUE(whole.state.empty());
        return;
      }
      EXPECT_EQ(again.rest.hash, one.rest.hash) << size << " ranks";
      EXPECT_EQ(whole.state.size(), expected.size());
      // Records in double precision end with bytes that nobody sets.
      if (c.json.find(R"("precision": "double")") != std::string::npos) return;
      for (const auto& [name, bytes] : expected) EXPECT_TRUE(whole.state.at(name) == bytes) << name;
    });
}

class StateOverRanks : public testing::TestWithParam<LawOfRanks> {};
INSTANTIATE_TEST_SUITE_P(Laws, StateOverRanks,
                         testing::Values(LawOfRanks{"hertz_mindlin", "hertz_mindlin", ""},
                                         LawOfRanks{"frictionless", "hertz_frictionless", ""},
                                         LawOfRanks{
                                             "rolling_double", "jkr",
                                             R"("precision": "double", "rolling": "elastic_plastic",)"}),
                         [](const auto& law) { return std::string(law.param.name); });

TEST_P(StateOverRanks, IsThatOfOneProcess) {
  expect_same_states({few_spheres(GetParam().contact, GetParam().options), 4, 601});
}

TEST(RankStates, BeforeTheFirstStep) {
  expect_same_states({few_spheres("hertz_mindlin"), 1, 1600}, {3});
}

TEST(RankStates, OfABoulderAmongSmallSpheres) {
  expect_same_states({falling_spheres("hertz_mindlin", "", 401), 4, 25, make_boulder});
}

TEST(RankStates, AcrossPeriodicFaces) {
  expect_same_states({chute(nlohmann::json::object()).json(), 8, 400});
}

TEST(RankStates, OfMoreRanksThanBlocksOfCells) {
  expect_same_states({falling_spheres("hertz_mindlin", "", 20), 10, 200}, {7});
}

// Some leave the domain, some are taken out, and others come in before and after the state is written.
TEST(RankStates, OfSpheresThatGoOutAndComeIn) {
  std::string json = few_spheres("hertz_mindlin");
  const std::string domain = R"("min": [-0.3, -0.3, -0.1])";
  json.replace(json.find(domain), domain.size(), R"("min": [-0.3, -0.3, 0.045])");
  RankCase c{json, 12, 151, [](particles::Spheres& s) { s.waiting = 40; }};
  c.between = [](ParticleRun& run, int window, RankResult& result) {
    if (window == 6)
      result.values.push_back(
          static_cast<double>(run.engine->remove({{-0.3, -0.3, -0.1}, {0.0, 0.3, 0.2}, {}, false})));
    if (window < 4 || window > 9) return;
    std::vector<dem::Arrival> arrivals;
    const auto first =
        static_cast<std::uint32_t>(run.spheres.size() - run.spheres.waiting) + 5u * (window - 4);
    for (std::uint32_t k = 0; k < 5; ++k)
      arrivals.push_back(
          {first + k, {{-0.08 + 0.03 * k, 0, 0.6}, run.spheres.radius[first + k]}, {0, 0, -2}});
    run.engine->insert(arrivals);
  };
  expect_same_states(c);
}

}  // namespace
}  // namespace tandem::test
