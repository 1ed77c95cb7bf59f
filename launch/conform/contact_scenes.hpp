// Small scenes of the judge in which spheres touch each other, and spheres and liquids come in and leave
// (scenes.hpp has the list).
#pragma once

namespace tandem::conform {

extern const char* const impact_scene;
extern const char* const stack_scene;
extern const char* const trays_scene;
extern const char* const inlets_scene;
extern const char* const outlet_scene;
extern const char* const spout_scene;
extern const char* const drain_scene;

}  // namespace tandem::conform
