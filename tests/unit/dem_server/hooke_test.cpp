#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/dem_server/contact_scene.hpp"

namespace tandem::test {
namespace {

ContactScene hooke(double restitution, double friction) {
  ContactScene scene;
  scene.dem = {{"contact", "hooke"}};
  scene.constants = {{"restitution", restitution}, {"friction", friction}, {"spring_stiffness", 1e7}};
  return scene;
}

// Runs until the sphere has left the plane, at most a dozen half periods.
void leave(ParticleRun& run, const ContactScene& scene) {
  for (int w = 0; w < 400 && run.state().position[0].z <= scene.radius; ++w)
    run.advance(100, 1e-3 / std::sqrt(1e7 / scene.mass()));
}

// A damped oscillator over half a period: duration pi / sqrt(k/m - (c/2m)^2) at any speed, and e by
// construction.
TEST(Hooke, ImpactIsHalfAPeriodOfTheOscillator) {
  for (const double e : {0.0, 0.2, 0.5, 0.8, 1.0})
    for (const double v : {0.01, 1.0}) {
      const ContactScene scene = hooke(e, 0);
      ParticleRun run = scene.run(scene.radius, {0, 0, -v});
      const double omega = std::sqrt(1e7 / scene.mass()),
                   l = e > 0 ? std::log(e) : -std::numeric_limits<double>::infinity();
      const double period =
          e > 0 ? std::numbers::pi / omega * std::sqrt(1 + l * l / (std::numbers::pi * std::numbers::pi)) : 0;
      const double dt = 1e-3 / omega;
      double duration = 0;
      for (int w = 0; w < 200; ++w) {
        for (const Wrench& load : run.advance(100, dt).load)
          if (load.force.z != 0) duration += dt;
        if (run.state().position[0].z > scene.radius) break;
      }
      std::printf("e = %.1f at %.2f m/s: ", e, v);
      EXPECT_NEAR(run.state().velocity[0].z / v, e, 1e-3);
      if (e > 0)
        expect_close("duration [s]", duration, period, 2e-3);
      else
        std::printf("returns %.2e m/s\n", run.state().velocity[0].z);
    }
}

// With k_t = 2/7 k_n a sticking contact returns -e times the tangential velocity of the surface.
TEST(Hooke, StickingImpactReturnsTheTangentialVelocity) {
  for (const double e : {0.5, 1.0}) {
    const ContactScene scene = hooke(e, 1000);  // sticks, except at the very begin and end
    const double v_n = 0.1, v_t = 0.05;
    ParticleRun run = scene.run(scene.radius, {v_t, 0, -v_n});
    leave(run, scene);
    const particles::Spheres s = run.state();
    expect_close("tangential restitution of the surface",
                 -(s.velocity[0].x - scene.radius * s.spin[0].y) / v_t, e, 2e-3);
  }
}

TEST(Hooke, SlidingImpactTakesCoulombsShare) {
  const double e = 0.5, mu = 0.2, v_n = 0.1, v_t = 1;
  const ContactScene scene = hooke(e, mu);
  ParticleRun run = scene.run(scene.radius, {v_t, 0, -v_n});
  leave(run, scene);
  expect_close("tangential momentum over m [m/s]", v_t - run.state().velocity[0].x, mu * (1 + e) * v_n, 2e-3);
}

}  // namespace
}  // namespace tandem::test
