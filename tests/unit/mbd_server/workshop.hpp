// A machine that has every part which acts in motion: redundant loop, gear, rack and pinion, cut screw,
// stops, friction, tables, bushing, actuator, loads that the particles would bring.
#pragma once

#include "common/scene/model.hpp"

namespace tandem::mbd {

// A crank-rocker drives a geared wheel, that one a rack between stops; a spindle moves a nut; a pod hangs on
// the coupler bar. Joints: 0 crank, 4 wheel, 5 rack, 6 spindle; boundary bodies: 1 (bar), 6 (pod).
scene::Scene workshop();

}  // namespace tandem::mbd
