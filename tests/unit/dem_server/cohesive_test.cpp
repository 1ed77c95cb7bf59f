#include <gtest/gtest.h>

#include <cmath>

#include "common/error.hpp"
#include "dem_server/laws/cohesive.hpp"
#include "tests/unit/dem_server/contact_scene.hpp"

namespace tandem::test {
namespace {

constexpr double pi = std::numbers::pi;

// The force of law `jkr` at rest, against both equations of [Johnson1971] at given contact radii.
template <class Real>
double worst_error_of_jkr() {
  const double R = 1e-4, E = 1e8, w = 0.1;
  dem::Coefficients<Real> k;
  k.k_n = static_cast<Real>(4.0 / 3 * E * std::sqrt(R));
  const double smallest = std::cbrt(pi * w * R * R / (8 * E));  // where the contact breaks
  double worst = 0;
  for (double a = 1.01 * smallest; a < 0.2 * R; a *= 1.1) {
    dem::Contact<Real> c;
    c.overlap = static_cast<Real>(a * a / R - std::sqrt(2 * pi * w * a / E));
    c.r_eff = static_cast<Real>(R);
    c.adhesion = static_cast<Real>(w);
    Vec3<Real> spring;
    const auto f = dem::Jkr{}(c, k, 0, spring);
    const double force = 4.0 / 3 * E * a * a * a / R - std::sqrt(8 * pi * w * E * a * a * a);
    worst = std::max(worst, std::abs(static_cast<double>(f.normal) - force) / (pi * w * R + std::abs(force)));
    EXPECT_TRUE(dem::Jkr::holds(c, k));
  }
  return worst;
}

TEST(Jkr, ForceIsThatOfJohnsonKendallAndRoberts) {
  const double exact = worst_error_of_jkr<double>(), mixed = worst_error_of_jkr<float>();
  std::printf("  worst error %.2e in double, %.2e in single precision\n", exact, mixed);
  EXPECT_LT(exact, 1e-9);
  EXPECT_LT(mixed, 2e-4) << "near the end the overlap's rounding moves the root";
}

TEST(Jkr, LargestPullIsThreeHalvesPiWorkRadius) {
  const double R = 1e-4, w = 0.1;
  dem::Coefficients<double> k;
  k.k_n = 4.0 / 3 * 1e8 * std::sqrt(R);
  const double unit = dem::Jkr::length(w, R, k.k_n);
  double pull = 0;
  for (int i = 0; i <= 20000; ++i) {
    dem::Contact<double> c;
    c.overlap = unit * (-0.47246 + 1e-4 * i);
    c.r_eff = R;
    c.adhesion = w;
    Vec3d spring;
    pull = std::max(pull, -dem::Jkr{}(c, k, 0, spring).normal);
  }
  expect_close("pull-off force [N]", pull, 1.5 * pi * w * R, 1e-6);
}

// With nearly no adhesion the result is that without adhesion.
template <class Real>
void expect_hertz_without_adhesion() {
  for (double work = 1e-9; work > 1e-38; work /= 10) {
    const double R = 5e-3, E = 5e7, overlap = 1e-5,
                 hertz = 4.0 / 3 * E * std::sqrt(R) * std::pow(overlap, 1.5);
    dem::Coefficients<Real> k;
    k.k_n = static_cast<Real>(4.0 / 3 * E * std::sqrt(R));
    dem::Contact<Real> c;
    c.overlap = static_cast<Real>(overlap);
    c.r_eff = static_cast<Real>(R);
    c.adhesion = static_cast<Real>(work);
    Vec3<Real> spring;
    const double force = static_cast<double>(dem::Jkr{}(c, k, 0, spring).normal);
    EXPECT_NEAR(force / hertz, 1, 3e-6) << work;
  }
}
TEST(Jkr, WithHardlyAnyAdhesionIsHertz) {
  expect_hertz_without_adhesion<double>();
  expect_hertz_without_adhesion<float>();
}

ContactScene adhesive(const char* precision) {
  ContactScene scene;
  scene.radius = 1e-4;
  scene.young = 1e8;
  scene.dem = {{"contact", "jkr"}, {"precision", precision}};
  scene.constants = {{"restitution", 1}, {"friction", 0.3}, {"work_of_adhesion", 0.1}};
  return scene;
}

std::string refusal(const ContactScene& scene) {
  try {
    scene.run(scene.radius, {});
  } catch (const Error& e) {
    std::printf("  %s\n", e.what());
    return e.what();
  }
  return "no error";
}

// The error names the required skin, however small.
TEST(Jkr, AReachBeyondTheSkinIsRefusedWithFigures) {
  ContactScene scene = adhesive("mixed");
  scene.dem["skin"] = 1e-9;
  const std::string text = refusal(scene);
  EXPECT_NE(text.find("half the skin of 1e-09 m"), std::string::npos) << text;
  EXPECT_NE(text.find("give a skin of at least "), std::string::npos) << text;
  EXPECT_EQ(text.find("at least 0 m"), std::string::npos) << text;
}

// The law assumes small contacts.
TEST(Jkr, AdhesionThatPressesSmallSpheresFlatIsRefusedWithFigures) {
  ContactScene scene = adhesive("mixed");
  scene.constants["work_of_adhesion"] = 1000;
  scene.dem["skin"] = 1e-3;
  const std::string text = refusal(scene);
  EXPECT_NE(text.find("into each other, more than half of R* = "), std::string::npos) << text;
  EXPECT_NE(text.find("give a work_of_adhesion of at most "), std::string::npos) << text;
}

// Small spheres of another material do not count, nor do walls that no such sphere can touch.
TEST(Jkr, SmallSpheresWithoutAdhesionMayLieAmongLargeOnesWithIt) {
  ContactScene scene = adhesive("mixed");
  nlohmann::json json = nlohmann::json::parse(scene.json());
  nlohmann::json& dem = json["dem"];
  dem["materials"].push_back({{"name", "hard"}, {"density", 2500}, {"young", 1e8}, {"poisson", 0.25}});
  nlohmann::json small = dem["particles"][0];
  small["name"] = "small", small["material"] = "hard", small["radius"] = 1e-6;
  small["fill"]["min"] = {3e-4, 3e-4, 1e-4}, small["fill"]["max"] = {4e-4, 4e-4, 2e-4};
  small["fill"]["spacing"] = 3e-6;
  dem["particles"].push_back(small);
  for (const char* other : {"m", "hard"})
    dem["pairs"].push_back(
        {{"a", "hard"}, {"b", other}, {"restitution", 1}, {"friction", 0.3}, {"work_of_adhesion", 0}});
  dem["pairs"][0]["work_of_adhesion"] = 20;
  EXPECT_NO_THROW(ParticleRun(json.dump()));
  dem["pairs"][2]["work_of_adhesion"] = 20;
  EXPECT_THROW(ParticleRun(json.dump()), Error);
}

// A contact begins where the surfaces touch and ends beyond. The work of separation from there is lost:
//   W = 4 pi w R delta_0 [2/3 t^7 - 4/15 t^10 - 1/4 t^4] from 4^(-1/3) to 1 = 7.09 (w^5 R^4 / E*^2)^(1/3)
TEST(Jkr, SlowerSpheresStickAndFasterLoseTheWorkOfAdhesion) {
  for (const char* precision : {"double", "mixed"}) {
    const ContactScene scene = adhesive(precision);
    const double R = scene.radius, w = 0.1;
    const auto G = [](double t) {
      return 2.0 / 3 * std::pow(t, 7) - 4.0 / 15 * std::pow(t, 10) - std::pow(t, 4) / 4;
    };
    const double unit = std::pow(2 * pi * w * std::sqrt(R) / scene.e_star(), 2.0 / 3);
    const double work = 4 * pi * w * R * unit * (G(1) - G(std::cbrt(0.25)));
    expect_close("work of adhesion in units of Thornton and Ning",
                 work / std::cbrt(std::pow(w, 5) * std::pow(R, 4) / std::pow(scene.e_star(), 2)), 7.09, 1e-3);
    const double least = std::sqrt(2 * work / scene.mass());
    const double dt = 4e-4 * std::sqrt(scene.mass() / (scene.hertz() * std::sqrt(unit)));
    for (const double share : {0.95, 1.05, 2.0}) {
      ParticleRun run = scene.run(R, {0, 0, -share * least});
      for (int step = 0; step < 400 && run.state().position[0].z < 1.05 * R; ++step) run.advance(500, dt);
      const particles::Spheres s = run.state();
      std::printf("  %s, %.2f of the sticking speed: ", precision, share);
      if (share < 1) {
        std::printf("at %.4f R\n", s.position[0].z / R);
        EXPECT_LT(s.position[0].z, R + 0.5 * unit);
      } else {
        expect_close("speed after over sticking speed", s.velocity[0].z / least, std::sqrt(share * share - 1),
                     5e-3);
      }
    }
  }
}

TEST(Jkr, DoesNotPullBeforeItTouches) {
  const ContactScene scene = adhesive("double");
  const double unit = dem::Jkr::length(0.1, scene.radius, scene.hertz());
  ParticleRun run = scene.run(scene.radius + 0.2 * unit, {});
  run.advance(1000, 1e-9);
  EXPECT_EQ(run.state().velocity[0], Vec3d{});
}

TEST(Jkr, TwoSpheresHoldEachOther) {
  ContactScene scene = adhesive("mixed");
  scene.plane = false;
  scene.count = 2;
  scene.constants["restitution"] = 0.3;
  const double R = scene.radius, pair_k = 4.0 / 3 * scene.e_star() * std::sqrt(R / 2);
  ParticleRun run(scene.json(), particles::Backend::cpu, 1, [&](particles::Spheres& s) {
    s.position = {{0, 0, 0}, {1.9999 * R, 0, 0}};
  });
  for (int w = 0; w < 40; ++w) run.advance(2000, 2e-9);
  // At rest F = 0: t^3 = 3/2.
  const double t = std::cbrt(1.5), at_rest = dem::Jkr::length(0.1, R / 2, pair_k) * (std::pow(t, 4) - t);
  const particles::Spheres s = run.state();
  expect_close("overlap at rest [m]", 2 * R - (s.position[1].x - s.position[0].x), at_rest, 1e-3);
}

TEST(Jkr, ReachBeyondTheSkinIsRefused) {
  ContactScene scene = adhesive("double");
  scene.dem["skin"] = 1e-7;
  try {
    scene.run(scene.radius, {});
    FAIL() << "taken";
  } catch (const Error& e) {
    EXPECT_EQ(e.where(), "dem.skin") << e.what();
  }
}

// Attraction and Hertz's force balance at delta = (2 pi Omega R / k)^2.
TEST(Sjkr, RestsWhereAttractionBalancesHertz) {
  ContactScene scene;
  scene.dem = {{"contact", "sjkr"}};
  const double density = 3e7;
  scene.constants = {{"restitution", 0.3}, {"friction", 0.3}, {"cohesion_energy_density", density}};
  const double depth = std::pow(2 * pi * density * scene.radius / scene.hertz(), 2);
  ParticleRun run = scene.run(scene.radius - 0.8 * depth, {});
  const double dt = 0.01 * std::sqrt(scene.mass() / (scene.hertz() * std::sqrt(depth)));
  for (int w = 0; w < 40; ++w) run.advance(1000, dt);
  expect_close("overlap at rest [m]", scene.radius - run.state().position[0].z, depth, 1e-4);
}

ContactScene cohesive() {
  ContactScene scene = adhesive("double");
  scene.dem["contact"] = "sjkr";
  scene.constants = {{"restitution", 1}, {"friction", 0.3}, {"cohesion_energy_density", 8e5}};
  return scene;
}

// Reference of both laws on a plane: contact radius and elastic force at an overlap.
struct Contact {
  double a = 0, force = 0;  // [m] [N]
  bool ends = false;
};
Contact jkr_contact(const ContactScene& scene, double overlap) {
  const double R = scene.radius, E = scene.e_star(), w = scene.constants["work_of_adhesion"];
  const auto overlap_of = [&](double a) { return a * a / R - std::sqrt(2 * pi * w * a / E); };
  double low = std::cbrt(pi * w * R * R / (8 * E)), high = R;  // from where it breaks
  if (overlap < overlap_of(low)) return {0, 0, true};
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (overlap_of(middle) < overlap ? low : high) = middle;
  }
  return {low, 4.0 / 3 * E * low * low * low / R - std::sqrt(8 * pi * w * E * low * low * low), false};
}
Contact sjkr_contact(const ContactScene& scene, double overlap) {
  if (overlap < 0) return {0, 0, true};
  const double density = scene.constants["cohesion_energy_density"], a = std::sqrt(scene.radius * overlap);
  return {a, scene.hertz() * std::pow(overlap, 1.5) - 2 * pi * density * a * a, false};
}
using ContactAt = Contact(const ContactScene&, double overlap);

double g_star(const ContactScene& scene) {
  return scene.young / (2 * (1 + scene.poisson)) / (2 * (2 - scene.poisson));
}
double alpha(const ContactScene& scene) {
  const double l = std::log(scene.constants["restitution"].get<double>());
  return -std::sqrt(5.0) * l / std::sqrt(l * l + pi * pi);
}

// Remaining fraction of a speed, with steps a tenth as long.
double speed_after(const ContactScene& scene, ContactAt* contact_at, double begin_speed, double dt) {
  const double c_n = alpha(scene) * std::sqrt(scene.mass() * scene.hertz());
  double overlap = 0, sink = begin_speed;
  for (int step = 0; step < 200000; ++step) {
    overlap += dt / 10 * sink;
    const Contact c = contact_at(scene, overlap);
    if (c.ends) return -sink;
    sink -= dt / 10 / scene.mass() * (c.force + c_n * std::sqrt(c.a / std::sqrt(scene.radius)) * sink);
  }
  ADD_FAILURE() << "it sticks";
  return 0;
}

// The dashpot acts on the contact radius, and adhesion reduces the speed as well.
void expect_restitution(ContactScene scene, ContactAt* contact_at, double begin_speed) {
  for (const double e : {0.6, 0.8, 0.95}) {
    scene.constants["restitution"] = e;
    const double dt = 2e-9;
    ParticleRun run = scene.run(scene.radius, {0, 0, -begin_speed});
    for (int w = 0; w < 100 && run.state().position[0].z < 1.02 * scene.radius; ++w) run.advance(200, dt);
    std::printf("  e = %.2f: ", e);
    expect_close("speed after over speed before", run.state().velocity[0].z / begin_speed,
                 speed_after(scene, contact_at, begin_speed, dt) / begin_speed, 2e-3);
  }
}
TEST(Jkr, RestitutionIsThatOfItsEquations) {
  expect_restitution(adhesive("double"), jkr_contact, 0.15);
}
TEST(Sjkr, RestitutionIsThatOfItsEquations) {
  expect_restitution(cohesive(), sjkr_contact, 0.4);
}

// Runs an elastic impact that slides throughout, so that the plane receives the elastic force, and calls
// `check` with friction and force. Returns the number of steps.
template <class Check>
int slide(const ContactScene& scene, Check check) {
  ParticleRun run = scene.run(scene.radius, {10, 0, -0.1});
  int steps = 0;
  for (int w = 0; w < 300 && run.state().position[0].z < 1.02 * scene.radius; ++w)
    for (const Wrench& load : run.advance(100, 2e-9).load)
      // The spring has to be stretched first.
      if (load.force.z != 0 && ++steps > 10) check(load.force.x, -load.force.z);
  return steps;
}

// [Thornton1991]: mu (F + 3 pi w R), so that a contact under tension still has friction.
TEST(Jkr, SlidesAtCoulombsShareOfForceAndTwiceTheLargestPull) {
  const ContactScene scene = adhesive("double");
  const double more = 3 * pi * 0.1 * scene.radius;
  double worst = 0, least = more, most = 0;
  const int steps = slide(scene, [&](double friction, double force) {
    worst = std::max(worst, std::abs(friction - 0.3 * (force + more)) / (0.3 * more));
    least = std::min(least, force), most = std::max(most, force);
  });
  std::printf("  %d steps, forces from %.2f to %.1f times 3 pi w R: friction differs by %.1e of that\n",
              steps, least / more, most / more, worst);
  EXPECT_GT(steps, 500);
  EXPECT_LT(least, -0.45 * more) << "all the way to the largest pull";
  EXPECT_LT(worst, 1e-6);
}

// Friction is limited by the repulsive force, whatever attraction subtracts from the normal force.
TEST(Sjkr, SlidesAtCoulombsShareOfHertzsForce) {
  const ContactScene scene = cohesive();
  double worst = 0, least = 0, most = 0;
  const int steps = slide(scene, [&](double friction, double force) {
    const double hertz = friction / 0.3, overlap = std::pow(hertz / scene.hertz(), 2.0 / 3);
    worst = std::max(worst, std::abs(hertz - 2 * pi * 8e5 * scene.radius * overlap - force));
    least = std::min(least, force), most = std::max(most, force);
  });
  std::printf("  %d steps, forces from %.2e to %.2e N: differ by %.1e of the largest\n", steps, least, most,
              worst / most);
  EXPECT_GT(steps, 300);
  EXPECT_LT(least, 0);
  EXPECT_LT(worst, 1e-6 * most);
}

// A ball that adhesion alone holds oscillates along the plane on the spring 8 G* a and the dashpot of the
// contact radius. The effective mass m_t of its surface follows from 1/m_t = 1/m + arm^2/I.
void expect_swing(ContactScene scene, ContactAt* contact_at, double overlap) {
  scene.constants["friction"] = 1000;
  for (const double e : {1.0, 0.5}) {
    scene.constants["restitution"] = e;
    const Contact contact = contact_at(scene, overlap);
    const double R = scene.radius, arm = R - overlap,
                 m_t = 1 / (1 / scene.mass() + arm * arm / scene.moment());
    const double k_t = 8 * g_star(scene) * contact.a, hertz_k_t = 8 * g_star(scene) * std::sqrt(R);
    const double c_t =
        alpha(scene) * std::sqrt(2.0 / 3 * scene.mass() * hertz_k_t) * std::sqrt(contact.a / std::sqrt(R));
    const double decay = c_t / (2 * m_t), omega = std::sqrt(k_t / m_t - decay * decay);
    constexpr int half = 4000;  // steps of half a period
    const double dt = pi / omega / half, v = 1e-4;
    ParticleRun run = scene.run(R - overlap, {v, 0, 0});
    const auto slip = [&] { return run.state().velocity[0].x - arm * run.state().spin[0].y; };
    double crossed = 0, before = v;
    for (int step = 1; step <= half / 10; ++step) {
      run.advance(10, dt);
      const double now = slip();
      if (before > 0 && now <= 0) crossed = 10 * dt * (step - now / (now - before));
      before = now;
    }
    std::printf("  e = %.1f:\n", e);
    expect_close("time until it turns [s]", crossed, std::atan2(omega, decay) / omega, 2e-3);
    expect_close("speed half a period later", before / v, -std::exp(-decay * pi / omega), 2e-3);
  }
}
TEST(Jkr, StuckContactSwingsOnMindlinsSpringAtItsContactRadius) {
  const ContactScene scene = adhesive("double");
  const double R = scene.radius, a = std::cbrt(4.5 * pi * 0.1 * R * R / scene.e_star());  // F = 0
  expect_swing(scene, jkr_contact, a * a / R - std::sqrt(2 * pi * 0.1 * a / scene.e_star()));
}
TEST(Sjkr, StuckContactSwingsOnMindlinsSpring) {
  const ContactScene scene = cohesive();
  expect_swing(scene, sjkr_contact, std::pow(2 * pi * 8e5 * scene.radius / scene.hertz(), 2));  // F = 0
}

}  // namespace
}  // namespace tandem::test
