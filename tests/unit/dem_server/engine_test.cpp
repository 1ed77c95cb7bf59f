// The engine as a whole: lists against brute force, laws against each other, threads, save and restore,
// momentum.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/error.hpp"
#include "dem_server/coupling/state_hash.hpp"
#include "tests/support/boulder.hpp"
#include "tests/support/neighbours.hpp"
#include "tests/support/particle_run.hpp"
#include "tests/support/particle_scenes.hpp"
#include "tests/unit/dem_server/contact_scene.hpp"

namespace tandem::test {
namespace {

using particles::Backend;

constexpr double dt = 2e-5;  // [s]

std::string hash_after(ParticleRun& run, int windows, std::uint32_t steps) {
  for (int w = 0; w < windows; ++w) run.advance(steps, dt);
  return dem::state_hash(run.state());
}

struct Law {
  const char *name, *options;  // dem.contact, and further keys of dem, ending in a comma

  bool full() const { return std::string(options).find("double") != std::string::npos; }
};
void PrintTo(const Law& law, std::ostream* out) {
  *out << law.name;
}
std::string falling(const Law& law, const std::string& options = "", int count = falling_count) {
  return falling_spheres(law.name, law.options + options, count);
}

constexpr Law specialised[] = {{"hertz_mindlin", ""}, {"hertz_frictionless", ""}, {"paper", ""}};
// These run on the generic variant.
constexpr Law other[] = {{"hooke", ""},
                         {"jkr", R"("rolling": "elastic_plastic", "twisting": "elastic_plastic",)"},
                         {"sjkr", R"("rolling": "elastic_plastic",)"}};
constexpr Law full[] = {
    {"hertz_mindlin", R"("precision": "double",)"},
    {"hooke", R"("precision": "double",)"},
    {"jkr", R"("precision": "double", "rolling": "elastic_plastic", "twisting": "elastic_plastic",)"}};
// A sanitizer sees the same code of the engine for all laws of a variant: there one law of each is enough.
#ifdef TANDEM_SANITIZED
constexpr int laws_of_each = 1;
#else
constexpr int laws_of_each = 3;
#endif
const auto name_of = [](const auto& law) { return std::string(law.param.name); };

class SpecialisedLaw : public testing::TestWithParam<Law> {};
INSTANTIATE_TEST_SUITE_P(Laws, SpecialisedLaw, testing::ValuesIn(specialised), name_of);
class EveryLaw : public testing::TestWithParam<Law> {};
INSTANTIATE_TEST_SUITE_P(Laws, EveryLaw, testing::ValuesIn(specialised, specialised + laws_of_each), name_of);
INSTANTIATE_TEST_SUITE_P(GenericLaws, EveryLaw, testing::ValuesIn(other, other + laws_of_each), name_of);
INSTANTIATE_TEST_SUITE_P(DoublePrecision, EveryLaw, testing::ValuesIn(full, full + laws_of_each), name_of);

TEST_P(SpecialisedLaw, GenericVariantGivesTheSameBits) {
  ParticleRun special(falling(GetParam()));
  ParticleRun generic(falling(GetParam(), R"("variant": "generic",)"));
  EXPECT_EQ(hash_after(special, 10, 400), hash_after(generic, 10, 400));
}

// The CPU then needs no columns for sizes and materials.
TEST_P(SpecialisedLaw, GenericVariantGivesTheSameBitsForSpheresOfOneSize) {
  const auto of_one_size = [](std::string scene) {
    const std::string sizes = "[0.008, 0.01]";
    return scene.replace(scene.find(sizes), sizes.size(), "0.009");
  };
  ParticleRun special(of_one_size(falling(GetParam())));
  ParticleRun generic(of_one_size(falling(GetParam(), R"("variant": "generic",)")));
  EXPECT_EQ(hash_after(special, 10, 400), hash_after(generic, 10, 400));
}

TEST_P(EveryLaw, ThreadsDoNotChangeTheBits) {
  ParticleRun one(falling(GetParam())), three(falling(GetParam()), Backend::cpu, 3);
  EXPECT_EQ(hash_after(one, 10, 400), hash_after(three, 10, 400));
}

TEST(Boulder, AmongSmallSpheresGivesTheSameBitsWhateverRunsIt) {
  const auto run = [](unsigned threads, const std::string& options = "") {
    return ParticleRun(falling_spheres("hertz_mindlin", options, 401), Backend::cpu, threads, make_boulder);
  };
  ParticleRun one = run(1), three = run(3), generic = run(1, R"("variant": "generic",)");
  std::size_t neighbours = 0, contacts = 0;
  for (int w = 0; w < 8; ++w) {
    contacts = std::max<std::size_t>(contacts, one.advance(25, dt).end.contacts);
    neighbours = std::max(neighbours, neighbours_of(one, 0).size());
  }
  const std::string hash = dem::state_hash(one.state());
  EXPECT_EQ(hash_after(three, 8, 25), hash);
  EXPECT_EQ(hash_after(generic, 8, 25), hash);
  EXPECT_GT(neighbours, 128u);
  EXPECT_GT(contacts, 100u);
}

TEST_P(EveryLaw, RestoredRunContinuesToTheSameBits) {
  ParticleRun run(falling(GetParam()));
  hash_after(run, 8, 400);
  run.engine->save();
  const std::string first = hash_after(run, 4, 400);
  run.engine->restore();
  EXPECT_EQ(hash_after(run, 4, 400), first);
}

// In a newly made engine with another number of threads.
TEST_P(EveryLaw, AnotherEngineContinuesToTheSameBits) {
  ParticleRun run(falling(GetParam()));
  hash_after(run, 8, 400);
  const Arrays arrays = written(run);
  const std::string end = hash_after(run, 4, 400);
  ParticleRun fresh(falling(GetParam()), Backend::cpu, 2);
  fresh.engine->read([&](const std::string& name) { return arrays.at(name); });
  EXPECT_EQ(written(fresh), arrays);
  EXPECT_EQ(hash_after(fresh, 4, 400), end);
  // Except the memory for what a rebuild carries over, which is not part of the state.
  const auto memory = static_cast<double>(run.engine->memory_bytes());
  EXPECT_NEAR(static_cast<double>(fresh.engine->memory_bytes()), memory, 0.01 * memory);
}

TEST(Arrays, OfAnotherLengthAreRefusedByName) {
  for (const auto& [law, name] : {std::pair<std::string, std::string>("hertz_mindlin", "position_radius.0"),
                                  {"hertz_mindlin", "spin.0"},
                                  {"hertz_mindlin", "pairs.start"},
                                  {"hertz_mindlin", "pairs.entry"},
                                  {"hertz_mindlin", "pairs.spring"},
                                  {"hertz_frictionless", "id"}}) {
    ParticleRun run(falling_spheres(law));
    run.advance(10, dt);
    Arrays arrays = written(run);
    const auto read = [&] {
      ParticleRun fresh(falling_spheres(law));
      fresh.engine->read([&](const std::string& n) { return arrays.at(n); });
    };
    EXPECT_NO_THROW(read()) << name;
    const bool of_pairs = name == "pairs.entry" || name == "pairs.spring";  // these may have spare memory
    const auto listed = array_of<particles::WindowProgress>(arrays, "host_window_progress").front().listed;
    ASSERT_GT(listed, 0u);
    arrays.at(name).resize(of_pairs ? (listed - 1) * (name == "pairs.entry" ? 4 : 12)
                                    : arrays.at(name).size() - 16);
    try {
      read();
      ADD_FAILURE() << name << " was taken";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("'" + name + "'"), std::string::npos) << error.what();
    }
  }
}

TEST_P(EveryLaw, MemoryIsKnownBeforeTheEngineIsMade) {
  ParticleRun run(falling(GetParam()));
  dem::EngineSetup setup{run.scene, run.surface, run.spheres, run.skins, 1};
  const dem::EngineChoice choice = dem::choose_engine(run.scene, Backend::cpu);
  EXPECT_GT(dem::predicted_bytes(choice, setup, false), run.engine->memory_bytes()) << "with grown lists";
  setup.neighbours = particles::most_neighbours(run.skins);
  setup.contacts = particles::most_contacts;
  setup.walls = particles::most_walls;
  setup.steps = 300;
  run.engine = dem::make_engine(choice, setup);
  EXPECT_EQ(dem::predicted_bytes(choice, setup, false), run.engine->memory_bytes());
  run.advance(300, dt);
  EXPECT_EQ(dem::predicted_bytes(choice, setup, false), run.engine->memory_bytes()) << "loads are in it";
  run.engine->save();
  EXPECT_EQ(dem::predicted_bytes(choice, setup, true), run.engine->memory_bytes());
}

TEST(Engine, ArraysOfAnotherBuildAreRefused) {
  ParticleRun run(falling(specialised[0]));
  Arrays arrays = written(run);
  arrays["fine_part"].pop_back();
  try {
    run.engine->read([&](const std::string& name) { return arrays.at(name); });
    FAIL() << "read";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::resource);
    EXPECT_NE(std::string(e.what()).find("'fine_part'"), std::string::npos) << e.what();
  }
}

TEST_P(EveryLaw, WindowLengthDoesNotChangeTheBits) {
  ParticleRun a(falling(GetParam())), b(falling(GetParam()));
  EXPECT_EQ(hash_after(a, 8, 500), hash_after(b, 20, 200));
}

// The CPU searches for pairs that may touch soon at the begin of each window, and otherwise every few steps.
TEST_P(EveryLaw, NoContactIsOverlookedBetweenLooks) {
  ParticleRun seldom(falling(GetParam())), always(falling(GetParam()));
  hash_after(seldom, 4, 500);
  hash_after(always, 4, 500);
  EXPECT_EQ(hash_after(seldom, 1, 1000), hash_after(always, 1000, 1));
}

TEST_P(EveryLaw, SkinDoesNotChangeTheMotion) {
  if (GetParam().full()) GTEST_SKIP() << "as are all laws below";
  // A thicker skin lists more candidates, none of which is in contact: only the order of the sums differs,
  // and the results by rounding. In double precision, because the length unit of mixed precision depends on
  // the skin.
  ParticleRun thin(falling(GetParam(), R"("skin": 0.0005, "precision": "double",)"));
  ParticleRun thick(falling(GetParam(), R"("skin": 0.006, "precision": "double",)"));
  const auto rebuilds_thin = (hash_after(thin, 10, 500), thin.advance(1, dt).window.rebuilds);
  const auto rebuilds_thick = (hash_after(thick, 10, 500), thick.advance(1, dt).window.rebuilds);
  EXPECT_GT(rebuilds_thin, 4 * rebuilds_thick);
  EXPECT_LT(largest_distance(thin.state(), thick.state()), 1e-8);
}

// tests/verification/dem tests the other laws.
TEST_P(SpecialisedLaw, MomentumIsBookedExactly) {
  ParticleRun run(falling(GetParam(), "", 600));
  Vec3d walls, gravity, lost, begin, end;
  std::uint64_t contacts = 0;
  for (int w = 0; w < 40; ++w) {
    const dem::WindowOutcome& o = run.advance(500, dt);
    if (w == 0) begin = o.begin.momentum;
    for (const Wrench& l : o.load) walls -= dt * l.force;
    gravity += o.gravity_impulse;
    lost += o.lost_momentum;
    end = o.end.momentum;
    contacts = o.end.contacts;
  }
  const double residual = norm(end - begin + lost - gravity - walls), scale = norm(walls) + norm(gravity);
  std::printf("momentum residual %.3e of %.3e N s\n", residual, scale);
  EXPECT_LT(residual, 1e-12 * scale);
  EXPECT_GT(contacts, 800u);
}

TEST(Engine, GenericVariantRunsWhatNoOtherHas) {
  for (const Law& law : other) {
    const dem::EngineChoice choice = dem::choose_engine(scene::parse(falling(law), "test"), Backend::cpu);
    EXPECT_EQ(choice.variant, "generic") << law.name;
    EXPECT_TRUE(choice.generic_fallback) << law.name;
  }
  for (const Law& law : full)
    EXPECT_EQ(dem::choose_engine(scene::parse(falling(law), "test"), Backend::cpu).variant, "generic_double")
        << law.name;
  const auto plain = scene::parse(falling_spheres("hertz_mindlin"), "test");
  EXPECT_EQ(dem::choose_engine(plain, Backend::cpu).variant, "hertz_mindlin");
}

// Pressure of a box, which is a mesh, and of a plane, which needs no grid.
TEST(Engine, SaysAllThatASceneDoesWithout) {
  using Strings = std::vector<std::string>;
  const auto left_out = [](const std::string& json) {
    return dem::choose_engine(scene::parse(json, "test"), Backend::cpu).left_out;
  };
  const auto on_plane = [&](const nlohmann::json& dem) {
    ContactScene scene;
    scene.dem = dem;
    scene.constants = {{"restitution", 1}, {"friction", 0}};
    return left_out(scene.json());
  };
  const Strings frictionless{"no friction: no tangential force", "no friction: no contact history",
                             "no friction: no spin"};
  const std::string no_grids = "no meshes: no facet grids";
  EXPECT_EQ(left_out(falling_spheres("hertz_mindlin")), Strings{});
  EXPECT_EQ(left_out(falling_spheres("hertz_frictionless")), frictionless);
  EXPECT_EQ(on_plane(nlohmann::json::object()), Strings{no_grids});
  Strings all = frictionless;
  all.push_back(no_grids);
  EXPECT_EQ(on_plane({{"contact", "hertz_frictionless"}, {"precision", "mixed"}}), all);
  // The generic variant stores the arrays of friction whatever law it runs.
  EXPECT_EQ(on_plane({{"contact", "hertz_frictionless"}}), Strings{no_grids});
}

TEST(Engine, TurnsAreStoredOnlyWhereTheSceneNeedsThem) {
  const Law hooke = other[0];
  ParticleRun without(falling(hooke)), with(falling(hooke, R"("rolling": "elastic_plastic",)"));
  without.advance(1, dt);
  with.advance(1, dt);
  EXPECT_GT(with.engine->memory_bytes(), without.engine->memory_bytes() + 1000);
}

TEST(Engine, ForcesOfAPairCancelToTheBit) {
  // Two touching spheres without gravity: the sum of their momenta does not change at all.
  const std::string json = falling_spheres("hertz_mindlin", "", 2);
  ParticleRun run(json, Backend::cpu, 1, [](particles::Spheres& s) {
    s.radius = {0.01, 0.008};
    s.position = {{0, 0, 0.3}, {0.0179, 0.0004, 0.3002}};
    s.velocity = {{0.3, 0.1, 0}, {-0.4, 0, 0.2}};
    s.spin = {{10, 20, -30}, {4, -50, 6}};
  });
  const dem::WindowOutcome& o = run.advance(20, dt);
  EXPECT_GT(o.window.max_overlap_ratio, 0.0f);
  const Vec3d change = o.end.momentum - o.begin.momentum - o.gravity_impulse;
  EXPECT_LT(norm(change), 1e-13 * norm(o.begin.momentum)) << "the quantum of the totals is 1e-14 of it";
}

// A sphere a million times as heavy as the others, which comes in later, hardly coarsens the balance of the
// others.
TEST(Engine, BooksOfSmallSpheresBesideAHeavyOne) {
  constexpr int small = 1000, steps = 10;
  const std::string json = falling_spheres("hertz_mindlin", "", small + 1);
  ParticleRun run(json, Backend::cpu, 1, [&](particles::Spheres& s) {
    ASSERT_EQ(s.size(), small + 1u);
    s.waiting = 1;
    for (std::size_t i = 0; i <= small; ++i) {
      s.radius[i] = i < small ? 0.001 : 0.1;
      s.velocity[i] = {};
    }
  });
  const dem::WindowOutcome& o = run.advance(steps, dt);
  const Vec3d change = o.end.momentum - o.begin.momentum;
  // Radii are counted in quanta of the heavy one.
  EXPECT_NEAR(o.end.mass, small * 2500 * 4.0 / 3.0 * std::numbers::pi * 1e-9, 1e-3 * o.end.mass);
  const Vec3d expected = (steps * dt * o.end.mass) * run.scene.gravity;
  std::printf("change %.9e, expected %.9e N s, error %.1e, tolerance 1e-11\n", change.z, expected.z,
              norm(change - expected) / norm(expected));
  EXPECT_LT(norm(change - expected), 1e-11 * norm(expected));
  EXPECT_LT(norm(change - o.gravity_impulse), 1e-11 * norm(expected));
}

// Indices of spheres that have left are no longer processed, and the remaining spheres do not change.
TEST_P(EveryLaw, ThoseThatStayMoveAsIfAlone) {
  constexpr double border = 0.08;  // [m], between the lowest layer of the lattice and the rest
  std::string json = falling(GetParam(), "", 600);
  const std::string sizes = "[0.008, 0.01]";
  json.replace(json.find(sizes), sizes.size(), "0.009");
  ParticleRun many(json), few(json, Backend::cpu, 1, [&](particles::Spheres&s) {
    const particles::Spheres all = s;
    std::size_t n = 0;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all.position[i].z < border) s.position[n++] = all.position[i];
    const auto keep = [n](auto&... column) { (column.resize(n), ...); };
    keep(s.position, s.velocity, s.spin, s.radius, s.material, s.id);
  });
  const std::uint64_t gone = many.engine->remove({{0, 0, border}, {}, {0, 0, 1}, true});
  EXPECT_GT(gone, 500u);
  for (int w = 0; w < 6; ++w) {
    const dem::WindowOutcome &of_many = many.advance(300, dt), &of_few = few.advance(300, dt);
    EXPECT_EQ(of_many.window.rebuilds, of_few.window.rebuilds);
    EXPECT_EQ(of_many.window.indices<200, w> 0) << "from the second list on";
    if (GetParam().full())
      // Sums have another order.
      EXPECT_LT(largest_distance(many.state(), few.state()), 1e-12) << "window " << w;
    else
      EXPECT_EQ(many.state().position, few.state().position) << "window " << w;
  }
}

// A frame has what the state has, without the spheres that have gone.
TEST_P(EveryLaw, FrameHasTheSpheresOfTheState) {
  ParticleRun run(falling(GetParam(), "", 600));
  run.advance(100, dt);
  const std::uint64_t gone = run.engine->remove({{0, 0, 0.08}, {}, {0, 0, 1}, true});
  EXPECT_GT(gone, 400u);
  const particles::Spheres state = run.state();
  dem::SphereFrame frame;
  run.engine->download(frame);
  EXPECT_EQ(frame.id, state.id);
  ASSERT_EQ(frame.position.size(), 3 * state.size());
  for (std::size_t i = 0; i < state.size(); ++i) {
    EXPECT_EQ(frame.radius[i], static_cast<float>(state.radius[i]));
    for (int a = 0; a < 3; ++a) {
      const std::size_t k = 3 * i + static_cast<std::size_t>(a);
      EXPECT_EQ(frame.position[k], state.position[i][a]);
      EXPECT_EQ(frame.velocity[k], static_cast<float>(state.velocity[i][a]));
      EXPECT_EQ(frame.spin[k], static_cast<float>(state.spin[i][a]));
    }
  }
}

// A step throws two spheres apart faster than a run admits; another sphere leaves the domain in the same
// step, and one only moves.
TEST(Engine, AFailureTellsWhatSpheresWereBefore) {
  for (const char* precision : {R"("precision": "mixed",)", R"("precision": "double",)"}) {
    std::string scene = falling_spheres("hertz_mindlin", precision, 4);
    const std::string soft = R"("young": 1e7)";
    scene.replace(scene.find(soft), soft.size(), R"("young": 1e13)");
    ParticleRun run(scene, Backend::cpu, 1, [](particles::Spheres& s) {
      s.radius = {0.01, 0.01, 0.01, 0.01};
      s.position = {{0, 0, 0.4}, {0.012, 0, 0.4}, {0.1, 0.1, 0.6}, {-0.1, 0.1, 0.5}};
      s.velocity = {{}, {}, {0, 0, 2000}, {0.001, 0, 0}};
      s.spin = {{1, 2, 3}, {0, -5, 4}, {7, 8, 9}, {2, 2, 2}};
    });
    run.advance(1, 1e-12);
    const particles::Spheres expected = run.state();
    try {
      run.advance(1, 1e-4);
      FAIL() << "no sphere is too fast";
    } catch (const dem::SphereError& e) {
      EXPECT_EQ(e.id, 0u);
      EXPECT_NE(std::string(e.what()).find("above 100000 m/s"), std::string::npos) << e.what();
      ASSERT_EQ(e.before.id, expected.id);
      EXPECT_LT(largest_distance(e.before, expected), 1e-9);
      EXPECT_EQ(e.before.spin, expected.spin);
      EXPECT_EQ(e.before.velocity[0], expected.velocity[0]);
      EXPECT_EQ(e.before.velocity[1], expected.velocity[1]);
    }
  }
}

// A sphere deep in the floor, and one with a higher id that is too fast, which is the graver error.
TEST(Engine, OfTwoErrorsTheGraverOneIsToldWithItsSphere) {
  for (const bool fast : {false, true}) {
    ParticleRun run(falling_spheres("hertz_mindlin", "", 2), Backend::cpu, 1, [&](particles::Spheres& s) {
      s.radius = {0.01, 0.01};
      s.position = {{0.2, 0.2, -0.058}, {0, 0, 0.4}};
      s.velocity = {{0, 0, -1000}, {0, 0, fast ? 2e5 : 1.0}};
    });
    try {
      run.advance(1, 1e-9);
      FAIL() << "nothing is wrong";
    } catch (const dem::SphereError& e) {
      const std::string text = e.what();
      EXPECT_EQ(e.id, fast ? 1u : 0u);
      EXPECT_NE(text.find(fast ? "above 100000 m/s" : "range of the exact sums"), std::string::npos) << text;
      EXPECT_NE(text.find(fast ? "sphere 1," : "sphere 0,"), std::string::npos) << text;
    }
  }
}

// In so long a step a sphere of 1e5 m/s would reach coordinates beyond the range of centres.
TEST(Engine, SpheresDoNotLeaveTheCountInOneStep) {
  for (const auto& [precision, fails] : {std::pair("mixed", true), std::pair("double", false)}) {
    ParticleRun run(
        falling_spheres("hertz_mindlin", R"("precision": ")" + std::string(precision) + R"(",)", 1),
        Backend::cpu, 1, [](particles::Spheres& s) {
          s.radius = {0.01};
          s.position = {{0, 0, 0.4}};
          s.velocity = {{0, 0, 9e4}};
        });
    std::string said;
    std::uint64_t lost = 0;
    try {
      lost = run.advance(1, 0.01).window.lost;
    } catch (const dem::SphereError& e) {
      said = e.problem();
    }
    EXPECT_EQ(lost, fails ? 0u : 1u);
    EXPECT_EQ(said, fails ? "a sphere's velocity is not finite or above 3200 m/s" : "");
  }
}

// The energy balance has room for speeds of 10 km/s; this energy is the 2^-68th part of that.
TEST(Engine, BooksKnowTheEnergyOfSpheresThatHardlyMove) {
  ParticleRun run(falling_spheres("hertz_mindlin", "", 2), Backend::cpu, 1, [](particles::Spheres& s) {
    s.radius = {0.01, 0.01};
    s.position = {{0, 0, 0.3}, {0.1, 0, 0.3}};
    s.velocity = {{1e-6, 0, 0}, {0, -2e-6, 2e-6}};
    s.spin = {{}, {}};
  });
  const dem::WindowOutcome& o = run.advance(1, dt);
  const double mass = o.begin.mass / 2, expected = 0.5 * mass * (1e-12 + 8e-12);
  std::printf("expected %.9e J, recorded %.9e J, tolerance 1e-6\n", expected, o.begin.kinetic_energy);
  EXPECT_NEAR(o.begin.kinetic_energy, expected, 1e-6 * expected);
}

// Positions are counted in quanta modulo 2^32: spheres 2^32 quanta apart appear to be at one position. In a
// vast domain they share a cell.
TEST(Engine, SpheresFarApartInAVastDomainDoNotTouch) {
  const std::string json = falling_spheres("hertz_mindlin", "", 2);
  const std::string domain = R"("domain": {"min": [-0.3, -0.3, -0.1], "max": [0.3, 0.3, 0.8]})";
  std::string vast = json;
  vast.replace(vast.find(domain), domain.size(),
               R"("domain": {"min": [-15, -15, -15], "max": [15, 15, 15]})");
  // A length of 0.025 m, twice radius and skin, is below 2^30 quanta of 2^-35 m.
  const double apart = std::ldexp(1.0, 32 - 35);
  ParticleRun run(vast, Backend::cpu, 1, [&](particles::Spheres& s) {
    s.radius = {0.01, 0.01};
    s.position = {{0.03, 0, 0.3}, {0.03 + apart + 0.015, 0, 0.3}};
    s.velocity = {{}, {}};
  });
  const dem::WindowOutcome& o = run.advance(1, dt);
  EXPECT_EQ(o.end.contacts, 0u);
  EXPECT_EQ(o.window.list_entries, 0u);
}

TEST(Engine, SphereThatLeavesTheDomainIsCountedWithItsMomentum) {
  const std::string json = falling_spheres("hertz_frictionless", "", 1);
  ParticleRun run(json, Backend::cpu, 1, [](particles::Spheres& s) {
    s.position = {{0, 0, 0.79}};
    s.velocity = {{0, 0, 5}};
  });
  const dem::WindowOutcome& o = run.advance(500, dt);
  EXPECT_EQ(o.window.lost, 1u);
  EXPECT_EQ(run.state().size(), 0u);
  const Vec3d residual = o.end.momentum - o.begin.momentum + o.lost_momentum - o.gravity_impulse;
  EXPECT_LT(norm(residual), 1e-12 * norm(o.begin.momentum));
}

TEST(Engine, NotANumberIsAnErrorThatNamesTheSphere) {
  ParticleRun run(falling_spheres("hertz_mindlin", "", 20), Backend::cpu, 1,
                  [](particles::Spheres& s) { s.velocity[13].y = std::nan(""); });
  try {
    run.advance(10, dt);
    FAIL() << "a NaN passed";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::numerics);
    EXPECT_NE(e.where().find("sphere 13"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace tandem::test
