// A machine with every kind of part that acts in motion: redundant loop, gear, rack and pinion, cut screw,
// stops, friction, tables, bushing, actuator, loads as from particles.
#pragma once

#include "common/scene/model.hpp"

namespace tandem::mbd {

// A crank-rocker drives a geared wheel, which drives a rack between stops; a spindle moves a nut; a pod is
// suspended from the coupler bar. Joints: 0 crank, 4 wheel, 5 rack, 6 spindle; boundary bodies: 1 (bar), 6
// (pod).
scene::Scene workshop();

}  // namespace tandem::mbd
