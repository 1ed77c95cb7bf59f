// All members of EngineOf: for the contacts of spheres in frames, for several ranks, for single spheres, for
// the sums of walls and of dissipated energy, for the tangents of contacts with bodies, and for the state of
// all ranks.
#pragma once

#include "dem_server/engine/engine_contacts.hpp"
#include "dem_server/engine/engine_ranks.hpp"
#include "dem_server/engine/engine_spheres.hpp"
#include "dem_server/engine/engine_sums.hpp"
#include "dem_server/engine/engine_tangents.hpp"
#include "dem_server/engine/engine_whole_state.hpp"
