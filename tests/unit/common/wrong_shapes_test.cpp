// Wrong scenes: shapes, orientations, degrees and relative poses.
#include "tests/unit/common/wrong_scene.hpp"

namespace tandem::scene::test {
namespace {

// Shapes of the body 'bird'.
#define SHAPES(list) R"([{"op": "add", "path": "/mbd/bodies/3/shapes", "value": [)" list R"(]}])"
// The same, and its mass follows from them.
#define MASS(list)                                                               \
  R"([{"op": "replace", "path": "/mbd/bodies/3/mass", "value": "from_shapes"},)" \
  R"({"op": "remove", "path": "/mbd/bodies/3/inertia"},)"                        \
  R"({"op": "add", "path": "/mbd/bodies/3/shapes", "value": [)" list R"(]}])"
#define ORIENTATION(object) \
  R"([{"op": "replace", "path": "/mbd/bodies/1/orientation", "value": {)" object R"(}}])"

const WrongScene wrong_shapes[] = {
    {"ContactOfBodies",
     SHAPES(R"({"name": "a", "use": "contact", "shape": {"type": "sphere", "radius": 1}})"),
     "mbd.bodies[3].shapes[0].use: the scene has no mbd.contact, which gives the materials of contacts (add "
     "mbd.contact, or give graphics)"},
    {"ShapeWithoutUse", SHAPES(R"({"name": "a", "shape": {"type": "sphere", "radius": 1}})"),
     "mbd.bodies[3].shapes[0]: the key 'use' is missing (add use: wall for the particles and the liquid, "
     "graphics only, or "
     "contact between bodies)"},
    {"WallWithoutMaterial",
     SHAPES(R"({"name": "a", "use": "wall", "shape": {"type": "sphere", "radius": 1}})"),
     "mbd.bodies[3].shapes[0]: the key 'material' is missing (add material: a wall is in contact with "
     "particles)"},
    {"WallOfTheNameOfAnother",
     SHAPES(
         R"({"name": "floor", "use": "wall", "material": "glass", "shape": {"type": "sphere", "radius": 1}})"),
     "mbd.bodies[3].shapes[0].name: the name 'floor' is that of another wall (choose another name)"},
    {"TwoShapesOfOneName",
     SHAPES(R"({"name": "a", "use": "graphics", "shape": {"type": "sphere", "radius": 1}},
                                     {"name": "a", "use": "graphics", "shape": {"type": "sphere", "radius": 2}})"),
     "mbd.bodies[3].shapes[1].name: the name 'a' is given twice (names in mbd.bodies[3].shapes must differ)"},
    {"DensityForAMassThatIsANumber",
     SHAPES(R"({"name": "a", "use": "graphics", "density": 5, "shape": {"type": "sphere", "radius": 1}})"),
     "mbd.bodies[3].shapes[0].density: the mass of 'bird' is a number, and needs no density (leave it out, "
     "or "
     "give \"mass\": \"from_shapes\")"},
    {"EndlessGraphics",
     SHAPES(
         R"({"name": "a", "use": "graphics", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}})"),
     "mbd.bodies[3].shapes[0].shape: the plane is endless, and cannot be drawn (draw a thin box or a "
     "cylinder "
     "with a height)"},
    {"RoundConeAsWall",
     SHAPES(
         R"({"name": "a", "use": "wall", "material": "steel", "shape": {"type": "cone", "radius": 1, "height": 1}})"),
     "mbd.bodies[3].shapes[0].shape: particles know no round surface of a cone (add segments: flat faces, "
     "inscribed, whose corners are at the radius)"},
    {"OpenApex",
     SHAPES(
         R"({"name": "a", "use": "graphics", "shape": {"type": "cone", "radius": 1, "height": 1, "open": ["+z"]}})"),
     "mbd.bodies[3].shapes[0].shape.open: the upper end is an apex, and not there to be open (leave out +z, "
     "or "
     "give top_radius)"},
    {"ColourOfAWallOfABody",
     R"([{"op": "add", "path": "/dem/walls/-", "value": {"name": "red", "body": "bird", "material": "steel", "color": [1, 0, 0],
         "shape": {"type": "sphere", "radius": 1}}}])",
     "dem.walls[3].color: the wall is on a body, which has one colour in pictures (give the colour to the "
     "body)"},
    {"RoundCapsuleAsWall",
     R"([{"op": "replace", "path": "/dem/walls/0/shape", "value": {"type": "capsule", "radius": 1, "height": 1}}])",
     "dem.walls[0].shape: particles know no round surface of a capsule (add segments: flat faces, inscribed, "
     "whose corners are at the radius)"},
    {"HullWithoutPoints", SHAPES(R"({"name": "a", "use": "graphics", "shape": {"type": "convex_hull"}})"),
     "mbd.bodies[3].shapes[0].shape: the hull has neither points nor a file (give one of them)"},
    {"HullOfPointsAndFile", SHAPES(R"({"name": "a", "use": "graphics", "shape": {"type": "convex_hull",
       "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "file": "a.stl"}})"),
     "mbd.bodies[3].shapes[0].shape: the hull has points and a file (give one of them)"},
    {"HullOfThreePoints", SHAPES(R"({"name": "a", "use": "graphics", "shape": {"type": "convex_hull",
       "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}})"),
     "mbd.bodies[3].shapes[0].shape.points: the value is [[0,0,0],[1,0,0],[0,1,0]] (give at least 4 "
     "elements: "
     "the points; either these or a file [m])"},
    {"ScaleOfPoints", SHAPES(R"({"name": "a", "use": "graphics", "shape": {"type": "convex_hull", "scale": 2,
       "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]}})"),
     "mbd.bodies[3].shapes[0].shape.scale: the scale is for the corners in a file (leave it out, and give "
     "the "
     "points in metres)"},
    {"UnevenHeightField", SHAPES(R"({"name": "a", "use": "graphics", "shape": {"type": "height_field",
       "size": [1, 1], "heights": [[0, 1], [0, 1, 2]]}})"),
     "mbd.bodies[3].shapes[0].shape.heights[1]: the row has 3 heights, and the first has 2 (all rows of the "
     "grid have the same number)"},
    {"HeightFieldBelowItsBase", SHAPES(R"({"name": "a", "use": "graphics", "shape": {"type": "height_field",
       "size": [1, 1], "heights": [[1, 1], [1, 0.5]], "base": 0.5}})"),
     "mbd.bodies[3].shapes[0].shape.heights[1][1]: the height of 0.5 m is not above the base at 0.5 m (give "
     "a "
     "lower base)"},
    {"ConeOfNoHeight",
     SHAPES(R"({"name": "a", "use": "graphics", "shape": {"type": "cone", "radius": 1, "height": 0}})"),
     "mbd.bodies[3].shapes[0].shape.height: the value is 0 (give a number from 1e-09 to 1e+09: full height "
     "[m])"},
    {"MassOfNoShapes", R"([{"op": "replace", "path": "/mbd/bodies/3/mass", "value": "from_shapes"},
                           {"op": "remove", "path": "/mbd/bodies/3/inertia"}])",
     "mbd.bodies[3].mass: the mass follows from the shapes, and the body has none (add shapes, or give mass "
     "and inertia)"},
    {"MassFromShapesAndInertia",
     R"([{"op": "replace", "path": "/mbd/bodies/3/mass", "value": "from_shapes"}])",
     "mbd.bodies[3].inertia: the inertia is given, and follows from the shapes (leave it out, or give the "
     "mass "
     "as a number)"},
    {"MassWithoutDensity",
     MASS(R"({"name": "a", "use": "graphics", "shape": {"type": "sphere", "radius": 1}})"),
     "mbd.bodies[3].shapes[0]: the shape has neither density nor material, and the mass of 'bird' follows "
     "from "
     "its shapes (add density [kg/m3]; 0 for a shape without mass)"},
    {"MassOfOpenBox", MASS(R"({"name": "a", "use": "graphics", "density": 1,
       "shape": {"type": "box", "size": [1, 1, 1], "open": ["+z"]}})"),
     "mbd.bodies[3].shapes[0].shape: a box with open faces is a surface, and has no volume for a mass (give "
     "\"density\": 0)"},
    {"MassOfAPlane", MASS(R"({"name": "a", "use": "wall", "material": "steel",
       "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}})"),
     "mbd.bodies[3].shapes[0].shape: the plane is endless, and has no volume for a mass (give \"density\": "
     "0)"},
    {"MassOfASurfaceOfHeights", MASS(R"({"name": "a", "use": "graphics", "density": 1,
       "shape": {"type": "height_field", "size": [1, 1], "heights": [[0, 0], [0, 0]]}})"),
     "mbd.bodies[3].shapes[0].shape: a height field without a base is a surface, and has no volume for a "
     "mass "
     "(give \"density\": 0)"},
    {"MassOfNothing", MASS(R"({"name": "a", "use": "graphics", "density": 0,
       "shape": {"type": "sphere", "radius": 1}})"),
     "mbd.bodies[3].mass: all shapes have the density 0 (give one of them a density)"},
};

const WrongScene wrong_orientations[] = {
    {"Empty", ORIENTATION(""),
     "mbd.bodies[1].orientation: the orientation is empty (give euler_deg and order, or axis and angle_deg, "
     "or "
     "two of x_axis, y_axis, z_axis)"},
    {"EulerAndAxis", ORIENTATION(R"("euler_deg": [0, 0, 0], "order": "xyz", "axis": [0, 0, 1], "angle": 1)"),
     "mbd.bodies[1].orientation: the orientation is given twice, by Euler angles and by an axis with an "
     "angle "
     "(give euler_deg and order, or axis and angle_deg, or two of x_axis, y_axis, z_axis)"},
    {"AngleAndAxes", ORIENTATION(R"("angle": 1, "x_axis": [1, 0, 0], "y_axis": [0, 1, 0])"),
     "mbd.bodies[1].orientation: the orientation is given twice, by an axis with an angle and by two axes "
     "(give euler_deg and order, or axis and angle_deg, or two of x_axis, y_axis, z_axis)"},
    {"QuaternionInAnObject", ORIENTATION(R"("quaternion": [1, 0, 0, 0])"),
     "mbd.bodies[1].orientation: unknown key 'quaternion' (known keys: angle, angle_deg, axis, euler, "
     "euler_deg, order, x_axis, y_axis, z_axis)"},
    {"EulerWithoutOrder", ORIENTATION(R"("euler_deg": [0, 0, 0])"),
     "mbd.bodies[1].orientation: the key 'order' is missing (add order: the axes of the three angles, such "
     "as "
     "\"zyx\")"},
    {"OrderWithoutEuler", ORIENTATION(R"("order": "xyz")"),
     "mbd.bodies[1].orientation.order: there are no Euler angles (add euler_deg, or leave out order)"},
    {"UnknownOrder", ORIENTATION(R"("euler_deg": [0, 0, 0], "order": "xyy")"),
     "mbd.bodies[1].orientation.order: the value is \"xyy\" (did you mean 'xyz'?)"},
    {"EulerTwice", ORIENTATION(R"("euler_deg": [0, 0, 0], "euler": [0, 0, 0], "order": "xyz")"),
     "mbd.bodies[1].orientation.euler_deg: euler and euler_deg are both given (keep one of them)"},
    {"AxisWithoutAngle", ORIENTATION(R"("axis": [0, 0, 1])"),
     "mbd.bodies[1].orientation: the key 'angle_deg' is missing (add angle_deg: the angle about the axis "
     "[deg])"},
    {"AngleWithoutAxis", ORIENTATION(R"("angle_deg": 4)"),
     "mbd.bodies[1].orientation: the key 'axis' is missing (add axis: the unit vector about which the angle "
     "is)"},
    {"AxisNotUnit", ORIENTATION(R"("axis": [0, 0, 2], "angle_deg": 4)"),
     "mbd.bodies[1].orientation.axis: [0, 0, 2] has length 2, not 1 (the unit one is [0, 0, 1])"},
    {"OneAxis", ORIENTATION(R"("z_axis": [0, 0, 1])"),
     "mbd.bodies[1].orientation: there is z_axis alone (two axes make an orientation: add another one)"},
    {"ThreeAxes", ORIENTATION(R"("x_axis": [1, 0, 0], "y_axis": [0, 1, 0], "z_axis": [0, 0, 1])"),
     "mbd.bodies[1].orientation: there are three axes (leave one out: it follows from the others)"},
    {"AxesNotPerpendicular", ORIENTATION(R"("x_axis": [1, 0, 0], "z_axis": [1, 0, 1])"),
     "mbd.bodies[1].orientation: x_axis and z_axis enclose an angle of 45 deg, not 90 deg (the axes of a "
     "frame "
     "are perpendicular, within 1e-6 rad)"},
    {"AxisWithoutDirection", ORIENTATION(R"("x_axis": [0, 0, 0], "z_axis": [1, 0, 1])"),
     "mbd.bodies[1].orientation.x_axis: [0, 0, 0] has no direction (give one)"},
    {"RateInDegreesOfALength",
     R"([{"op": "remove", "path": "/mbd/joints/0/rate"}, {"op": "add", "path": "/mbd/joints/0/rate_deg", "value": 5}])",
     "mbd.joints[0].rate_deg: the coordinate of a prismatic joint is a length (give rate)"},
    {"LimitTwice", R"([{"op": "add", "path": "/mbd/joints/1/limits", "value":
                       {"lower": 0, "lower_deg": 0, "upper": 1, "stiffness": 1}}])",
     "mbd.joints[1].limits.lower_deg: lower and lower_deg are both given (keep one of them)"},
    {"AngleTwice", R"([{"op": "add", "path": "/mbd/forces/1/angle_deg", "value": 5}])",
     "mbd.forces[1].angle_deg: angle and angle_deg are both given (keep one of them)"},
    {"ForceInDegrees",
     R"([{"op": "replace", "path": "/mbd/forces/1", "value": {"name": "f", "type": "actuator",
                       "joint": "hinge", "size": {"type": "constant", "value_deg": 3}}}])",
     "mbd.forces[1].size.value_deg: the size of a force is no angle (give value)"},
    {"ForceRampInDegrees",
     R"([{"op": "replace", "path": "/mbd/forces/1", "value": {"name": "f", "type": "actuator",
                       "joint": "hinge", "size": {"type": "ramp", "to_deg": 3, "duration": 1}}}])",
     "mbd.forces[1].size.to_deg: the size of a force is no angle (give to)"},
    {"ThrottleInDegrees",
     R"([{"op": "replace", "path": "/mbd/forces/1", "value": {"name": "m", "type": "motor", "control": "throttle",
                       "joint": "hinge", "target": {"type": "constant", "value_deg": 3}}}])",
     "mbd.forces[1].target.value_deg: a throttle is no angle (give value)"},
    {"StrokeInDegrees",
     R"([{"op": "replace", "path": "/mbd/forces/1", "value": {"name": "c", "type": "cylinder", "control": "stroke",
                       "body_b": "crate", "point_a": [0, 0, 0], "point_b": [0, 0, 1],
                       "target": {"type": "constant", "value_deg": 3}}}])",
     "mbd.forces[1].target.value_deg: the target of a cylinder is no angle (give value)"},
    {"BrakeInDegrees",
     R"([{"op": "replace", "path": "/mbd/forces/1", "value": {"name": "m", "type": "motor", "control": "speed",
                       "joint": "hinge", "target": {"type": "constant", "value": 3},
                       "brake": {"torque": 1, "slip": 1, "engaged": {"type": "constant", "value_deg": 3}}}}])",
     "mbd.forces[1].brake.engaged.value_deg: the share of a brake is no angle (give value)"},
    {"BeltInDegrees",
     R"([{"op": "add", "path": "/dem/walls/0/surface_velocity", "value":
                       {"direction": [1, 0, 0], "speed": {"type": "constant", "value_deg": 3}}}])",
     "dem.walls[0].surface_velocity.speed.value_deg: the speed of a surface is no angle (give value)"},
    {"ForceOverDegreesOfALength",
     R"([{"op": "replace", "path": "/mbd/forces/1", "value": {"name": "f", "type": "actuator", "joint": "slide",
                       "over": {"joint": "slide", "arguments_deg": [0, 1], "values": [0, 1]}}}])",
     "mbd.forces[1].over.arguments_deg: the coordinate of a prismatic joint is a length (give arguments)"},
    {"ForceOverNothing",
     R"([{"op": "replace", "path": "/mbd/forces/1", "value": {"name": "f", "type": "actuator", "joint": "slide",
                       "over": {"joint": "slide", "values": [0, 1]}}}])",
     "mbd.forces[1].over: the key 'arguments' is missing (add arguments: increasing coordinates [rad] or "
     "[m], or "
     "rates [rad/s] or [m/s])"},
    {"RampToNowhere",
     R"([{"op": "replace", "path": "/mbd/joints/1/motion", "value": {"type": "ramp", "duration": 1}}])",
     "mbd.joints[1].motion: the key 'to' is missing (add to: coordinate after the ramp [rad] or [m], or its "
     "rate "
     "[rad/s] or [m/s])"},
    {"RelativeToNothing", R"([{"op": "add", "path": "/mbd/joints/1/relative_to", "value": "arn"}])",
     "mbd.joints[1].relative_to: unknown name 'arn' (did you mean 'arm'?)"},
    {"RelativeToItself", R"([{"op": "add", "path": "/mbd/bodies/1/relative_to", "value": "arm"}])",
     "mbd.bodies[1].relative_to: the pose of 'arm' is relative to itself: 'arm' to 'arm' (give one of them "
     "relative to the ground or to another body)"},
    {"RelativeInACircle", R"([{"op": "add", "path": "/mbd/bodies/0/relative_to", "value": "arm"},
                              {"op": "add", "path": "/mbd/bodies/1/relative_to", "value": "ball"},
                              {"op": "add", "path": "/mbd/bodies/2/relative_to", "value": "crate"}])",
     "mbd.bodies[0].relative_to: the pose of 'crate' is relative to itself: 'crate' to 'arm' to 'ball' to "
     "'crate' "
     "(give one of them relative to the ground or to another body)"},
    {"RelativeAxisNotUnit", R"([{"op": "add", "path": "/mbd/joints/1/relative_to", "value": "arm"},
                                {"op": "replace", "path": "/mbd/joints/1/axis", "value": [0, 0, 2]}])",
     "mbd.joints[1].axis: [0, 0, 2] has length 2, not 1 (the unit one is [0, 0, 1])"},
    {"RelativeToABodyOfNoOrientation", R"([{"op": "add", "path": "/mbd/joints/1/relative_to", "value": "arm"},
                                {"op": "replace", "path": "/mbd/bodies/1/orientation", "value": [0, 0, 0, 0]}])",
     "mbd.bodies[1].orientation: [0, 0, 0, 0] has length 0, not 1 (give a direction)"},
    {"RelativeWallOfAnUnknownBody", R"([{"op": "replace", "path": "/dem/walls/0/body", "value": "crane"},
                                {"op": "add", "path": "/dem/walls/0/relative_to", "value": "arm"}])",
     "dem.walls[0].body: unknown name 'crane' (did you mean 'crate'?)"},
};

INSTANTIATE_TEST_SUITE_P(Shapes, WrongSceneTest, testing::ValuesIn(wrong_shapes), name_of_case);
INSTANTIATE_TEST_SUITE_P(Orientations, WrongSceneTest, testing::ValuesIn(wrong_orientations), name_of_case);

// Without particles there is nothing to be a wall for, and no material.
TEST(WrongShapes, WithoutParticles) {
  const auto with = [](const std::string& keys) {
    return verdict(R"({"tandem": "1.1", "name": "a", "end_time": 1, "mbd": {"bodies": [{"name": "a",
      "mass": "from_shapes", "shapes": [{"name": "s", "shape": {"type": "sphere", "radius": 1}, )" +
                   keys + "}]}]}}");
  };
  EXPECT_EQ(with(R"("use": "graphics", "density": 1)"), "no error");
  EXPECT_EQ(
      with(R"("use": "wall", "density": 1)"),
      "scene.json: mbd.bodies[0].shapes[0].use: there are no particles to be a wall for (give graphics, or "
      "add dem or sph)");
  EXPECT_EQ(
      with(R"("use": "graphics", "material": "steel")"),
      "scene.json: mbd.bodies[0].shapes[0].material: materials are those of dem, which the scene does not "
      "have (give the density)");
}

}  // namespace
}  // namespace tandem::scene::test
