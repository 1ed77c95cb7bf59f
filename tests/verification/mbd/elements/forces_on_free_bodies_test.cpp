// Free bodies with contact take steps in islands of their own, where nothing else acts on them
// (mbd_server/step/contact_islands.hpp).
#include <gtest/gtest.h>

#include <string>

#include "common/scene/parse.hpp"
#include "tests/verification/mbd/whole_run.hpp"

namespace tandem::mbd {
namespace free_bodies_test {

// Nine boxes apart from each other, the first of which a spring holds above the floor, which it would hit
// else.
TEST(FreeBodies, ASpringToTheGroundHoldsOneOfMany) {
  std::string bodies;
  for (int i = 0; i < 9; ++i)
    bodies += (i ? "," : "") + std::string(R"({"name": "box)") + std::to_string(i) +
              R"(", "mass": 1, "inertia": [0.00167, 0.00167, 0.00167], "position": [)" +
              std::to_string(0.5 * i) + R"(, 0, )" + (i == 0 ? "0.5" : "0.05") +
              R"(], "shapes": [{"name": "s)" + std::to_string(i) +
              R"(", "use": "contact", "material": "m", "shape": {"type": "box", "size": [0.1, 0.1, 0.1]}}]})";
  const std::string text =
      R"({"tandem": "1.1", "name": "hang", "end_time": 0.2, "mbd": {"integrator": {"step": 1e-3},
          "contact": {"materials": [{"name": "m", "stiffness": 1e5, "restitution": 0.2, "friction": 0.5}],
                      "ground": [{"name": "floor", "material": "m",
                                  "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}]},
          "forces": [{"name": "hang", "type": "spring_damper", "body_b": "box0", "point_a": [0, 0, 1.5],
                      "point_b": [0, 0, 0.5], "stiffness": 200, "length": 0.95095}],
          "bodies": [)" +
      bodies + "]}}";
  machines::WholeRun run(scene::parse(text, "hang.json"));
  const protocol::BodiesFrame& frame = run.solver.observe();
  const double z = frame.bodies[0].pose.p_WB.z;
  std::printf("height of the box on the spring: expected 0.5 measured %.9f tolerance 1e-6\n", z);
  EXPECT_NEAR(z, 0.5, 1e-6);
}

}  // namespace free_bodies_test
}  // namespace tandem::mbd
