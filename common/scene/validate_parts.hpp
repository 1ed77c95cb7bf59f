// The parts of validate(), by JSON object. `origin` names the file in errors.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/scene/fault.hpp"
#include "common/scene/model.hpp"

namespace tandem::scene {

void validate_mbd(const Mbd& mbd, double window, double end_time, const std::string& origin);
// The motion of a joint until end_time, and the function of time of a force.
void validate_motion(const Joint& joint, double end_time, const std::string& origin, const std::string& path);
void validate_size(const Motion& size, const std::string& origin, const std::string& path);
void validate_force(const Motor& motor, const Mbd& mbd, double end_time, const std::string& origin,
                    const std::string& path);
void validate_force(const Tyre& tyre, const Mbd& mbd, double end_time, const std::string& origin,
                    const std::string& path);
void validate_force(const Cylinder& cylinder, const Mbd& mbd, double end_time, const std::string& origin,
                    const std::string& path);
// A table of a force has one value for each argument, and its arguments increase.
void validate_arguments(const ForceTable& table, const std::string& origin, const std::string& path);
// The same of a function of a joint coordinate, whose table covers its period. `unit`: of all of them, that
// of the scene, for the messages.
enum class AngleUnit { radians, degrees };
void validate_curve_arguments(const std::vector<double>& arguments, const std::optional<double>& period,
                              AngleUnit unit, const std::string& origin, const std::string& path);
// A function of a joint coordinate through points.
void validate_curve(const std::vector<double>& arguments, const std::vector<double>& values,
                    const std::optional<double>& period, bool closes, const std::string& origin,
                    const std::string& path);
void validate_forces(const Mbd& mbd, double end_time, const std::string& origin);
void validate_dem(const Dem& dem, double window, const std::string& origin);

// Refuses a joint that is not revolute, at `path`. `hint`: what it is for.
void require_revolute(const Joint& joint, const Mbd& mbd, const std::string& hint, const std::string& origin,
                      const std::string& path);

// Shapes of bodies, and masses that follow from them.
void validate_shapes(const Scene& scene, const std::string& origin);

// What time stepping of contacts does not compute; `scene` has mbd.contact.
void validate_time_stepping(const Scene& scene, const std::string& origin);

// Whether shapes of two bodies touch where they meet: the scene has mbd.contact, no joint connects the
// bodies, and they are not in `ignore`.
bool may_touch(const Scene& scene, BodyId a, BodyId b);
// Roads of tyres are shapes of the ground that a tyre can roll on.
void validate_roads(const Scene& scene, const std::string& origin);
// Outputs of contacts name shapes that may touch, and have names of their own.
void validate_contact_outputs(const Scene& scene, const std::string& origin);

// Refuses two walls that coincide in whole or in part: spheres would be in contact with both.
void validate_walls(const Scene& scene, const std::string& origin);

// The same for the walls of the liquid, and what it knows no surface of.
void validate_liquid_walls(const Scene& scene, const std::string& origin);

// The liquid without its walls.
void validate_sph(const Scene& scene, const std::string& origin);

// Sizes of spheres, and fills that are placed before the start.
void validate_fills(const Scene& scene, const std::string& origin);

// The requirements of a domain that follows a body.
void validate_moving_domain(const Scene& scene, const std::string& origin);

// The wall of this name. Refuses one that is not there, at `path`.
const Wall& require_wall(const std::string& name, const std::vector<Wall>& walls, const std::string& origin,
                         const std::string& path);

// Sensors of the particles, and of the liquid.
void validate_particle_sensors(const Scene& scene, const std::string& origin);
void validate_liquid_sensors(const Scene& scene, const std::string& origin);
void validate_body_contacts(const Scene& scene, const std::string& origin);
void validate_dissipation(const Scene& scene, const std::string& origin);
void validate_wall_fields(const Scene& scene, const std::string& origin);

void require_unit(double length, const std::string& value, const std::string& unit_value,
                  const std::string& origin, const std::string& path);
void require_unit(Vec3d direction, const std::string& origin, const std::string& path);
void require_unit(Quat orientation, const std::string& origin, const std::string& path);

// Requires min < max along each axis.
void require_box(Vec3d min, Vec3d max, const std::string& origin, const std::string& path);

// Whether all of the box, or some of it, is in the region of an outlet.
struct Overlap {
  bool all = true, some = true;
};
Overlap overlap(const Box& box, const Outlet& outlet);
// Requires a region that is one.
void require_region(const Outlet& outlet, const std::string& origin, const std::string& path);

// Inlets and outlets of the liquid.
void validate_liquid_traffic(const Scene& scene, const std::string& origin);

}  // namespace tandem::scene
