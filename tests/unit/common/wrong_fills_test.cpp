// Wrong scenes: packings, sizes, fills from runs.
#include "tests/unit/common/wrong_scene.hpp"

namespace tandem::scene::test {
namespace {

#define PACKING(fill) R"([{"op": "replace", "path": "/dem/particles/0/fill", "value": )" fill "}]"
#define SIZES(sizes)                                                                               \
  R"([{"op": "replace", "path": "/dem/particles/0/fill",)"                                         \
  R"("value": {"type": "packing", "count": 20, "region": {"type": "inside", "wall": "inside"}}},)" \
  R"({"op": "remove", "path": "/dem/particles/0/radius"},)"                                        \
  R"({"op": "add", "path": "/dem/particles/0/sizes", "value": )" sizes "}]"

const WrongScene wrong_fills[] = {
    {"MassAndCount",
     PACKING(R"({"type": "packing", "mass": 1, "count": 5, "region": {"type": "inside", "wall": "inside"}})"),
     "dem.particles[0].fill: the packing has a mass and a count (give one of them, or neither: the region is "
     "then full)"},
    {"UnknownWall", PACKING(R"({"type": "packing", "region": {"type": "inside", "wall": "inside_"}})"),
     "dem.particles[0].fill.region.wall: unknown name 'inside_' (did you mean 'inside'?)"},
    {"VoidFractionOfNothing",
     PACKING(R"({"type": "packing", "void_fraction": 0.1, "region": {"type": "inside", "wall": "inside"}})"),
     "dem.particles[0].fill.void_fraction: the value is 0.1 (give a number from 0.3 to 0.999: share of the "
     "filled volume that is not in a sphere [-])"},
    {"RegionBeyondTheDomain",
     PACKING(R"({"type": "packing", "region": {"type": "box", "min": [0, 0, 0], "max": [1, 1, 4]}})"),
     "dem.particles[0].fill.region: the region reaches from [0, 0, 0] m to [1, 1, 4] m, beyond the domain "
     "(enlarge dem.domain, or move the region)"},
    {"RegionTooNarrow",
     PACKING(R"({"type": "packing", "region": {"type": "box", "min": [0, 0, 0], "max": [1, 0.02, 1]}})"),
     "dem.particles[0].fill.region: the region is 0.02 m wide along y, too narrow for a sphere of radius "
     "0.012 "
     "m (enlarge the region, or give smaller spheres)"},
    {"CylinderWithoutLength",
     PACKING(
         R"({"type": "packing", "region": {"type": "cylinder", "from": [0, 0, 0], "to": [0, 0, 0], "radius": 1}})"),
     "dem.particles[0].fill.region.to: the ends are both at [0, 0, 0] (give two points)"},
    {"BedOfLessThanASphere",
     PACKING(
         R"({"type": "packing", "region": {"type": "above", "wall": "floor", "min": [0, 0], "max": [1, 1], "height": 0.01}})"),
     "dem.particles[0].fill.region.height: 0.01 m is less than the largest diameter of 0.024 m (give a "
     "higher "
     "bed, or smaller spheres)"},
    {"RoomAboveWithoutAnEnd",
     PACKING(
         R"({"type": "packing", "region": {"type": "above", "wall": "floor", "min": [0, 0], "max": [1, 1]}})"),
     "dem.particles[0].fill.region: the room above a wall has no upper end (give the bed a height, or the "
     "fill a "
     "level up to which it reaches)"},
    {"RoomAboveWithTwoEnds",
     PACKING(
         R"({"type": "packing", "level": 1, "region": {"type": "above", "wall": "floor", "height": 0.5}})"),
     "dem.particles[0].fill.level: the bed above a wall has a height (leave out level, or height)"},
    {"HalfARectangle",
     PACKING(
         R"({"type": "packing", "level": 1, "region": {"type": "above", "wall": "floor", "min": [0, 0]}})"),
     "dem.particles[0].fill.region: min without max (give both, or neither: the region is then wherever the "
     "wall is)"},
    {"RoomBetweenAnUnknownWall",
     PACKING(R"({"type": "packing", "region": {"type": "between", "walls": ["inside", "insid"]}})"),
     "dem.particles[0].fill.region.walls[1]: unknown name 'insid' (did you mean 'inside'?)"},
    {"RadiusAndSizes",
     R"([{"op": "add", "path": "/dem/particles/0/sizes", "value": {"type": "list", "radius": [0.01], "mass_fraction": [1]}}])",
     "dem.particles[0].sizes: the group has a radius and sizes (keep one of them)"},
    {"SizesOfALattice",
     R"([{"op": "remove", "path": "/dem/particles/0/radius"},
         {"op": "add", "path": "/dem/particles/0/sizes", "value": {"type": "list", "radius": [0.01], "mass_fraction": [1]}}])",
     "dem.particles[0].sizes: the fill is of type 'lattice', which takes no sizes (give a radius, or a fill "
     "of "
     "type 'packing')"},
    {"PackingWithoutRadius",
     R"([{"op": "remove", "path": "/dem/particles/0/radius"},
         {"op": "replace", "path": "/dem/particles/0/fill", "value": {"type": "packing", "region": {"type": "inside", "wall": "inside"}}}])",
     "dem.particles[0]: the key 'radius' is missing (add radius: a packing needs the radius of its spheres "
     "[m], or sizes)"},
    {"MassFractionsOfLessThanOne",
     SIZES(R"({"type": "list", "radius": [0.01, 0.02], "mass_fraction": [0.3, 0.6]})"),
     "dem.particles[0].sizes.mass_fraction: the sum is 0.9 (the mass fractions add up to 1)"},
    {"ListsOfUnlikeLength", SIZES(R"({"type": "list", "radius": [0.01, 0.02], "mass_fraction": [1]})"),
     "dem.particles[0].sizes: radius has 2 values and mass_fraction 1 (give one for each)"},
    {"SievesDescending", SIZES(R"({"type": "sieve", "size": [0.02, 0.01], "passing": [0, 1]})"),
     "dem.particles[0].sizes.size[1]: 0.01 m follows 0.02 m (give the sieves from the finest to the "
     "coarsest)"},
    {"SieveThatLetsNotAllPass", SIZES(R"({"type": "sieve", "size": [0.01, 0.02], "passing": [0, 0.9]})"),
     "dem.particles[0].sizes.passing[1]: the value is 0.9 (everything passes the coarsest sieve: give 1, "
     "with "
     "the largest diameter as its size)"},
    {"CutThatLeavesNothing",
     SIZES(R"({"type": "normal", "mean": 0.01, "deviation": 0.001, "min": 0.02, "max": 0.03})"),
     "dem.particles[0].sizes: min and max leave 0 of the distribution (let the middle of the distribution be "
     "between min and max, or nearer to them)"},
    {"FixedPacking",
     R"([{"op": "remove", "path": "/dem/particles/0/velocity"},
         {"op": "add", "path": "/dem/particles/0/fixed", "value": true},
         {"op": "replace", "path": "/dem/particles/0/fill", "value": {"type": "packing", "region": {"type": "inside", "wall": "inside"}}}])",
     "dem.particles[0].fixed: spheres of a fill of type 'packing' move (leave out fixed, or give a lattice "
     "or "
     "a file)"},
    {"SettleWithoutGravity",
     R"([{"op": "add", "path": "/gravity", "value": [0, 0, 0]},
         {"op": "add", "path": "/dem/settle", "value": {"kinetic_energy": 1e-6}}])",
     "dem.settle: the scene has no gravity, without which no bed forms (leave out settle, or give gravity)"},
    {"SettleWithoutAnEnergy", R"([{"op": "add", "path": "/dem/settle", "value": {"at_most": 2}}])",
     "dem.settle: the key 'kinetic_energy' is missing (add kinetic_energy: the bed is at rest when the mean "
     "kinetic energy of its spheres is below this [J])"},
    {"SettleOfAnInlet",
     R"([{"op": "replace", "path": "/dem/particles/0/fill", "value":
          {"type": "inlet", "min": [0, 0, 0], "max": [0.5, 0.5, 0.5], "rate": 10}},
         {"op": "add", "path": "/dem/settle", "value": {"kinetic_energy": 1e-6}}])",
     "dem.settle: no sphere that moves is there at the start (leave out settle, or add a group that moves "
     "and "
     "has no inlet)"},
    {"RadiusOfARun", PACKING(R"({"type": "run", "folder": "results"})"),
     "dem.particles[0].radius: radii and velocities are those of the frame of the run (leave it out)"},
};

INSTANTIATE_TEST_SUITE_P(Fills, WrongSceneTest, testing::ValuesIn(wrong_fills), name_of_case);

TEST(Fills, RightOnesAreTaken) {
  EXPECT_EQ(verdict_on_patch(
                PACKING(R"({"type": "packing", "mass": 1, "region": {"type": "inside", "wall": "inside"}})")),
            "no error");
  EXPECT_EQ(verdict_on_patch(SIZES(R"({"type": "sieve", "size": [0.01, 0.02], "passing": [0, 1]})")),
            "no error");
  EXPECT_EQ(verdict_on_patch(
                R"([{"op": "add", "path": "/dem/settle", "value": {"kinetic_energy": 1e-6, "at_most": 2}}])"),
            "no error");
}

}  // namespace
}  // namespace tandem::scene::test
