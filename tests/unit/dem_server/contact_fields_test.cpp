// Number and mean stress of the contacts of spheres in frames: against closed forms, a search over all pairs,
// and each other on every variant; and that they change nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "dem_server/coupling/state_hash.hpp"
#include "tests/support/particle_scenes.hpp"
#include "tests/support/periodic_scene.hpp"

namespace tandem::test {
namespace {

constexpr double frame_dt = 2e-5;  // [s]

std::string with_fields(const std::string& scene) {
  nlohmann::json all = nlohmann::json::parse(scene);
  all["output"]["fields"] = {"contact_count", "mean_stress"};
  return all.dump();
}

dem::ContactsFrame contacts_of(ParticleRun& run) {
  std::vector<particles::BodyPose> poses;
  for (const BodyId body : run.surface.boundary_bodies) {
    const Pose pose = body == ground ? Pose{} : run.scene.mbd->bodies[body.value].pose;
    poses.push_back({pose.p_WB, pose.q_WB.matrix(), {}, {}});
  }
  dem::ContactsFrame frame;
  run.engine->download({poses, frame_dt}, frame);
  return frame;
}

// Hertz's force of two surfaces of the material of `bed` [N].
double hertz(double r_eff, double overlap) {
  const double e_eff = 1e6 / (2 * (1 - 0.25 * 0.25));
  return 4.0 / 3 * e_eff * std::sqrt(r_eff) * std::pow(overlap, 1.5);
}

class ContactFields : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Variants, ContactFields,
                         testing::Values(R"({})", R"({"variant": "generic"})", R"({"precision": "double"})",
                                         R"({"contact": "hertz_frictionless"})"));

// Two spheres one above the other on a floor, before the first window.
TEST_P(ContactFields, OfAColumnFollowFromItsOverlaps) {
  PeriodicScene scene = bed(nlohmann::json::parse(GetParam()));
  scene.count = 3;
  const double r = scene.radius, low = r / 64, high = r / 128;
  ParticleRun run(with_fields(scene.json()), particles::Backend::cpu, 1, [&](particles::Spheres& s) {
    s.position = {{r, r, r - low}, {r, r, 3 * r - low - high}, {0.06, 0.06, 0.1}};
  });
  const dem::ContactsFrame frame = contacts_of(run);
  EXPECT_EQ(frame.count, (std::vector<std::uint32_t>{2, 1, 0}));
  const double volume = 4.0 / 3 * std::numbers::pi * r * r * r;
  const double pair = hertz(r / 2, high) * (r - high / 2), floor = hertz(r, low) * (r - low);
  const double expected[] = {(pair + floor) / (3 * volume), pair / (3 * volume), 0};
  for (int i = 0; i < 3; ++i) {
    std::printf("sphere %d: expected %.6g Pa, measured %.6g Pa\n", i, expected[i], frame.mean_stress[i]);
    EXPECT_NEAR(frame.mean_stress[i], expected[i], 3e-5 * expected[0]);
  }
}

// Spheres without friction at rest in a box whose walls at x = 0, y = 0 and z = 0 are the ground's, and those
// at x = L and y = L of two bodies. The virial of the contact forces of all spheres is that of gravity and of
// the loads on the two bodies: the sum of 3 V p is m g z of all spheres + L (N_x + N_y).
TEST_P(ContactFields, OfABedAtRestBearItsWeight) {
  constexpr double size = 0.0625, top = 0.25;
  constexpr const char* names = "xy";
  PeriodicScene scene;
  scene.dem = nlohmann::json::parse(GetParam());
  scene.gravity = {0, 0, -9.81};
  scene.count = 90;
  scene.axes = {};
  scene.restitution = 0.2;
  scene.friction = 0;
  auto all = nlohmann::json::parse(with_fields(scene.json()));
  auto& fill = all["dem"]["particles"][0]["fill"];
  fill["max"] = {size, size, top};
  const auto plane = [](std::vector<double> point, std::vector<double> normal, const std::string& body) {
    nlohmann::json wall = {{"name", "wall" + std::to_string(static_cast<int>(9 + normal[0] + 3 * normal[1]))},
                           {"material", "m"},
                           {"shape", {{"type", "plane"}, {"point", point}, {"normal", normal}}}};
    if (!body.empty()) wall["body"] = body;
    return wall;
  };
  all["dem"]["walls"] = {plane({0, 0, 0}, {0, 0, 1}, ""), plane({0, 0, 0}, {1, 0, 0}, ""),
                         plane({0, 0, 0}, {0, 1, 0}, ""), plane({size, 0, 0}, {-1, 0, 0}, "x"),
                         plane({0, size, 0}, {0, -1, 0}, "y")};
  for (int a = 0; a < 2; ++a)
    all["mbd"]["bodies"].push_back({{"name", std::string(1, names[a])}, {"mass", 1}, {"inertia", {1, 1, 1}}});
  ParticleRun run(all.dump(), particles::Backend::cpu, 1, [&](particles::Spheres& s) {
    for (std::size_t i = 0; i < s.size(); ++i) {  // no columns, in which nothing would press on the sides
      const auto phase = static_cast<double>(i);
      s.position[i] += 0.1 * scene.radius * Vec3d{std::sin(12.9 * phase), std::cos(78.2 * phase), 0};
    }
  });
  // Under a sanitizer the spheres still move a little.
  for (int w = 0; w < (sanitized ? 35 : 60); ++w) run.advance(1000, frame_dt);
  const dem::WindowOutcome& last = run.advance(1, frame_dt);
  const double on_x = last.load[1].force.x, on_y = last.load[2].force.y;
  const dem::ContactsFrame frame = contacts_of(run);
  const particles::Spheres s = run.state();
  double virial = 0, expected = size * (on_x + on_y), fastest = 0;
  std::uint32_t total = 0, touching = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double volume = 4.0 / 3 * std::numbers::pi * std::pow(s.radius[i], 3);
    virial += 3 * volume * frame.mean_stress[i];
    expected += 2500 * volume * 9.81 * s.position[i].z;
    fastest = std::max(fastest, norm(s.velocity[i]));
    total += frame.count[i];
    for (int a = 0; a < 3; ++a) touching += s.position[i][a] < s.radius[i] ? 1 : 0;
    for (int a = 0; a < 2; ++a) touching += s.position[i][a] > size - s.radius[i] ? 1 : 0;
    for (std::size_t k = 0; k < i; ++k)
      touching += norm(s.position[i] - s.position[k]) < s.radius[i] + s.radius[k] ? 2 : 0;
  }
  std::printf(
      "virial: expected %.8g J, of it the side walls %.3g J, measured %.8g J; fastest sphere %.2g m/s, %u "
      "contacts\n",
      expected, size * (on_x + on_y), virial, fastest, total);
  EXPECT_GT(size * (on_x + on_y), 0.1 * expected);
  EXPECT_NEAR(virial, expected, (sanitized ? 0.1 : 3e-3) * expected);
  EXPECT_EQ(total, touching);
  EXPECT_GT(total, 300u);
}

// A run that asks for them has the bits of one that does not, from the frame at the start on.
TEST_P(ContactFields, ChangeNothing) {
  const PeriodicScene scene = chute(nlohmann::json::parse(GetParam()));
  ParticleRun without(scene.json()), with(with_fields(scene.json()));
  const Arrays before = written(with);
  contacts_of(with);
  EXPECT_EQ(written(with), before);
  for (int w = 0; w < 10; ++w) {
    without.advance(400, frame_dt);
    with.advance(400, frame_dt);
    contacts_of(with);
  }
  EXPECT_EQ(dem::state_hash(with.state()), dem::state_hash(without.state()));
}

// Spheres fall into a box: the contacts of the ground are the load of the next micro step, and say which
// spheres press where.
TEST(BodyContacts, AreTheLoadOfTheNextStep) {
  for (const char* law : {"hertz_mindlin", "hertz_frictionless", "paper", "hooke"}) {
    nlohmann::json all = nlohmann::json::parse(falling_spheres(law, "", 150));
    all["output"]["contacts"] = {"ground"};
    ParticleRun run(all.dump()), without(falling_spheres(law, "", 150));
    const std::vector<particles::BodyPose> poses{{{}, Quat{}.matrix(), {}, {}}};
    const std::vector<std::uint8_t> wanted{1}, none{0};
    EXPECT_TRUE(run.engine->body_contacts({poses, frame_dt}, wanted).empty())
        << "no sphere touches a wall at the start";
    for (int w = 0; w < 10; ++w) {
      run.advance(400, frame_dt);
      without.advance(400, frame_dt);
      const std::vector<dem::BodyContact> contacts = run.engine->body_contacts({poses, frame_dt}, wanted);
      const particles::Spheres s = run.state();
      Vec3d sum;
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        const dem::BodyContact& c = contacts[i];
        sum += c.force;
        const std::size_t sphere = c.sphere;  // none has left the domain, so that ids are indices
        EXPECT_LT(norm(c.point - s.position[sphere]), s.radius[sphere]);
        EXPECT_GT(norm(c.point - s.position[sphere]), 0.8 * s.radius[sphere]);
        if (i > 0) {
          EXPECT_LE(contacts[i - 1].sphere, c.sphere);
        }
      }
      EXPECT_TRUE(run.engine->body_contacts({poses, frame_dt}, none).empty());
      const dem::WindowOutcome& next = run.advance(1, frame_dt);
      without.advance(1, frame_dt);
      if (w == 9) {
        std::printf("%s: %zu contacts, sum (%.6g, %.6g, %.6g) N, load (%.6g, %.6g, %.6g) N\n", law,
                    contacts.size(), sum.x, sum.y, sum.z, next.load[0].force.x, next.load[0].force.y,
                    next.load[0].force.z);
        EXPECT_GE(contacts.size(), 4u);
      }
      EXPECT_LT(norm(sum - next.load[0].force), 1e-4 * norm(next.load[0].force) + 1e-6);
    }
    EXPECT_EQ(dem::state_hash(run.state()), dem::state_hash(without.state())) << law;
  }
}

TEST(ContactFieldsOfVariants, HaveTheSameBits) {
  for (const char* law : {"hertz_mindlin", "hertz_frictionless", "paper"}) {
    ParticleRun special(with_fields(falling_spheres(law, "", 150)), particles::Backend::cpu, 1),
        generic(with_fields(falling_spheres(law, R"("variant": "generic",)", 150)), particles::Backend::cpu,
                3);
    for (int w = 0; w < 3; ++w) {
      special.advance(400, frame_dt);
      generic.advance(400, frame_dt);
    }
    const dem::ContactsFrame a = contacts_of(special), b = contacts_of(generic);
    EXPECT_EQ(a.count, b.count) << law;
    EXPECT_EQ(a.mean_stress, b.mean_stress) << law;
  }
}

// A cohesive contact that pulls has a negative stress, and stays one contact across its gap.
TEST(ContactFieldsOfCohesion, PullAcrossAGap) {
  PeriodicScene scene = bed(nlohmann::json::parse(
      R"({"contact": "jkr", "pairs": [{"a": "m", "b": "m", "restitution": 0.3, "friction": 0.4, "work_of_adhesion": 1}]})"));
  scene.gravity = {};
  scene.count = 2;
  const double r = scene.radius;
  ParticleRun run(with_fields(scene.json()), particles::Backend::cpu, 1, [&](particles::Spheres& s) {
    s.position = {{0.05, 0.05, 0.06}, {0.05 + 2 * r - 1e-6, 0.05, 0.06}};
    s.velocity = {{-0.02, 0, 0}, {0.02, 0, 0}};
  });
  bool pulled_across = false;
  for (int w = 0; w < 200 && !pulled_across; ++w) {
    run.advance(1, frame_dt);
    const particles::Spheres s = run.state();
    const dem::ContactsFrame frame = contacts_of(run);
    if (norm(s.position[1] - s.position[0]) <= 2 * r || frame.count[0] == 0) continue;
    pulled_across = true;
    EXPECT_LT(frame.mean_stress[0], 0);
    EXPECT_EQ(frame.mean_stress[0], frame.mean_stress[1]);
  }
  EXPECT_TRUE(pulled_across);
}

}  // namespace
}  // namespace tandem::test
