#include "launch/conform/contact_scenes.hpp"

namespace tandem::conform {

// Two unlike spheres meet on a line along x; the gap between them is 1 mm.
const char* const impact_scene = R"({
  "tandem": "1.0", "name": "impact", "gravity": [0, 0, 0], "end_time": 1, "coupling": {"window": 0.001},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.6, "friction": 0.3}],
    "precision": "double", "micro_step": 2e-5,
    "particles": [
      {"name": "light", "material": "glass", "radius": 0.02, "velocity": [0.3, 0, 0],
       "fill": {"type": "lattice", "min": [-0.041, 0.08, 0.18], "max": [0, 0.121, 0.221], "spacing": 0.04}},
      {"name": "heavy", "material": "glass", "radius": 0.03, "velocity": [-0.2, 0, 0],
       "fill": {"type": "lattice", "min": [0, 0.07, 0.17], "max": [0.061, 0.131, 0.231], "spacing": 0.06}}
    ],
    "walls": [{"name": "floor", "material": "glass", "shape": {"type": "plane", "point": [0, 0, -0.9], "normal": [0, 0, 1]}}],
    "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}
  }
})";

// A small sphere on a large one on a tray; their centres are on a line along gravity.
const char* const stack_scene = R"({
  "tandem": "1.0", "name": "stack", "gravity": [0, 0, -9.81], "end_time": 1, "coupling": {"window": 0.001},
  "mbd": {"bodies": [{"name": "spare", "mass": 1, "inertia": [1, 1, 1], "position": [5, 0, 0]},
                     {"name": "tray", "mass": 5, "inertia": [1, 1, 1], "position": [0.3, 0.2, 0.5]}]},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.1, "friction": 0.3}],
    "precision": "double", "micro_step": 2e-5,
    "particles": [
      {"name": "lower", "material": "glass", "radius": 0.02,
       "fill": {"type": "lattice", "min": [0.48, 0.18, 0.35], "max": [0.521, 0.221, 0.391], "spacing": 0.04}},
      {"name": "upper", "material": "glass", "radius": 0.015,
       "fill": {"type": "lattice", "min": [0.485, 0.185, 0.39], "max": [0.516, 0.216, 0.421], "spacing": 0.03}}
    ],
    "walls": [{"name": "top", "body": "tray", "material": "glass", "position": [0.1, -0.05, -0.2],
               "shape": {"type": "box", "size": [0.4, 0.4, 0.1]}}],
    "domain": {"min": [-2, -2, -1], "max": [2, 2, 2]}
  }
})";

// Each tray carries a sphere of its own; the order of the walls is not that of the bodies.
const char* const trays_scene = R"({
  "tandem": "1.0", "name": "trays", "gravity": [0, 0, -9.81], "end_time": 1, "coupling": {"window": 0.001},
  "mbd": {"bodies": [{"name": "left", "mass": 5, "inertia": [1, 1, 1], "position": [-0.5, 0.2, 0.5]},
                     {"name": "right", "mass": 5, "inertia": [1, 1, 1], "position": [0.5, -0.1, 0.4]}]},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.1, "friction": 0.3}],
    "precision": "double", "micro_step": 2e-5,
    "particles": [
      {"name": "on_left", "material": "glass", "radius": 0.02,
       "fill": {"type": "lattice", "min": [-0.52, 0.18, 0.55], "max": [-0.479, 0.221, 0.591], "spacing": 0.04}},
      {"name": "on_right", "material": "glass", "radius": 0.03,
       "fill": {"type": "lattice", "min": [0.47, -0.13, 0.45], "max": [0.531, -0.069, 0.511], "spacing": 0.06}}
    ],
    "walls": [
      {"name": "top_right", "body": "right", "material": "glass", "shape": {"type": "box", "size": [0.4, 0.4, 0.1]}},
      {"name": "top_left", "body": "left", "material": "glass", "shape": {"type": "box", "size": [0.4, 0.4, 0.1]}}
    ],
    "domain": {"min": [-2, -2, -1], "max": [2, 2, 2]}
  }
})";

// Three spheres each: due every 5 ms, and every 5.24 ms, the mass of a sphere over its mass rate.
const char* const inlets_scene = R"({
  "tandem": "1.0", "name": "inlets", "gravity": [0, 0, 0], "end_time": 1, "coupling": {"window": 0.001},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0.3}],
    "precision": "double", "micro_step": 2e-5,
    "particles": [
      {"name": "there", "material": "glass", "radius": 0.02,
       "fill": {"type": "lattice", "min": [-0.52, -0.52, -0.52], "max": [-0.479, -0.479, -0.479], "spacing": 0.04}},
      {"name": "by_rate", "material": "glass", "radius": 0.015, "velocity": [0.5, 0, -4],
       "fill": {"type": "inlet", "min": [0.1, 0.1, 0.5], "max": [0.3, 0.3, 0.6], "rate": 200, "count": 3}},
      {"name": "by_mass", "material": "glass", "radius": 0.01, "velocity": [0, 4, 0],
       "fill": {"type": "inlet", "min": [-0.4, -0.4, 0.1], "max": [-0.2, -0.3, 0.3], "mass_rate": 2, "count": 3}}
    ],
    "walls": [{"name": "floor", "material": "glass", "shape": {"type": "plane", "point": [0, 0, -0.9], "normal": [0, 0, 1]}}],
    "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}
  }
})";

// The first sphere flies into the outlet, 9.5 ms after the start; the second one stays.
const char* const outlet_scene = R"({
  "tandem": "1.0", "name": "outlet", "gravity": [0, 0, 0], "end_time": 1, "coupling": {"window": 0.001},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0.3}],
    "precision": "double", "micro_step": 2e-5,
    "particles": [
      {"name": "leaves", "material": "glass", "radius": 0.02, "velocity": [0.2, 0, -2],
       "fill": {"type": "lattice", "min": [0.48, 0.48, -0.001], "max": [0.521, 0.521, 0.04], "spacing": 0.04}},
      {"name": "stays", "material": "glass", "radius": 0.02, "velocity": [0, 0.1, 0],
       "fill": {"type": "lattice", "min": [0.18, 0.18, 0.48], "max": [0.221, 0.221, 0.521], "spacing": 0.04}}
    ],
    "outlets": [{"name": "hole", "region": {"type": "box", "min": [0.3, 0.3, -0.4], "max": [0.8, 0.8, 0]}}],
    "walls": [{"name": "side", "material": "glass", "shape": {"type": "plane", "point": [-0.5, 0, 0], "normal": [1, 0, 0]}}],
    "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}
  }
})";

// A jet from an inlet without gravity; the block of liquid at rest is far from it.
const char* const spout_scene = R"({
  "tandem": "1.1", "name": "spout", "gravity": [0, 0, 0], "end_time": 1, "coupling": {"window": 0.001},
  "sph": {
    "spacing": 0.02, "precision": "double",
    "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001, "sound_speed": 14, "pressure": "zero",
                 "fill": [{"type": "box", "min": [-0.5, -0.5, -0.5], "max": [-0.44, -0.44, -0.44]}]}],
    "inlets": [{"name": "spout", "position": [0.1, 0, 0], "orientation": {"axis": [0, 1, 0], "angle_deg": 90},
                "shape": {"type": "rectangle", "size": [0.06, 0.14]}, "velocity": 0.5}],
    "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}
  }
})";

// Without gravity a block of liquid flies into an outlet, which all of it has reached after 0.16 s; another
// one stays.
const char* const drain_scene = R"({
  "tandem": "1.1", "name": "drain", "gravity": [0, 0, 0], "end_time": 1, "coupling": {"window": 0.001},
  "sph": {
    "spacing": 0.02, "precision": "double",
    "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001, "sound_speed": 14, "pressure": "zero",
                 "velocity": [1, 0.2, 0],
                 "fill": [{"type": "box", "min": [-0.06, -0.06, -0.06], "max": [0.06, 0.06, 0.06]},
                          {"type": "box", "min": [-0.66, -0.06, -0.06], "max": [-0.6, 0, 0]}]}],
    "outlets": [{"name": "drain", "region": {"type": "plane", "point": [0.1, 0, 0], "normal": [1, 0, 0]}}],
    "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}
  }
})";

}  // namespace tandem::conform
