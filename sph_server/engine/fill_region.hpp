// A liquid at rest below a level inside a closed mesh, at the start of a run.
#pragma once

#include <functional>

#include "sph_server/engine/fill_amount.hpp"
#include "sph_server/engine/liquid_engine.hpp"

namespace tandem::sph {

// A region that is filled. Walls: those of a setup with their poses; they enclose the region, up to the level
// at least.
struct Filling {
  // In world axes, closed up to the level; where it has cavities, their triangles are wound the other way.
  TriangleMesh region;
  FillAmount amount;
  Mat3d axes = Mat3d::identity();  // of the region, which the lattice follows as far as gravity lets it
};

// Called after each step of the relaxation: done of all. What it throws ends the filling.
using AfterStep = std::function<void(int done, int all)>;

struct FilledPlaces {
  std::vector<Vec3d> position;  // [m]
  double surface = 0;           // height against gravity [m]
  bool relaxed = false;         // false: the lattice fits between the walls
};

// Places of the particles. Where a lattice up to the level fits between the walls, as in a box of whole
// spacings, it is taken, its layers as much closer together as the column of liquid is compressed. Elsewhere
// a lattice is cut at the walls (cut_lattice.hpp), and the particles are relaxed on the back end of
// the setup under a lid at their surface: always as many steps, so that the time is known beforehand, first
// under a high pressure that spreads them evenly, then under a low one, against which walls repel those that
// came too near to them. Few that were squeezed out of the region are put back, and all are relaxed again.
// The places are the same for every back end and number of threads.
// Error{scene} as filled_part() and cut_lattice(), and where particles leave the region again and again; they
// may pass sheets.
FilledPlaces fill_places(const LiquidSetup& setup, const std::vector<particles::BodyPose>& poses,
                         const Filling& filling, const AfterStep& after_step = {});

// The liquid at rest with places that were relaxed, under the hydrostatic pressure that its compression
// states. Error{scene} as filled_part(), Error{protocol} where their number is not that of its mass.
LiquidState at_rest_in(const LiquidSetup& setup, const Filling& filling, const std::vector<Vec3d>& places);

LiquidState fill_region(const LiquidSetup& setup, const std::vector<particles::BodyPose>& poses,
                        const Filling& filling);

}  // namespace tandem::sph
