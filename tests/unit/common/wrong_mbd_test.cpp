// Wrong scenes: bodies, joints and forces.
#include "tests/unit/common/wrong_scene.hpp"

namespace tandem::scene::test {
namespace {

const WrongScene wrong_mbd[] = {
    {"NegativeMass", R"([{"op": "replace", "path": "/mbd/bodies/0/mass", "value": -1}])",
     "mbd.bodies[0].mass: the value is -1 (give a number from 1e-18 to 1e+18: mass [kg])"},
    {"ZeroMass", R"([{"op": "replace", "path": "/mbd/bodies/0/mass", "value": 0}])",
     "mbd.bodies[0].mass: the value is 0 (give a number from 1e-18 to 1e+18: mass [kg])"},
    {"MassWithUnit", R"([{"op": "replace", "path": "/mbd/bodies/0/mass", "value": "10 kg"}])",
     "mbd.bodies[0].mass: the value is \"10 kg\" (give a number or \"from_shapes\": mass [kg]; from_shapes: "
     "mass, "
     "centre of mass and inertia of the shapes by their densities)"},
    {"MassNull", R"([{"op": "replace", "path": "/mbd/bodies/0/mass", "value": null}])",
     "mbd.bodies[0].mass: the value is null (give a number or \"from_shapes\": mass [kg]; from_shapes: mass, "
     "centre of mass and inertia of the shapes by their densities)"},
    {"MissingInertia", R"([{"op": "remove", "path": "/mbd/bodies/0/inertia"}])",
     "mbd.bodies[0]: the key 'inertia' is missing (add inertia: about the centre of mass in body axes: xx, "
     "yy, zz, or xx, yy, zz, xy, xz, yz [kg m2])"},
    {"InertiaOfFourNumbers", R"([{"op": "replace", "path": "/mbd/bodies/0/inertia", "value": [1, 1, 1, 0]}])",
     "mbd.bodies[0].inertia: the value is [1,1,1,0] (give a list of 3 numbers or a list of 6 numbers: "
     "about the centre of mass in body axes: xx, yy, zz, or xx, yy, zz, xy, xz, yz [kg m2])"},
    {"InertiaNotPositive", R"([{"op": "replace", "path": "/mbd/bodies/0/inertia", "value": [1, 1, -1]}])",
     "mbd.bodies[0].inertia: the principal moments are [-1, 1, 1] kg m2; all must be positive (check xx, "
     "yy, zz, xy, xz, yz and their units)"},
    {"InertiaZero", R"([{"op": "replace", "path": "/mbd/bodies/0/inertia", "value": [0, 0, 0]}])",
     "mbd.bodies[0].inertia: the principal moments are [0, 0, 0] kg m2; all must be positive (check xx, "
     "yy, zz, xy, xz, yz and their units)"},
    {"InertiaIndefiniteByItsProducts",
     R"([{"op": "replace", "path": "/mbd/bodies/0/inertia", "value": [1, 1, 1, 2, 0, 0]}])",
     "mbd.bodies[0].inertia: the principal moments are [-1, 1, 3] kg m2; all must be positive (check xx, "
     "yy, zz, xy, xz, yz and their units)"},
    {"InertiaOfNoBody", R"([{"op": "replace", "path": "/mbd/bodies/0/inertia", "value": [1, 1, 5]}])",
     "mbd.bodies[0].inertia: the principal moments are [1, 1, 5] kg m2; the largest exceeds the sum of the "
     "others (no rigid body has such an inertia)"},
    {"NoBodies", R"([{"op": "replace", "path": "/mbd/bodies", "value": []}])",
     "mbd.bodies: the list is empty (give at least 1 element: the rigid bodies)"},
    {"TwoBodiesOfOneName", R"([{"op": "replace", "path": "/mbd/bodies/3/name", "value": "crate"}])",
     "mbd.bodies[3].name: the name 'crate' is given twice (names in mbd.bodies must differ)"},
    {"BodyCalledGround", R"([{"op": "replace", "path": "/mbd/bodies/3/name", "value": "ground"}])",
     "mbd.bodies[3].name: the name 'ground' is reserved (choose another name)"},
    {"BodyCalledSummary", R"([{"op": "replace", "path": "/mbd/bodies/3/name", "value": "summary"}])",
     "mbd.bodies[3].name: the name 'summary' is reserved (choose another name)"},
    {"OrientationNotUnit",
     R"([{"op": "replace", "path": "/mbd/bodies/1/orientation", "value": [1, 1, 0, 0]}])",
     "mbd.bodies[1].orientation: [1, 1, 0, 0] has length 1.4142135623730951, not 1 (the unit one is "
     "[0.7071067811865475, 0.7071067811865475, 0, 0])"},
    {"OrientationZero", R"([{"op": "replace", "path": "/mbd/bodies/1/orientation", "value": [0, 0, 0, 0]}])",
     "mbd.bodies[1].orientation: [0, 0, 0, 0] has length 0, not 1 (give a direction)"},
    {"OrientationOfThreeNumbers",
     R"([{"op": "replace", "path": "/mbd/bodies/1/orientation", "value": [0, 0, 0]}])",
     "mbd.bodies[1].orientation: the value is [0,0,0] (give a list of 4 numbers w, x, y, z or an object: "
     "unit "
     "quaternion, body to world, at the start [-])"},
    {"MisspeltBodyKey", R"([{"op": "add", "path": "/mbd/bodies/0/postion", "value": [0, 0, 0]}])",
     "mbd.bodies[0]: unknown key 'postion' (did you mean 'position'?)"},
    {"VelocityOfAJointedBody", R"([{"op": "add", "path": "/mbd/bodies/0/velocity", "value": [0, 0, 1]}])",
     "mbd.bodies[0].velocity: 'crate' gets its velocity from joint 'slide' (leave it out; revolute and "
     "prismatic joints have a rate)"},
    {"AngularVelocityOfAJointedBody",
     R"([{"op": "add", "path": "/mbd/bodies/2/angular_velocity", "value": [0, 0, 1]}])",
     "mbd.bodies[2].angular_velocity: 'ball' gets its velocity from joint 'socket' (leave it out; revolute "
     "and prismatic joints have a rate)"},
    {"UnknownJointType", R"([{"op": "replace", "path": "/mbd/joints/0/type", "value": "prismatc"}])",
     "mbd.joints[0].type: the value is \"prismatc\" (did you mean 'prismatic'?)"},
    {"JointWithoutType", R"([{"op": "remove", "path": "/mbd/joints/0/type"}])",
     "mbd.joints[0]: the key 'type' is missing (known types: revolute, prismatic, spherical, fixed, "
     "cylindrical, planar, universal, screw, distance, free)"},
    {"JointWithoutAxis", R"([{"op": "remove", "path": "/mbd/joints/0/axis"}])",
     "mbd.joints[0]: the key 'axis' is missing (add axis: unit vector in the world at the start [-])"},
    {"AxisOnASphericalJoint", R"([{"op": "add", "path": "/mbd/joints/2/axis", "value": [0, 0, 1]}])",
     "mbd.joints[2]: unknown key 'axis' for type 'spherical' (known keys: child, child_position, cut, "
     "damping, name, parent, position, "
     "relative_to, type)"},
    {"MotionOnASphericalJoint",
     R"([{"op": "add", "path": "/mbd/joints/2/motion", "value": {"type": "constant"}}])",
     "mbd.joints[2]: unknown key 'motion' for type 'spherical' (known keys: child, child_position, cut, "
     "damping, name, parent, position, "
     "relative_to, type)"},
    {"DampingOnAFixedJoint", R"([{"op": "replace", "path": "/mbd/joints/2/type", "value": "fixed"}])",
     "mbd.joints[2]: unknown key 'damping' for type 'fixed' (known keys: child, cut, name, parent, position, "
     "relative_to, type)"},
    {"NegativeDamping", R"([{"op": "replace", "path": "/mbd/joints/1/damping", "value": -1}])",
     "mbd.joints[1].damping: the value is -1 (give a number from 0 to 1e+18: torque or force against the "
     "rate [N m "
     "s/rad] or [N s/m])"},
    {"AxisNotUnit", R"([{"op": "replace", "path": "/mbd/joints/0/axis", "value": [0, 0, 2]}])",
     "mbd.joints[0].axis: [0, 0, 2] has length 2, not 1 (the unit one is [0, 0, 1])"},
    {"AxisZero", R"([{"op": "replace", "path": "/mbd/joints/0/axis", "value": [0, 0, 0]}])",
     "mbd.joints[0].axis: [0, 0, 0] has length 0, not 1 (give a direction)"},
    {"UnknownChild", R"([{"op": "replace", "path": "/mbd/joints/0/child", "value": "crat"}])",
     "mbd.joints[0].child: unknown name 'crat' (did you mean 'crate'?)"},
    {"UnknownParent", R"([{"op": "replace", "path": "/mbd/joints/1/parent", "value": "cart"}])",
     "mbd.joints[1].parent: unknown name 'cart' (known bodies: crate, arm, ball, bird)"},
    {"GroundAsChild", R"([{"op": "replace", "path": "/mbd/joints/0/child", "value": "ground"}])",
     "mbd.joints[0].child: the ground is no child of a joint (swap parent and child)"},
    {"ParentIsChild", R"([{"op": "replace", "path": "/mbd/joints/1/parent", "value": "arm"}])",
     "mbd.joints[1].child: 'arm' is parent and child of one joint (a joint connects two bodies)"},
    {"TwoJointsOfOneName", R"([{"op": "replace", "path": "/mbd/joints/1/name", "value": "slide"}])",
     "mbd.joints[1].name: the name 'slide' is given twice (names in mbd.joints must differ)"},
    {"JointCalledTime", R"([{"op": "replace", "path": "/mbd/joints/1/name", "value": "time"}])",
     "mbd.joints[1].name: the name 'time' is reserved (choose another name)"},
    {"RateWithMotion", R"([{"op": "add", "path": "/mbd/joints/1/rate", "value": 1}])",
     "mbd.joints[1].motion: the joint has both a motion and a rate of 1 (leave out the rate: the motion "
     "gives it)"},
    {"UnknownMotion", R"([{"op": "replace", "path": "/mbd/joints/1/motion/type", "value": "tabel"}])",
     "mbd.joints[1].motion.type: the value is \"tabel\" (did you mean 'table'?)"},
    {"MotionAsNumber", R"([{"op": "replace", "path": "/mbd/joints/1/motion", "value": 0.5}])",
     "mbd.joints[1].motion: the value is 0.5 (give an object: prescribes the coordinate [rad] or [m])"},
    {"TimesNotIncreasing", R"([{"op": "replace", "path": "/mbd/joints/1/motion/times", "value": [0, 2, 2]}])",
     "mbd.joints[1].motion.times[2]: 2 s does not come after 2 s (times must increase)"},
    {"TimesTooClose",
     R"([{"op": "replace", "path": "/mbd/joints/1/motion/times", "value": [0, 2, 2.0000000001]}])",
     "mbd.joints[1].motion.times[2]: 2.0000000001 s is 1e-10 s after 2 s, and a change takes 5.2e-07 s or "
     "more "
     "there (give times that are further apart, or one time with \"interpolation\": \"step\")"},
    {"RampTooShort",
     R"([{"op": "replace", "path": "/mbd/joints/1/motion", "value": {"type": "ramp", "to": 1, "start": 4, "duration": 1e-10}}])",
     "mbd.joints[1].motion.duration: 1e-10 s is too short for a change at 4 s (give 6.7e-07 s or more)"},
    {"RampOfASpeedTooShort",
     R"([{"op": "replace", "path": "/mbd/joints/1/motion", "value": {"type": "ramp", "of": "speed", "to": 1, "start": 4, "duration": 1e-10}}])",
     "mbd.joints[1].motion.duration: 1e-10 s is too short for a change at 4 s (give 1e-09 s or more)"},
    {"TimesWithoutValues", R"([{"op": "replace", "path": "/mbd/joints/1/motion/values", "value": [0, 1]}])",
     "mbd.joints[1].motion.values: 2 values for 3 times (give one value for each time)"},
    {"MotionWithCorners",
     R"([{"op": "add", "path": "/mbd/joints/1/motion/interpolation", "value": "linear"}])",
     "mbd.joints[1].motion.interpolation: a motion with corners has no acceleration there (add "
     "\"smoothing\": a time "
     "up to 1 s, the shortest between two times, or write \"monotone\")"},
    {"MotionWithSteps", R"([{"op": "replace", "path": "/mbd/joints/1/motion",
       "value": {"type": "table", "of": "speed", "times": [0, 0.5, 2], "values": [0, 1, 2], "interpolation": "step"}}])",
     "mbd.joints[1].motion.interpolation: a motion with steps has no acceleration there (add \"smoothing\": "
     "a time "
     "up to 0.5 s, the shortest between two times, or write \"monotone\")"},
    {"SmoothingTooLong", R"([{"op": "replace", "path": "/mbd/joints/1/motion", "value": {"type": "table",
       "times": [0, 0.5, 2], "values": [0, 1, 2], "interpolation": "linear", "smoothing": 0.6}}])",
     "mbd.joints[1].motion.smoothing: 0.6 s is longer than the shortest time between two values, 0.5 s (give "
     "that or "
     "less)"},
    {"SmoothingOfASpline", R"([{"op": "add", "path": "/mbd/joints/1/motion/smoothing", "value": 0.1}])",
     "mbd.joints[1].motion.smoothing: a table that is neither linear nor stepped is given 0.1 s (leave it "
     "out, or add "
     "\"interpolation\": \"linear\" or \"step\")"},
    {"OffsetOfPositions", R"([{"op": "add", "path": "/mbd/joints/1/motion/offset", "value": 2}])",
     "mbd.joints[1].motion.offset: the motion gives positions, and an offset of 2 as well (leave it out, or "
     "add "
     "\"of\": \"speed\")"},
    {"UnknownInterpolation",
     R"([{"op": "add", "path": "/mbd/joints/1/motion/interpolation", "value": "cubic"}])",
     "mbd.joints[1].motion.interpolation: the value is \"cubic\" (known values: monotone, linear, step, "
     "spline)"},
    {"MotionThroughItsStop",
     R"([{"op": "replace", "path": "/mbd/joints/1/motion", "value": {"type": "constant",
       "rate": 2}}, {"op": "add", "path": "/mbd/joints/1/limits", "value": {"lower": 0, "upper": 0.5,
       "stiffness": 1e5}}])",
     "mbd.joints[1].motion: the motion of joint 'hinge' leaves its limits at t = 0.25 s: at t = 0.5 s it is "
     "at 1, above "
     "the upper limit of 0.5 (a stop does not hold a prescribed coordinate: change the motion, or move or "
     "leave out the "
     "limits)"},
    {"HarmonicMotionThroughItsStop", R"([{"op": "replace", "path": "/mbd/joints/1/motion", "value":
       {"type": "harmonic", "amplitude": 1, "frequency": 100}}, {"op": "add", "path": "/mbd/joints/1/limits",
       "value": {"lower": -0.5, "upper": 1, "stiffness": 1e5}}])",
     "mbd.joints[1].motion: the motion of joint 'hinge' leaves its limits at t = 0.00583333 s: at t = 0.0075 "
     "s it is at "
     "-1, below the lower limit of -0.5 (a stop does not hold a prescribed coordinate: change the motion, or "
     "move or "
     "leave out the limits)"},
    {"TableOfOnePoint", R"([{"op": "replace", "path": "/mbd/joints/1/motion/times", "value": [0]}])",
     "mbd.joints[1].motion.times: the value is [0] (give at least 2 elements: increasing times [s])"},
    {"RampWithoutDuration",
     R"([{"op": "replace", "path": "/mbd/joints/1/motion", "value": {"type": "ramp", "to": 1, "duration": 0}}])",
     "mbd.joints[1].motion.duration: the value is 0 (give a number from 1e-12 to 1e+09: length of the ramp "
     "[s])"},
    {"ForceOnUnknownJoint", R"([{"op": "replace", "path": "/mbd/forces/1/joint", "value": "hing"}])",
     "mbd.forces[1].joint: unknown name 'hing' (did you mean 'hinge'?)"},
    {"ForceWithoutJoints", R"([{"op": "replace", "path": "/mbd/joints", "value": []}])",
     "mbd.forces[1].joint: unknown name 'hinge' (there are no joints)"},
    {"RotationalSpringOnASlide", R"([{"op": "replace", "path": "/mbd/forces/1/joint", "value": "slide"}])",
     "mbd.forces[1].joint: joint 'slide' is not revolute (a rotational_spring_damper turns about the axis "
     "of a revolute joint; known revolute joints: hinge)"},
    {"SpringOnOneBody", R"([{"op": "add", "path": "/mbd/forces/0/body_a", "value": "crate"}])",
     "mbd.forces[0].body_b: both ends of 'spring' are on the same body (a spring acts between two bodies, "
     "or a body and the ground)"},
    {"SpringWithoutDirection", R"([{"op": "replace", "path": "/mbd/forces/0/point_b", "value": [0, 0, 3]}])",
     "mbd.forces[0].point_b: both ends are at [0, 0, 3]: the force has no direction (move one of the "
     "points)"},
    {"SpringWithoutLength", R"([{"op": "remove", "path": "/mbd/forces/0/length"}])",
     "mbd.forces[0]: the key 'length' is missing (add length: free length [m])"},
    {"NegativeStiffness", R"([{"op": "replace", "path": "/mbd/forces/0/stiffness", "value": -1000}])",
     "mbd.forces[0].stiffness: the value is -1000 (give a number from 0 to 1e+18: stiffness [N/m])"},
    {"TwoForcesOfOneName", R"([{"op": "replace", "path": "/mbd/forces/1/name", "value": "spring"}])",
     "mbd.forces[1].name: the name 'spring' is given twice (names in mbd.forces must differ)"},
    {"StepAboveTheWindow", R"([{"op": "replace", "path": "/mbd/integrator/step", "value": 0.002}])",
     "mbd.integrator.step: the step of 0.002 s is longer than the window of 0.001 s (leave it out for one "
     "step per window)"},
    {"RhoInfAboveOne", R"([{"op": "replace", "path": "/mbd/integrator/rho_inf", "value": 1.5}])",
     "mbd.integrator.rho_inf: the value is 1.5 (give a number from 0 to 1: spectral radius at infinite "
     "frequency "
     "[-])"},
    {"IterationsAsFraction", R"([{"op": "replace", "path": "/mbd/integrator/max_iterations", "value": 2.5}])",
     "mbd.integrator.max_iterations: the value is 2.5 (give an integer: Newton iterations of one step [-])"},
};

INSTANTIATE_TEST_SUITE_P(Mbd, WrongSceneTest, testing::ValuesIn(wrong_mbd), name_of_case);

TEST(Forces, OfAnUnknownTypeAreToldTheTypes) {
  const std::string said =
      verdict_on_patch(R"([{"op": "replace", "path": "/mbd/forces/0/type", "value": "spring"}])");
  EXPECT_TRUE(
      said.starts_with("scene.json: mbd.forces[0].type: the value is \"spring\" (known values: "
                       "spring_damper, rotational_spring_damper, bushing, force, torque, actuator"))
      << said;
}

}  // namespace
}  // namespace tandem::scene::test
