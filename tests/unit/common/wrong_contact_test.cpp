// Wrong scenes: contact between bodies. What is not computed is refused.
#include "tests/unit/common/wrong_scene.hpp"

namespace tandem::scene::test {
namespace {

#define HARD R"({"name": "hard", "stiffness": 1e6, "restitution": 0.5, "friction": 0.3})"
#define ROUND R"({"name": "round", "young": 1e9, "poisson": 0.3, "restitution": 0.5, "friction": 0.3})"
#define FLOOR(material)                         \
  R"({"name": "floor", "material": ")" material \
  R"(", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}})"
// The good scene with mbd.contact of these materials and further keys, and one shape of contact of 'bird'.
#define CONTACT(materials, more, shape)                                                                   \
  R"([{"op": "add", "path": "/mbd/contact", "value": {"materials": [)" materials R"(])" more              \
  R"(}}, {"op": "add", "path": "/mbd/bodies/3/shapes", "value": [{"name": "a", "use": "contact", )" shape \
  R"(}]}])"
#define BALL R"("material": "hard", "shape": {"type": "sphere", "radius": 0.1})"

#define OUTPUT(keys) CONTACT(HARD, R"(, "ground": [)" FLOOR("hard") R"(], "outputs": [{)" keys "}]", BALL)

#define HILLS \
  R"({"name": "hills", "material": "hard", "shape": {"type": "height_field", "size": [4, 4], "heights": [[0, 0], [0, 0]]}})"
#define NOT_COMPUTED                                                                                      \
  "(add their bodies to mbd.contact.ignore, or use other shapes: planes do not touch each other, nor do " \
  "meshes and height fields, and cylinders do not touch spheres, capsules and cylinders)"

const WrongScene wrong_contacts[] = {
    {"ShapeWithoutMaterial", CONTACT(HARD, "", R"("shape": {"type": "sphere", "radius": 0.1})"),
     "mbd.bodies[3].shapes[0]: the key 'material' is missing (add material: the name of one in "
     "mbd.contact.materials)"},
    {"MaterialOfParticles",
     CONTACT(HARD, "", R"("material": "glass", "shape": {"type": "sphere", "radius": 0.1})"),
     "mbd.bodies[3].shapes[0].material: unknown name 'glass' (known materials: hard)"},
    {"StiffnessAndYoung",
     CONTACT(
         R"({"name": "hard", "stiffness": 1, "young": 1e9, "poisson": 0.3, "restitution": 1, "friction": 0})",
         "", BALL),
     "mbd.contact.materials[0]: the material has a stiffness and Young's modulus (give stiffness [N/m], or "
     "young [Pa] and poisson)"},
    {"NeitherStiffnessNorYoung", CONTACT(R"({"name": "hard", "restitution": 1, "friction": 0})", "", BALL),
     "mbd.contact.materials[0]: the material has neither a stiffness nor Young's modulus (give stiffness "
     "[N/m], or young [Pa] and poisson)"},
    {"YoungWithoutPoisson",
     CONTACT(R"({"name": "hard", "young": 1e9, "restitution": 1, "friction": 0})", "", BALL),
     "mbd.contact.materials[0]: 'young' without 'poisson' (give both, or the stiffness of a point of contact "
     "[N/m])"},
    {"ImpactsWithinFixedSteps", CONTACT(HARD, R"(, "impacts": "within_steps")", BALL),
     "mbd.contact.impacts: steps of one length do not see how hard bodies hit each other within them (give "
     "mbd.integrator.error_tolerance, such as 3e-5, or leave out impacts)"},
    {"SurfaceVelocityWithImpacts",
     CONTACT(
         HARD,
         R"(, "ground": [{"name": "belt", "material": "hard", "surface_velocity": [1, 0, 0], "shape": {"type": "box", "size": [1, 1, 1]}}])",
         BALL),
     "mbd.contact.ground[0].surface_velocity: a surface of contact moves along itself with time stepping "
     "only (give "
     "mbd.contact.impacts \"time_stepping\", or leave out surface_velocity)"},
    {"TimeSteppingWithParticles", CONTACT(HARD, R"(, "impacts": "time_stepping")", BALL),
     "mbd.contact.impacts: time stepping of contacts takes no loads of particles (leave out impacts, or the "
     "particles)"},
    {"PairTwice",
     CONTACT(HARD "," ROUND,
             R"(, "pairs": [{"a": "hard", "b": "round", "stiffness": 1}, {"a": "round", "b": "hard"}])",
             BALL),
     "mbd.contact.pairs[1]: the pair is given twice (leave one of them out)"},
    {"MixedMaterials", CONTACT(HARD "," ROUND, R"(, "ground": [)" FLOOR("round") "]", BALL),
     "mbd.bodies[3].shapes[0].material: 'round' and 'hard' touch, and one has a stiffness, the other Young's "
     "modulus (give the pair a stiffness in mbd.contact.pairs)"},
    {"HertzOfABox",
     CONTACT(ROUND, R"(, "ground": [)" FLOOR("round") "]",
             R"("material": "round", "shape": {"type": "box", "size": [1, 1, 1]})"),
     "mbd.bodies[3].shapes[0].material: the contact of the box 'a' of 'bird' with the plane 'floor' of "
     "'ground' has no curvature for Hertz's law (give their materials a stiffness [N/m] in place of young "
     "and "
     "poisson)"},
    {"Cone", CONTACT(HARD, "", R"("material": "hard", "shape": {"type": "cone", "radius": 1, "height": 1})"),
     "mbd.bodies[3].shapes[0].shape: contact of a cone is not computed in this version (use a sphere, a "
     "capsule, a cylinder, a box, a convex_hull, a mesh, a height_field or a plane)"},
    {"MeshOnAHeightField",
     CONTACT(HARD, R"(, "ground": [)" HILLS "]",
             R"("material": "hard", "shape": {"type": "mesh", "file": "a.stl"})"),
     "mbd.bodies[3].shapes[0].shape: the contact of the mesh 'a' of 'bird' with the height_field 'hills' of "
     "'ground' is not computed in this version " NOT_COMPUTED},
    {"CylinderOnASphere",
     CONTACT(HARD, R"(, "ground": [{"name": "stone", )" BALL "}]",
             R"("material": "hard", "shape": {"type": "cylinder", "radius": 1, "height": 1})"),
     "mbd.bodies[3].shapes[0].shape: the contact of the cylinder 'a' of 'bird' with the sphere 'stone' of "
     "'ground' is not computed in this version " NOT_COMPUTED},
    {"EndlessCylinder",
     CONTACT(HARD, "", R"("material": "hard", "shape": {"type": "cylinder", "radius": 1})"),
     "mbd.bodies[3].shapes[0].shape.height: contact is that of a cylinder with two ends (give the height)"},
    {"OpenCylinder",
     CONTACT(
         HARD, "",
         R"("material": "hard", "shape": {"type": "cylinder", "radius": 1, "height": 1, "open": ["+z"]})"),
     "mbd.bodies[3].shapes[0].shape.open: a cylinder with open ends is a surface, and contact is that of a "
     "solid "
     "(leave out open)"},
    {"CylinderOfSegments",
     CONTACT(HARD, "",
             R"("material": "hard", "shape": {"type": "cylinder", "radius": 1, "height": 1, "segments": 8})"),
     "mbd.bodies[3].shapes[0].shape.segments: contact is that of the round cylinder (leave out segments)"},
    {"HertzOnAHeightField",
     CONTACT(
         HARD "," ROUND,
         R"(, "pairs": [], "ground": [{"name": "hills", "material": "round", "shape": {"type": "height_field", "size": [4, 4], "heights": [[0, 0], [0, 0]]}}])",
         R"("material": "round", "shape": {"type": "sphere", "radius": 0.1})"),
     "mbd.bodies[3].shapes[0].material: the contact of the sphere 'a' of 'bird' with the height_field "
     "'hills' of "
     "'ground' has no curvature for Hertz's law (give their materials a stiffness [N/m] in place of young "
     "and "
     "poisson)"},
    {"OpenBox",
     CONTACT(HARD, "", R"("material": "hard", "shape": {"type": "box", "size": [1, 1, 1], "open": ["+z"]})"),
     "mbd.bodies[3].shapes[0].shape.open: a box with open faces is a surface, and contact is that of a solid "
     "(leave out open)"},
    {"CapsuleOfSegments",
     CONTACT(HARD, "",
             R"("material": "hard", "shape": {"type": "capsule", "radius": 1, "height": 1, "segments": 8})"),
     "mbd.bodies[3].shapes[0].shape.segments: contact is that of the round capsule (leave out segments)"},
    {"UnknownBodyToIgnore", CONTACT(HARD, R"(, "ignore": [["bird", "crat"]])", BALL),
     "mbd.contact.ignore[0]: unknown name 'crat' (did you mean 'crate'?)"},
    {"ABodyAndItselfToIgnore", CONTACT(HARD, R"(, "ignore": [["bird", "bird"]])", BALL),
     "mbd.contact.ignore[0]: both names are 'bird' (give two bodies that may pass through each other)"},
    {"TwoPlanes",
     CONTACT(HARD, R"(, "ground": [)" FLOOR("hard") "]",
             R"("material": "hard", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]})"),
     "mbd.bodies[3].shapes[0].shape: the contact of the plane 'a' of 'bird' with the plane 'floor' of "
     "'ground' is not computed in this version " NOT_COMPUTED},
    {"OutputOfAnUnknownBody", OUTPUT(R"("name": "feet", "on": ["brid"])"),
     "mbd.contact.outputs[0].on[0]: unknown name 'brid' (did you mean 'bird'?)"},
    {"OutputOfAShapeOfTheGround", OUTPUT(R"("name": "feet", "on": ["bird"], "from": ["floor"])"),
     "mbd.contact.outputs[0].from[0]: unknown name 'floor' ('floor' is a shape: write 'ground/floor')"},
    {"OutputOfAShapeOfABody", OUTPUT(R"("name": "feet", "on": ["a"])"),
     "mbd.contact.outputs[0].on[0]: unknown name 'a' ('a' is a shape: write 'bird/a')"},
    {"OutputOfABodyWithoutContact", OUTPUT(R"("name": "feet", "on": ["bird", "crate"])"),
     "mbd.contact.outputs[0].on: 'crate' has no shape of contact (give it a shape with \"use\": "
     "\"contact\")"},
    {"OutputOfAnUnknownShape", OUTPUT(R"("name": "feet", "on": ["bird"], "from": ["ground/flor"])"),
     "mbd.contact.outputs[0].from: 'ground' has no shape of contact 'flor' (did you mean 'floor'?)"},
    {"OutputOnBothSides", OUTPUT(R"("name": "feet", "on": ["bird"], "from": ["ground", "bird/a"])"),
     "mbd.contact.outputs[0].from: the shape 'a' of 'bird' is on both sides (leave it out of one of them)"},
    {"OutputOfBodiesThatPassThroughEachOther",
     CONTACT(
         HARD,
         R"(, "ground": [)" FLOOR(
             "hard") R"(], "ignore": [["ground", "bird"]], "outputs": [{"name": "feet", "on": ["bird"]}])",
         BALL),
     "mbd.contact.outputs[0]: the two sides never touch: they are one body, joined, or in mbd.contact.ignore "
     "(name bodies that may touch each other)"},
    {"OutputWithTheNameOfABody", OUTPUT(R"("name": "crate", "on": ["bird"])"),
     "mbd.contact.outputs[0].name: a body is called 'crate' as well, so that columns would be mixed up (give "
     "the output another name, such as 'crate_contact')"},
    {"OutputWithTheNameOfAForce", OUTPUT(R"("name": "coil", "on": ["bird"])"),
     "mbd.contact.outputs[0].name: a force is called 'coil' as well, so that columns would be mixed up (give "
     "the output another name, such as 'coil_contact')"},
    {"OutputTwice", OUTPUT(R"("name": "feet", "on": ["bird"]}, {"name": "feet", "on": ["bird"])"),
     "mbd.contact.outputs[1].name: the name 'feet' is given twice (names in mbd.contact.outputs must "
     "differ)"},
    {"OutputOfNothing", OUTPUT(R"("name": "feet", "on": [])"),
     "mbd.contact.outputs[0].on: the list is empty (give a list of names: bodies that the forces act on)"},
    {"RollingFrictionAboveOne",
     CONTACT(
         R"({"name": "hard", "stiffness": 1e6, "restitution": 0.5, "friction": 0.3, "rolling_friction": 2})",
         "", BALL),
     "mbd.contact.materials[0].rolling_friction: the value is 2 (give a number from 0 to 1: largest rolling "
     "moment over R* N, R* the radius of what rolls [-])"},
    {"ExplicitMethod", R"([{"op": "add", "path": "/mbd/contact", "value": {"materials": [)" HARD R"(]}},
         {"op": "replace", "path": "/mbd/integrator", "value": {"method": "dormand_prince"}}])",
     "mbd.integrator.method: 'dormand_prince' does not compute the contacts of mbd.contact (leave out "
     "method, "
     "which is then generalized_alpha)"},
    {"Extrapolation", R"([{"op": "add", "path": "/mbd/contact", "value": {"materials": [)" HARD R"(]}},
         {"op": "add", "path": "/mbd/integrator/extrapolate", "value": true}])",
     "mbd.integrator.extrapolate: contacts begin at other times in each of the two runs (leave out "
     "extrapolate or mbd.contact)"},
    {"Equilibrium", R"([{"op": "add", "path": "/mbd/contact", "value": {"materials": [)" HARD R"(]}},
         {"op": "remove", "path": "/mbd/bodies/3/velocity"}, {"op": "remove", "path": "/mbd/bodies/3/angular_velocity"},
         {"op": "remove", "path": "/mbd/joints/0/rate"}, {"op": "add", "path": "/mbd/start", "value": "equilibrium"}])",
     "mbd.start: the search for the equilibrium knows no contacts between bodies (leave out start, and let "
     "the bodies come to rest in a run)"},
};

TEST(WrongContacts, AcceptsABallOnAFloor) {
  EXPECT_EQ(verdict_on_patch(CONTACT(HARD, R"(, "ground": [)" FLOOR("hard") "]", BALL)), "no error");
}

TEST(WrongContacts, AcceptsOutputsOfBodiesAndShapes) {
  EXPECT_EQ(
      verdict_on_patch(OUTPUT(
          R"("name": "feet", "on": ["bird"]}, {"name": "down", "on": ["ground/floor"], "from": ["bird/a"])")),
      "no error");
}

INSTANTIATE_TEST_SUITE_P(Contacts, WrongSceneTest, testing::ValuesIn(wrong_contacts), name_of_case);

}  // namespace
}  // namespace tandem::scene::test
