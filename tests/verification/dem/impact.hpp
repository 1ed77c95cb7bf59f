// The impact of one sphere on a rigid plane, or of two spheres, with any contact variant.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::test {

struct Variant {
  const char *name, *law, *options;  // dem.contact, and more keys of dem that end in a comma
  bool friction;
  const char* constants = "";  // more keys of the pairs, without braces

  bool hooke() const { return std::string(law) == "hooke"; }
  // Whether friction follows Mindlin's law, limited by the elastic part of the normal force.
  bool mindlin() const { return friction && !hooke() && std::string(law) != "paper"; }
  friend void PrintTo(const Variant& v, std::ostream* out) { *out << v.name; }
};
// The variants of dem_server/engine/contact_variants.def.
std::vector<Variant> contact_variants();
// The laws that only the generic variant has, in mixed or double precision. Without adhesion, as here, `jkr`
// and `sjkr` are Hertz's law.
std::vector<Variant> more_laws();

struct Ball {
  double young, poisson, density;  // [Pa] [-] [kg/m3]
  double restitution, friction;    // [-]
  double radius;                   // [m]

  double mass() const;                        // [kg]
  double stiffness_on_plane() const;          // of Hertz: F = k delta^1.5 [N/m^1.5]
  double stiffness_of_pair() const;           // likewise, for two equal balls
  double deepest_on_plane(double v_n) const;  // elastic Hertz contact [m]
  double duration_on_plane(double v_n) const;
  double spring() const;  // of `hooke`: secant stiffness of Hertz at an overlap of a hundredth of R [N/m]
};

// A scene without gravity: `count` balls, and walls of a rigid material.
std::string impact_scene(const Variant& variant, const Ball& ball, int count, const std::string& walls);
inline const char* const rigid_plane =
    R"({"name": "plane", "material": "rigid", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}})";

struct Rebound {
  Vec3d velocity, spin;  // [m/s] [rad/s]
  double force = 0;      // largest on the plane [N]
  double deepest = 0;    // largest overlap [m]
  double duration = 0;   // time with a force on the plane [s]
};
// Takes micro steps of duration_on_plane / `steps` until the ball has left the plane, or for ten durations.
Rebound impact_on_plane(const Variant& variant, const Ball& ball, Vec3d velocity, Vec3d spin,
                        int steps = 4000);

// The same for the walls of a scene with these meshes. The ball starts above the point `at`.
Rebound impact_on_walls(const std::string& scene, const std::vector<NamedMesh>& meshes, const Ball& ball,
                        Vec3d at, Vec3d velocity, Vec3d spin, int steps);

// Prints a line of a table and expects |measured - expected| <= tolerance |expected|.
void expect_row(const Variant& variant, const std::string& what, double measured, double expected,
                double tolerance);

}  // namespace tandem::test
