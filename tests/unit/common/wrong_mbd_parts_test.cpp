// Wrong scenes: stops, friction, cut joints, couplers, tabulated laws, bushings, loads, actuators.
#include "tests/unit/common/wrong_scene.hpp"

namespace tandem::scene::test {
namespace {

// Joints of the good scene: 0 slide (prismatic), 1 hinge (revolute, driven), 2 socket (spherical).
#define PUT(place, value) R"([{"op": "add", "path": "/mbd/)" place R"(", "value": )" value "}]"
#define TWO_JOINTS \
  R"({"name": "spin", "type": "revolute", "child": "ball", "position": [0, 0, 0], "axis": [0, 0, 1]})"
#define COUPLER(rest)                                                   \
  R"([{"op": "replace", "path": "/mbd/joints/2", "value": )" TWO_JOINTS \
  R"(}, {"op": "add", "path": "/mbd/couplers", "value": [{"name": "c", )" rest "}]}]"

const WrongScene joints[] = {
    {"LimitsReversed", PUT("joints/0/limits", R"({"lower": 1, "upper": -1, "stiffness": 1e6})"),
     "mbd.joints[0].limits.upper: -1 is not above the lower limit of 1 (lower < upper)"},
    {"LimitsWithoutStiffness", PUT("joints/0/limits", R"({"lower": -1, "upper": 1})"),
     "mbd.joints[0].limits: the key 'stiffness' is missing (add stiffness: of the stops [N m/rad] or [N/m])"},
    {"LimitsWithoutLower", PUT("joints/0/limits", R"({"upper": 1, "stiffness": 1})"),
     "mbd.joints[0].limits: the key 'lower' is missing (add lower: lower end of the travel [rad] or [m])"},
    {"SoftLimits", PUT("joints/0/limits", R"({"lower": -1, "upper": 1, "stiffness": 0})"),
     "mbd.joints[0].limits.stiffness: the value is 0 (give a number from 1e-09 to 1e+18: of the stops [N "
     "m/rad] or [N/m])"},
    {"LimitsThatFeedEnergy",
     PUT("joints/0/limits", R"({"lower": -1, "upper": 1, "stiffness": 1e6, "damping": -0.1})"),
     "mbd.joints[0].limits.damping: the value is -0.1 (give a number from 0 to 1e+18: d in the force "
     "stiffness depth (1 + d "
     "rate) [s/rad] or [s/m])"},
    {"LimitsWithDampingAndRestitution",
     PUT("joints/0/limits",
         R"({"lower": -1, "upper": 1, "stiffness": 1e6, "damping": 0.1, "restitution": 0.5})"),
     "mbd.joints[0].limits.restitution: the damping is given as well, and each follows from the other (leave "
     "out one of "
     "the two)"},
    {"LimitsThatReturnNothing",
     PUT("joints/0/limits", R"({"lower": -1, "upper": 1, "stiffness": 1e6, "restitution": 0})"),
     "mbd.joints[0].limits.restitution: the value is 0 (give a number from 0.01 to 1: rate after a contact "
     "over the rate "
     "before it [-], in place of damping; 0.01 returns a ten-thousandth of the energy)"},
    {"LimitsOfTwoRuns",
     R"([{"op": "add", "path": "/mbd/joints/0/limits", "value": {"lower": -1, "upper": 1, "stiffness": 1e6}},
         {"op": "add", "path": "/mbd/integrator", "value": {"extrapolate": true}}])",
     "mbd.integrator.extrapolate: the contacts of mbd.joints[0].limits begin at other times in each of the "
     "two runs (leave "
     "out extrapolate or the limits)"},
    {"MisspeltLimit", PUT("joints/0/limits", R"({"lower": -1, "uper": 1, "stiffness": 1e6})"),
     "mbd.joints[0].limits: unknown key 'uper' (did you mean 'upper'?)"},
    {"LimitsAsList", PUT("joints/0/limits", "[-1, 1]"),
     "mbd.joints[0].limits: the value is [-1,1] (give an object: stops at the ends of the travel)"},
    {"LimitsOnASphericalJoint", PUT("joints/2/limits", R"({"lower": -1, "upper": 1, "stiffness": 1})"),
     "mbd.joints[2]: unknown key 'limits' for type 'spherical' (known keys: child, child_position, cut, "
     "damping, "
     "name, parent, position, "
     "relative_to, type)"},
    {"FrictionThatJumps", PUT("joints/0/friction", R"({"force": 5, "slip": 0})"),
     "mbd.joints[0].friction.slip: the value is 0 (give a number from 1e-12 to 1e+12: rate at which tanh(1) "
     "of it act [rad/s] or "
     "[m/s])"},
    {"FrictionThatDrives", PUT("joints/0/friction", R"({"force": -5, "slip": 0.01})"),
     "mbd.joints[0].friction.force: the value is -5 (give a number from 0 to 1e+18: friction torque or force "
     "of the sliding "
     "joint [N m] or [N])"},
    {"FrictionAsNumber", PUT("joints/0/friction", "0.3"),
     "mbd.joints[0].friction: the value is 0.3 (give an object: Coulomb friction)"},
    {"CutJointWithDamping", PUT("joints/2/cut", "true"),
     "mbd.joints[2].cut: joint 'socket' is cut, but has a motion, rate, damping, limits or friction, which "
     "act on "
     "its coordinate (cut another joint of the loop)"},
    {"CutAsNumber", PUT("joints/2/cut", "1"),
     "mbd.joints[2].cut: the value is 1 (give a boolean: close a loop here, whatever the automatic choice)"},
    {"UniversalWithoutItsSecondAxis",
     PUT("joints/2",
         R"({"name": "u", "type": "universal", "child": "ball", "position": [0, 0, 0], "axis": [0, 0, 1]})"),
     "mbd.joints[2]: the key 'axis2' is missing (add axis2: second axis, fixed in the child, perpendicular "
     "to the "
     "first [-])"},
    {"UniversalWithoutACross",
     PUT("joints/2",
         R"({"name": "u", "type": "universal", "child": "ball", "position": [0, 0, 0], "axis": [0, 0, 1],
                         "axis2": [0, 0.6, 0.8]})"),
     "mbd.joints[2].axis2: [0, 0.6, 0.8] is not perpendicular to the axis [0, 0, 1] (the axes of a universal "
     "joint "
     "make a cross)"},
    {"SecondAxisNotUnit",
     PUT("joints/2",
         R"({"name": "u", "type": "universal", "child": "ball", "position": [0, 0, 0], "axis": [0, 0, 1],
                         "axis2": [3, 0, 0]})"),
     "mbd.joints[2].axis2: [3, 0, 0] has length 3, not 1 (the unit one is [1, 0, 0])"},
    {"ScrewWithoutPitch",
     PUT("joints/2",
         R"({"name": "s", "type": "screw", "child": "ball", "position": [0, 0, 0], "axis": [0, 0, 1]})"),
     "mbd.joints[2]: the key 'pitch' is missing (add pitch: travel along the axis per angle [m/rad])"},
    {"PlanarWithLimits",
     PUT("joints/2",
         R"({"name": "p", "type": "planar", "child": "ball", "position": [0, 0, 0], "axis": [0, 0, 1],
                         "limits": {}})"),
     "mbd.joints[2]: unknown key 'limits' for type 'planar' (known keys: axis, child, child_position, cut, "
     "damping, "
     "name, parent, position, "
     "relative_to, type)"},
    {"DistanceOfNoLength",
     PUT("joints/2", R"({"name": "d", "type": "distance", "child": "ball", "position": [0, 0, 0],
                         "child_position": [1, 0, 0], "length": 0})"),
     "mbd.joints[2].length: the value is 0 (give a number from 1e-09 to 1e+09: distance of the two points "
     "[m])"},
    {"DistanceWithoutDirection",
     PUT("joints/2", R"({"name": "d", "type": "distance", "child": "ball", "position": [1, 0, 0],
                         "child_position": [1, 0, 0], "length": 1})"),
     "mbd.joints[2].child_position: both ends are at [1, 0, 0]: the distance has no direction (move one of "
     "the "
     "points)"},
    {"DistanceInTheTree",
     PUT("joints/2", R"({"name": "d", "type": "distance", "child": "ball", "position": [1, 0, 0],
                         "child_position": [2, 0, 0], "length": 1, "cut": true})"),
     "mbd.joints[2]: unknown key 'cut' for type 'distance' (known keys: child, child_position, length, name, "
     "parent, position, "
     "relative_to, type)"},
};
INSTANTIATE_TEST_SUITE_P(Joints, WrongSceneTest, testing::ValuesIn(joints), name_of_case);

const WrongScene couplers[] = {
    {"UnknownCoupler", COUPLER(R"("type": "gears", "joint_a": "hinge", "joint_b": "spin", "ratio": 2)"),
     "mbd.couplers[0].type: the value is \"gears\" (did you mean 'gear'?)"},
    {"CouplerWithoutRatio", COUPLER(R"("type": "belt", "joint_a": "hinge", "joint_b": "spin")"),
     "mbd.couplers[0]: the key 'ratio' is missing (add ratio: q_b / q_a, negative for meshing gears [-] or "
     "[m/rad])"},
    {"RatioZero", COUPLER(R"("type": "gear", "joint_a": "hinge", "joint_b": "spin", "ratio": 0)"),
     "mbd.couplers[0].ratio: the ratio is 0 (give q_b / q_a)"},
    {"CouplerOfAnUnknownJoint",
     COUPLER(R"("type": "gear", "joint_a": "hinge", "joint_b": "spinn", "ratio": 2)"),
     "mbd.couplers[0].joint_b: unknown name 'spinn' (did you mean 'spin'?)"},
    {"GearOnASlide", COUPLER(R"("type": "gear", "joint_a": "slide", "joint_b": "spin", "ratio": 2)"),
     "mbd.couplers[0].joint_a: joint 'slide' is not revolute (name a revolute joint; known revolute joints: "
     "hinge, spin)"},
    {"BeltToASlide", COUPLER(R"("type": "belt", "joint_a": "spin", "joint_b": "slide", "ratio": 2)"),
     "mbd.couplers[0].joint_b: joint 'slide' is not revolute (gears and belts join revolute joints; "
     "known revolute joints: hinge, spin)"},
    {"RackThatTurns",
     COUPLER(R"("type": "rack_and_pinion", "joint_a": "hinge", "joint_b": "spin", "ratio": 2)"),
     "mbd.couplers[0].joint_b: joint 'spin' is not prismatic (a rack slides)"},
    {"GearWithItself", COUPLER(R"("type": "gear", "joint_a": "spin", "joint_b": "spin", "ratio": 2)"),
     "mbd.couplers[0].joint_b: 'spin' is coupled to itself (name two joints)"},
    {"TwoCouplersOfOneName",
     COUPLER(R"("type": "gear", "joint_a": "hinge", "joint_b": "spin", "ratio": 2}, {"name": "c",
                "type": "belt", "joint_a": "hinge", "joint_b": "spin", "ratio": 2)"),
     "mbd.couplers[1].name: the name 'c' is given twice (names in mbd.couplers must differ)"},
    {"GearOnACutJoint",
     R"([{"op": "replace", "path": "/mbd/joints/2", "value": {"name": "spin", "type": "revolute", "child": "ball",
          "position": [0, 0, 0], "axis": [0, 0, 1], "cut": true}},
         {"op": "add", "path": "/mbd/couplers", "value": [{"name": "c", "type": "gear", "joint_a": "hinge",
          "joint_b": "spin", "ratio": 2}]}])",
     "mbd.couplers[0].joint_b: joint 'spin' is cut and has no coordinate (cut another joint of the loop)"},
};
INSTANTIATE_TEST_SUITE_P(Couplers, WrongSceneTest, testing::ValuesIn(couplers), name_of_case);

const WrongScene forces[] = {
    {"TableBesideAStiffness", PUT("forces/0/table", R"({"arguments": [0, 1], "values": [0, 1]})"),
     "mbd.forces[0].table: there is a stiffness as well (give one of the two)"},
    {"TableBesideADamping", PUT("forces/1/damping_table", R"({"arguments": [0, 1], "values": [0, 1]})"),
     "mbd.forces[1].damping_table: there is a damping as well (give one of the two)"},
    {"TableOfOnePoint", PUT("forces/0/table", R"({"arguments": [0], "values": [0, 1]})"),
     "mbd.forces[0].table.arguments: the value is [0] (give at least 2 elements: increasing arguments of the "
     "law)"},
    {"ArgumentsNotIncreasing",
     R"([{"op": "remove", "path": "/mbd/forces/0/stiffness"},
         {"op": "add", "path": "/mbd/forces/0/table", "value": {"arguments": [0, 2, 1], "values": [0, 1, 2]}}])",
     "mbd.forces[0].table.arguments[2]: 1 does not come after 2 (arguments must increase)"},
    {"ArgumentsWithoutValues",
     R"([{"op": "remove", "path": "/mbd/forces/0/stiffness"},
         {"op": "add", "path": "/mbd/forces/0/table", "value": {"arguments": [0, 1, 2], "values": [0, 1]}}])",
     "mbd.forces[0].table.values: 2 values for 3 arguments (give one value for each argument)"},
    {"BushingOnOneBody",
     PUT("forces/0",
         R"({"name": "b", "type": "bushing", "body_a": "arm", "body_b": "arm", "position": [0, 0, 0],
                         "stiffness": [1, 1, 1, 1, 1, 1]})"),
     "mbd.forces[0].body_b: both ends of 'b' are on the same body (a bushing connects two bodies, or a body "
     "and the "
     "ground)"},
    {"BushingOfFiveNumbers",
     PUT("forces/0", R"({"name": "b", "type": "bushing", "body_b": "arm", "position": [0, 0, 0],
                         "stiffness": [1, 1, 1, 1, 1]})"),
     "mbd.forces[0].stiffness: the value is [1,1,1,1,1] (give a list of 6 numbers or a list of 36 numbers: "
     "diagonal "
     "or rows of the matrix from x y z [m] and rotation vector [rad] to force [N] and torque [N m])"},
    {"ForceOnTheGround",
     PUT("forces/0",
         R"({"name": "f", "type": "force", "body": "ground", "point": [0, 0, 0], "direction": [0, 0, 1],
                         "size": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].body: unknown name 'ground' (known bodies: crate, arm, ball, bird)"},
    {"ForceWithoutDirection",
     PUT("forces/0",
         R"({"name": "f", "type": "force", "body": "arm", "point": [0, 0, 0], "direction": [0, 0, 0],
                         "size": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].direction: [0, 0, 0] has length 0, not 1 (give a direction)"},
    {"TorqueAtAPoint",
     PUT("forces/0",
         R"({"name": "f", "type": "torque", "body": "arm", "point": [0, 0, 0], "direction": [0, 0, 1],
                         "size": {"type": "constant", "value": 1}})"),
     "mbd.forces[0]: unknown key 'point' for type 'torque' (known keys: body, direction, follows, local, "
     "name, "
     "over, "
     "size, type)"},
    {"ForceOfUnknownSize",
     PUT("forces/0",
         R"({"name": "f", "type": "force", "body": "arm", "point": [0, 0, 0], "direction": [0, 0, 1],
                         "size": 3})"),
     "mbd.forces[0].size: the value is 3 (give an object: as a function of time [N])"},
    {"SizeWithoutValues",
     PUT("forces/0",
         R"({"name": "f", "type": "force", "body": "arm", "point": [0, 0, 0], "direction": [0, 0, 1],
                         "size": {"type": "table", "times": [0, 1, 2], "values": [1, 2]}})"),
     "mbd.forces[0].size.values: 2 values for 3 times (give one value for each time)"},
    {"SpeedOfAForce",
     PUT("forces/0", R"({"name": "t", "type": "torque", "body": "crate", "direction": [0, 0, 1],
                         "size": {"type": "ramp", "of": "speed", "to": 1, "duration": 1}})"),
     "mbd.forces[0].size: unknown key 'of' for type 'ramp' (known keys: duration, from, from_deg, start, to, "
     "to_deg, type)"},
    {"ActuatorOnASphericalJoint",
     PUT("forces/0", R"({"name": "m", "type": "actuator", "joint": "socket", "size": {"type": "constant"}})"),
     "mbd.forces[0].joint: joint 'socket' is neither revolute nor prismatic (an actuator drives one "
     "coordinate)"},
    {"ActuatorOnADrivenJoint",
     PUT("forces/0", R"({"name": "m", "type": "actuator", "joint": "hinge", "size": {"type": "constant"}})"),
     "mbd.forces[0].joint: joint 'hinge' has a motion: no torque can move it (leave out one of the two)"},
    {"ForceOfTimeAndOfACoordinate",
     PUT("forces/0",
         R"({"name": "f", "type": "force", "body": "crate", "point": [0, 0, 0], "direction": [0, 0, 1], "size": {"type": "constant"}, "over": {"joint": "slide", "arguments": [0, 1], "values": [0, 1]}})"),
     "mbd.forces[0]: the force has a size and an over (give one of them: a function of time, or of a joint "
     "coordinate)"},
    {"ForceOverASphericalJoint",
     PUT("forces/0",
         R"({"name": "f", "type": "torque", "body": "crate", "direction": [0, 0, 1], "over": {"joint": "socket", "arguments": [0, 1], "values": [0, 1]}})"),
     "mbd.forces[0].over.joint: joint 'socket' has no coordinate of its own (name a revolute, prismatic or "
     "screw "
     "joint)"},
    {"ForceOverLessThanAPeriod",
     PUT("forces/0",
         R"({"name": "f", "type": "actuator", "joint": "slide", "over": {"joint": "hinge", "arguments": [0, 3, 6], "values": [0, 1, 0], "period": 12}})"),
     "mbd.forces[0].over.period: the arguments cover 6, and the period is 12 (let the table begin and end "
     "one "
     "period apart)"},
    {"PeriodInDegrees",
     PUT("forces/0",
         R"({"name": "f", "type": "actuator", "joint": "slide", "over": {"joint": "hinge", "arguments_deg": [0, 90, 360], "values": [0, 1, 0], "period_deg": 720}})"),
     "mbd.forces[0].over.period_deg: the arguments cover 360 deg, and the period is 720 deg (let the table "
     "begin "
     "and end one period apart)"},
    {"ArgumentsInDegreesThatFall",
     PUT("forces/0",
         R"({"name": "f", "type": "actuator", "joint": "slide", "over": {"joint": "hinge", "arguments_deg": [0, 90, 45], "values": [0, 1, 0]}})"),
     "mbd.forces[0].over.arguments_deg[2]: 45 deg does not come after 90 deg (arguments must increase)"},
    {"ForceThatJumpsAtItsPeriod",
     PUT("forces/0",
         R"({"name": "f", "type": "actuator", "joint": "slide", "over": {"joint": "hinge", "arguments": [0, 3, 6], "values": [0, 1, 2], "period": 6}})"),
     "mbd.forces[0].over.values: the last value, 2, differs from the first, 0 (both are at the same place of "
     "the "
     "period: give the same value)"},
    {"RopeOnOneBody",
     PUT("forces/0",
         R"({"name": "r", "type": "rope", "length": 1, "axial_stiffness": 1e5, "points": [{"body": "crate", "point": [0, 0, 1]}, {"body": "crate", "point": [0, 0, 2]}]})"),
     "mbd.forces[0].points: all points of rope 'r' are on the same body (name points of two bodies at least, "
     "or "
     "of a body and the ground)"},
    {"RopeWithoutDirection",
     PUT("forces/0",
         R"({"name": "r", "type": "rope", "length": 1, "axial_stiffness": 1e5, "points": [{"point": [0, 0, 1]}, {"body": "crate", "point": [0, 0, 1]}]})"),
     "mbd.forces[0].points[1].point: two points in succession are at [0, 0, 1]: the rope has no direction "
     "there "
     "(move one of the points, or leave it out)"},
    {"RopeWithoutStiffness",
     PUT("forces/0",
         R"({"name": "r", "type": "rope", "length": 1, "axial_stiffness": 0, "points": [{"point": [0, 0, 1]}, {"body": "crate", "point": [0, 0, 2]}]})"),
     "mbd.forces[0].axial_stiffness: the value is 0 (give a number from 1e-09 to 1e+18: tension per strain, "
     "E A "
     "[N])"},
    {"FrictionOfTwoKinds", PUT("joints/0/friction", R"({"force": 1, "slip": 0.1, "breakaway": 2})"),
     "mbd.joints[0].friction: there is a slip and a breakaway (give one of them: with slip the joint creeps "
     "under "
     "a load, with breakaway it stays at rest)"},
    {"FrictionOfNoKind", PUT("joints/0/friction", R"({"force": 1})"),
     "mbd.joints[0].friction: there is neither slip nor breakaway (give one of them: with slip the joint "
     "creeps "
     "under a load, with breakaway it stays at rest)"},
    {"FrictionThatBreaksAwayTooEarly", PUT("joints/0/friction", R"({"force": 3, "breakaway": 2})"),
     "mbd.joints[0].friction.breakaway: 2 is below the force of the sliding joint, 3 (give that or more)"},
    {"CoupledSphericalJoint",
     PUT("couplers",
         R"([{"name": "c", "type": "linear", "terms": [{"joint": "slide", "factor": 1}, {"joint": "socket", "factor": 2}]}])"),
     "mbd.couplers[0].terms[1].joint: joint 'socket' has no coordinate of its own (name a revolute, "
     "prismatic, "
     "screw or cylindrical joint)"},
    {"CoupledWithItself",
     PUT("couplers",
         R"([{"name": "c", "type": "linear", "terms": [{"joint": "slide", "factor": 1}, {"joint": "slide", "factor": 2}]}])"),
     "mbd.couplers[0].terms[1].joint: 'slide' is coupled to itself (name each coordinate once)"},
    {"CoupledByNothing",
     PUT("couplers",
         R"([{"name": "c", "type": "linear", "terms": [{"joint": "slide", "factor": 0}, {"joint": "hinge", "factor": 2}]}])"),
     "mbd.couplers[0].terms[0].factor: the factor is 0 (leave the term out)"},
    {"CoupledCoordinateOfOne",
     PUT("couplers",
         R"([{"name": "c", "type": "linear", "terms": [{"joint": "slide", "factor": 1, "coordinate": "angle"}, {"joint": "hinge", "factor": 2}]}])"),
     "mbd.couplers[0].terms[0].coordinate: joint 'slide' has one coordinate (leave it out)"},
    {"CamThatRunsBack",
     PUT("couplers",
         R"([{"name": "c", "type": "cam", "joint_a": "hinge", "joint_b": "slide", "table": {"arguments": [0, 2, 1], "values": [0, 1, 2]}}])"),
     "mbd.couplers[0].table.arguments[2]: 1 does not come after 2 (arguments must increase)"},
    {"ActuatorWithoutSize", PUT("forces/0", R"({"name": "m", "type": "actuator", "joint": "slide"})"),
     "mbd.forces[0]: the actuator has neither size nor input (give one of them: a function of time, or the "
     "name of a control input, or over, a function of a joint coordinate)"},
    {"ActuatorOfTwoMinds",
     PUT("forces/0",
         R"({"name": "m", "type": "actuator", "joint": "slide", "size": {"type": "constant"}, "input": "u"})"),
     "mbd.forces[0]: the actuator has a size and an input (give one of them: a function of time, or the name "
     "of a control input, or over, a function of a joint coordinate)"},
    {"UnknownSensor", PUT("sensors", R"(["hinge.q", "hinge.angle"])"),
     "mbd.sensors[1]: unknown signal 'hinge.angle' (known signals: hinge.q, hinge.rate, "
     "hinge.reaction_force.x, "
     "hinge.reaction_force.y, hinge.reaction_force.z, hinge.reaction_torque.x, hinge.reaction_torque.y, "
     "hinge.reaction_torque.z, hinge.undetermined, hinge.torque, hinge.speed, "
     "hinge.power, and 3 more)"},
    {"SensorOfUnknownJoint", PUT("sensors", R"(["hing.q"])"),
     "mbd.sensors[0]: unknown signal 'hing.q' (did you mean 'hinge.q'?)"},
    {"SensorOfUnknownJointAndColumn", PUT("sensors", R"(["hing.rat"])"),
     "mbd.sensors[0]: unknown signal 'hing.rat' (did you mean 'hinge.rate'?)"},
    {"SensorOfUnknownJointAlone", PUT("sensors", R"(["hing.temperature"])"),
     "mbd.sensors[0]: unknown signal 'hing.temperature' (did you mean 'hinge'?)"},
    {"SensorOfUnknownMotor",
     R"([{"op": "remove", "path": "/mbd/joints/1/motion"},
         {"op": "replace", "path": "/mbd/forces/0", "value": {"name": "motor", "type": "motor", "joint": "hinge",
          "control": "speed", "target": {"type": "constant", "value": 1}, "gains": {"proportional": 1}}},
         {"op": "add", "path": "/mbd/sensors", "value": ["motr.torque"]}])",
     "mbd.sensors[0]: unknown signal 'motr.torque' (did you mean 'motor.torque'?)"},
    {"SensorTwice", PUT("sensors", R"(["hinge.q", "hinge.q"])"),
     "mbd.sensors[1]: the value \"hinge.q\" is given twice (keep one of them)"},
    {"UnknownFormulation", PUT("integrator/formulation", R"("index1")"),
     "mbd.integrator.formulation: the value is \"index1\" (did you mean 'index2'?)"},
    {"ErrorToleranceZero", PUT("integrator/error_tolerance", "0"),
     "mbd.integrator.error_tolerance: the value is 0 (give a number from 1e-18 to 1: local error per step "
     "of the position, and of the velocity times step, relative to 1 rad and the size of the system [-])"},
    {"UnknownMethod", PUT("integrator/method", R"("dormand_price")"),
     "mbd.integrator.method: the value is \"dormand_price\" (did you mean 'dormand_prince'?)"},
    {"SettingOfTheOtherMethod", PUT("integrator", R"({"method": "dormand_prince", "rho_inf": 0.5})"),
     "mbd.integrator.rho_inf: the method 'dormand_prince' has no such setting (leave it out, or write "
     "\"method\": \"generalized_alpha\")"},
    {"LimitsByTheExplicitMethod",
     R"([{"op": "add", "path": "/mbd/integrator", "value": {"method": "dormand_prince"}},
         {"op": "add", "path": "/mbd/joints/0/limits", "value": {"lower": -1, "upper": 1, "stiffness": 1e6}}])",
     "mbd.integrator.method: 'dormand_prince' does not compute the contacts of mbd.joints[0].limits (leave "
     "out "
     "method, which is then generalized_alpha, or leave out the limits)"},
    {"BrakeByTheExplicitMethod",
     R"([{"op": "remove", "path": "/mbd/joints/1/motion"},
         {"op": "add", "path": "/mbd/integrator", "value": {"method": "dormand_prince"}},
         {"op": "replace", "path": "/mbd/forces/0", "value": {"name": "m", "type": "motor", "joint": "hinge",
          "control": "speed", "target": {"type": "constant", "value": 1}, "gains": {"proportional": 1},
          "brake": {"torque": 5, "breakaway": 6}}}])",
     "mbd.integrator.method: 'dormand_prince' does not hold a joint at rest, as the breakaway of "
     "mbd.forces[0].brake asks (leave out method, which is then generalized_alpha, or give the brake a "
     "slip)"},
    {"ExtrapolationUnderErrorControl", PUT("integrator", R"({"extrapolate": true, "error_tolerance": 1e-6})"),
     "mbd.integrator.extrapolate: two runs with steps of h and h/2 have no step of their own to control "
     "(leave out "
     "extrapolate or error_tolerance)"},
    {"MinStepZero", PUT("integrator/min_step", "0"),
     "mbd.integrator.min_step: the value is 0 (give a number from 1e-18 to 1e+09: shortest step of the error "
     "control [s])"},
};
INSTANTIATE_TEST_SUITE_P(Forces, WrongSceneTest, testing::ValuesIn(forces), name_of_case);

}  // namespace
}  // namespace tandem::scene::test
