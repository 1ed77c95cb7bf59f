// Histories of existing contacts, which a rebuild of the lists carries over.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "dem_server/contact/view.hpp"
#include "dem_server/coupling/state_hash.hpp"
#include "tests/support/particle_run.hpp"
#include "tests/support/particle_scenes.hpp"

namespace tandem::test {
namespace {

using particles::Backend;

constexpr double dt = 2e-5;  // [s]

struct Law {
  const char *name, *options;
};
void PrintTo(const Law& law, std::ostream* out) {
  *out << law.name;
}
constexpr Law laws[] = {{"hertz_mindlin", ""},
                        {"jkr", R"("rolling": "elastic_plastic", "twisting": "elastic_plastic",)"}};
class Rebuild : public testing::TestWithParam<Law> {
 protected:
  static std::string falling(int count, const std::string& options = "") {
    return falling_spheres(GetParam().name, GetParam().options + options, count);
  }
};
INSTANTIATE_TEST_SUITE_P(Laws, Rebuild, testing::ValuesIn(laws),
                         [](const auto& law) { return std::string(law.param.name); });

// State of the contacts of two spheres, or of one, in mixed precision.
struct Contacts {
  std::uint32_t in_contact = 0;  // entries in contact in the last micro step
  bool in_order = false;         // sphere 0 has the lower index
  Vec3f spring, rolled;          // of sphere 0 relative to the other
  float twisted = 0;             // [rad]

  explicit Contacts(const ParticleRun& run) {
    const Arrays arrays = written(run);
    const auto window = array_of<particles::WindowProgress>(arrays, "host_window_progress").front();
    in_order = ids_of(arrays).front() == 0;
    const auto take = [&](const std::string& list, std::uint64_t entries, auto is_in_contact,
                          auto spring_of) {
      const auto rolling = array_of<dem::RollingSpring<float>>(arrays, list + ".rolling_spring");
      for (std::uint32_t k = 0; k < entries; ++k) {
        if (!is_in_contact(k)) continue;
        ++in_contact;
        spring = in_order ? spring_of(k) : -spring_of(k);
        if (rolling.empty()) continue;
        rolled = in_order ? rolling[k].rolled : -rolling[k].rolled;
        twisted = rolling[k].twisted;
      }
    };
    const auto pair = array_of<dem::Neighbour>(arrays, "pairs.entry");
    const auto springs = array_of<Vec3f>(arrays, "pairs.spring");
    take(
        "pairs", window.list_entries, [&](auto k) { return pair[k].in_contact(); },
        [&](auto k) { return springs[k]; });
    const auto wall = array_of<dem::History<float>>(arrays, "walls.history");
    take(
        "walls", window.wall_entries, [&](auto k) { return wall[k].stamp == window.progress[0].stamp - 1; },
        [&](auto k) { return wall[k].spring; });
  }
};

void expect_little_change(const char* what, double change, double size) {
  std::printf("  %s of %.3e changes by %.3e, tolerance 0.2 of it\n", what, size, change);
  EXPECT_GT(size, 0) << what;
  EXPECT_LT(change, 0.2 * size) << what;
}
// Change in one micro step of a contact that has lasted for many.
void expect_little_change(const Contacts& before, const Contacts& after) {
  expect_little_change("spring", norm(after.spring - before.spring), norm(before.spring));
  if (norm(before.rolled) == 0) return;
  expect_little_change("rolled angle", norm(after.rolled - before.rolled), norm(before.rolled));
  expect_little_change("twisted angle", std::abs(after.twisted - before.twisted), std::abs(before.twisted));
}

// Two spheres move together so fast that a list lasts two steps, and cross several layers of cells while in
// contact.
ParticleRun passing_cells(const std::string& scene) {
  return ParticleRun(scene, Backend::cpu, 1, [](particles::Spheres& s) {
    s.radius = {0.01, 0.01};
    s.position = {{-0.01, 0, 0.5}, {0.0095, 0.003, 0.497}};
    s.velocity = {{0.05, 0, -12}, {-0.05, 0.02, -12}};
    s.spin = {{3, 10, -8}, {-2, 12, 6}};
  });
}
// On the floor, nearly rolling, equally fast.
ParticleRun bouncing(const std::string& scene) {
  return ParticleRun(scene, Backend::cpu, 1, [](particles::Spheres& s) {
    s.radius = {0.01, 0.01};
    s.position = {{0.2, -0.2, -0.0398}, {0.2, 0.2, 0.5}};
    s.velocity = {{0, 8, -0.5}, {}};
    s.spin = {{-795, 0, 10}, {}};
  });
}
constexpr const char* thin = R"("skin": 0.0005,)";

// The sphere that is lower in space changes its cell, and with it its index, before the other one does.
TEST_P(Rebuild, AHistoryOutlivesThatItsSpheresChangeTheirOrder) {
  ParticleRun run = passing_cells(falling(2, thin));
  int there = 0, back = 0;
  Contacts before(run);
  for (int step = 0; step < 400; ++step) {
    run.advance(1, dt);
    const Contacts after(run);
    if (before.in_contact == 1 && after.in_contact == 1 && before.in_order != after.in_order) {
      ++(before.in_order ? there : back);
      expect_little_change(before, after);
    }
    before = after;
  }
  EXPECT_GT(there, 0);
  EXPECT_GT(back, 0);
}

TEST_P(Rebuild, AHistoryWithAWallOutlivesIt) {
  ParticleRun run = bouncing(falling(2, thin));
  int steps = 0, rebuilds = 0;  // since the contact began
  std::uint64_t rebuilds_before = 0;
  Contacts before(run);
  for (int step = 0; step < 400 && steps < 60; ++step) {
    const std::uint64_t rebuilds_now = run.advance(1, dt).window.rebuilds;
    const Contacts after(run);
    steps = after.in_contact == 1 ? steps + 1 : 0;
    if (steps > 20 && rebuilds_now > rebuilds_before) {
      ++rebuilds;
      expect_little_change(before, after);
    }
    rebuilds_before = rebuilds_now;
    before = after;
  }
  EXPECT_GT(rebuilds, 5);
}

// Separated spheres, and a wall that has been left, stay listed for some time.
TEST_P(Rebuild, WhatTouchesIsCarriedOverAndNothingElse) {
  const std::string scene = falling(2, thin);
  ParticleRun pair = passing_cells(scene), wall = bouncing(scene);
  for (ParticleRun* run : {&pair, &wall}) {
    int with = 0, without = 0;
    std::uint64_t rebuilds = 1;
    Contacts before(*run);
    for (int step = 0; step < 800; ++step) {
      const particles::WindowProgress c = run->advance(1, dt).window;
      if (c.rebuilds > rebuilds) {
        ASSERT_EQ(c.carried_entries, before.in_contact) << step;
        const bool listed = c.list_entries + c.wall_entries > 0;
        with += before.in_contact > 0;
        without += listed && before.in_contact == 0;
      }
      rebuilds = c.rebuilds;
      before = Contacts(*run);
    }
    EXPECT_GT(with, 5);
    EXPECT_GT(without, 5);
  }
}

TEST_P(Rebuild, ThatIsDoneAgainWithMoreRoomGivesTheSameBits) {
  const auto with_room_for = [](double neighbours, double contacts, double walls) {
    ParticleRun run(falling(300));
    dem::EngineSetup setup{run.scene, run.surface, run.spheres, run.skins, 1};
    setup.neighbours = neighbours;
    setup.contacts = contacts;
    setup.walls = walls;
    run.engine = dem::make_engine(dem::choose_engine(run.scene, Backend::cpu), setup);
    return run;
  };
  ParticleRun roomy = with_room_for(20, 10, 4), tight = with_room_for(20, 0, 0),
              tightest = with_room_for(0, 0, 0);
  for (int w = 0; w < 20; ++w)
    for (ParticleRun* run : {&roomy, &tight, &tightest}) run->advance(400, dt);
  const particles::WindowProgress c = tight.advance(1, dt).window;
  EXPECT_GT(std::min<std::uint64_t>(c.wall_entries, c.near), 64u) << "more than there is room for at first";
  for (ParticleRun* run : {&roomy, &tightest}) run->advance(1, dt);
  const Arrays expected = written(roomy), measured = written(tight);
  EXPECT_TRUE(measured.at("pairs.start") == expected.at("pairs.start"));
  const std::pair<std::string, std::size_t> parts[] = {
      {"pairs.entry", sizeof(dem::Neighbour)},
      {"pairs.spring", sizeof(Vec3f)},
      {"pairs.rolling_spring", sizeof(dem::RollingSpring<float>)},
      {"walls.entry", sizeof(std::uint32_t)},
      {"walls.history", sizeof(dem::History<float>)},
      {"walls.rolling_spring", sizeof(dem::RollingSpring<float>)},
      {"near", sizeof(dem::NearBody)}};
  for (const auto& [part, size] : parts) {
    // The memory of these lists differs.
    const auto &a = measured.at(part), &b = expected.at(part);
    const std::size_t entries = part == "near"              ? c.near
                                : part.starts_with("pairs") ? c.list_entries
                                                            : c.wall_entries,
                      used = a.empty() ? 0 : entries * size;
    ASSERT_EQ(a.empty(), b.empty());
    ASSERT_LE(used, std::min(a.size(), b.size()));
    EXPECT_TRUE(std::equal(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(used), b.begin())) << part;
  }
  EXPECT_EQ(dem::state_hash(tight.state()), dem::state_hash(roomy.state()));
  EXPECT_EQ(dem::state_hash(tightest.state()), dem::state_hash(roomy.state()));
}

// A row of spheres in a square channel, each in contact with four planes and its neighbours: one contact of
// four has to be saved behind the lists. Half of the spheres leave, so that the new lists are shorter than
// the old ones, which are still read while contacts are saved behind both.
TEST_P(Rebuild, WhatIsCarriedOverLiesBehindBothLists) {
  constexpr int count = 100;
  const auto with_room_for = [](double neighbours) {
    auto scene = nlohmann::json::parse(falling(count, R"("skin": 0.0001,)"));
    auto& walls = scene["dem"]["walls"] = nlohmann::json::array();
    for (const auto& [axis, middle] : {std::pair(1, 0.0), std::pair(2, 0.5)})
      for (const double side : {-1.0, 1.0}) {
        Vec3d point, normal;
        point[axis] = middle + 0.0098 * side;
        normal[axis] = -side;
        walls.push_back({{"name", "side" + std::to_string(walls.size())},
                         {"material", "steel"},
                         {"shape",
                          {{"type", "plane"},
                           {"point", {point.x, point.y, point.z}},
                           {"normal", {normal.x, normal.y, normal.z}}}}});
      }
    scene["dem"]["domain"] = {{"min", {-1.2, -0.3, -0.1}}, {"max", {1.2, 0.3, 0.8}}};
    ParticleRun run(scene.dump(), Backend::cpu, 4, [](particles::Spheres& s) {
      for (int i = 0; i < count; ++i) {
        s.radius[i] = 0.01;
        s.position[i] = {0.0198 * (i - count / 2 + 0.5), 0, 0.5};
        s.velocity[i] = {0, 0.01 * (i % 3), 0};
        s.spin[i] = {3.0 * (i % 5), 0, 10};
      }
    });
    dem::EngineSetup setup{run.scene, run.surface, run.spheres, run.skins, 4};
    setup.neighbours = neighbours;
    run.engine = dem::make_engine(dem::choose_engine(run.scene, Backend::cpu), setup);
    return run;
  };
  const auto room_of = [](const ParticleRun& run) {
    const Arrays arrays = written(run);
    return std::pair(arrays.at("pairs.entry").size() / sizeof(dem::Neighbour),
                     arrays.at("pairs.spring").size() / sizeof(Vec3f));
  };
  ParticleRun tight = with_room_for(6.6), roomy = with_room_for(40);
  for (ParticleRun* run : {&tight, &roomy}) {
    run->advance(1, dt);
    run->engine->remove({{-2, -1, -1}, {0, 1, 1}, {}});
  }
  EXPECT_EQ(room_of(tight), std::pair(std::size_t{330}, std::size_t{330}));
  for (ParticleRun* run : {&tight, &roomy}) {
    const particles::WindowProgress c = run->advance(1, dt, 1.0).window;
    EXPECT_EQ(c.rebuilds, 2u);
    EXPECT_EQ(c.carried_entries, 4u * count + count - 1);
    EXPECT_EQ(c.list_entries, count / 2 - 1u);
  }
  // The memory would suffice for the new lists alone, and it does for the entries.
  EXPECT_EQ(room_of(tight).first, 330u);
  EXPECT_GE(room_of(tight).second, count - 1 + (200 * 4 + 2) / 3);
  EXPECT_EQ(dem::state_hash(tight.state()), dem::state_hash(roomy.state()));
  for (int w = 0; w < 20; ++w)
    for (ParticleRun* run : {&tight, &roomy}) run->advance(20, dt, w % 2 == 0 ? 1.0 : 0.0);
  EXPECT_EQ(dem::state_hash(tight.state()), dem::state_hash(roomy.state()));
}

// A sphere between six planes has more contacts than fit into the memory that it leaves.
TEST_P(Rebuild, MoreContactsThanFitBesideTheSpheresAreCarriedOver) {
  std::string scene = falling(1, R"("skin": 0.0001,)"), seldom = falling(1, R"("skin": 0.01,)");
  const std::string before = R"("walls": [)";
  std::string cage;
  for (const auto& [axis, point] :
       {std::pair("1, 0, 0", "-0.0098, 0, 0.5"), std::pair("-1, 0, 0", "0.0098, 0, 0.5"),
        std::pair("0, 1, 0", "0, -0.0098, 0.5"), std::pair("0, -1, 0", "0, 0.0098, 0.5"),
        std::pair("0, 0, 1", "0, 0, 0.4902"), std::pair("0, 0, -1", "0, 0, 0.5098")})
    cage += R"({"name": "cage)" + std::to_string(cage.size()) + R"(", "material": "steel",
                "shape": {"type": "plane", "point": [)" +
            point + R"(], "normal": [)" + axis + "]}},\n";
  for (std::string* of : {&scene, &seldom}) of->insert(of->find(before) + before.size(), cage);
  const auto with_room_for = [](const std::string& json, double contacts) {
    ParticleRun run(json, Backend::cpu, 1, [](particles::Spheres& s) {
      s.radius = {0.01};
      s.position = {{0, 0, 0.5}};
      s.velocity = {{0.2, 0.1, -0.15}};
      s.spin = {{30, -20, 10}};
    });
    dem::EngineSetup setup{run.scene, run.surface, run.spheres, run.skins, 1};
    setup.contacts = setup.neighbours = contacts;
    run.engine = dem::make_engine(dem::choose_engine(run.scene, Backend::cpu), setup);
    return run;
  };
  ParticleRun roomy = with_room_for(scene, 10), tight = with_room_for(scene, 0),
              kept = with_room_for(seldom, 10);
  for (int w = 0; w < 5; ++w)
    for (ParticleRun* run : {&roomy, &tight, &kept}) run->advance(100, dt);
  const particles::WindowProgress c = tight.advance(1, dt).window;
  EXPECT_EQ(c.carried_entries, 6u);
  EXPECT_GT(c.carried_entries, dem::carried_in_state);
  EXPECT_GT(c.rebuilds, 3u);
  roomy.advance(1, dt);
  EXPECT_EQ(dem::state_hash(tight.state()), dem::state_hash(roomy.state()));
  // Where lists are kept nothing has to be carried over.
  EXPECT_EQ(kept.advance(1, dt).window.rebuilds, 1u);
  const particles::Spheres a = tight.state(), b = kept.state();
  const double rotate_spring = norm(a.spin[0] - b.spin[0]) / norm(b.spin[0]),
               moved = norm(a.position[0] - b.position[0]);
  std::printf("  unlike spin by %.1e, tolerance 1e-3; place by %.1e m, tolerance 1e-9 m\n", rotate_spring,
              moved);
  EXPECT_LT(rotate_spring, 1e-3);
  EXPECT_LT(moved, 1e-9);
}

}  // namespace
}  // namespace tandem::test
