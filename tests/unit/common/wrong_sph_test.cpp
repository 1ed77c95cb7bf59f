// Scenes with a liquid: what is read, and what is refused.
#include "common/error.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/sensor_columns.hpp"
#include "tests/unit/common/good_scene.hpp"
#include "tests/unit/common/wrong_scene.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace tandem::scene::test {
namespace {

#define LIQUID(more)                                               \
  R"({"name": "water", "density": 1000, "viscosity": 0.001,)" more \
  R"("fill": [{"type": "box", "min": [0, 0, 0], "max": [0.2, 0.2, 0.1]}]})"
#define SPH_WITH(liquids, more)                                                                   \
  R"({"op": "add", "path": "/sph", "value": {"spacing": 0.02, "liquids": [)" liquids R"(],)" more \
  R"("domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}}})"
#define SPH(liquids, more) "[" SPH_WITH(liquids, more) "]"
#define FILL(boxes) SPH(R"({"name": "water", "density": 1000, "viscosity": 0.001, "fill": [)" boxes "]}", "")

#define FOLLOWING(more, body) \
  "[" SPH_WITH(LIQUID(""), more) R"(, {"op": "add", "path": "/sph/domain/follows", "value": ")" body R"("}])"

#define TUB                                                                                                       \
  R"("walls": [{"name": "tub", "position": [0.1, 0.1, 0.1], "shape": {"type": "box", "size": [0.3, 0.3, 0.3]}},)" \
  R"({"name": "floor", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],)"
#define INSIDE(more)                                                                                       \
  SPH(R"({"name": "water", "density": 1000, "viscosity": 0.001, "fill": [{"type": "inside", )" more "}]}", \
      TUB)

#define INLET(more) SPH(LIQUID(""), R"("inlets": [{"name": "pipe", )" more "}],")
#define RECTANGLE R"("position": [0, 0, 0.5], "shape": {"type": "rectangle", "size": [0.04, 0.08]})"

TEST(Sph, InletsAndOutletsAreRead) {
  const nlohmann::json json = good_scene().patch(nlohmann::json::parse(
      SPH(R"({"name": "water", "density": 1000, "viscosity": 0.001, "fill": []})", R"("inlets": [
             {"name": "pipe", )" RECTANGLE R"(, "flow": 0.0032, "end": 2},
             {"name": "nozzle", "position": [0, 0, 0.5], "orientation": {"axis": [0, 1, 0], "angle_deg": 90},
              "shape": {"type": "disc", "radius": 0.1}, "velocity": 2, "start": 0.5}],
             "outlets": [{"name": "drain", "region": {"type": "box", "min": [-1, -1, -1], "max": [1, 1, -0.9]}}],)")));
  const Scene scene = parse(json.dump(), "scene.json");
  EXPECT_NO_THROW(validate(scene, "scene.json"));
  const std::vector<LiquidInlet>& inlets = scene.sph->inlets;
  ASSERT_EQ(inlets.size(), 2u);
  EXPECT_NEAR(inlets[0].speed(), 1, 1e-12);
  EXPECT_NEAR(inlets[1].area(), 0.0314159265, 1e-9);
  EXPECT_NEAR(inlets[1].pose.q_WB.rotate({0, 0, 1}).x, 1, 1e-12);
  ASSERT_EQ(scene.sph->outlets.size(), 1u);
  EXPECT_EQ(std::get<Box>(scene.sph->outlets[0].region).max.z, -0.9);
}

TEST(Sph, SensorsAndPairsAreRead) {
  const nlohmann::json json =
      good_scene().patch(nlohmann::json::parse(SPH(LIQUID(R"("shifting": 5,)"), TUB R"("sensors": [
             {"type": "load", "name": "thrust", "wall": "tub", "position": [0, 0, 1], "axis": [0, 1, 0]},
             {"type": "load", "name": "on_all"},
             {"type": "level", "name": "gauge", "position": [0.1, 0.1, 0]},
             {"type": "pressure", "name": "probe", "position": [0.1, 0.1, 0]},
             {"type": "region", "name": "half", "shape": {"type": "box", "size": [1, 1, 1]}, "flow": "x"}],
             "pairs": [{"liquid": "water", "body": "ground", "wall_friction": "free_slip"}],)")));
  const Scene scene = parse(json.dump(), "scene.json");
  EXPECT_NO_THROW(validate(scene, "scene.json"));
  EXPECT_EQ(scene.sph->liquids[0].shifting, 5);
  ASSERT_EQ(scene.sph->sensors.size(), 5u);
  ASSERT_EQ(scene.sph->pairs.size(), 1u);
  EXPECT_EQ(scene.sph->pairs[0].wall_friction, WallFriction::free_slip);
  std::vector<std::string> columns = sensor_columns(scene);
  std::erase_if(columns, [](const std::string& column) { return column.starts_with("half."); });
  const std::vector<std::string> expected = {
      "thrust.force.x",  "thrust.force.y",     "thrust.force.z",  "thrust.torque.x", "thrust.torque.y",
      "thrust.torque.z", "thrust.axis_torque", "on_all.force.x",  "on_all.force.y",  "on_all.force.z",
      "on_all.torque.x", "on_all.torque.y",    "on_all.torque.z", "gauge.level",     "probe.pressure"};
  columns.erase(columns.begin(), std::ranges::find(columns, expected.front()));
  EXPECT_EQ(columns, expected);
}

TEST(Sph, IsRead) {
  const nlohmann::json json = good_scene().patch(
      nlohmann::json::parse(SPH(LIQUID(R"("velocity": [1, 0, 0], "pressure": "zero", "expected_speed": 3,)"),
                                R"("wall_friction": "free_slip", "precision": "double", "micro_step": 1e-4,
             "walls": [{"name": "tub", "body": "crate", "shape": {"type": "box", "size": [1, 1, 1], "open": ["+z"]}}],)")));
  const Scene scene = parse(json.dump(), "scene.json");
  EXPECT_NO_THROW(validate(scene, "scene.json"));
  ASSERT_TRUE(scene.sph && scene.sph->liquids.size() == 1);
  const Liquid& liquid = scene.sph->liquids[0];
  EXPECT_EQ(liquid.density, 1000);
  EXPECT_EQ(liquid.velocity.value().x, 1);
  EXPECT_EQ(liquid.expected_speed, 3);
  EXPECT_FALSE(liquid.sound_speed);
  EXPECT_EQ(liquid.pressure, StartPressure::zero);
  EXPECT_EQ(scene.sph->wall_friction, WallFriction::free_slip);
  EXPECT_EQ(scene.sph->precision, LiquidPrecision::full);
  EXPECT_EQ(scene.sph->walls.size(), 1u);
  EXPECT_EQ(scene.walls().size(), scene.dem->walls.size() + 1);
  EXPECT_LE(scene.domain().min.x, -1);
}

// A wall of both lists is one surface.
TEST(Sph, WallsOfTheSameNameAreOneSurface) {
  nlohmann::json json = good_scene().patch(nlohmann::json::parse(SPH(LIQUID(""), "")));
  nlohmann::json wall = json["dem"]["walls"][0];
  wall.erase("material");
  wall.erase("surface_velocity");
  json["sph"]["walls"] = {wall};
  const Scene scene = parse(json.dump(), "scene.json");
  EXPECT_EQ(scene.walls().size(), scene.dem->walls.size());
  json["sph"]["walls"][0]["position"] = {0, 0, 0.123};
  EXPECT_THROW(parse(json.dump(), "scene.json"), Error);
}

const WrongScene wrong_sph[] = {
    {"NoDensity", SPH(R"({"name": "water", "viscosity": 0, "fill": []})", ""),
     "sph.liquids[0]: the key 'density' is missing (add density, or use a name of docs/materials.md, whose "
     "figures are known)"},
    {"TwoLiquids",
     SPH(LIQUID("") R"(, {"name": "oil", "density": 900, "viscosity": 0.1,
         "fill": [{"type": "box", "min": [0, 0, 0.2], "max": [0.2, 0.2, 0.3]}]})",
         ""),
     "sph.liquids[1]: 'oil' is a second liquid, and the solver computes one (leave one of them)"},
    {"GramsPerCubicCentimetre",
     SPH(R"({"name": "oil", "density": 0.88, "viscosity": 0.1,
             "fill": [{"type": "box", "min": [0, 0, 0], "max": [0.2, 0.2, 0.1]}]})",
         ""),
     "sph.liquids[0].density: no liquid has a density of 0.88 kg/m3; they are from 50 to 25000 kg/m3 (1 "
     "g/cm3 is "
     "1000 kg/m3: give 880)"},
    {"Gas",
     SPH(R"({"name": "air", "density": 0.01, "viscosity": 1e-5,
             "fill": [{"type": "box", "min": [0, 0, 0], "max": [0.2, 0.2, 0.1]}]})",
         ""),
     "sph.liquids[0].density: no liquid has a density of 0.01 kg/m3; they are from 50 to 25000 kg/m3 (water "
     "has "
     "1000 kg/m3)"},
    {"InsideWithoutAmount", INSIDE(R"("wall": "tub")"),
     "sph.liquids[0].fill[0]: the fill has neither level nor volume nor mass (give one of them)"},
    {"InsideWithBoth", INSIDE(R"("wall": "tub", "level": 0.1, "volume": 1)"),
     "sph.liquids[0].fill[0]: the fill has a level and a volume (give one of them)"},
    {"InsideWithLevelAndMass", INSIDE(R"("wall": "tub", "level": 0.1, "mass": 1)"),
     "sph.liquids[0].fill[0]: the fill has a level and a mass (give one of them)"},
    {"InsideOfNoWall", INSIDE(R"("wall": "tup", "level": 0.1)"),
     "sph.liquids[0].fill[0].wall: there is no wall 'tup' (did you mean 'tub'?)"},
    {"InsideOfAPlane", INSIDE(R"("wall": "floor", "level": 0.1)"),
     "sph.liquids[0].fill[0].wall: 'floor' is a plane, which has no inside (name a wall that ends on all "
     "sides, "
     "or fill a box)"},
    {"PairOfNoBody",
     SPH(LIQUID(""), R"("pairs": [{"liquid": "water", "body": "crate", "wall_friction": "no_slip"}],)"),
     "sph.pairs[0].body: there is no wall of the liquid on 'crate' (name a body that has one)"},
    {"EquilibriumOfALiquidThatMoves",
     "[" SPH_WITH(
         LIQUID(R"("velocity": [0.1, 0, 0],)"),
         R"("walls": [{"name": "skin", "body": "arm", "shape": {"type": "sphere", "radius": 0.1}}],)") R"(, {"op": "add", "path": "/mbd/start", "value": "equilibrium"},
             {"op": "add", "path": "/mbd/bodies/3/velocity", "value": [0, 0, 0]}, {"op": "add", "path": "/mbd/bodies/3/angular_velocity", "value": [0, 0, 0]}, {"op": "add", "path": "/mbd/joints/0/rate", "value": 0}])",
     "sph.liquids[0].velocity: the liquid moves at the start, and an equilibrium is at rest (leave velocity "
     "out, or mbd.start)"},
    {"SamePair",
     SPH(LIQUID(""), TUB R"("pairs": [{"liquid": "water", "body": "ground", "wall_friction": "no_slip"},
             {"liquid": "water", "body": "ground", "wall_friction": "free_slip"}],)"),
     "sph.pairs[1]: is the same pair as sph.pairs[0] (leave one of them out)"},
    {"SensorOfNoWall", SPH(LIQUID(""), TUB R"("sensors": [{"type": "load", "name": "l", "wall": "tup"}],)"),
     "sph.sensors[0].wall: there is no wall 'tup' (did you mean 'tub'?)"},
    {"SensorOfWallAndBody",
     SPH(LIQUID(""), TUB R"("sensors": [{"type": "load", "name": "l", "wall": "tub", "body": "ground"}],)"),
     "sph.sensors[0].body: the sensor has a wall, and the body follows from it (leave one of them out)"},
    {"SensorBeyondTheDomain",
     SPH(LIQUID(""), TUB R"("sensors": [{"type": "pressure", "name": "p", "position": [0, 0, 3]}],)"),
     "sph.sensors[0].position: the point at [0, 0, 3] lies outside sph.domain, where no liquid is (move it "
     "into the "
     "domain)"},
    {"SensorOnABodyWithoutWalls",
     SPH(LIQUID(""),
         TUB R"("sensors": [{"type": "level", "name": "l", "body": "crate", "position": [0, 0, 0]}],)"),
     "sph.sensors[0].body: the body 'crate' carries no wall (the particles know where bodies with walls are: "
     "name one "
     "of those)"},
    {"SensorWithTheNameOfABody",
     SPH(LIQUID(""), TUB R"("sensors": [{"type": "pressure", "name": "crate", "position": [0, 0, 0]}],)"),
     "sph.sensors[0].name: a body, joint, element or part of the results is called 'crate' as well, so that "
     "columns "
     "would be mixed up (give the sensor another name, such as 'crate_content')"},
    {"SoundSpeedAndExpectedSpeed", SPH(LIQUID(R"("sound_speed": 20, "expected_speed": 2,)"), ""),
     "sph.liquids[0].expected_speed: the speed of sound is given, and expected_speed is for choosing it "
     "(leave "
     "one of them out)"},
    {"PartOfASpacing", FILL(R"({"type": "box", "min": [0, 0, 0], "max": [0.2, 0.21, 0.1]})"),
     "sph.liquids[0].fill[0].max[1]: the box is 0.21 m wide along y, which is 10.5 times sph.spacing "
     "(particles "
     "are cubes of one spacing: give 0.2 or 0.22, or a spacing of 0.021)"},
    {"EmptyBox", FILL(R"({"type": "box", "min": [0, 0, 0], "max": [0.2, 0, 0.1]})"),
     "sph.liquids[0].fill[0].max[1]: 0 m is not above the minimum of 0 m (min < max along each axis)"},
    {"BeyondTheDomain", FILL(R"({"type": "box", "min": [0, 0, 0], "max": [0.2, 0.2, 1.2]})"),
     "sph.liquids[0].fill[0].max[2]: 1.2 m is outside the domain, which ends at 1 m (enlarge sph.domain or "
     "move "
     "the fill)"},
    {"Twice", FILL(R"({"type": "box", "min": [0, 0, 0], "max": [0.2, 0.2, 0.1]},
             {"type": "box", "min": [0.1, 0, 0], "max": [0.3, 0.2, 0.1]})"),
     "sph.liquids[0].fill[1]: the box overlaps sph.liquids[0].fill[0] (the liquid would be there twice: let "
     "the "
     "boxes touch)"},
    {"FollowsNoBody", FOLLOWING("", "crat"),
     "sph.domain.follows: unknown name 'crat' (did you mean 'crate'?)"},
    {"FollowsABodyWithoutWalls", FOLLOWING("", "arm"),
     "sph.domain.follows: the body 'arm' carries no wall of the liquid (the solver of the liquid knows where "
     "bodies with walls are: name one of those)"},
    {"FollowsAlongAPlane",
     FOLLOWING(R"("walls": [{"name": "tub", "body": "arm", "shape": {"type": "sphere", "radius": 0.5}},
        {"name": "floor", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],)",
               "arm"),
     "sph.domain.follows: the plane 'floor' ends where the domain is at the start, and is not on 'arm' (give "
     "it as a box or a mesh that reaches along the whole way, or leave out follows)"},
    {"FollowsWithAnInlet",
     FOLLOWING(R"("walls": [{"name": "tub", "body": "arm", "shape": {"type": "sphere", "radius": 0.5}}],
        "inlets": [{"name": "pipe", )" RECTANGLE R"(, "velocity": 1}],)",
               "arm"),
     "sph.domain.follows: inlets are on the ground, and the domain leaves it (leave out inlets or follows)"},
    {"LongStep", SPH(LIQUID(""), R"("micro_step": 0.5,)"),
     "sph.micro_step: the micro step of 0.5 s is longer than the window of 0.001 s (a window holds whole "
     "steps)"},
    {"NoSpeedOfSound",
     "[" SPH_WITH(LIQUID(""), "") R"(, {"op": "add", "path": "/gravity", "value": [0, 0, 0]}])",
     "sph.liquids[0]: no speed of sound follows: there is no gravity, and no speed is expected (give "
     "expected_speed, the largest speed that the run will have [m/s], or sound_speed)"},
    {"InletWithoutFlow", INLET(RECTANGLE),
     "sph.inlets[0]: the inlet has neither velocity nor flow (give one of them)"},
    {"InletWithBoth", INLET(RECTANGLE R"(, "velocity": 1, "flow": 1)"),
     "sph.inlets[0]: the inlet has a velocity and a flow (give one of them)"},
    {"InletOfPartsOfASpacing",
     INLET(R"("position": [0, 0, 0.5], "velocity": 1, "shape": {"type": "rectangle", "size": [0.05, 0.08]})"),
     "sph.inlets[0].shape.size[0]: the inlet is 0.05 m wide, which is 2.5 times sph.spacing (particles are "
     "cubes of one spacing: give 0.04 or 0.06)"},
    {"InletBelowASpacing",
     INLET(R"("position": [0, 0, 0.5], "velocity": 1, "shape": {"type": "disc", "radius": 0.01})"),
     "sph.inlets[0].shape.radius: the radius of 0.01 m is less than sph.spacing (give at least 0.02)"},
    {"InletBeyondTheDomain",
     INLET(R"("position": [0, 0, 0.99], "velocity": 1, "shape": {"type": "disc", "radius": 0.1})"),
     "sph.inlets[0].position: the inlet, with two spacings in front of it, reaches to [-0.1, -0.1, 1.03] m, "
     "outside the domain (enlarge sph.domain or move the inlet)"},
    {"InletThatEndsBeforeItStarts", INLET(RECTANGLE R"(, "velocity": 1, "start": 2, "end": 1)"),
     "sph.inlets[0].end: the inlet ends at 1 s, and starts at 2 s (give a later end)"},
    {"InletBeyondTheSpeedOfSound",
     SPH(LIQUID(R"("sound_speed": 20,)"),
         R"("inlets": [{"name": "pipe", )" RECTANGLE R"(, "velocity": 3}],)"),
     "sph.inlets[0]: the liquid comes in with 3 m/s, more than a tenth of sound_speed (give a sound_speed of "
     "30 m/s or more, or a larger inlet)"},
    {"OutletBeyondTheDomain",
     SPH(LIQUID(""),
         R"("outlets": [{"name": "drain", "region": {"type": "plane", "point": [0, 0, -2], "normal": [0, 0, -1]}}],)"),
     "sph.outlets[0].region: no place of sph.domain is in it, so that no particle goes out (move it into the "
     "domain)"},
    {"NoLiquidAtAll", SPH(R"({"name": "water", "density": 1000, "viscosity": 0.001, "fill": []})", ""),
     "sph.liquids[0].fill: there is no liquid: nothing is filled, and no inlet brings any (give a fill or an "
     "inlet)"},
    {"EndlessCylinder",
     SPH(LIQUID(""), R"("walls": [{"name": "pipe", "shape": {"type": "cylinder", "radius": 1}}],)"),
     "sph.walls[0].shape: the cylinder is endless, and the liquid knows no such wall (give it a height)"},
    {"PlaneOnABody",
     SPH(LIQUID(""),
         R"("walls": [{"name": "lid", "body": "crate", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],)"),
     "sph.walls[0].shape: the plane is on a body that moves, and the liquid knows no endless walls there "
     "(give a "
     "face of a box: a box with five open faces)"},
    {"MaterialOfAWall",
     SPH(LIQUID(""),
         R"("walls": [{"name": "lid", "material": "steel", "shape": {"type": "box", "size": [1, 1, 1]}}],)"),
     "sph.walls[0]: unknown key 'material' (known keys: body, color, name, orientation, position, "
     "relative_to, "
     "shape)"},
};

INSTANTIATE_TEST_SUITE_P(Sph, WrongSceneTest, testing::ValuesIn(wrong_sph), name_of_case);

}  // namespace
}  // namespace tandem::scene::test
