// Inlets and outlets, accessed through the solver.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <numbers>

#include "tests/support/error_of.hpp"
#include "tests/support/flow.hpp"

namespace tandem::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

const json floor_outlet = {
    {{"name", "drain"}, {"region", {{"type", "plane"}, {"point", {0, 0, 0}}, {"normal", {0, 0, -1}}}}}};

TEST(Inlet, BringsInSpheresAtItsRate) {
  Rain rain(shower({{"rate", 800}, {"start", 0.01}}, json::object(), {0.002, 0.004}));
  EXPECT_EQ(rain.configured["spheres"], 392) << "those to come are counted: 800 per s in 0.49 s";
  double smallest = 1, largest = 0, sum = 0;
  for (const int windows : {5, 10, 100, 200}) {
    rain.advance(windows);
    // The last boundary was at the begin of the last window.
    const double border = 1e-3 * static_cast<double>(rain.windows - 1);
    const auto expected =
        static_cast<std::size_t>(std::max(0.0, std::floor(800 * (border - 0.01) + 1e-9) + 1));
    std::printf("  t = %.3f s: expected %zu, measured %zu spheres\n", border, expected,
                rain.frame().id.size());
    EXPECT_EQ(rain.frame().id.size(), expected);
  }
  const protocol::ParticlesFrame& f = rain.frame();
  for (std::size_t i = 0; i < f.id.size(); ++i) {
    EXPECT_EQ(f.id[i], i) << "in order";
    const double r = static_cast<double>(f.radius[i]);
    smallest = std::min(smallest, r), largest = std::max(largest, r), sum += r;
    EXPECT_FLOAT_EQ(f.velocity[3 * i + 2], -1);
    for (int a = 0; a < 2; ++a) EXPECT_LE(std::abs(f.position[3 * i + a]), 0.1 - r + 1e-12);
    EXPECT_LE(f.position[3 * i + 2], 0.5 - r);
  }
  EXPECT_LT(smallest, 0.0021);
  EXPECT_GT(largest, 0.0039);
  EXPECT_NEAR(sum / static_cast<double>(f.id.size()), 0.003, 1e-4);
  // No sphere was placed on another one: they move alike without contact.
  EXPECT_EQ(rain.report()["contacts"], 0);
  EXPECT_EQ(rain.report()["inlets"]["rain"]["borders_without_room"], 0);
}

TEST(Inlet, BringsInMassAtItsRate) {
  Rain rain(shower({{"mass_rate", 0.2}}, json::object(), {0.002, 0.006}));
  rain.advance(401);
  double mass = 0, heaviest = 0;
  for (const float r : rain.frame().radius) {
    const double m = 4.0 / 3 * std::numbers::pi * 2500 * std::pow(static_cast<double>(r), 3);
    mass += m;
    heaviest = std::max(heaviest, m);
  }
  std::printf("  expected %.6g kg measured %.6g kg tolerance one sphere, %.2g kg\n", 0.2 * 0.4, mass,
              heaviest);
  EXPECT_NEAR(mass, 0.2 * 0.4, heaviest);
}

TEST(Inlet, ItsCountIsThatOfTheSceneWhateverTheEnd) {
  // So that a run can continue from restart files beyond its end.
  EXPECT_EQ(Rain(shower({{"rate", 10}, {"count", 7}})).configured["spheres"], 7);
  EXPECT_EQ(Rain(shower({{"rate", 10}})).configured["spheres"], 5);
}

TEST(Inlet, TakesMemoryForThoseThatAreThere) {
  const auto scene = [](int count) {
    return shower({{"rate", 3000}, {"count", count}}, json::object(), 0.003);
  };
  Rain few(scene(300)), many(scene(100000));
  const auto memory = [](Rain& rain) { return rain.report()["dem_memory_MB"].get<double>(); };
  double with_none = 0;
  for (const int windows : {1, 20, 79}) {
    few.advance(windows);
    many.advance(windows);
    std::printf("  t = %.3f s: %zu spheres; memory with 300 to come in %.3f MB, with 100000 %.3f MB\n",
                to_seconds(many.now), many.frame().id.size(), memory(few), memory(many));
    EXPECT_EQ(many.frame().id, few.frame().id);
    EXPECT_EQ(many.hash(), few.hash());
    if (windows == 1) with_none = memory(many);
  }
  EXPECT_EQ(many.frame().id.size(), 298u);
  EXPECT_LT(memory(many) - with_none, 300 * 3e-3) << "that is 3 kB for each";
  EXPECT_GT(many.configured["dem_memory_predicted_MB"], 50) << "for all at once";
}

TEST(Inlet, WaitsWhereThereIsNoRoom) {
  // Spheres at rest in a box that has room for one or two; the inlet stays blocked.
  Rain rain(shower({{"rate", 1000}, {"max", {-0.07, -0.07, 0.43}}, {"count", 20}}));
  rain.advance(1);
  EXPECT_EQ(rain.frame().id.size(), 1u);
  rain.advance(29);
  // The first has moved by 30 mm: each sphere of 20 mm needs the ones before to have left.
  const std::size_t in = rain.frame().id.size();
  EXPECT_GE(in, 2u);
  EXPECT_LT(in, 10u);
  const json report = rain.report();
  EXPECT_EQ(report["inlets"]["rain"]["to_come"], 20 - in);
  EXPECT_GT(report["inlets"]["rain"]["borders_without_room"], 10);
  EXPECT_THAT(report["warnings"].get<std::vector<std::string>>(),
              Contains(HasSubstr("inlet 'rain' had no room")));
  rain.advance(470);
  EXPECT_EQ(rain.report()["came_in"], 20);
  EXPECT_EQ(rain.report()["contacts"], 0) << "none was put on another";
}

TEST(Inlet, TooFastOnesAreRefusedBeforeTheRun) {
  json scene = shower({{"rate", 100}});
  scene["dem"]["particles"][0]["velocity"] = {0, 0, -2e5};
  EXPECT_EQ(
      error_of([&] { Rain{scene}; }),
      "scene: dem.particles[0] 'rain': its spheres come in with 200000 m/s; a run ends with a sphere of "
      "100000 m/s (give the group a smaller velocity)");
}

// Refused before memory is allocated, which for so many spheres would be exhausted.
TEST(Inlet, TooManyAreRefusedAtOnce) {
  for (const char* rate : {"rate", "mass_rate"})
    EXPECT_THAT(error_of([&] {
                  Rain{shower({{rate, 1e14}})};
                }),
                AllOf(HasSubstr("dem.particles[0] 'rain': more than 2147483647 spheres come in"),
                      HasSubstr("give a count, or a smaller rate")));
}

TEST(Inlet, ThatBringsInNothingIsWarnedOf) {
  const auto warnings = [](Rain& rain) { return rain.report()["warnings"].get<std::vector<std::string>>(); };
  Rain late(shower({{"rate", 10}, {"count", 3}, {"start", 2}}));
  EXPECT_THAT(warnings(late),
              Contains(HasSubstr("'rain' starts at 2 s, so that no sphere comes in before the "
                                 "end at 0.5 s")));
  json solid = {{{"name", "floor"},
                 {"material", "glass"},
                 {"shape", {{"type", "plane"}, {"point", {0, 0, 0.55}}, {"normal", {0, 0, 1}}}}}};
  Rain blocked(shower({{"rate", 1000}, {"count", 5}}, {{"walls", solid}}));
  blocked.advance(5);
  EXPECT_THAT(warnings(blocked), Contains(AllOf(HasSubstr("no sphere came in"), HasSubstr("move its box"))));
}

TEST(Inlet, WhatNeverCameInIsToldWithItsRadius) {
  json scene = shower({{"rate", 1e5}, {"count", 3000}});
  scene["dem"]["particles"][0]["velocity"] = {0, 0, 0};
  Rain rain(scene);
  rain.advance(60);
  const json report = rain.report();
  EXPECT_GT(report["came_in"], 10);
  EXPECT_THAT(report["warnings"].get<std::vector<std::string>>(),
              Contains(AllOf(HasSubstr("of 3000 spheres that were due have not come in"),
                             HasSubstr("the next one has a radius of 0.01 m: enlarge the box"))));
}

// 0.1 + 2 / 10 is above 0.3 in floating point.
TEST(Inlet, WhatIsDueAtABorderComesInThere) {
  Rain rain(shower({{"rate", 10}, {"start", 0.1}}));
  rain.advance(300);  // the last window begins at 0.299 s
  EXPECT_EQ(rain.report()["came_in"], 2);
  rain.advance(1);
  EXPECT_EQ(rain.report()["came_in"], 3);
  EXPECT_EQ(rain.report()["inlets"]["rain"]["to_come"], 1) << "0.1 + 4 / 10 is the end, and not before it";
}

TEST(Inlet, OneThatIsDueAfterTheLastBorderIsWarnedOf) {
  Rain rain(shower({{"rate", 10}, {"start", 0.4995}}));
  rain.advance(500);
  EXPECT_THAT(
      rain.report()["warnings"].get<std::vector<std::string>>(),
      Contains(HasSubstr("brought in no sphere: the first one is due at 0.4995 s, and the last window began "
                         "at 0.499 s")));
}

TEST(Inlet, KeepsOffWalls) {
  json plane = {{{"name", "floor"},
                 {"material", "glass"},
                 {"shape", {{"type", "plane"}, {"point", {0, 0, 0.45}}, {"normal", {0, 0, 1}}}}}};
  json scene = shower({{"rate", 1000}, {"count", 50}}, {{"walls", plane}});
  scene["dem"]["particles"][0]["velocity"] = {0, 0, 0};
  Rain rain(scene);
  rain.advance(60);
  const protocol::ParticlesFrame& f = rain.frame();
  EXPECT_GT(f.id.size(), 20u);
  for (std::size_t i = 0; i < f.id.size(); ++i) EXPECT_GE(f.position[3 * i + 2], 0.45 + 0.01);
  EXPECT_EQ(rain.report()["max_speed"], 0) << "nothing touches anything";
}

TEST(Outlet, TakesOutWhatPassesAndBooksIt) {
  Rain rain(shower({{"rate", 300}}, {{"outlets", floor_outlet}}));
  // Without gravity at 1 m/s: the number under way is the rate times the time from the inlet to the outlet.
  rain.advance(500);
  double lowest = 1;
  const protocol::ParticlesFrame& f = rain.frame();
  for (std::size_t i = 0; i < f.id.size(); ++i) lowest = std::min(lowest, f.position[3 * i + 2]);
  const json report = rain.report();
  const auto out = report["outlets"]["drain"].get<std::size_t>();
  EXPECT_EQ(out, report["went_out"]);
  EXPECT_EQ(report["came_in"], f.id.size() + out);
  // From heights uniform in 0.41 to 0.49 m: 0.45 s on average.
  std::printf("  on the way: expected %.0f measured %zu; momentum left open %.2e of %.2e N s\n", 300 * 0.45,
              f.id.size(), norm(rain.open), rain.exchanged);
  EXPECT_NEAR(static_cast<double>(f.id.size()), 300 * 0.45, 5);
  EXPECT_GT(out, 5u);
  EXPECT_GE(lowest, -1e-3) << "at most a window beyond the plane";
  EXPECT_EQ(rain.lost, 0u) << "what goes out is not lost";
  EXPECT_LT(norm(rain.open), 1e-12 * rain.exchanged);
}

TEST(Outlet, MakesRoomForThoseThatComeIn) {
  json region = {
      {{"name", "drain"}, {"region", {{"type", "plane"}, {"point", {0, 0, 0.3}}, {"normal", {0, 0, -1}}}}}};
  Rain flow(shower({{"rate", 2000}}, {{"outlets", region}}, 0.003));
  flow.advance(200);
  const double memory = flow.report()["dem_memory_MB"];
  flow.advance(290);
  const std::vector<std::uint32_t> id = flow.frame().id;
  const json report = flow.report();
  std::printf("  %d came in, %zu are there; memory %.3f MB, before %.3f MB\n", report["came_in"].get<int>(),
              id.size(), report["dem_memory_MB"].get<double>(), memory);
  EXPECT_EQ(report["came_in"], 979);
  EXPECT_EQ(report["came_in"].get<std::size_t>(), id.size() + report["went_out"].get<std::size_t>());
  EXPECT_LT(id.size(), 400u);
  EXPECT_EQ(report["dem_memory_MB"].get<double>(), memory);
  // Two more in each window for 150 ms, from then on 300.
  const double steps = flow.configured["steps_per_window"].get<double>(),
               expected = (150 * 150 + 340 * 300) / 490.0,
               measured = report["sphere_steps"].get<double>() / (490 * steps);
  std::printf("  mean number: expected %.1f, measured %.1f\n", expected, measured);
  EXPECT_NEAR(measured, expected, 5);
  EXPECT_TRUE(std::ranges::is_sorted(id, std::less_equal{})) << "each once";
  EXPECT_EQ(id.back(), 978u);
  EXPECT_LT(norm(flow.open), 1e-12 * flow.exchanged);
}

TEST(Outlet, BoxTakesOutOnlyWhatIsInIt) {
  json box = {{{"name", "half"}, {"region", {{"type", "box"}, {"min", {0, -1, -1}}, {"max", {1, 1, 0.3}}}}}};
  Rain rain(shower({{"rate", 500}}, {{"outlets", box}}));
  rain.advance(400);
  const protocol::ParticlesFrame& f = rain.frame();
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < f.id.size(); ++i) {
    const bool low = f.position[3 * i + 2] < 0.299;
    EXPECT_FALSE(low && f.position[3 * i] >= 0);
    beyond += low ? 1 : 0;
  }
  EXPECT_GT(beyond, 30u);
  EXPECT_GT(rain.report()["outlets"]["half"], 30);
}

class Flow : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Variants, Flow,
                         testing::Values("", R"({"contact": "hertz_frictionless"})",
                                         R"({"precision": "double"})"),
                         [](const auto& v) { return "case" + std::to_string(v.index); });

TEST_P(Flow, IsTheSameForAnyNumberOfThreadsAndAgain) {
  const auto run = [](unsigned threads) {
    Rain rain(heap(GetParam()), threads);
    rain.advance(60);  // threads are slow on a busy machine
    EXPECT_GT(rain.report()["went_out"], gone_at_once + 10);
    EXPECT_GT(rain.report()["contacts"], 5);
    EXPECT_LT(norm(rain.open), 1e-12 * rain.exchanged);
    return rain.hash();
  };
  const std::string one = run(1);
  EXPECT_EQ(run(1), one);
  EXPECT_EQ(run(2), one);
}

TEST_P(Flow, GoesOnToTheSameBitsAfterEachWayBack) {
  Rain straight(heap(GetParam()));
  straight.advance(100);
  const std::string expected = straight.hash();

  Rain back(heap(GetParam()));
  back.advance(60);
  back.solver->save();
  const Nanoseconds then = back.now;
  for (const int windows : {15, 1}) {
    back.advance(windows);
    back.solver->restore();
    back.now = then;
  }
  back.advance(25);
  const std::string file =
      std::filesystem::temp_directory_path() / ("traffic" + std::to_string(getpid()) + ".h5");
  back.solver->checkpoint({85, back.now, file});
  const Nanoseconds saved = back.now;
  back.advance(15);
  EXPECT_EQ(back.hash(), expected);
  EXPECT_EQ(back.report()["came_in"], straight.report()["came_in"]);
  EXPECT_EQ(back.report()["went_out"], straight.report()["went_out"]);

  Rain resumed(heap(GetParam()));
  resumed.solver->resume({85, saved, file});
  resumed.now = saved;
  resumed.advance(15);
  EXPECT_EQ(resumed.hash(), expected);
  EXPECT_EQ(resumed.report()["came_in"], straight.report()["came_in"]);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace tandem::test
