// The two back ends must give the same bits. These tests need a CUDA device; launch/test_device runs them,
// not ctest, since a machine without a GPU could only skip them.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "common/error.hpp"
#include "dem_server/coupling/state_hash.hpp"
#include "dem_server/coupling/tangents.hpp"
#include "tests/support/boulder.hpp"
#include "tests/support/flow.hpp"
#include "tests/support/neighbours.hpp"
#include "tests/support/particle_run.hpp"
#include "tests/support/particle_scenes.hpp"
#include "tests/support/periodic_scene.hpp"
#include "tests/support/tool_scene.hpp"

namespace tandem::test {
namespace {

using particles::Backend;
constexpr double dt = 2e-5;  // [s]

struct Case {
  const char *name, *law, *options;
};
class BackEnds : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Variants, BackEnds,
    testing::Values(Case{"hertz_mindlin", "hertz_mindlin", ""},
                    Case{"hertz_frictionless", "hertz_frictionless", ""}, Case{"paper", "paper", ""},
                    Case{"generic", "hertz_mindlin", R"("variant": "generic",)"}, Case{"hooke", "hooke", ""},
                    Case{"jkr", "jkr", R"("rolling": "elastic_plastic", "twisting": "elastic_plastic",)"},
                    Case{"sjkr", "sjkr", R"("rolling": "elastic_plastic",)"},
                    Case{"generic_double", "hertz_mindlin", R"("precision": "double",)"}),
    [](const auto& c) { return std::string(c.param.name); });

// Scenes as small as these run in shared memory (dem_server/backend/cuda/resident/resident.cuh). While
// ThroughMemory exists, new engines run like those of large scenes: with the spheres in global memory, and
// `lanes` threads per sphere.
struct ThroughMemory {
  explicit ThroughMemory(const char* lanes) {
    setenv("TANDEM_CUDA_REGIONS", "0", 1);
    setenv("TANDEM_CUDA_LANES", lanes, 1);
  }
  ~ThroughMemory() {
    unsetenv("TANDEM_CUDA_LANES");
    unsetenv("TANDEM_CUDA_REGIONS");
  }
};
template <class Change>
std::unique_ptr<ParticleRun> through_memory(const std::string& json, const char* lanes, Change change) {
  const ThroughMemory those_made_now(lanes);
  return std::make_unique<ParticleRun>(json, Backend::cuda, 1, change);
}
std::unique_ptr<ParticleRun> through_memory(const std::string& json, const char* lanes = "2") {
  return through_memory(json, lanes, [](particles::Spheres&) {});
}

void expect_same_bits(const dem::WindowOutcome& a, const dem::WindowOutcome& b) {
  EXPECT_EQ(a.window.rebuilds, b.window.rebuilds);
  EXPECT_EQ(a.window.max_overlap_ratio, b.window.max_overlap_ratio);
  EXPECT_EQ(a.max_overlap_ratio, b.max_overlap_ratio);
  EXPECT_EQ(a.max_speed, b.max_speed);
  EXPECT_EQ(a.end.momentum, b.end.momentum);
  EXPECT_EQ(a.end.contacts, b.end.contacts);
  for (std::size_t i = 0; i < a.load.size(); ++i) {
    ASSERT_EQ(a.load[i].force, b.load[i].force);
    ASSERT_EQ(a.load[i].torque, b.load[i].torque);
  }
}

TEST_P(BackEnds, GiveTheSameBits) {
  const std::string json = falling_spheres(GetParam().law, GetParam().options);
  ParticleRun cpu(json, Backend::cpu, 0), resident(json, Backend::cuda);
  const auto memory = through_memory(json), one_lane = through_memory(json, "1");
  for (int w = 0; w < 12; ++w) {
    const dem::WindowOutcome& expected = cpu.advance(400, dt);
    for (ParticleRun* cuda : {&resident, memory.get(), one_lane.get()}) {
      expect_same_bits(expected, cuda->advance(400, dt));
      ASSERT_EQ(dem::state_hash(cpu.state()), dem::state_hash(cuda->state())) << "window " << w;
    }
  }
  EXPECT_GT(resident.engine->regions(), 1u);
  EXPECT_EQ(memory->engine->regions(), 0u);
}

// Few regions are large ones: a thread then has more than one sphere where the bed is loose, and a region's
// spheres are in contact with many walls.
TEST_P(BackEnds, LargeRegionsGiveTheSameBits) {
  const std::string json = falling_spheres(GetParam().law, GetParam().options, 1000);
  ParticleRun cpu(json, Backend::cpu, 0);
  // In double precision a region holds half as many.
  const bool twice_as_large = std::string_view(GetParam().name) == "generic_double";
  setenv("TANDEM_CUDA_REGIONS", twice_as_large ? "4" : "2", 1);
  ParticleRun cuda(json, Backend::cuda);
  unsetenv("TANDEM_CUDA_REGIONS");
  for (int w = 0; w < 12; ++w) {
    expect_same_bits(cpu.advance(400, dt), cuda.advance(400, dt));
    ASSERT_EQ(dem::state_hash(cpu.state()), dem::state_hash(cuda.state())) << "window " << w;
  }
  EXPECT_EQ(cuda.engine->regions(), twice_as_large ? 4u : 2u);
}

// The spheres are loose at first and have few neighbours. Then they form a heap with so many neighbours that
// no region fits: a rebuild during the run finds that, and the run continues with the spheres in global
// memory. The lists of a warp then also exceed found_room (dem_server/backend/cuda/fill_lists.cuh).
TEST_P(BackEnds, RegionsThatNoLongerFitGiveTheSameBits) {
  const std::string json =
      falling_spheres(GetParam().law, std::string(GetParam().options) + R"("skin": 0.012,)", 1000);
  const auto start = [](particles::Spheres& s) {
    for (std::size_t i = 0; i < s.size(); ++i) {
      s.radius[i] = 0.003;
      const double jitter = 1e-3 * std::sin(static_cast<double>(i));
      s.position[i] = {-0.09 + 0.015 * static_cast<double>(i % 13) + jitter,
                       -0.09 + 0.015 * static_cast<double>(i / 13 % 13) - jitter,
                       0.1 + 0.015 * static_cast<double>(i / 169)};
      s.velocity[i] = {0.1, 0, -2};
    }
  };
  ParticleRun cpu(json, Backend::cpu, 0, start);
  setenv("TANDEM_CUDA_REGIONS", "2", 1);
  ParticleRun cuda(json, Backend::cuda, 1, start);
  unsetenv("TANDEM_CUDA_REGIONS");
  const auto one_lane = through_memory(json, "1", start);
  for (int w = 0; w < 20; ++w) {
    const dem::WindowOutcome& expected = cpu.advance(400, dt);
    for (ParticleRun* run : {&cuda, one_lane.get()}) {
      expect_same_bits(expected, run->advance(400, dt));
      ASSERT_EQ(dem::state_hash(cpu.state()), dem::state_hash(run->state())) << "window " << w;
    }
    if (w == 0) {
      EXPECT_EQ(cuda.engine->regions(), 2u);
    }
  }
  EXPECT_EQ(cuda.engine->regions(), 0u);
}

// Windows end anywhere between two rebuilds; each one continues from the state that the previous one left on
// the device.
TEST_P(BackEnds, ShortWindowsGiveTheSameBits) {
  const std::string json = falling_spheres(GetParam().law, GetParam().options);
  ParticleRun cpu(json, Backend::cpu, 0), resident(json, Backend::cuda);
  const auto memory = through_memory(json);
  for (ParticleRun* run : {&cpu, &resident, memory.get()}) run->advance(2400, dt);
  for (int round = 0; round < 20; ++round)
    for (const std::uint32_t steps : {1u, 3u, 7u, 2u, 40u}) {
      const dem::WindowOutcome& expected = cpu.advance(steps, dt);
      expect_same_bits(expected, resident.advance(steps, dt));
      expect_same_bits(expected, memory->advance(steps, dt));
    }
  EXPECT_EQ(dem::state_hash(cpu.state()), dem::state_hash(resident.state()));
  EXPECT_EQ(dem::state_hash(cpu.state()), dem::state_hash(memory->state()));
}

// The boulder has several hundred neighbours, which a warp tests together.
TEST(Boulder, AmongSmallSpheresGivesTheSameBits) {
  for (const char* law : {"hertz_mindlin", "hertz_frictionless", "jkr"}) {
    const std::string json = falling_spheres(law);
    ParticleRun cpu(json, Backend::cpu, 0, make_boulder), resident(json, Backend::cuda, 1, make_boulder);
    const auto memory = through_memory(json, "2", make_boulder),
               one_lane = through_memory(json, "1", make_boulder);
    std::size_t most = 0;
    for (int w = 0; w < 20; ++w) {
      const dem::WindowOutcome& expected = cpu.advance(50, dt);
      for (ParticleRun* cuda : {&resident, memory.get(), one_lane.get()}) {
        expect_same_bits(expected, cuda->advance(50, dt));
        ASSERT_EQ(dem::state_hash(cpu.state()), dem::state_hash(cuda->state())) << law << " window " << w;
      }
      most = std::max(most, neighbours_of(cpu, 0).size());
    }
    EXPECT_GT(most, 128u);
    EXPECT_GT(resident.engine->regions(), 1u);
  }
}

// Fixed spheres are curved walls.
TEST(FixedSpheres, UnderFallingOnesGiveTheSameBits) {
  for (const char* law : {"hertz_mindlin", "hertz_frictionless", "jkr"}) {
    auto scene = nlohmann::json::parse(falling_spheres(law));
    scene["dem"]["particles"].push_back(nlohmann::json::parse(
        R"({"name": "floor", "material": "steel", "radius": 0.006, "fixed": true,
            "fill": {"type": "lattice", "min": [-0.1, -0.1, 0.0], "max": [0.1, 0.1, 0.012], "spacing": 0.0125}})"));
    const std::string json = scene.dump();
    ParticleRun cpu(json, Backend::cpu, 0), resident(json, Backend::cuda);
    const auto memory = through_memory(json);
    std::uint64_t contacts = 0;
    for (int w = 0; w < 10; ++w) {
      const dem::WindowOutcome& expected = cpu.advance(400, dt);
      contacts += expected.end.contacts;
      expect_same_bits(expected, resident.advance(400, dt));
      expect_same_bits(expected, memory->advance(400, dt));
      ASSERT_EQ(dem::state_hash(cpu.state()), dem::state_hash(resident.state())) << law << " window " << w;
      ASSERT_EQ(dem::state_hash(cpu.state()), dem::state_hash(memory->state())) << law << " window " << w;
    }
    EXPECT_GT(contacts, 20u);
  }
}

// A short test for launch/test_device --sanitizer, with fast spheres and long steps.
TEST_P(BackEnds, FewStepsGiveTheSameBits) {
  constexpr std::string_view slow = "[0.1, 0, -1]";
  std::string json = falling_spheres(GetParam().law, GetParam().options, 400);
  json.replace(json.find(slow), slow.size(), "[0.1, 0, -3]");
  ParticleRun cpu(json, Backend::cpu, 0), cuda(json, Backend::cuda);
  const auto memory = through_memory(json), one_lane = through_memory(json, "1");
  std::uint64_t contacts = 0;
  for (int w = 0; w < 12; ++w) {
    cpu.advance(25, 5 * dt);
    for (ParticleRun* through : {memory.get(), one_lane.get()}) through->advance(25, 5 * dt);
    contacts += cuda.advance(25, 5 * dt).end.contacts;
    for (const ParticleRun* run : {&cuda, memory.get(), one_lane.get()})
      ASSERT_EQ(dem::state_hash(cpu.state()), dem::state_hash(run->state())) << "window " << w;
  }
  EXPECT_GT(contacts, 20u);
}

// A setting that no GPU can fulfil must be refused, not replaced by another number.
TEST(BackEndSettings, WrongOnesAreRefused) {
  const std::string json = falling_spheres("hertz_mindlin", "");
  const auto refusal = [&](const char* name, const char* value) -> std::string {
    setenv(name, value, 1);
    std::string said = "nothing";
    try {
      ParticleRun(json, Backend::cuda);
    } catch (const Error& e) {
      said = e.what();
    }
    unsetenv(name);
    return said;
  };
  EXPECT_EQ(refusal("TANDEM_CUDA_BLOCK", "33"),
            "TANDEM_CUDA_BLOCK: no block has 33 threads (say a multiple of 32)");
  EXPECT_EQ(refusal("TANDEM_CUDA_BLOCK", "0"),
            "TANDEM_CUDA_BLOCK: no block has 0 threads (say a multiple of 32)");
  for (const char* name :
       {"TANDEM_CUDA_BLOCK", "TANDEM_CUDA_REGIONS", "TANDEM_CUDA_LANES", "TANDEM_CUDA_GRAPHS"})
    for (const char* value : {"64abc", "", "-1", " 64", "99999999999"})
      EXPECT_EQ(refusal(name, value), std::string(name) + ": \"" + value +
                                          "\" is not a whole number (say one, or unset the variable)");
  EXPECT_EQ(refusal("TANDEM_CUDA_BLOCK", "64"), "nothing");
}

// The number of threads in a block determines which thread computes what, and the number of partial sums of
// the loads.
TEST_P(BackEnds, OtherBlocksGiveTheSameBits) {
  const std::string json = falling_spheres(GetParam().law, GetParam().options);
  ParticleRun cpu(json, Backend::cpu, 0);
  std::vector<std::unique_ptr<ParticleRun>> runs;
  for (const char* threads : {"32", "64", "96"}) {
    setenv("TANDEM_CUDA_BLOCK", threads, 1);
    for (const char* lanes : {"1", "2"}) runs.push_back(through_memory(json, lanes));
  }
  unsetenv("TANDEM_CUDA_BLOCK");
  for (int w = 0; w < 8; ++w) {
    const dem::WindowOutcome& expected = cpu.advance(400, dt);
    for (const auto& run : runs) {
      expect_same_bits(expected, run->advance(400, dt));
      ASSERT_EQ(dem::state_hash(cpu.state()), dem::state_hash(run->state())) << "window " << w;
    }
  }
}

// An error names the same sphere and the same step, and has the same spheres before that step.
TEST_P(BackEnds, ErrorsOfASphereAreTheSame) {
  const std::string json = falling_spheres(GetParam().law, GetParam().options, 200);
  const auto error_of = [](ParticleRun& run, double step) -> std::optional<dem::SphereError> {
    try {
      for (int w = 0; w < 5; ++w) run.advance(40, step);
    } catch (const dem::SphereError& error) {
      return error;
    }
    return std::nullopt;
  };
  const auto expect_same = [&](auto start, double step) {
    ParticleRun cpu(json, Backend::cpu, 0, start), resident(json, Backend::cuda, 1, start);
    const auto memory = through_memory(json, "2", start), one_lane = through_memory(json, "1", start);
    const auto expected = error_of(cpu, step);
    std::printf("%s\n", expected ? expected->what() : "no error");
    for (ParticleRun* run : {&resident, memory.get(), one_lane.get()}) {
      const auto error = error_of(*run, step);
      EXPECT_EQ(error.has_value(), expected.has_value());
      if (!error || !expected) continue;
      EXPECT_STREQ(error->what(), expected->what());
      EXPECT_EQ(error->step, expected->step);
      EXPECT_EQ(dem::state_hash(error->before), dem::state_hash(expected->before));
    }
    return expected.has_value();
  };
  EXPECT_TRUE(expect_same([](particles::Spheres& s) { s.velocity[113].y = std::nan(""); }, dt));
  // Steps this long are far too long: where the law or the precision cannot bear it, the run ends within a
  // window.
  expect_same(
      [](particles::Spheres& s) {
        s.position[113] = {0, 0, 0.6};
        s.position[114] = {0, 0, 0.6 + 0.1 * s.radius[113]};
        s.position[115] = {0, 0, 0.6 - 0.1 * s.radius[113]};
      },
      400 * dt);
}

TEST_P(BackEnds, RestoredRunContinuesToTheSameBits) {
  ParticleRun run(falling_spheres(GetParam().law, GetParam().options), Backend::cuda);
  for (int w = 0; w < 6; ++w) run.advance(400, dt);
  run.engine->save();
  for (int w = 0; w < 3; ++w) run.advance(400, dt);
  const std::string first = dem::state_hash(run.state());
  run.engine->restore();
  for (int w = 0; w < 3; ++w) run.advance(400, dt);
  EXPECT_EQ(dem::state_hash(run.state()), first);
}

TEST(Domain, PeriodicGivesTheSameBits) {
  for (const char* options :
       {"{}", R"({"precision": "double"})", R"({"contact": "hertz_frictionless"})",
        R"({"contact": "jkr", "rolling": "elastic_plastic", "pairs": [{"a": "m", "b": "m",
                                  "restitution": 0.6, "friction": 0.4, "work_of_adhesion": 0.01, "rolling_friction": 0.1,
                                  "rolling_damping": 0.3}]})",
        R"({"particles": [{"name": "fine", "material": "m", "radius": 0.004,
                           "fill": {"type": "lattice", "min": [0, 0, 0], "max": [0.125, 0.125, 0.07],
                                    "spacing": 0.0085, "count": 600}},
                          {"name": "coarse", "material": "m", "radius": 0.014,
                           "fill": {"type": "lattice", "min": [0, 0, 0.07], "max": [0.125, 0.125, 0.12],
                                    "spacing": 0.03, "count": 9}}]})"}) {
    const std::string json = chute(nlohmann::json::parse(options)).json();
    ParticleRun cpu(json, Backend::cpu, 0), resident(json, Backend::cuda);
    const auto one_lane = through_memory(json, "1");
    std::uint64_t contacts = 0;
    for (int w = 0; w < 12; ++w) {
      const dem::WindowOutcome& a = cpu.advance(300, dt);
      contacts += a.end.contacts;
      for (ParticleRun* cuda : {&resident, one_lane.get()}) {
        const dem::WindowOutcome& b = cuda->advance(300, dt);
        ASSERT_EQ(dem::state_hash(cpu.state()), dem::state_hash(cuda->state())) << options << " window " << w;
        EXPECT_EQ(a.window.rebuilds, b.window.rebuilds);
        EXPECT_EQ(a.end.momentum, b.end.momentum);
        EXPECT_EQ(a.end.contacts, b.end.contacts);
      }
    }
    EXPECT_GT(contacts, 200u);
  }
}

// The domain leaves spheres behind between windows and within them.
TEST(Domain, ThatFollowsABodyGivesTheSameBits) {
  for (const char* options : {"{}", R"({"contact": "hertz_frictionless"})", R"({"precision": "double"})"}) {
    const std::string json = tool_scene(nlohmann::json::parse(options)).dump();
    const auto push = [](particles::Spheres& s) {
      for (std::size_t i = 0; i < s.size(); ++i)
        s.velocity[i] = {0.5 * std::sin(static_cast<double>(i)), 0.2, -1};
    };
    ParticleRun cpu(json, Backend::cpu, 0, push), resident(json, Backend::cuda, 0, push);
    const auto one_lane = through_memory(json, "1", push);
    for (int w = 0; w < 12; ++w) {
      const Pose pose{{0.4, 0.05, 0.2}, {}};
      const std::vector<particles::PreparedPath> paths = {
          particles::prepare_path({}, 100 * dt), particles::prepare_path({pose, pose, {}, {}}, 100 * dt)};
      const dem::WindowPlan plan{100, dt, paths, 0, 0, {0.02 * w, 0, 0}};
      const dem::WindowOutcome& a = cpu.engine->advance(plan);
      for (ParticleRun* cuda : {&resident, one_lane.get()}) {
        const dem::WindowOutcome& b = cuda->engine->advance(plan);
        ASSERT_EQ(dem::state_hash(cpu.state()), dem::state_hash(cuda->state())) << options << " window " << w;
        EXPECT_EQ(a.window.lost, b.window.lost);
        EXPECT_EQ(a.lost_momentum, b.lost_momentum);
        EXPECT_EQ(a.end.momentum, b.end.momentum);
      }
    }
    EXPECT_LT(cpu.state().size(), cpu.spheres.size() - 50);
    EXPECT_GT(cpu.state().size(), 20u);
  }
}

// Stiffness and damping of the contacts of a body.
TEST_P(BackEnds, TangentsAreTheSame) {
  auto scene = nlohmann::json::parse(falling_spheres(GetParam().law, GetParam().options));
  scene["mbd"]["bodies"] = {
      {{"name", "tool"}, {"mass", 1}, {"inertia", {1, 1, 1}}, {"position", {0.01, 0.02, 0}}}};
  for (const int wall : {1, 2, 3}) scene["dem"]["walls"][wall]["body"] = "tool";
  const std::string json = scene.dump();
  ParticleRun cpu(json, Backend::cpu, 0), resident(json, Backend::cuda);
  const auto memory = through_memory(json);
  int touched = 0;
  for (int w = 0; w < 12; ++w) {
    std::vector<particles::BodyPose> poses;
    for (const BodyId body : cpu.surface.boundary_bodies) {
      const Pose pose = body == ground ? Pose{} : cpu.scene.mbd->bodies[body.value].pose;
      poses.push_back({pose.p_WB, pose.q_WB.matrix(), {}, {}});
    }
    cpu.advance(400, dt);
    const auto expected = dem::body_tangents(cpu.engine->wall_tangents(poses), cpu.surface.boundary_bodies);
    touched += static_cast<int>(expected.size());
    for (ParticleRun* cuda : {&resident, memory.get()}) {
      cuda->advance(400, dt);
      const auto bodies = dem::body_tangents(cuda->engine->wall_tangents(poses), cpu.surface.boundary_bodies);
      ASSERT_EQ(bodies.size(), expected.size()) << "window " << w;
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        EXPECT_EQ(bodies[b].stiffness, expected[b].stiffness) << "window " << w;
        EXPECT_EQ(bodies[b].damping, expected[b].damping) << "window " << w;
      }
    }
  }
  EXPECT_GT(touched, 3);
}

// Also before the first window, and on spheres in shared memory.
TEST_P(BackEnds, ContactsOfSpheresHaveTheSameBits) {
  auto scene = nlohmann::json::parse(falling_spheres(GetParam().law, GetParam().options));
  scene["output"]["fields"] = {"contact_count", "mean_stress"};
  const std::string json = scene.dump();
  ParticleRun cpu(json, Backend::cpu, 0), resident(json, Backend::cuda);
  const auto memory = through_memory(json);
  const std::vector<particles::BodyPose> poses(cpu.surface.boundary_bodies.size(),
                                               {{}, Quat{}.matrix(), {}, {}});
  std::uint32_t contacts = 0;
  for (int w = 0; w < 12; ++w) {
    dem::ContactsFrame expected, found;
    cpu.engine->download({poses, dt}, expected);
    for (const std::uint32_t count : expected.count) contacts += count;
    for (ParticleRun* cuda : {&resident, memory.get()}) {
      cuda->engine->download({poses, dt}, found);
      EXPECT_EQ(found.count, expected.count) << "window " << w;
      EXPECT_EQ(found.mean_stress, expected.mean_stress) << "window " << w;
      cuda->advance(400, dt);
    }
    cpu.advance(400, dt);
    EXPECT_EQ(dem::state_hash(resident.state()), dem::state_hash(cpu.state())) << "window " << w;
  }
  EXPECT_GT(contacts, 100u);
}

// What spheres do to walls, the contacts of a body, and the dissipated energy, where the law has it.
TEST_P(BackEnds, SumsOfWallsAndEnergiesHaveTheSameBits) {
  auto scene = nlohmann::json::parse(falling_spheres(GetParam().law, GetParam().options));
  const std::string law = GetParam().law;
  scene["output"] = {{"wall_fields", {"plate", "box"}}, {"contacts", {"ground"}}};
  scene["output"]["dissipation"] = law == "hertz_mindlin" || law == "hertz_frictionless" || law == "hooke";
  for (const char* wall : {"box", "post", "floor"})
    scene["dem"]["sensors"].push_back({{"name", std::string("on_") + wall}, {"wall", wall}});
  const std::string json = scene.dump();
  ParticleRun cpu(json, Backend::cpu, 0), resident(json, Backend::cuda);
  const auto memory = through_memory(json);
  const std::vector<particles::BodyPose> poses(cpu.surface.boundary_bodies.size(),
                                               {{}, Quat{}.matrix(), {}, {}});
  const std::vector<std::uint8_t> wanted(poses.size(), 1);
  const auto values = [](const std::vector<dem::BodyContact>& contacts) {
    std::vector<double> all;
    for (const dem::BodyContact& c : contacts)
      all.insert(all.end(), {static_cast<double>(c.sphere), c.point.x, c.point.y, c.point.z, c.force.x,
                             c.force.y, c.force.z});
    return all;
  };
  std::size_t contacts = 0;
  for (int w = 0; w < 12; ++w) {
    const std::vector<double> of_body = values(cpu.engine->body_contacts({poses, dt}, wanted)),
                              means = cpu.advance(400, dt).wall_means, fields = cpu.engine->wall_fields();
    contacts += of_body.size();
    for (ParticleRun* cuda : {&resident, memory.get()}) {
      EXPECT_EQ(values(cuda->engine->body_contacts({poses, dt}, wanted)), of_body) << "window " << w;
      EXPECT_EQ(cuda->advance(400, dt).wall_means, means) << "window " << w;
      EXPECT_EQ(cuda->engine->wall_fields(), fields) << "window " << w;
      EXPECT_EQ(cuda->engine->dissipated(), cpu.engine->dissipated()) << "window " << w;
    }
  }
  EXPECT_GT(contacts, 100u);
}

// Restart files rely on this.
TEST_P(BackEnds, AnotherEngineContinuesToTheSameBits) {
  const std::string json = falling_spheres(GetParam().law, GetParam().options);
  ParticleRun run(json, Backend::cuda), fresh(json, Backend::cuda);
  for (int w = 0; w < 6; ++w) run.advance(400, dt);
  const Arrays arrays = written(run);
  for (int w = 0; w < 3; ++w) run.advance(400, dt);
  fresh.engine->read([&](const std::string& name) { return arrays.at(name); });
  for (int w = 0; w < 3; ++w) fresh.advance(400, dt);
  EXPECT_EQ(dem::state_hash(fresh.state()), dem::state_hash(run.state()));
}

TEST_P(BackEnds, MemoryIsKnownBeforeTheEngineIsMade) {
  ParticleRun run(falling_spheres(GetParam().law, GetParam().options), Backend::cuda);
  const dem::EngineChoice choice = dem::choose_engine(run.scene, Backend::cuda);
  dem::EngineSetup setup{run.scene, run.surface, run.spheres, run.skins, 1};
  setup.neighbours = particles::most_neighbours(run.skins);
  setup.contacts = particles::most_contacts;
  setup.walls = particles::most_walls;
  EXPECT_EQ(dem::predicted_bytes(choice, setup, false), dem::make_engine(choice, setup)->memory_bytes());
}

// Spheres come in, heap up and go out, with rollbacks in between.
TEST(Traffic, GivesTheSameBits) {
  struct Setup {
    const char* options;
    bool one_lane;
  };
  for (const auto [options, one_lane] :
       {Setup{"", false}, Setup{R"({"precision": "double"})", false}, Setup{"", true}}) {
    std::optional<ThroughMemory> those_made_now;
    if (one_lane) those_made_now.emplace("1");
    nlohmann::json scene = heap(options);
    scene["dem"]["sensors"] = {
        {{"name", "gate"},
         {"position", {0, 0, 0.1}},
         {"orientation", {{"axis", {0.6, 0, 0.8}}, {"angle", 0.5}}},
         {"shape", {{"type", "box"}, {"size", {0.3, 0.3, 0.2}}}},
         {"flow", "z"}},
        {{"name", "round"}, {"shape", {{"type", "cylinder"}, {"radius", 0.2}, {"height", 1}}}}};
    Rain cpu(scene, 0, "cpu"), cuda(scene, 0, "cuda");
    those_made_now.reset();
    for (int w = 0; w < 12; ++w) {
      cuda.solver->save();
      const Nanoseconds now = cuda.now;
      cuda.advance(3);
      cuda.solver->restore();
      cuda.now = now;
      cpu.advance(10);
      cuda.advance(10);
      ASSERT_EQ(cpu.hash(), cuda.hash()) << options << " window " << 10 * (w + 1);
      ASSERT_EQ(cpu.sensed, cuda.sensed) << options << " window " << 10 * (w + 1);
    }
    EXPECT_NE(cpu.sensed.at(12), 0);  // has passed the gate
    EXPECT_EQ(cpu.report()["came_in"], cuda.report()["came_in"]);
    EXPECT_GT(cuda.report()["went_out"], gone_at_once + 10);
    EXPECT_EQ(cpu.report()["went_out"], cuda.report()["went_out"]);
  }
}

}  // namespace
}  // namespace tandem::test
