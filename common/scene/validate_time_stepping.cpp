// What time stepping of contacts (mbd.contact.impacts: "time_stepping") does not compute is refused by name.
#include "common/scene/validate_parts.hpp"

namespace tandem::scene {
namespace {

// Free bodies, and bodies that a motion moves against the ground.
void expect_free_or_moved(const Mbd& mbd, const std::string& origin) {
  for (std::size_t i = 0; i < mbd.joints.size(); ++i) {
    const Joint& joint = mbd.joints[i];
    const std::string at = "mbd.joints[" + std::to_string(i) + "]";
    if (joint.damping > 0 || joint.friction || joint.limits)
      fail(origin, at,
           "time stepping of contacts knows no damping, friction and limits of joints, as those of '" +
               joint.name + "'",
           "leave them out, or leave out mbd.contact.impacts");
    if (joint.type == JointType::free || joint.type == JointType::fixed) continue;
    if (!joint.motion)
      fail(origin, at,
           "time stepping of contacts computes no joint whose coordinate is free, as '" + joint.name + "'",
           "give the joint a motion, or leave out mbd.contact.impacts");
    if (joint.parent != ground)
      fail(origin, at + ".parent", "time stepping of contacts moves bodies against the ground only",
           "make the ground the parent, or leave out mbd.contact.impacts");
  }
}

void expect_plain_materials(const BodyContact& contact, const std::string& origin) {
  for (std::size_t i = 0; i < contact.materials.size(); ++i) {
    const std::string at = "mbd.contact.materials[" + std::to_string(i) + "]";
    if (!contact.materials[i].stiffness)
      fail(origin, at + ".young", "time stepping of contacts has a linear law only",
           "give a stiffness [N/m] in place of young and poisson, or leave out mbd.contact.impacts");
    if (contact.materials[i].rolling_friction > 0)
      fail(origin, at + ".rolling_friction", "time stepping of contacts has no rolling friction",
           "leave out rolling_friction or mbd.contact.impacts");
  }
  for (std::size_t i = 0; i < contact.pairs.size(); ++i)
    if (contact.pairs[i].rolling_friction.value_or(0) > 0)
      fail(origin, "mbd.contact.pairs[" + std::to_string(i) + "].rolling_friction",
           "time stepping of contacts has no rolling friction",
           "leave out rolling_friction or mbd.contact.impacts");
}

bool is_computed(const Geometry& geometry) {
  return std::holds_alternative<PlaneShape>(geometry) || std::holds_alternative<SphereShape>(geometry) ||
         std::holds_alternative<CapsuleShape>(geometry) || std::holds_alternative<BoxShape>(geometry) ||
         std::holds_alternative<HullShape>(geometry);
}

}  // namespace

void validate_time_stepping(const Scene& scene, const std::string& origin) {
  const BodyContact& contact = *scene.contact;
  if (contact.impacts != Impacts::time_stepping) {
    for (const Shape& shape : contact.ground)
      if (shape.surface_velocity)
        fail(origin, shape.path + ".surface_velocity",
             "a surface of contact moves along itself with time stepping only",
             "give mbd.contact.impacts \"time_stepping\", or leave out surface_velocity");
    return;
  }
  const Mbd& mbd = *scene.mbd;
  if (mbd.integrator.error_tolerance)
    fail(origin, "mbd.integrator.error_tolerance", "time stepping of contacts has steps of one length",
         "give mbd.integrator.step, or leave out mbd.contact.impacts");
  if (scene.dem || scene.sph)
    fail(origin, "mbd.contact.impacts", "time stepping of contacts takes no loads of particles",
         "leave out impacts, or the particles");
  if (!mbd.forces.empty())
    fail(origin, "mbd.forces", "time stepping of contacts knows gravity and contacts, and no other forces",
         "leave out the forces, or mbd.contact.impacts");
  if (!mbd.couplers.empty())
    fail(origin, "mbd.couplers", "time stepping of contacts computes no couplers",
         "leave out the couplers, or mbd.contact.impacts");
  if (!contact.outputs.empty())
    fail(origin, "mbd.contact.outputs", "time stepping of contacts has no outputs of contacts",
         "leave out outputs, or mbd.contact.impacts");
  expect_free_or_moved(mbd, origin);
  expect_plain_materials(contact, origin);
  const auto expect_shape = [&](const Shape& shape) {
    if (!is_computed(shape.geometry))
      fail(origin, shape.path + ".shape",
           "time stepping of contacts does not compute the contact of a " + name_of(shape.geometry),
           "use planes, spheres, capsules, boxes and convex hulls, or leave out mbd.contact.impacts");
  };
  for (const Shape& shape : contact.ground) expect_shape(shape);
  for (const Shape& shape : scene.shapes)
    if (shape.use == ShapeUse::contact) expect_shape(shape);
}

}  // namespace tandem::scene
