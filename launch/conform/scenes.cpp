#include "launch/conform/scenes.hpp"

#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "launch/conform/contact_scenes.hpp"

namespace tandem::conform {
namespace {

// All scenes are of format 1.0, which participants of earlier releases read as well.

// Two boundary bodies with a body without walls between them, and the wall of the second one first: neither
// the order of the walls nor a count of boundary bodies is the index of a body.
constexpr const char* free_bodies_scene = R"({
  "tandem": "1.0", "name": "free_bodies", "gravity": [0.4, -0.7, -9.7], "end_time": 1, "coupling": {"window": 0.001},
  "mbd": {
    "integrator": {"step": 2.5e-4},
    "bodies": [
      {"name": "plate", "mass": 3, "inertia": [0.05, 0.08, 0.11, 0.004, -0.003, 0.006], "position": [0.3, -0.2, 1.1],
       "orientation": [0.8, 0, 0.6, 0], "velocity": [0.5, -0.2, 0.1], "angular_velocity": [1, -2, 3]},
      {"name": "idle", "mass": 1, "inertia": [0.01, 0.01, 0.01], "position": [5, 0, 0]},
      {"name": "ball", "mass": 0.7, "inertia": [0.002, 0.003, 0.004], "position": [-1, 0.4, 0.2]}
    ]
  },
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0.3}],
    "particles": [{"name": "far", "material": "glass", "radius": 0.02,
                   "fill": {"type": "lattice", "min": [8, 8, 8], "max": [8.041, 8.041, 8.041], "spacing": 0.04}}],
    "walls": [
      {"name": "skin", "body": "ball", "material": "glass", "shape": {"type": "sphere", "radius": 0.1}},
      {"name": "face", "body": "plate", "material": "glass", "shape": {"type": "box", "size": [0.4, 0.3, 0.1]}}
    ],
    "domain": {"min": [-10, -10, -10], "max": [10, 10, 10]}
  }
})";

// Both joints can move across gravity only, so that nothing moves without a load along them.
constexpr const char* joints_scene = R"({
  "tandem": "1.0", "name": "joints", "gravity": [0, 0, -9.81], "end_time": 1, "coupling": {"window": 0.001},
  "mbd": {
    "integrator": {"step": 2.5e-4},
    "bodies": [
      {"name": "door", "mass": 2, "inertia": [0.1, 0.2, 0.3], "position": [0.5, 0, 1]},
      {"name": "drawer", "mass": 4, "inertia": [0.1, 0.1, 0.1], "position": [2.2, 0.1, 1]}
    ],
    "joints": [
      {"name": "hinge", "type": "revolute", "child": "door", "position": [0, 0, 0.8], "axis": [0, 0, 1]},
      {"name": "slide", "type": "prismatic", "child": "drawer", "position": [2, 0, 1.5], "axis": [1, 0, 0]}
    ]
  },
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0.3}],
    "particles": [{"name": "far", "material": "glass", "radius": 0.02,
                   "fill": {"type": "lattice", "min": [8, 8, 8], "max": [8.041, 8.041, 8.041], "spacing": 0.04}}],
    "walls": [
      {"name": "leaf", "body": "door", "material": "glass", "shape": {"type": "box", "size": [0.9, 0.02, 0.4]}},
      {"name": "box", "body": "drawer", "material": "glass", "shape": {"type": "box", "size": [0.4, 0.3, 0.1]}}
    ],
    "domain": {"min": [-10, -10, -10], "max": [10, 10, 10]}
  }
})";

constexpr const char* actuated_scene = R"({
  "tandem": "1.0", "name": "actuated", "gravity": [0, 0, -9.81], "end_time": 1, "coupling": {"window": 0.001},
  "mbd": {
    "integrator": {"step": 2.5e-4},
    "bodies": [{"name": "drawer", "mass": 4, "inertia": [0.1, 0.1, 0.1], "position": [2.2, 0.1, 1]}],
    "joints": [{"name": "slide", "type": "prismatic", "child": "drawer", "position": [2, 0, 1.5], "axis": [1, 0, 0]}],
    "forces": [{"name": "motor", "type": "actuator", "joint": "slide", "input": "push"}]
  },
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0.3}],
    "particles": [{"name": "far", "material": "glass", "radius": 0.02,
                   "fill": {"type": "lattice", "min": [8, 8, 8], "max": [8.041, 8.041, 8.041], "spacing": 0.04}}],
    "walls": [{"name": "box", "body": "drawer", "material": "glass", "shape": {"type": "box", "size": [0.4, 0.3, 0.1]}}],
    "domain": {"min": [-10, -10, -10], "max": [10, 10, 10]}
  }
})";

constexpr const char* flight_scene = R"({
  "tandem": "1.0", "name": "flight", "gravity": [0.4, -0.7, -9.7], "end_time": 1, "coupling": {"window": 0.001},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0.3}],
    "precision": "double", "micro_step": 2e-5,
    "particles": [
      {"name": "one", "material": "glass", "radius": 0.02, "velocity": [1, 0.5, 2],
       "fill": {"type": "lattice", "min": [0.98, 0.98, 0.98], "max": [1.021, 1.021, 1.021], "spacing": 0.04}},
      {"name": "two", "material": "glass", "radius": 0.03, "velocity": [-1, 0, 0.5],
       "fill": {"type": "lattice", "min": [-1.03, 0.97, 1.97], "max": [-0.969, 1.031, 2.031], "spacing": 0.06}}
    ],
    "walls": [{"name": "floor", "material": "glass", "shape": {"type": "plane", "point": [0, 0, -5], "normal": [0, 0, 1]}}],
    "domain": {"min": [-9, -9, -6], "max": [9, 9, 9]}
  }
})";

// A sphere rests on a tray, off the tray's centre of mass, and another one on the ground, off the world's
// origin.
constexpr const char* tray_scene = R"({
  "tandem": "1.0", "name": "tray", "gravity": [0, 0, -9.81], "end_time": 1, "coupling": {"window": 0.001},
  "mbd": {"bodies": [{"name": "spare", "mass": 1, "inertia": [1, 1, 1], "position": [5, 0, 0]},
                     {"name": "tray", "mass": 5, "inertia": [1, 1, 1], "position": [0.3, 0.2, 0.5]}]},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.1, "friction": 0.3}],
    "precision": "double", "micro_step": 2e-5,
    "particles": [
      {"name": "on_tray", "material": "glass", "radius": 0.02,
       "fill": {"type": "lattice", "min": [0.43, 0.10, 0.35], "max": [0.471, 0.141, 0.391], "spacing": 0.04}},
      {"name": "on_ground", "material": "glass", "radius": 0.03,
       "fill": {"type": "lattice", "min": [0.97, -0.53, 0], "max": [1.031, -0.469, 0.061], "spacing": 0.06}}
    ],
    "walls": [
      {"name": "floor", "material": "glass", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
      {"name": "top", "body": "tray", "material": "glass", "position": [0.1, -0.05, -0.2],
       "shape": {"type": "box", "size": [0.4, 0.4, 0.1]}}
    ],
    "domain": {"min": [-2, -2, -1], "max": [2, 2, 2]}
  }
})";

// The face of the piston is at x = 0; the sphere begins at x = 0.2 mm and lies in the line of the piston's
// centre. No friction, no loss: the sphere leaves with twice the speed of the piston.
constexpr const char* piston_scene = R"({
  "tandem": "1.0", "name": "piston", "gravity": [0, 0, 0], "end_time": 1, "coupling": {"window": 0.001},
  "mbd": {"bodies": [{"name": "piston", "mass": 5, "inertia": [1, 1, 1], "position": [-0.2, 0, 0]}]},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 1, "friction": 0}],
    "precision": "double", "micro_step": 2e-5,
    "particles": [{"name": "ball", "material": "glass", "radius": 0.02,
                   "fill": {"type": "lattice", "min": [0.0002, -0.02, -0.02], "max": [0.0412, 0.021, 0.021], "spacing": 0.04}}],
    "walls": [{"name": "face", "body": "piston", "material": "glass", "position": [0.1, 0, 0],
               "shape": {"type": "box", "size": [0.2, 0.4, 0.4]}}],
    "domain": {"min": [-2, -2, -2], "max": [2, 2, 2]}
  }
})";

// The paddle turns about z through its centre of mass; the sphere is in front of its face, 0.3 m from the
// axis.
constexpr const char* paddle_scene = R"({
  "tandem": "1.0", "name": "paddle", "gravity": [0, 0, 0], "end_time": 1, "coupling": {"window": 0.001},
  "mbd": {"bodies": [{"name": "paddle", "mass": 5, "inertia": [1, 1, 1], "position": [0.1, 0.05, 0]}]},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e8, "poisson": 0.25, "restitution": 1, "friction": 0}],
    "precision": "double", "micro_step": 1e-5,
    "particles": [{"name": "ball", "material": "glass", "radius": 0.02,
                   "fill": {"type": "lattice", "min": [0.38, 0.0605, -0.02], "max": [0.421, 0.1015, 0.021], "spacing": 0.04}}],
    "walls": [{"name": "blade", "body": "paddle", "material": "glass", "position": [0.25, 0, 0],
               "shape": {"type": "box", "size": [0.4, 0.02, 0.4]}}],
    "domain": {"min": [-2, -2, -2], "max": [2, 2, 2]}
  }
})";

// Grains fall into a crate and beside it.
constexpr const char* bed_scene = R"({
  "tandem": "1.0", "name": "bed", "gravity": [0, 0, -9.81], "end_time": 1, "coupling": {"window": 0.001},
  "mbd": {"bodies": [{"name": "crate", "mass": 5, "inertia": [1, 1, 1], "position": [0.05, 0.02, 0.4]}]},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.4, "friction": 0.4}],
    "precision": "double", "micro_step": 2e-5,
    "particles": [
      {"name": "inside", "material": "glass", "radius": [0.008, 0.01], "velocity": [0.3, 0.2, -1],
       "fill": {"type": "lattice", "min": [-0.05, -0.05, 0.301], "max": [0.05, 0.05, 0.4], "spacing": 0.021, "jitter": 0.8,
                "seed": 1, "count": 40}},
      {"name": "beside", "material": "glass", "radius": 0.01, "velocity": [0, 0, -1],
       "fill": {"type": "lattice", "min": [0.3, 0.3, 0.001], "max": [0.36, 0.36, 0.05], "spacing": 0.021, "count": 8}}
    ],
    "walls": [
      {"name": "floor", "material": "glass", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
      {"name": "case", "body": "crate", "material": "glass", "position": [-0.05, -0.02, 0],
       "shape": {"type": "box", "size": [0.12, 0.12, 0.2], "open": ["+z"]}}
    ],
    "domain": {"min": [-1, -1, -0.1], "max": [1, 1, 1]}
  }
})";

// The first sphere leaves the domain downwards, the second one stays in flight.
constexpr const char* way_out_scene = R"({
  "tandem": "1.0", "name": "way_out", "gravity": [0, 0, 0], "end_time": 1, "coupling": {"window": 0.001},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0.3}],
    "precision": "double", "micro_step": 2e-5,
    "particles": [
      {"name": "leaves", "material": "glass", "radius": 0.02, "velocity": [0.2, 0, -2],
       "fill": {"type": "lattice", "min": [0.48, 0.48, 0.001], "max": [0.521, 0.521, 0.042], "spacing": 0.04}},
      {"name": "stays", "material": "glass", "radius": 0.02, "velocity": [0, 0.1, 0],
       "fill": {"type": "lattice", "min": [0.18, 0.18, 0.48], "max": [0.221, 0.221, 0.521], "spacing": 0.04}}
    ],
    "walls": [{"name": "side", "material": "glass", "shape": {"type": "plane", "point": [-0.5, 0, 0], "normal": [1, 0, 0]}}],
    "domain": {"min": [-1, -1, 0], "max": [1, 1, 1]}
  }
})";

constexpr const char* round_trip_scene = R"({
  "tandem": "1.0", "name": "round_trip", "gravity": [0, 0, 0], "end_time": 1, "coupling": {"window": 0.001},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0.3}],
    "precision": "double", "micro_step": 2e-5,
    "particles": [
      {"name": "ball", "material": "glass", "radius": 0.02, "velocity": [2, 0, 0],
       "fill": {"type": "lattice", "min": [0.95, 0.48, 0.48], "max": [0.991, 0.521, 0.521], "spacing": 0.04}}
    ],
    "walls": [{"name": "side", "material": "glass", "shape": {"type": "plane", "point": [0, 0, -1], "normal": [0, 0, 1]}}],
    "domain": {"min": [0, 0, 0], "max": [1, 1, 1], "periodic": ["x"]}
  }
})";

// A basin on a body, filled with a liquid at rest.
constexpr const char* basin_scene = R"({
  "tandem": "1.1", "name": "basin", "gravity": [0, 0, -9.81], "end_time": 1, "coupling": {"window": 0.001},
  "mbd": {"bodies": [{"name": "basin", "mass": 5, "inertia": [1, 1, 1], "position": [0.3, 0.2, 0.1]}]},
  "sph": {
    "spacing": 0.02, "precision": "double", "wall_friction": "free_slip", "micro_step": 0.0005,
    "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001, "sound_speed": 14,
                 "artificial_viscosity": 0.1,
                 "fill": [{"type": "box", "min": [0.24, 0.14, 0], "max": [0.36, 0.26, 0.12]}]}],
    "walls": [{"name": "case", "body": "basin", "shape": {"type": "box", "size": [0.12, 0.12, 0.2], "open": ["+z"]}}],
    "domain": {"min": [0, 0, -0.1], "max": [0.6, 0.5, 0.5]}
  }
})";

// A block of liquid in flight, without walls.
constexpr const char* block_scene = R"({
  "tandem": "1.1", "name": "block", "gravity": [0, 0, -9.81], "end_time": 1, "coupling": {"window": 0.001},
  "sph": {
    "spacing": 0.02, "precision": "double",
    "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001, "sound_speed": 14, "pressure": "zero",
                 "velocity": [0.5, 0, 0.2],
                 "fill": [{"type": "box", "min": [-0.06, -0.06, -0.06], "max": [0.06, 0.06, 0.06]}]}],
    "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}
  }
})";

}  // namespace

const std::vector<BuiltInScene>& built_in_scenes() {
  using protocol::Role;
  static const std::vector<BuiltInScene> scenes{{"free_bodies", Role::mbd, free_bodies_scene},
                                                {"joints", Role::mbd, joints_scene},
                                                {"actuated", Role::mbd, actuated_scene},
                                                {"flight", Role::dem, flight_scene},
                                                {"tray", Role::dem, tray_scene},
                                                {"piston", Role::dem, piston_scene},
                                                {"paddle", Role::dem, paddle_scene},
                                                {"bed", Role::dem, bed_scene},
                                                {"way_out", Role::dem, way_out_scene},
                                                {"round_trip", Role::dem, round_trip_scene},
                                                {"impact", Role::dem, impact_scene},
                                                {"stack", Role::dem, stack_scene},
                                                {"trays", Role::dem, trays_scene},
                                                {"inlets", Role::dem, inlets_scene},
                                                {"outlet", Role::dem, outlet_scene},
                                                {"basin", Role::sph, basin_scene},
                                                {"block", Role::sph, block_scene},
                                                {"spout", Role::sph, spout_scene},
                                                {"drain", Role::sph, drain_scene}};
  return scenes;
}

const BuiltInScene& built_in_scene(const std::string& name) {
  for (const BuiltInScene& scene : built_in_scenes())
    if (scene.name == name) return scene;
  throw Error(ErrorCode::internal, "the judge has no scene '" + name + "'");
}

std::string with_simplest_contact(const std::string& text) {
  auto scene = nlohmann::ordered_json::parse(text);
  scene["dem"]["contact"] = "hooke";
  for (auto& material : scene["dem"]["materials"]) {
    material["friction"] = 0;
    // Contacts as long as those of Hertz's law in these scenes, some milliseconds [N/m].
    material["spring_stiffness"] = material["young"].get<double>() > 2e7 ? 2e5 : 1e4;
  }
  return scene.dump();
}

std::string with_end_time(const std::string& text, double end_time) {
  auto scene = nlohmann::ordered_json::parse(text);
  scene["end_time"] = end_time;
  return scene.dump();
}

}  // namespace tandem::conform
