// Wrong scenes: materials, pairs, particles and walls.
#include "tests/unit/common/wrong_scene.hpp"

namespace tandem::scene::test {
namespace {

const WrongScene wrong_dem[] = {
    {"MisspeltFriction", R"([{"op": "remove", "path": "/dem/pairs/0/friction"},
         {"op": "add", "path": "/dem/pairs/0/frition", "value": 0.3}])",
     "dem.pairs[0]: unknown key 'frition' (did you mean 'friction'?)"},
    {"NegativeDensity", R"([{"op": "replace", "path": "/dem/materials/0/density", "value": -2500}])",
     "dem.materials[0].density: the value is -2500 (give a number from 1e-06 to 1e+09: density [kg/m3])"},
    {"DensityOfTwoToThe64",
     R"([{"op": "replace", "path": "/dem/materials/0/density", "value": 18446744073709551616}])",
     "dem.materials[0].density: the value is 18446744073709551616 (give a number from 1e-06 to 1e+09: "
     "density [kg/m3])"},
    {"YoungOfNothing", R"([{"op": "replace", "path": "/dem/materials/0/young", "value": 1e-300}])",
     "dem.materials[0].young: the value is 1e-300 (give a number from 1 to 1e+30: Young's modulus [Pa])"},
    {"FrictionWithoutBound", R"([{"op": "replace", "path": "/dem/pairs/0/friction", "value": 1e300}])",
     "dem.pairs[0].friction: the value is 1e+300 (give a number from 0 to 1e+06: Coulomb friction "
     "coefficient [-])"},
    {"MicroStepOfNothing", R"([{"op": "add", "path": "/dem/micro_step", "value": 1e-300}])",
     "dem.micro_step: the value is 1e-300 (give a number from 1e-18 to 1000: longest time step of the "
     "particles; the window is cut "
     "into whole steps [s]; auto: from the critical time and the time of the fastest collision to expect)"},
    {"PoissonTooLarge", R"([{"op": "replace", "path": "/dem/materials/0/poisson", "value": 0.6}])",
     "dem.materials[0].poisson: the value is 0.6 (give a number <= 0.5: Poisson's ratio [-])"},
    {"PoissonMinusOne", R"([{"op": "replace", "path": "/dem/materials/0/poisson", "value": -1}])",
     "dem.materials[0].poisson: the value is -1 (give a number > -1: Poisson's ratio [-])"},
    {"RestitutionAboveOne", R"([{"op": "replace", "path": "/dem/pairs/0/restitution", "value": 1.1}])",
     "dem.pairs[0].restitution: the value is 1.1 (give a number from 0 to 1: coefficient of restitution "
     "[-])"},
    {"NegativeFriction", R"([{"op": "replace", "path": "/dem/pairs/0/friction", "value": -0.1}])",
     "dem.pairs[0].friction: the value is -0.1 (give a number from 0 to 1e+06: Coulomb friction coefficient "
     "[-])"},
    {"TwoMaterialsOfOneName", R"([{"op": "replace", "path": "/dem/materials/1/name", "value": "glass"}])",
     "dem.materials[1].name: the name 'glass' is given twice (names in dem.materials must differ)"},
    {"PairOfUnknownMaterial", R"([{"op": "replace", "path": "/dem/pairs/1/a", "value": "stell"}])",
     "dem.pairs[1].a: unknown name 'stell' (did you mean 'steel'?)"},
    {"PairGivenTwice",
     R"([{"op": "add", "path": "/dem/pairs/-", "value": {"a": "glass", "b": "steel", "restitution": 0.1, "friction": 0.1}}])",
     "dem.pairs[2]: the pair of 'glass' and 'steel' is given twice (keep one of them; the order of a and b "
     "does not matter)"},
    {"PairOfSphereAndWallMissing", R"([{"op": "remove", "path": "/dem/pairs/1"}])",
     "dem.pairs: no pair of 'glass' and 'steel' (spheres of 'grains' and wall 'inside' can meet: add their "
     "pair)"},
    {"PairOfSpheresMissing", R"([{"op": "remove", "path": "/dem/pairs/0"}])",
     "dem.pairs: no pair of 'glass' and 'glass' (spheres of 'grains' and 'grains' can meet: add their pair)"},
    {"MaterialsWithoutRollingFriction",
     R"([{"op": "remove", "path": "/dem/pairs"},
         {"op": "add", "path": "/dem/materials/0/restitution", "value": 0.5},
         {"op": "add", "path": "/dem/materials/0/friction", "value": 0.5},
         {"op": "add", "path": "/dem/materials/0/rolling_damping", "value": 0.5},
         {"op": "add", "path": "/dem/rolling", "value": "elastic_plastic"}])",
     "dem.materials: 'glass' and 'glass' have no 'rolling_friction', which rolling 'elastic_plastic' needs "
     "(spheres of 'grains' and 'grains' can meet: give it to both, or to their pair)"},
    {"PairWithoutRestitution", R"([{"op": "remove", "path": "/dem/pairs/0/restitution"}])",
     "dem.pairs[0]: the key 'restitution' is missing (contact 'hertz_mindlin' needs it for every pair, or "
     "'restitution' for both materials)"},
    {"PairWithoutFriction", R"([{"op": "remove", "path": "/dem/pairs/0/friction"}])",
     "dem.pairs[0]: the key 'friction' is missing (contact 'hertz_mindlin' needs it for every pair, or "
     "'friction' for both materials)"},
    {"PaperWithoutItsConstants", R"([{"op": "replace", "path": "/dem/contact", "value": "paper"}])",
     "dem.pairs[0]: the key 'normal_stiffness' is missing (contact 'paper' needs it for every pair)"},
    {"PairWithoutWorkOfAdhesion", R"([{"op": "replace", "path": "/dem/contact", "value": "jkr"}])",
     "dem.pairs[0]: the key 'work_of_adhesion' is missing (contact 'jkr' needs it for every pair, or "
     "'surface_energy' for both materials)"},
    {"SurfaceEnergyOfOneMaterial",
     R"([{"op": "replace", "path": "/dem/contact", "value": "jkr"},
         {"op": "add", "path": "/dem/materials/0/surface_energy", "value": 0.05}])",
     "dem.pairs[1]: the key 'work_of_adhesion' is missing (contact 'jkr' needs it for every pair, or "
     "'surface_energy' for both materials)"},
    {"NegativeSurfaceEnergy", R"([{"op": "add", "path": "/dem/materials/0/surface_energy", "value": -1}])",
     "dem.materials[0].surface_energy: the value is -1 (give a number from 0 to 1e+15: of the law jkr, of "
     "pairs that "
     "give no work_of_adhesion [J/m2])"},
    {"RollingWithoutItsConstants", R"([{"op": "add", "path": "/dem/rolling", "value": "elastic_plastic"}])",
     "dem.pairs[0]: the key 'rolling_friction' is missing (rolling 'elastic_plastic' needs it for every "
     "pair, "
     "or 'rolling_friction' for both materials)"},
    {"TwistingWithoutFriction",
     R"([{"op": "replace", "path": "/dem/contact", "value": "hertz_frictionless"},
         {"op": "add", "path": "/dem/twisting", "value": "elastic_plastic"}])",
     "dem.twisting: spheres of 'hertz_frictionless' do not turn (choose a contact law with friction, or "
     "\"none\")"},
    {"TwistingOfThePapersLaw",
     R"([{"op": "replace", "path": "/dem/contact", "value": "paper"},
         {"op": "add", "path": "/dem/twisting", "value": "elastic_plastic"},
         {"op": "replace", "path": "/dem/pairs", "value": [
           {"a": "glass", "b": "glass", "friction": 0.3, "normal_stiffness": 1e6, "normal_damping": 1,
            "tangential_stiffness": 1e6, "tangential_damping": 1},
           {"a": "glass", "b": "steel", "friction": 0.3, "normal_stiffness": 1e6, "normal_damping": 1,
            "tangential_stiffness": 1e6, "tangential_damping": 1}]}])",
     "dem.twisting: contacts of 'paper' have no tangential stiffness before they slide, which twisting needs "
     "(choose another contact law, or \"none\")"},
    {"RollingDampingAboveCritical",
     R"([{"op": "add", "path": "/dem/rolling", "value": "elastic_plastic"},
         {"op": "add", "path": "/dem/pairs/0/rolling_friction", "value": 0.3},
         {"op": "add", "path": "/dem/pairs/0/rolling_damping", "value": 10}])",
     "dem.pairs[0].rolling_damping: the value is 10 (give a number from 0 to 1: share of the critical "
     "damping of "
     "rolling [-])"},
    {"UnknownContactLaw", R"([{"op": "replace", "path": "/dem/contact", "value": "hertz_mindlim"}])",
     "dem.contact: the value is \"hertz_mindlim\" (did you mean 'hertz_mindlin'?)"},
    {"UnknownVariant", R"([{"op": "replace", "path": "/dem/variant", "value": "special"}])",
     "dem.variant: the value is \"special\" (known values: auto, generic)"},
    {"UnknownPrecision", R"([{"op": "replace", "path": "/dem/precision", "value": "single"}])",
     "dem.precision: the value is \"single\" (known values: mixed, double)"},
    {"NoParticles", R"([{"op": "replace", "path": "/dem/particles", "value": []}])",
     "dem.particles: the scene has no sphere (add a group, or leave out dem)"},
    {"NoSphereFits", R"([{"op": "replace", "path": "/dem/particles/0/fill/max", "value": [0.1, 0.1, 0.91]}])",
     "dem.particles[0].fill: the box holds no sphere of radius 0.012 m (enlarge it)"},
    {"CountDoesNotFit", R"([{"op": "replace", "path": "/dem/particles/0/fill/count", "value": 1000000}])",
     "dem.particles[0].fill.count: 1000000 spheres do not fit: the lattice has 580 sites (enlarge the box, "
     "or reduce count or spacing)"},
    {"ZeroCount", R"([{"op": "replace", "path": "/dem/particles/0/fill/count", "value": 0}])",
     "dem.particles[0].fill.count: the value is 0 (give a number from 1 to 2147483647: number of spheres; "
     "without it the "
     "box is filled [-])"},
    {"EndlessLattice", R"([{"op": "remove", "path": "/dem/particles/0/fill/count"},
         {"op": "replace", "path": "/dem/particles/0/fill/spacing", "value": 1e-07},
         {"op": "replace", "path": "/dem/particles/0/radius", "value": 1e-08},
         {"op": "remove", "path": "/dem/micro_step"}])",
     "dem.particles[0].fill: the lattice has 1.13137e+19 sites, more than 2147483647 (give a count)"},
    {"SpheresOverlapAtTheStart",
     R"([{"op": "replace", "path": "/dem/particles/0/fill/spacing", "value": 0.023}])",
     "dem.particles[0].fill.spacing: the spacing of 0.023 m is less than the largest diameter of 0.024 m "
     "(spheres would overlap at the start)"},
    {"FillOutsideTheDomain",
     R"([{"op": "replace", "path": "/dem/particles/0/fill/max", "value": [0.1, 2.5, 1.1]}])",
     "dem.particles[0].fill.max[1]: 2.5 m is outside the domain, which ends at 2 m (spheres outside the "
     "domain are lost: enlarge dem.domain or move the fill)"},
    {"FillBelowTheDomain",
     R"([{"op": "replace", "path": "/dem/particles/0/fill/min", "value": [-0.1, -0.1, -1.5]}])",
     "dem.particles[0].fill.min[2]: -1.5 m is outside the domain, which ends at -1 m (spheres outside the "
     "domain are lost: enlarge dem.domain or move the fill)"},
    {"FillWithMinAboveMax",
     R"([{"op": "replace", "path": "/dem/particles/0/fill/min", "value": [0.2, -0.1, 0.9]}])",
     "dem.particles[0].fill.max[0]: 0.1 m is not above the minimum of 0.2 m (min < max along each axis)"},
    {"UnknownFill", R"([{"op": "replace", "path": "/dem/particles/0/fill/type", "value": "latice"}])",
     "dem.particles[0].fill.type: the value is \"latice\" (did you mean 'lattice'?)"},
    {"UnknownLattice", R"([{"op": "replace", "path": "/dem/particles/0/fill/lattice", "value": "fcc"}])",
     "dem.particles[0].fill.lattice: the value is \"fcc\" (known values: cubic, hexagonal)"},
    {"JitterAboveOne", R"([{"op": "replace", "path": "/dem/particles/0/fill/jitter", "value": 2}])",
     "dem.particles[0].fill.jitter: the value is 2 (give a number from 0 to 1: largest displacement per axis "
     "as a "
     "share of half the gap between spheres [-])"},
    {"NegativeSeed", R"([{"op": "replace", "path": "/dem/particles/0/fill/seed", "value": -1}])",
     "dem.particles[0].fill.seed: the value is -1 (give a number from 0 to 9007199254740992: of the random "
     "radii and "
     "displacements [-])"},
    {"ASumIsWrittenWithoutRoundOff",
     R"([{"op": "replace", "path": "/dem/particles/0/radius", "value": -0.30000000000000004}])",
     "dem.particles[0].radius: the value is -0.3 (give a number from 1e-09 to 1e+09: of all spheres, or "
     "smallest and "
     "largest of a uniform distribution [m])"},
    {"WrongByRoundOffAlone",
     R"([{"op": "replace", "path": "/dem/particles/0/radius", "value": 1000000000.0000002}])",
     "dem.particles[0].radius: the value is 1000000000.0000002 (give a number from 1e-09 to 1e+09: of all "
     "spheres, or "
     "smallest and largest of a uniform distribution [m])"},
    {"AGroupAsAName", R"([{"op": "replace", "path": "/dem/particles/0", "value": "sand"}])",
     "dem.particles[0]: the value is \"sand\" (give an object, as {\"name\": \"sand\", ...}: groups of "
     "spheres)"},
    {"NegativeRadius", R"([{"op": "replace", "path": "/dem/particles/0/radius", "value": -0.01}])",
     "dem.particles[0].radius: the value is -0.01 (give a number from 1e-09 to 1e+09: of all spheres, or "
     "smallest and "
     "largest of a uniform distribution [m])"},
    {"RadiusOfThreeNumbers",
     R"([{"op": "replace", "path": "/dem/particles/0/radius", "value": [0.01, 0.011, 0.012]}])",
     "dem.particles[0].radius: the value is [0.01,0.011,0.012] (give a number or a list of 2 numbers: of "
     "all spheres, or smallest and largest of a uniform distribution [m])"},
    {"RadiusUpsideDown", R"([{"op": "replace", "path": "/dem/particles/0/radius", "value": [0.012, 0.01]}])",
     "dem.particles[0].radius: the largest radius of 0.01 m is below the smallest of 0.012 m (give the "
     "smaller first)"},
    {"RadiusMissing", R"([{"op": "remove", "path": "/dem/particles/0/radius"}])",
     "dem.particles[0]: the key 'radius' is missing (add radius: a lattice needs the radius of its spheres "
     "[m])"},
    {"AllGroupsFixed", R"([{"op": "add", "path": "/dem/particles/0/fixed", "value": true},
         {"op": "remove", "path": "/dem/particles/0/velocity"}])",
     "dem.particles: all groups are fixed: the scene has no sphere that moves (add a group without fixed, or "
     "leave out dem)"},
    {"FixedWithVelocity",
     R"([{"op": "add", "path": "/dem/particles/0/fixed", "value": true},
         {"op": "add", "path": "/dem/particles/0/velocity", "value": [0, 0, 0]}])",
     "dem.particles[0].velocity: the spheres of a fixed group never move (leave out velocity, or fixed)"},
    {"FixedInlet",
     R"([{"op": "add", "path": "/dem/particles/-", "value": {"name": "tap", "material": "glass", "radius": 0.01, "fixed": true,
          "fill": {"type": "inlet", "min": [0, 0, 0.5], "max": [0.1, 0.1, 0.6], "rate": 10}}}])",
     "dem.particles[1].fixed: spheres that come in through an inlet move (leave out fixed, or fill a "
     "lattice)"},
    {"GroupOfUnknownMaterial",
     R"([{"op": "replace", "path": "/dem/particles/0/material", "value": "water"}])",
     "dem.particles[0].material: unknown name 'water' (known materials: glass, steel)"},
    {"TwoGroupsOfOneName",
     R"([{"op": "add", "path": "/dem/particles/-", "value": {"name": "grains", "material": "glass", "radius": 0.01, "fill": {"type": "file", "file": "a.csv"}}}])",
     "dem.particles[1].name: the name 'grains' is given twice (names in dem.particles must differ)"},
    {"EmptyDomain", R"([{"op": "replace", "path": "/dem/domain/min", "value": [-2, -2, 3]}])",
     "dem.domain.max[2]: 3 m is not above the minimum of 3 m (min < max along each axis)"},
    {"DomainWithoutMax", R"([{"op": "remove", "path": "/dem/domain/max"}])",
     "dem.domain: the key 'max' is missing (add max: corner in the world [m])"},
    {"PeriodicAlongNoAxis", R"([{"op": "add", "path": "/dem/domain/periodic", "value": ["w"]}])",
     "dem.domain.periodic[0]: the value is \"w\" (known values: x, y, z)"},
    {"PeriodicTwice", R"([{"op": "add", "path": "/dem/domain/periodic", "value": ["x", "x"]}])",
     "dem.domain.periodic[1]: the value \"x\" is given twice (keep one of them)"},
    {"FollowedAndPeriodic", R"([{"op": "add", "path": "/dem/domain/follows", "value": "crate"}])",
     "dem.domain.follows: a periodic domain cannot follow a body (leave out periodic or follows)"},
    {"FollowsNoBody", R"([{"op": "add", "path": "/dem/domain/follows", "value": "crat"}])",
     "dem.domain.follows: unknown name 'crat' (did you mean 'crate'?)"},
    {"FollowsABodyWithoutWalls",
     R"([{"op": "remove", "path": "/dem/domain/periodic"}, {"op": "remove", "path": "/dem/walls/2"},
        {"op": "add", "path": "/dem/domain/follows", "value": "arm"}])",
     "dem.domain.follows: the body 'arm' carries no wall (the particles know where bodies with walls are: "
     "name one of those)"},
    {"EndlessWallOnAnotherBody",
     R"([{"op": "remove", "path": "/dem/domain/periodic"}, {"op": "add", "path": "/dem/domain/follows", "value": "arm"},
        {"op": "add", "path": "/dem/walls/1/body", "value": "crate"}])",
     "dem.walls[1]: the wall 'floor' is endless, on a body that the domain does not follow (give it an end, "
     "fix it to the ground or to 'arm', or leave out dem.domain.follows)"},
    {"MicroStepAboveTheWindow", R"([{"op": "replace", "path": "/dem/micro_step", "value": 0.002}])",
     "dem.micro_step: the micro step of 0.002 s is longer than the window of 0.001 s (a window holds whole "
     "steps)"},
    {"MicroStepZero", R"([{"op": "replace", "path": "/dem/micro_step", "value": 0}])",
     "dem.micro_step: the value is 0 (give a number from 1e-18 to 1000: longest time step of the particles; "
     "the window is "
     "cut into whole steps [s]; auto: from the critical time and the time of the fastest collision to "
     "expect)"},
    {"MicroStepOfAWord", R"([{"op": "replace", "path": "/dem/micro_step", "value": "fast"}])",
     "dem.micro_step: the value is \"fast\" (give a number or \"auto\": longest time step of the particles; "
     "the window "
     "is cut "
     "into whole steps [s]; auto: from the critical time and the time of the fastest collision to expect)"},
    {"StartOverlapOfAWord", R"([{"op": "add", "path": "/dem/start_overlap", "value": "relaxed"}])",
     "dem.start_overlap: the value is \"relaxed\" (did you mean 'relax'?)"},
    {"NegativeSkin", R"([{"op": "replace", "path": "/dem/skin", "value": -0.001}])",
     "dem.skin: the value is -0.001 (give a number from 1e-09 to 1e+09: margin of the neighbour list [m])"},
    {"TwoWallsOfOneName", R"([{"op": "replace", "path": "/dem/walls/2/name", "value": "floor"}])",
     "dem.walls[2].name: the name 'floor' is given twice (names in dem.walls must differ)"},
    {"BeltThatStands", R"([{"op": "add", "path": "/dem/walls/1/surface_velocity", "value": [0, 0, 0]}])",
     "dem.walls[1].surface_velocity: the velocity is 0 (leave it out, or give the velocity of the surface "
     "[m/s])"},
    {"BeltThatLeavesItsPlane",
     R"([{"op": "add", "path": "/dem/walls/1/surface_velocity", "value": [3, 0, 4]}])",
     "dem.walls[1].surface_velocity: the velocity has a share of 0.8 along the normal of the plane, [0, 0, "
     "1] "
     "(a surface moves along itself: give a velocity in the plane, or move the body)"},
    {"BeltWithoutDirection",
     R"([{"op": "add", "path": "/dem/walls/1/surface_velocity", "value": {"direction": [0, 2, 0], "speed": {"type": "constant", "value": 1}}}])",
     "dem.walls[1].surface_velocity.direction: [0, 2, 0] has length 2, not 1 (the unit one is [0, 1, 0])"},
    {"BeltOfOneNumber", R"([{"op": "add", "path": "/dem/walls/1/surface_velocity", "value": 2}])",
     "dem.walls[1].surface_velocity: the value is 2 (give a list of 3 numbers or an object: velocity of the "
     "surface along itself, in the body's frame [m/s], as of a conveyor belt)"},
    {"BeltWithoutFriction",
     R"([{"op": "replace", "path": "/dem/contact", "value": "hertz_frictionless"},
         {"op": "add", "path": "/dem/walls/1/surface_velocity", "value": [3, 0, 0]}])",
     "dem.walls[1].surface_velocity: the law hertz_frictionless has no friction, so that a belt moves "
     "nothing "
     "(choose a contact law with friction, or leave it out)"},
    {"WallOnUnknownBody", R"([{"op": "replace", "path": "/dem/walls/0/body", "value": "create"}])",
     "dem.walls[0].body: unknown name 'create' (did you mean 'crate'?)"},
    {"WallOfUnknownMaterial", R"([{"op": "replace", "path": "/dem/walls/1/material", "value": "glas"}])",
     "dem.walls[1].material: unknown name 'glas' (did you mean 'glass'?)"},
    {"WallOnABodyWithoutBodies", R"([{"op": "remove", "path": "/mbd"}])",
     "dem.walls[0].body: unknown name 'crate' (there are no bodies)"},
    {"UnknownShape", R"([{"op": "replace", "path": "/dem/walls/0/shape/type", "value": "cube"}])",
     "dem.walls[0].shape.type: the value is \"cube\" (known values: plane, box, cylinder, sphere, mesh, "
     "capsule, cone, "
     "convex_hull, height_field)"},
    {"ShapeWithoutType", R"([{"op": "remove", "path": "/dem/walls/0/shape/type"}])",
     "dem.walls[0].shape: the key 'type' is missing (known types: plane, box, cylinder, sphere, mesh, "
     "capsule, cone, "
     "convex_hull, height_field)"},
    {"TypeThatIsNoWord", R"([{"op": "add", "path": "/mbd/bodies/0/type", "value": [1]}])",
     "mbd.bodies[0]: unknown key 'type' (known keys: angular_velocity, assembly, color, inertia, mass, name, "
     "orientation, "
     "position, "
     "relative_to, shapes, velocity)"},
    {"KeyOfAnotherShape", R"([{"op": "add", "path": "/dem/walls/1/shape/size", "value": [1, 1, 1]}])",
     "dem.walls[1].shape: unknown key 'size' for type 'plane' (known keys: normal, point, type)"},
    {"NormalNotUnit", R"([{"op": "replace", "path": "/dem/walls/1/shape/normal", "value": [0, 1, 1]}])",
     "dem.walls[1].shape.normal: [0, 1, 1] has length 1.4142135623730951, not 1 (the unit one is [0, "
     "0.7071067811865475, 0.7071067811865475])"},
    {"WallOrientationNotUnit",
     R"([{"op": "replace", "path": "/dem/walls/2/orientation", "value": [0.8, 0.7, 0, 0]}])",
     "dem.walls[2].orientation: [0.8, 0.7, 0, 0] has length 1.063014581273465, not 1 (the unit one is "
     "[0.7525766947068778, 0.658504607868518, 0, 0])"},
    {"BoxOfNoHeight", R"([{"op": "replace", "path": "/dem/walls/0/shape/size", "value": [1, 1, 0]}])",
     "dem.walls[0].shape.size[2]: the value is 0 (give a number from 1e-09 to 1e+09: full edge lengths [m])"},
    {"UnknownOpenFace", R"([{"op": "replace", "path": "/dem/walls/0/shape/open", "value": ["top"]}])",
     "dem.walls[0].shape.open[0]: the value is \"top\" (known values: +x, -x, +y, -y, +z, -z)"},
    {"OpenFaceTwice", R"([{"op": "replace", "path": "/dem/walls/0/shape/open", "value": ["+z", "+z"]}])",
     "dem.walls[0].shape.open[1]: the value \"+z\" is given twice (keep one of them)"},
    {"AllFacesOpen",
     R"([{"op": "replace", "path": "/dem/walls/0/shape/open", "value": ["+x", "-x", "+y", "-y", "+z", "-z"]}])",
     "dem.walls[0].shape.open: all six faces of the box are open (leave a face, or leave out the wall)"},
    {"CylinderOfTwoFaces", R"([{"op": "replace", "path": "/dem/walls/2/shape/segments", "value": 2}])",
     "dem.walls[2].shape.segments: the value is 2 (give a number from 3 to 1000: makes the side a prism of "
     "so many "
     "flat faces [-])"},
    {"EndlessCylinderOfFlatFaces", R"([{"op": "remove", "path": "/dem/walls/2/shape/height"}])",
     "dem.walls[2].shape.segments: a cylinder without a height is endless: it has no flat faces (give a "
     "height, or leave this out)"},
    {"EndlessCylinderWithAnEnd",
     R"([{"op": "remove", "path": "/dem/walls/2/shape/height"}, {"op": "remove", "path": "/dem/walls/2/shape/segments"}])",
     "dem.walls[2].shape.open: a cylinder without a height is endless: it has no ends (give a height, or "
     "leave this out)"},
    {"SphereOfNoRadius",
     R"([{"op": "replace", "path": "/dem/walls/2/shape", "value": {"type": "sphere", "radius": 0}}])",
     "dem.walls[2].shape.radius: the value is 0 (give a number from 1e-09 to 1e+09: radius [m])"},
    {"SameSphereTwice",
     R"([{"op": "add", "path": "/dem/walls/-", "value": {"name": "bulb", "material": "steel", "shape": {"type": "sphere", "radius": 2}}},
         {"op": "add", "path": "/dem/walls/-", "value": {"name": "again", "material": "steel", "shape": {"type": "sphere", "radius": 2}}}])",
     "dem.walls[4]: wall 'again' overlaps wall 'bulb' on 'ground' (which of them spheres touch is left to "
     "chance: move "
     "one, or leave it out)"},
    {"CylindersOneInTheOther",
     R"([{"op": "add", "path": "/dem/walls/-", "value": {"name": "pipe", "material": "steel", "shape": {"type": "cylinder", "radius": 2}}},
         {"op": "add", "path": "/dem/walls/-", "value": {"name": "sleeve", "material": "steel", "position": [0, 0, 9], "shape": {"type": "cylinder", "radius": 2, "height": 1, "open": ["+z", "-z"]}}}])",
     "dem.walls[4]: wall 'sleeve' overlaps wall 'pipe' on 'ground' (which of them spheres touch is left to "
     "chance: move "
     "one, or leave it out)"},
    {"RoundTableFlushWithAPlane",
     R"([{"op": "add", "path": "/dem/walls/-", "value": {"name": "table", "material": "steel", "position": [1, 1, -0.5], "shape": {"type": "cylinder", "radius": 0.4, "height": 1}}}])",
     "dem.walls[3]: wall 'table' overlaps wall 'floor' on 'ground' (which of them spheres touch is left to "
     "chance: move "
     "one, or leave it out)"},
    {"InletWithoutARate",
     R"([{"op": "replace", "path": "/dem/particles/0/fill", "value": {"type": "inlet", "min": [0, 0, 1], "max": [1, 1, 2]}}])",
     "dem.particles[0].fill: the inlet has neither rate nor mass_rate (give one of them: spheres or mass per "
     "second)"},
    {"InletOfTwoRates",
     R"([{"op": "replace", "path": "/dem/particles/0/fill", "value": {"type": "inlet", "min": [0, 0, 1], "max": [1, 1, 2], "rate": 1, "mass_rate": 1}}])",
     "dem.particles[0].fill: the inlet has a rate and a mass_rate (give one of them: spheres or mass per "
     "second)"},
    {"InletWithoutARadius",
     R"([{"op": "remove", "path": "/dem/particles/0/radius"},
         {"op": "replace", "path": "/dem/particles/0/fill", "value": {"type": "inlet", "min": [0, 0, 1], "max": [1, 1, 2], "rate": 1}}])",
     "dem.particles[0]: the key 'radius' is missing (add radius: an inlet needs the radius of its spheres "
     "[m])"},
    {"InletTooNarrow",
     R"([{"op": "replace", "path": "/dem/particles/0/fill", "value": {"type": "inlet", "min": [0, 0, 1], "max": [1, 0.02, 2], "rate": 1}}])",
     "dem.particles[0].fill: the box is 0.02 m wide along y, too narrow for a sphere of radius 0.012 m "
     "(spheres come in inside the box: enlarge it)"},
    {"InletOutsideTheDomain",
     R"([{"op": "replace", "path": "/dem/particles/0/fill", "value": {"type": "inlet", "min": [0, 0, 1], "max": [1, 1, 4], "rate": 1}}])",
     "dem.particles[0].fill.max[2]: 4 m is outside the domain, which ends at 3 m (spheres outside the domain "
     "are lost: enlarge dem.domain or move the fill)"},
    {"SensorNamedLikeABody",
     R"([{"op": "add", "path": "/dem/sensors", "value": [{"name": "crate", "shape": {"type": "box", "size": [1, 1, 1]}}]}])",
     "dem.sensors[0].name: a body, joint, element or part of the results is called 'crate' as well, so that "
     "columns would be "
     "mixed up (give the sensor another name, such as 'crate_content')"},
    {"SensorNamedLikeTheSummary",
     R"([{"op": "add", "path": "/dem/sensors", "value": [{"name": "summary", "shape": {"type": "box", "size": [1, 1, 1]}}]}])",
     "dem.sensors[0].name: a body, joint, element or part of the results is called 'summary' as well, so "
     "that "
     "columns would be mixed up (give the sensor another name, such as 'summary_content')"},
    {"SensorOfNothing", R"([{"op": "add", "path": "/dem/sensors", "value": [{"name": "gate"}]}])",
     "dem.sensors[0]: the sensor has neither 'shape' nor 'wall' (give 'shape', a region whose spheres are "
     "measured, or 'wall', the name of a wall)"},
    {"SensorOfAWallWithAnAxis",
     R"([{"op": "add", "path": "/dem/sensors", "value": [{"name": "gate", "wall": "post", "flow": "x"}]}])",
     "dem.sensors[0]: 'flow' is of a region, and this is the sensor of a wall (leave it out)"},
    {"SensorOfAnUnknownWall",
     R"([{"op": "add", "path": "/dem/sensors", "value": [{"name": "gate", "wall": "pots"}]}])",
     "dem.sensors[0].wall: there is no wall 'pots' (did you mean 'post'?)"},
    {"SensorOfACylinderAcrossIt",
     R"([{"op": "add", "path": "/dem/sensors", "value": [{"name": "gate", "shape": {"type": "cylinder", "radius": 1, "height": 1}, "flow": "x"}]}])",
     "dem.sensors[0].flow: a cylinder has different lengths along x and y, so that no flow follows (measure "
     "along its axis, z, or give a box)"},
    {"SensorOnABodyWithoutWalls",
     R"([{"op": "add", "path": "/dem/sensors", "value": [{"name": "gate", "body": "bird", "shape": {"type": "box", "size": [1, 1, 1]}}]}])",
     "dem.sensors[0].body: the body 'bird' carries no wall (the particles know where bodies with walls are: "
     "name one of those)"},
    {"SensorOutsideTheDomain",
     R"([{"op": "add", "path": "/dem/sensors", "value": [{"name": "gate", "position": [0, 0, 9], "shape": {"type": "box", "size": [1, 1, 1]}}]}])",
     "dem.sensors[0].position: the region at [0, 0, 9] lies outside dem.domain, where no sphere is (move "
     "it into the domain)"},
    {"SensorOnAnUnknownBody",
     R"([{"op": "add", "path": "/dem/sensors", "value": [{"name": "gate", "body": "crat", "shape": {"type": "box", "size": [1, 1, 1]}}]}])",
     "dem.sensors[0].body: unknown name 'crat' (did you mean 'crate'?)"},
    {"OutletWithoutAThickness",
     R"([{"op": "add", "path": "/dem/outlets", "value": [{"name": "drain", "region": {"type": "box", "min": [0, 0, 0], "max": [1, 1, 0]}}]}])",
     "dem.outlets[0].region.max[2]: 0 m is not above the minimum of 0 m (min < max along each axis)"},
    {"OutletNormalNotUnit",
     R"([{"op": "add", "path": "/dem/outlets", "value": [{"name": "drain", "region": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, -2]}}]}])",
     "dem.outlets[0].region.normal: [0, 0, -2] has length 2, not 1 (the unit one is [0, 0, -1])"},
    {"OutletBoxBesideTheDomain",
     R"([{"op": "add", "path": "/dem/outlets", "value": [{"name": "drain", "region": {"type": "box", "min": [500, 0, 0], "max": [501, 1, 1]}}]}])",
     "dem.outlets[0].region: it does not intersect dem.domain, so that no sphere can leave through it (move "
     "it into the "
     "domain; what leaves that counts as lost)"},
    {"OutletPlaneBelowTheDomain",
     R"([{"op": "add", "path": "/dem/outlets", "value": [{"name": "drain", "region": {"type": "plane", "point": [0, 0, -500], "normal": [0, 0, -1]}}]}])",
     "dem.outlets[0].region: it does not intersect dem.domain, so that no sphere can leave through it (move "
     "it into the "
     "domain; what leaves that counts as lost)"},
    {"InletInAnOutletBox",
     R"([{"op": "add", "path": "/dem/particles/-", "value": {"name": "rain", "material": "steel", "radius": 0.1, "fill": {"type": "inlet", "min": [0, 0, 1], "max": [1, 1, 2], "rate": 1}}},
         {"op": "add", "path": "/dem/outlets", "value": [{"name": "drain", "region": {"type": "box", "min": [0, 0, 0], "max": [1, 1, 2]}}]}])",
     "dem.outlets[0].region: all of the inlet dem.particles[1] is in it: what comes in goes out a window "
     "later (move one of the two)"},
    {"InletBeyondAnOutletPlane",
     R"([{"op": "add", "path": "/dem/particles/-", "value": {"name": "rain", "material": "steel", "radius": 0.1, "fill": {"type": "inlet", "min": [0, 0, 1], "max": [1, 1, 2], "rate": 1}}},
         {"op": "add", "path": "/dem/outlets", "value": [{"name": "drain", "region": {"type": "plane", "point": [0, 0, 2], "normal": [0, 0, -1]}}]}])",
     "dem.outlets[0].region: all of the inlet dem.particles[1] is in it: what comes in goes out a window "
     "later (move one of the two)"},
    {"SameWallTwice", R"([{"op": "copy", "from": "/dem/walls/0", "path": "/dem/walls/-"},
         {"op": "replace", "path": "/dem/walls/3/name", "value": "again"}])",
     "dem.walls[3]: wall 'again' overlaps wall 'inside' on 'crate' (which of them spheres touch is left to "
     "chance: move "
     "one, or leave it out)"},
    {"TwoPlanesInOne",
     R"([{"op": "add", "path": "/dem/walls/-", "value": {"name": "ice", "material": "steel", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}}])",
     "dem.walls[3]: wall 'ice' overlaps wall 'floor' on 'ground' (which of them spheres touch is left to "
     "chance: move "
     "one, or leave it out)"},
    {"BoxFlushWithAPlane",
     R"([{"op": "add", "path": "/dem/walls/-", "value": {"name": "slab", "material": "steel", "position": [1, 1, -0.5], "shape": {"type": "box", "size": [1, 1, 1]}}}])",
     "dem.walls[3]: wall 'slab' overlaps wall 'floor' on 'ground' (which of them spheres touch is left to "
     "chance: move "
     "one, or leave it out)"},
    {"TwoBoxesFlush",
     R"([{"op": "add", "path": "/dem/walls/-", "value": {"name": "big", "body": "bird", "material": "steel", "shape": {"type": "box", "size": [1, 1, 1]}}},
         {"op": "add", "path": "/dem/walls/-", "value": {"name": "small", "body": "bird", "material": "steel", "position": [0.3, 0, 0.25], "shape": {"type": "box", "size": [0.5, 0.5, 0.5]}}}])",
     "dem.walls[4]: wall 'small' overlaps wall 'big' on 'bird' (which of them spheres touch is left to "
     "chance: move "
     "one, or leave it out)"},
    {"SameMeshTwice",
     R"([{"op": "replace", "path": "/dem/walls/1/shape", "value": {"type": "mesh", "file": "hull.stl"}},
         {"op": "copy", "from": "/dem/walls/1", "path": "/dem/walls/-"},
         {"op": "replace", "path": "/dem/walls/3/name", "value": "again"}])",
     "dem.walls[3]: wall 'again' overlaps wall 'floor' on 'ground' (which of them spheres touch is left to "
     "chance: move "
     "one, or leave it out)"},
    {"MeshStretchZero",
     R"([{"op": "replace", "path": "/dem/walls/1/shape", "value": {"type": "mesh", "file": "hull.stl", "stretch": [1, 0, 1]}}])",
     "dem.walls[1].shape.stretch[1]: the value is 0 (give a number from 1e-09 to 1e+09: further factors "
     "along "
     "the axes of the file [-])"},
    {"MeshScaleZero",
     R"([{"op": "replace", "path": "/dem/walls/1/shape", "value": {"type": "mesh", "file": "hull.stl", "scale": 0}}])",
     "dem.walls[1].shape.scale: the value is 0 (give a number from 1e-09 to 1e+09: length in metres of one "
     "unit of the "
     "file [m])"},
    {"MeshWithoutFile", R"([{"op": "replace", "path": "/dem/walls/1/shape", "value": {"type": "mesh"}}])",
     "dem.walls[1].shape: the key 'file' is missing (add file: STL or OBJ file, relative to the scene's "
     "folder)"},
};

INSTANTIATE_TEST_SUITE_P(Dem, WrongSceneTest, testing::ValuesIn(wrong_dem), name_of_case);

}  // namespace
}  // namespace tandem::scene::test
