// Wrong scenes: motors and cylinders.
#include "tests/unit/common/wrong_scene.hpp"

namespace tandem::scene::test {
namespace {

// The third joint of the good scene becomes a free revolute one, its first force the given one.
#define ELEMENT(force)                                                                                     \
  R"([{"op": "replace", "path": "/mbd/joints/2", "value": {"name": "spin", "type": "revolute", "child": )" \
  R"("ball", "position": [0, 0, 0], "axis": [0, 0, 1]}}, )"                                                \
  R"({"op": "add", "path": "/mbd/forces/0", "value": )" force "}]"

const WrongScene elements[] = {
    {"MotorOnASlide",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "slide", "control": "speed", "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].joint: joint 'slide' is not revolute (a motor turns; write a cylinder for a "
     "sliding joint; known revolute joints: hinge, spin)"},
    {"MotorOnADrivenJoint",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "hinge", "control": "speed", "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].joint: joint 'hinge' has a motion: no torque can move it (leave out one of the "
     "two)"},
    {"MotorWithoutTarget", ELEMENT(R"({"name": "m", "type": "motor", "joint": "spin", "control": "speed"})"),
     "mbd.forces[0]: the motor has neither target nor input (give one of them: a function of time, "
     "or the name of a control input)"},
    {"MotorOfTwoMinds",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "speed", "input": "u", "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0]: the motor has a target and an input (give one of them: a function of time, or "
     "the name of a control input)"},
    {"MotorWithoutGains",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "speed", "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].gains: all gains are 0: nothing follows the target (give a proportional gain, "
     "and an integral one where a load must not leave an error)"},
    {"AccelerationWithoutFilter",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "speed", "gains": {"derivative": 1}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].gains.derivative: the derivative of a rate is an acceleration, which is not "
     "filtered (add \"filter\": a time constant, or leave out the derivative)"},
    {"FilterOfNothing",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "position", "gains": {"proportional": 1, "filter": 0.1}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].gains.filter: there is no derivative to filter (leave it out, or add a "
     "derivative)"},
    {"AntiWindupWithoutLimit",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "speed", "gains": {"proportional": 1, "integral": 1, "anti_windup": 1}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].gains.anti_windup: no limit can wind up an integral here (leave it out, or give "
     "a limit and an integral gain)"},
    {"IntegralThatWindsUp",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "speed", "gains": {"integral": 1}, "max_torque": 2, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].gains.integral: the limited integral has no time constant to be drawn back with "
     "(add \"anti_windup\": a time constant, or a proportional gain)"},
    {"ThrottleWithoutCurve",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "throttle", "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].control: a throttle takes a share of torque_speed, which is not given (add "
     "torque_speed, or control the speed or the position)"},
    {"ThrottleWithGains",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "throttle", "gains": {"proportional": 1}, "torque_speed": {"arguments": [0, 1], "values": [1, 0]}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].gains: the control 'throttle' has no error for them (leave them out)"},
    {"ThrottleBeyondFull",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "throttle", "torque_speed": {"arguments": [0, 1], "values": [1, 0]}, "target": {"type": "constant", "value": 2}})"),
     "mbd.forces[0].target: the throttle is 2 at t = 0 s (give values from -1 to 1)"},
    {"TwoLimitsOfAMotor",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "speed", "gains": {"proportional": 1}, "max_torque": 1, "torque_speed": {"arguments": [0, 1], "values": [1, 0]}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].max_torque: torque_speed limits the torque already (leave out one of the two)"},
    {"CurveThatTurnsBack",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "speed", "gains": {"proportional": 1}, "torque_speed": {"arguments": [1, 0], "values": [1, 0]}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].torque_speed.arguments[1]: 0 does not come after 1 (arguments must increase)"},
    {"BrakeBeyondFull",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "speed", "gains": {"proportional": 1}, "brake": {"torque": 1, "slip": 0.1, "engaged": {"type": "constant", "value": 2}}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].brake.engaged: the share is 2 at t = 0 s (give values from 0 to 1)"},
    {"BrakeOfTwoMinds",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "speed", "gains": {"proportional": 1}, "brake": {"torque": 1, "slip": 0.1, "input": "b", "engaged": {"type": "constant"}}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].brake.engaged: the brake has an input as well (leave out one of the two)"},
    {"CylinderOnOneBody",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_a": "crate", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "force", "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].body_b: both ends of 'c' are on the same body (a cylinder acts between two "
     "bodies, or a body and the ground)"},
    {"CylinderWithoutDirection",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 3], "control": "force", "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].point_b: both ends are at [0, 0, 3]: the force has no direction (move one of the "
     "points)"},
    {"CylinderWithoutControl",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0]: the key 'control' is missing (add control: what the target is: the stroke, which gains "
     "control; the force; or the opening of the valve of hydraulics)"},
    {"ForceWithALimit",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "force", "max_force": 3, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].max_force: only a controlled stroke has a largest force (leave it out, or write "
     "\"control\": \"stroke\")"},
    {"StrokeWithoutGains",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "stroke", "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].gains: all gains are 0: nothing follows the target (give a proportional gain, "
     "and an integral one where a load must not leave an error)"},
    {"CylinderThatPassesItself",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "force", "limits": {"lower": -2, "upper": 1, "stiffness": 1e6}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].limits.lower: at a stroke of -2 m the ends of 'c', which start 1.5 m apart, meet "
     "(give more than -1.5 m)"},
    {"EndStopsReversed",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "force", "limits": {"lower": 1, "upper": -1, "stiffness": 1e6}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].limits.upper: -1 is not above the lower limit of 1 (lower < upper)"},
    {"EndStopsWithRestitution",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "force", "limits": {"lower": -1, "upper": 1, "stiffness": 1e6, "restitution": 0.5}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].limits.restitution: the end stops of a cylinder have a damping (give damping, or "
     "limits with a restitution at a prismatic joint)"},
    {"ValveWithoutHydraulics",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "valve", "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].control: there is no valve without hydraulics (add \"hydraulics\")"},
    {"HydraulicsWithoutValve",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "force", "target": {"type": "constant", "value": 1}, "limits": {"lower": -0.2, "upper": 0.4, "stiffness": 1e9}, "hydraulics": {"bore_area": 2e-3, "dead_volume": 1e-4, "supply_pressure": 15e6, "valve_flow": 1e-3}})"),
     "mbd.forces[0].hydraulics: the control is not that of the valve (write \"control\": \"valve\", "
     "or leave out the hydraulics)"},
    {"HydraulicsWithoutEnds",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "valve", "target": {"type": "constant", "value": 1}, "hydraulics": {"bore_area": 2e-3, "dead_volume": 1e-4, "supply_pressure": 15e6, "valve_flow": 1e-3}})"),
     "mbd.forces[0].limits: the chambers have no length without end stops (add the lower and upper "
     "stroke at which the piston meets its end, and a stiffness)"},
    {"StartBeyondTheEnd",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "valve", "target": {"type": "constant", "value": 1}, "limits": {"lower": 0.1, "upper": 0.4, "stiffness": 1e9}, "hydraulics": {"bore_area": 2e-3, "dead_volume": 1e-4, "supply_pressure": 15e6, "valve_flow": 1e-3}})"),
     "mbd.forces[0].limits: the stroke at the start, 0, is outside (strokes are counted from the "
     "length at the start: lower <= 0 <= upper)"},
    {"RodThickerThanBore",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "valve", "target": {"type": "constant", "value": 1}, "limits": {"lower": -0.2, "upper": 0.4, "stiffness": 1e9}, "hydraulics": {"bore_area": 2e-3, "dead_volume": 1e-4, "supply_pressure": 15e6, "valve_flow": 1e-3, "rod_area": 3e-3}})"),
     "mbd.forces[0].hydraulics.rod_area: 0.003 m2 is not below the bore_area of 0.002 m2 (the rod is "
     "thinner than the bore)"},
    {"TankAboveSupply",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "valve", "target": {"type": "constant", "value": 1}, "limits": {"lower": -0.2, "upper": 0.4, "stiffness": 1e9}, "hydraulics": {"bore_area": 2e-3, "dead_volume": 1e-4, "supply_pressure": 15e6, "valve_flow": 1e-3, "tank_pressure": 2e7}})"),
     "mbd.forces[0].hydraulics.tank_pressure: 2e+07 Pa is not below the supply_pressure of 1.5e+07 Pa (oil "
     "flows from the supply to the tank)"},
    {"StartsCavitated",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "valve", "target": {"type": "constant", "value": 1}, "limits": {"lower": -0.2, "upper": 0.4, "stiffness": 1e9}, "hydraulics": {"bore_area": 2e-3, "dead_volume": 1e-4, "supply_pressure": 15e6, "valve_flow": 1e-3, "pressure_b": -5e4, "cavitation_pressure": 0}})"),
     "mbd.forces[0].hydraulics.pressure_b: -50000 Pa is below the cavitation_pressure of 0 Pa (start "
     "with a higher pressure)"},
    {"OpeningBeyondFull",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "valve", "target": {"type": "ramp", "to": 1.5, "duration": 0.1}, "limits": {"lower": -0.2, "upper": 0.4, "stiffness": 1e9}, "hydraulics": {"bore_area": 2e-3, "dead_volume": 1e-4, "supply_pressure": 15e6, "valve_flow": 1e-3}})"),
     "mbd.forces[0].target: the opening is 1.5 at t = 0.1 s (give values from -1 to 1)"},
    {"BulkModulusZero",
     ELEMENT(
         R"({"name": "c", "type": "cylinder", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "control": "valve", "target": {"type": "constant", "value": 1}, "limits": {"lower": -0.2, "upper": 0.4, "stiffness": 1e9}, "hydraulics": {"bore_area": 2e-3, "dead_volume": 1e-4, "supply_pressure": 15e6, "valve_flow": 1e-3, "bulk_modulus": 0}})"),
     "mbd.forces[0].hydraulics.bulk_modulus: the value is 0 (give a number from 1 to 1e+18: of the "
     "oil, with the air in it [Pa])"},
    {"BrakeWithoutSlip",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "speed", "gains": {"proportional": 1}, "brake": {"torque": 1}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].brake: the brake has neither slip nor breakaway (give one of them: with slip the "
     "joint creeps under a load, with breakaway it stays at rest)"},
    {"BrakeThatCreepsAndHolds",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "speed", "gains": {"proportional": 1}, "brake": {"torque": 1, "slip": 0.1, "breakaway": 2}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].brake: the brake has a slip and a breakaway (give one of them: with slip the joint "
     "creeps under a load, with breakaway it stays at rest)"},
    {"BrakeThatHoldsLessThanItSlips",
     ELEMENT(
         R"({"name": "m", "type": "motor", "joint": "spin", "control": "speed", "gains": {"proportional": 1}, "brake": {"torque": 3, "breakaway": 2}, "target": {"type": "constant", "value": 1}})"),
     "mbd.forces[0].brake.breakaway: 2 is below the torque of the slipping brake, 3 (give that or more)"},
    {"TyreWithoutRadius",
     ELEMENT(
         R"({"name": "t", "type": "tyre", "joint": "spin", "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2})"),
     "mbd.forces[0]: the key 'radius' is missing (add radius: of the wheel without a load [m])"},
    {"TyreOnASlide",
     ELEMENT(
         R"({"name": "t", "type": "tyre", "joint": "slide", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2})"),
     "mbd.forces[0].joint: joint 'slide' is not revolute (name the joint about which the wheel turns; its "
     "child is the wheel; known revolute joints: hinge, spin)"},
    {"TyreThatLies",
     ELEMENT(
         R"({"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "road_point": [0, 0, -0.3]})"),
     "mbd.forces[0].joint: the axis [0, 0, 1] of joint 'spin' is along the normal of the road, [0, 0, 1] "
     "(the "
     "axle of a wheel that stands is across it)"},
    {"TyreBelowTheRoad",
     ELEMENT(
         R"({"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "road_normal": [1, 0, 0], "road_point": [0.2, 0, 0]})"),
     "mbd.forces[0].road_point: the centre of the wheel, the point of joint 'spin', is -0.2 m above the "
     "road, "
     "less than half of the radius of 0.3 m (give road_point and road_normal of a road below the wheel)"},
    {"TyreThatTouchesAlongMoreThanItsDiameter",
     ELEMENT(
         R"({"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "patch_length": 5, "road_normal": [1, 0, 0], "road_point": [-0.3, 0, 0]})"),
     "mbd.forces[0].patch_length: the tyre touches the road along 5 m, more than the diameter of the wheel, "
     "0.6 m (give the length of the patch, a part of the radius)"},
    {"RoadWithoutUnitNormal",
     ELEMENT(
         R"({"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "road_normal": [2, 0, 0], "road_point": [-0.3, 0, 0]})"),
     "mbd.forces[0].road_normal: [2, 0, 0] has length 2, not 1 (the unit one is [1, 0, 0])"},
    {"RoadAndPlane",
     ELEMENT(
         R"({"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "road_normal": [1, 0, 0], "patch_length": 0.1, "road": ["lane"], "road_point": [0, 0, 0]})"),
     "mbd.forces[0].road_point: the road is that of the shapes in 'road', not a plane through a point (leave "
     "out road_point or road)"},
    {"RoadWithoutPatch",
     ELEMENT(
         R"({"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "road_normal": [1, 0, 0], "road": ["lane"]})"),
     "mbd.forces[0].patch_length: a tyre on shapes of the ground needs the length of its patch, and it is 0 "
     "(give patch_length: the road under the tyre is the plane through points of its patch)"},
    {"RoadWithoutContact",
     ELEMENT(
         R"({"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "road_normal": [1, 0, 0], "patch_length": 0.1, "road": ["lane"]})"),
     "mbd.forces[0].road[0]: the scene has no mbd.contact, whose ground has the roads (add mbd.contact with "
     "the shape 'lane' in its ground, or leave out road)"},
    {"RoadThatDoesNotExist",
     R"([{"op": "replace", "path": "/mbd/joints/2", "value": {"name": "spin", "type": "revolute", "child": "ball", "position": [0, 0, 0], "axis": [0, 0, 1]}}, {"op": "add", "path": "/mbd/contact", "value": {"materials": [{"name": "m", "stiffness": 1e6, "restitution": 0.5, "friction": 0.5}], "ground": [{"name": "kerb", "material": "m", "shape": {"type": "box", "size": [1, 1, 1]}}, {"name": "lane", "material": "m", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}]}}, {"op": "add", "path": "/mbd/forces/0", "value": {"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "road_normal": [1, 0, 0], "patch_length": 0.1, "road": ["lame"]}}])",
     "mbd.forces[0].road[0]: unknown name 'lame' (did you mean 'lane'?)"},
    {"RoadOfABox",
     R"([{"op": "replace", "path": "/mbd/joints/2", "value": {"name": "spin", "type": "revolute", "child": "ball", "position": [0, 0, 0], "axis": [0, 0, 1]}}, {"op": "add", "path": "/mbd/contact", "value": {"materials": [{"name": "m", "stiffness": 1e6, "restitution": 0.5, "friction": 0.5}], "ground": [{"name": "kerb", "material": "m", "shape": {"type": "box", "size": [1, 1, 1]}}, {"name": "lane", "material": "m", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}]}}, {"op": "add", "path": "/mbd/forces/0", "value": {"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "road_normal": [1, 0, 0], "patch_length": 0.1, "road": ["lane", "kerb"]}}])",
     "mbd.forces[0].road[1]: 'kerb' is a box (roads are planes, meshes and height fields)"},
    {"RoadTwice",
     R"([{"op": "replace", "path": "/mbd/joints/2", "value": {"name": "spin", "type": "revolute", "child": "ball", "position": [0, 0, 0], "axis": [0, 0, 1]}}, {"op": "add", "path": "/mbd/contact", "value": {"materials": [{"name": "m", "stiffness": 1e6, "restitution": 0.5, "friction": 0.5}], "ground": [{"name": "kerb", "material": "m", "shape": {"type": "box", "size": [1, 1, 1]}}, {"name": "lane", "material": "m", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}]}}, {"op": "add", "path": "/mbd/forces/0", "value": {"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "road_normal": [1, 0, 0], "patch_length": 0.1, "road": ["lane", "lane"]}}])",
     "mbd.forces[0].road[0]: 'lane' is given twice (leave one of them out)"},
    {"TyreAndRigidWheel",
     R"([{"op": "replace", "path": "/mbd/joints/2", "value": {"name": "spin", "type": "revolute", "child": "ball", "position": [0, 0, 0], "axis": [0, 0, 1]}}, {"op": "add", "path": "/mbd/contact", "value": {"materials": [{"name": "m", "stiffness": 1e6, "restitution": 0.5, "friction": 0.5}], "ground": [{"name": "lane", "material": "m", "shape": {"type": "plane", "point": [-0.3, 0, 0], "normal": [1, 0, 0]}}]}}, {"op": "add", "path": "/mbd/bodies/2/shapes", "value": [{"name": "rim", "use": "contact", "material": "m", "shape": {"type": "cylinder", "radius": 0.3, "height": 0.1}}]}, {"op": "add", "path": "/mbd/forces/0", "value": {"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "road_normal": [1, 0, 0], "patch_length": 0.1, "road": ["lane"]}}])",
     "mbd.forces[0]: the tyre and the shape of contact 'rim' of its wheel, which reaches 0.3 m from the "
     "axle, would "
     "both stand on 'lane' (leave one of them out, make the shape smaller than the radius of 0.3 m, or add "
     "['ball', 'ground'] to mbd.contact.ignore)"},
    {"TyreAndRigidWheelOnAPlane",
     R"([{"op": "replace", "path": "/mbd/joints/2", "value": {"name": "spin", "type": "revolute", "child": "ball", "position": [0, 0, 0], "axis": [0, 0, 1]}}, {"op": "add", "path": "/mbd/contact", "value": {"materials": [{"name": "m", "stiffness": 1e6, "restitution": 0.5, "friction": 0.5}], "ground": [{"name": "lane", "material": "m", "shape": {"type": "plane", "point": [-0.3, 0, 0], "normal": [1, 0, 0]}}]}}, {"op": "add", "path": "/mbd/bodies/2/shapes", "value": [{"name": "rim", "use": "contact", "material": "m", "shape": {"type": "cylinder", "radius": 0.3, "height": 0.1}}]}, {"op": "add", "path": "/mbd/forces/0", "value": {"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "road_normal": [1, 0, 0], "patch_length": 0.1, "road_point": [-0.3, 1, 2]}}])",
     "mbd.forces[0]: the tyre and the shape of contact 'rim' of its wheel, which reaches 0.3 m from the "
     "axle, would "
     "both stand on 'lane' (leave one of them out, make the shape smaller than the radius of 0.3 m, or add "
     "['ball', 'ground'] to mbd.contact.ignore)"},
    {"DrumThatSlides",
     ELEMENT(
         R"({"name": "r", "type": "rope", "drum": "slide", "length": 1, "axial_stiffness": 1e5, "points": [{"point": [0.2, 0, 0]}, {"body": "crate", "point": [0.2, 1, 0]}]})"),
     "mbd.forces[0].drum: joint 'slide' is not revolute (name the joint about which the drum turns; "
     "known revolute joints: hinge, spin)"},
    {"DrumThatDoesNotExist",
     ELEMENT(
         R"({"name": "r", "type": "rope", "drum": "spim", "length": 1, "axial_stiffness": 1e5, "points": [{"point": [0.2, 0, 0]}, {"body": "crate", "point": [0.2, 1, 0]}]})"),
     "mbd.forces[0].drum: unknown name 'spim' (did you mean 'spin'?)"},
    {"RopeThatTurnsWithItsDrum",
     ELEMENT(
         R"({"name": "r", "type": "rope", "drum": "spin", "length": 1, "axial_stiffness": 1e5, "points": [{"body": "ball", "point": [0.2, 0, 0]}, {"body": "crate", "point": [0.2, 1, 0]}]})"),
     "mbd.forces[0].points[0].body: the rope leaves the drum at a point of 'ball', and the parent of "
     "joint 'spin' is 'ground' (name the parent, since that point does not turn with the drum)"},
    {"RopeFromTheAxis",
     ELEMENT(
         R"({"name": "r", "type": "rope", "drum": "spin", "length": 1, "axial_stiffness": 1e5, "points": [{"point": [0, 0, 2]}, {"body": "crate", "point": [0.2, 1, 0]}]})"),
     "mbd.forces[0].points[0].point: the rope leaves the drum on its axis (give the point at which the "
     "rope leaves the surface: its distance from the axis is the radius)"},
    {"RopeAcrossItsDrum",
     ELEMENT(
         R"({"name": "r", "type": "rope", "drum": "spin", "length": 1, "axial_stiffness": 1e5, "points": [{"point": [0.2, 0, 0]}, {"body": "crate", "point": [1.2, 1, 0]}]})"),
     "mbd.forces[0].points[0].point: the rope leaves the drum at 45 degrees to its surface (give the point "
     "at which the rope touches the drum as a tangent, within 10 degrees)"},
    {"LocalPointOfNoBody",
     ELEMENT(
         R"({"name": "s", "type": "spring_damper", "local": true, "body_b": "crat", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "length": 1})"),
     "mbd.forces[0].body_b: unknown name 'crat' (did you mean 'crate'?)"},
    {"LocalByName",
     ELEMENT(
         R"({"name": "s", "type": "spring_damper", "local": "crate", "body_b": "crate", "point_a": [0, 0, 3], "point_b": [0, 0, 1.5], "length": 1})"),
     "mbd.forces[0].local: the value is \"crate\" (give a boolean: true: each point is in the frame of its "
     "body)"},
};
INSTANTIATE_TEST_SUITE_P(Elements, WrongSceneTest, testing::ValuesIn(elements), name_of_case);

// A rim below the tyre's radius, and one that does not touch the ground.
TEST(Tyres, MayHaveASmallerRim) {
  EXPECT_EQ(
      verdict_on_patch(
          R"([{"op": "replace", "path": "/mbd/joints/2", "value": {"name": "spin", "type": "revolute", "child": "ball", "position": [0, 0, 0], "axis": [0, 0, 1]}}, {"op": "add", "path": "/mbd/contact", "value": {"materials": [{"name": "m", "stiffness": 1e6, "restitution": 0.5, "friction": 0.5}], "ground": [{"name": "lane", "material": "m", "shape": {"type": "plane", "point": [-0.3, 0, 0], "normal": [1, 0, 0]}}]}}, {"op": "add", "path": "/mbd/bodies/2/shapes", "value": [{"name": "rim", "use": "contact", "material": "m", "shape": {"type": "cylinder", "radius": 0.25, "height": 0.1}}]}, {"op": "add", "path": "/mbd/forces/0", "value": {"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "road_normal": [1, 0, 0], "patch_length": 0.1, "road": ["lane"]}}])"),
      "no error");
  EXPECT_EQ(
      verdict_on_patch(
          R"([{"op": "replace", "path": "/mbd/joints/2", "value": {"name": "spin", "type": "revolute", "child": "ball", "position": [0, 0, 0], "axis": [0, 0, 1]}}, {"op": "add", "path": "/mbd/contact", "value": {"materials": [{"name": "m", "stiffness": 1e6, "restitution": 0.5, "friction": 0.5}], "ignore": [["ball", "ground"]], "ground": [{"name": "lane", "material": "m", "shape": {"type": "plane", "point": [-0.3, 0, 0], "normal": [1, 0, 0]}}]}}, {"op": "add", "path": "/mbd/bodies/2/shapes", "value": [{"name": "rim", "use": "contact", "material": "m", "shape": {"type": "cylinder", "radius": 0.3, "height": 0.1}}]}, {"op": "add", "path": "/mbd/forces/0", "value": {"name": "t", "type": "tyre", "joint": "spin", "radius": 0.3, "stiffness": 1e5, "friction": 1, "slip_stiffness": 10, "cornering_stiffness": 10, "relaxation_length": 0.2, "road_normal": [1, 0, 0], "patch_length": 0.1, "road": ["lane"]}}])"),
      "no error");
}

}  // namespace
}  // namespace tandem::scene::test
