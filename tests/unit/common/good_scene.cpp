#include "tests/unit/common/good_scene.hpp"

#include <nlohmann/json.hpp>

namespace tandem::scene::test {

const char* const good_scene_text = R"({
  "tandem": "1.0",
  "name": "machine",
  "description": "a crate on a slide with an arm and a ball",
  "gravity": [0, 0, -9.81],
  "end_time": 0.5,
  "coupling": {"scheme": "mbd_first", "window": 1e-3},
  "mbd": {
    "integrator": {"rho_inf": 0.9, "step": 5e-4, "tolerance": 1e-9, "max_iterations": 12},
    "bodies": [
      {"name": "crate", "mass": 10, "inertia": [1, 2, 2.5, 0.1, 0.2, 0.3], "position": [0, 0, 1]},
      {"name": "arm", "mass": 2, "inertia": [0.1, 0.1, 0.05], "position": [1, 0, 1], "orientation": [0.6, 0, 0.8, 0]},
      {"name": "ball", "mass": 1, "inertia": [0.1, 0.1, 0.1]},
      {"name": "bird", "mass": 1, "inertia": [1, 1, 1], "velocity": [1, 2, 3], "angular_velocity": [4, 5, 6]}
    ],
    "joints": [
      {"name": "slide", "type": "prismatic", "child": "crate", "position": [0, 0, 1], "axis": [0, 0, 1], "rate": 0.5},
      {"name": "hinge", "type": "revolute", "parent": "crate", "child": "arm", "position": [1, 0, 1],
       "axis": [0, 0.6, 0.8], "damping": 0.1,
       "motion": {"type": "table", "times": [0, 1, 2], "values": [0, 0.5, 0]}},
      {"name": "socket", "type": "spherical", "parent": "arm", "child": "ball", "position": [0, 0, 0], "damping": 0.2}
    ],
    "forces": [
      {"name": "spring", "type": "spring_damper", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5],
       "stiffness": 1000, "damping": 5, "length": 1.5},
      {"name": "coil", "type": "rotational_spring_damper", "joint": "hinge", "stiffness": 3, "damping": 0.2, "angle": 0.1}
    ]
  },
  "dem": {
    "materials": [
      {"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25},
      {"name": "steel", "density": 7800, "young": 2e11, "poisson": 0.3}
    ],
    "pairs": [
      {"a": "glass", "b": "glass", "restitution": 0.5, "friction": 0.3},
      {"a": "steel", "b": "glass", "restitution": 0.6, "friction": 0.2}
    ],
    "contact": "hertz_mindlin",
    "variant": "generic",
    "precision": "double",
    "micro_step": 1e-5,
    "skin": 0.001,
    "particles": [
      {"name": "grains", "material": "glass", "radius": [0.01, 0.012], "velocity": [0, 0, -1],
       "fill": {"type": "lattice", "min": [-0.1, -0.1, 0.9], "max": [0.1, 0.1, 1.1], "lattice": "hexagonal",
                "spacing": 0.025, "jitter": 0.5, "seed": 7, "count": 100}}
    ],
    "walls": [
      {"name": "inside", "body": "crate", "material": "steel", "position": [0, 0, 0.1],
       "shape": {"type": "box", "size": [0.3, 0.3, 0.4], "open": ["+z"]}},
      {"name": "floor", "material": "glass", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
      {"name": "post", "body": "arm", "material": "steel", "orientation": [0.8, 0.6, 0, 0],
       "shape": {"type": "cylinder", "radius": 0.1, "height": 0.5, "segments": 12, "open": ["-z"]}}
    ],
    "domain": {"min": [-2, -2, -1], "max": [2, 2, 3], "periodic": ["x", "z"]}
  },
  "output": {"frame_interval": 0.01, "particles": false,
             "camera": {"eye": [3, 3, 2], "target": [0, 0, 1], "up": [0, 0, 1], "field_of_view": 30}},
  "checks": [
    {"name": "weight", "of": "crate.contact_force.z", "reduce": "mean", "from": 0.4, "to": 0.5, "expected": -10,
     "tolerance": 0.01, "why": "sum of m g"},
    {"name": "nothing lost", "of": "summary.lost_particles", "expected": 0, "tolerance": 0, "absolute": true}
  ]
})";

nlohmann::json good_scene() {
  return nlohmann::json::parse(good_scene_text);
}

}  // namespace tandem::scene::test
