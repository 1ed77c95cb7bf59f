#include "dem_server/contact/parameters.hpp"

#include <gtest/gtest.h>

#include "common/scene/parse.hpp"
#include "tests/unit/dem_server/contact_scene.hpp"

namespace tandem::test {
namespace {

// Range of the exact torques over that of the exact forces [m]; a domain of 10 m about x.
double reach_of_torques(double x) {
  ContactScene contact;
  contact.constants = {{"restitution", 0.5}, {"friction", 0.3}};
  contact.dem = {{"domain", {{"min", {x - 5, -5, -5}}, {"max", {x + 5, 5, 5}}}}};
  particles::Spheres spheres;
  spheres.position = {{x, 0, 1}};
  spheres.velocity = spheres.spin = {{}};
  spheres.id = {0};
  spheres.radius = {contact.radius};
  spheres.material = {0};
  const auto p = dem::make_parameters<double>(scene::parse(contact.json(), "scene.json"), spheres, 0.005);
  return p.torque.size / p.force.size;
}

// The torque on the ground is about the origin of the world. With the size of the domain as the longest
// lever, the sum overflowed without a word where the domain was some kilometres away.
TEST(Parameters, TorquesReachToTheOriginOfTheWorld) {
  for (const double x : {0.0, 100.0, 5e3, 1e5}) {
    const double lever = std::max(std::sqrt(300.0), std::hypot(x + 5, 5, 5)), reach = reach_of_torques(x);
    std::printf("x %g m: reach %g m of %g m\n", x, reach, lever);
    EXPECT_GE(2 * reach, lever);
    EXPECT_LE(reach, 2 * lever);
  }
}

}  // namespace
}  // namespace tandem::test
