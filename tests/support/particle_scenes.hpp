// Small particle scenes for tests.
#pragma once

#include <string>

namespace tandem::test {

// Sanitizers make a run ten times slower; fewer spheres execute the same code.
#if defined(TANDEM_SANITIZED)
inline constexpr int falling_count = 150;
inline constexpr bool sanitized = true;
#else
inline constexpr int falling_count = 600;
inline constexpr bool sanitized = false;
#endif

// Loose spheres fall into a box with a slanted plate, a post and a knob: contacts with neighbours, faces,
// edges, corners and round walls.
inline std::string falling_spheres(const std::string& law, const std::string& options = "",
                                   int count = falling_count) {
  return R"({"tandem": "1.0", "name": "falling", "end_time": 1.0, "coupling": {"window": 0.001},
    "dem": {"contact": ")" +
         law + R"(", )" + options + R"(
      "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25},
                    {"name": "steel", "density": 7800, "young": 2e8, "poisson": 0.3}],
      "pairs": [{"a": "glass", "b": "glass", "restitution": 0.6, "friction": 0.4,
                 "normal_stiffness": 7e5, "normal_damping": 20, "tangential_stiffness": 5e5, "tangential_damping": 5,
                 "spring_stiffness": 4e4, "work_of_adhesion": 0.5, "cohesion_energy_density": 1e4,
                 "rolling_friction": 0.05, "rolling_damping": 0.3},
                {"a": "glass", "b": "steel", "restitution": 0.5, "friction": 0.3,
                 "normal_stiffness": 1e6, "normal_damping": 20, "tangential_stiffness": 6e5, "tangential_damping": 5,
                 "spring_stiffness": 5e4, "work_of_adhesion": 0.3, "cohesion_energy_density": 1e4,
                 "rolling_friction": 0.05, "rolling_damping": 0.3}],
      "particles": [{"name": "fill", "material": "glass", "radius": [0.008, 0.01], "velocity": [0.1, 0, -1],
                     "fill": {"type": "lattice", "min": [-0.1, -0.1, 0.06], "max": [0.1, 0.1, 0.5],
                              "spacing": 0.022, "jitter": 0.9, "seed": 7, "count": )" +
         std::to_string(count) + R"(}}],
      "walls": [{"name": "box", "material": "steel", "position": [0, 0, 0.3],
                 "shape": {"type": "box", "size": [0.22, 0.22, 0.6], "open": ["+z"]}},
                {"name": "plate", "material": "steel", "position": [0.02, 0, 0.04],
                 "orientation": [0.9807852804032304, 0, 0.19509032201612825, 0],
                 "shape": {"type": "box", "size": [0.1, 0.1, 0.01]}},
                {"name": "post", "material": "steel", "position": [-0.06, 0.05, 0.02],
                 "shape": {"type": "cylinder", "radius": 0.02, "height": 0.06}},
                {"name": "knob", "material": "steel", "position": [-0.05, -0.06, 0.01],
                 "shape": {"type": "sphere", "radius": 0.03}},
                {"name": "floor", "material": "steel", "shape": {"type": "plane", "point": [0, 0, -0.05], "normal": [0, 0, 1]}}],
      "domain": {"min": [-0.3, -0.3, -0.1], "max": [0.3, 0.3, 0.8]}}})";
}

}  // namespace tandem::test
