// Results over time of the machine elements: of each force of the scene, each coupler, each joint with a
// prescribed motion, damping, friction or limits, and each output of contacts. They are the columns
// ELEMENT.CHANNEL of elements.csv.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::scene {

enum class Channel {
#define ELEMENT_CHANNEL(identifier, name, unit, meaning) identifier,
#include "common/scene/element_channels.def"
#undef ELEMENT_CHANNEL
  count
};
const char* name(Channel channel);
const char* unit(Channel channel);  // "N m"; "-": none

struct ElementColumn {
  Channel channel{};
  int part = 0;      // of a channel with several columns: axis, or joint of a coupler
  std::string name;  // "lift.pressure_a", "mount.force.x", "gearbox.torque.wheel"
};

struct ElementOfScene {
  enum class Source { joint, coupler, force, contact } source{};
  std::size_t index = 0;  // in mbd.joints, mbd.couplers, mbd.forces or mbd.contact.outputs
  std::string kind;       // type of the force or coupler in the scene, "joint" or "contact"
  // Its name; "KIND:NAME" for a force whose name a joint or a coupler has too, or a coupler whose name a
  // joint has.
  std::string name;
  std::vector<ElementColumn> columns;
};

// In the order of the columns: joints, couplers, forces, contacts. Empty without any.
std::vector<ElementOfScene> elements_of(const Scene& scene);

// Without "time". The values travel in this order (protocol::BodiesFrame).
std::vector<std::string> element_columns(const Scene& scene);

// The table of docs/results.md.
std::string element_channels_as_markdown();

}  // namespace tandem::scene
