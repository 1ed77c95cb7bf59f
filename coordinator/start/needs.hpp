// What a scene needs of its solvers, in capability bits, and what can be run with the solvers that are there.
#pragma once

#include <string>
#include <vector>

#include "common/error.hpp"
#include "common/scene/model.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

// A capability, and the setting that needs it.
struct Need {
  protocol::Capability capability;
  std::string by;      // "scheme 'implicit'"
  std::string remedy;  // how to do without, other than by another scheme: "leave out coupling.adaptive"
};

// Only what the scheme and the other settings use: `mbd_first` predicts nothing.
std::vector<Need> needs_of(protocol::Role role, const scene::Scene& scene);
// The same as bits.
std::uint64_t needed_of(protocol::Role role, const scene::Scene& scene);

// "rollback (save and restore)"
std::string in_words(protocol::Capability capability);

// What a participant has sent at registration.
struct Offer {
  protocol::Role role{};
  std::string program;  // "liggghts 3.8"
  std::uint64_t capabilities = 0;
};

// Names of the schemes that run with these participants, and with which the scene's other settings are valid.
std::vector<std::string> possible_schemes(const scene::Scene& scene, const std::vector<Offer>& offers);

// A scene that the solvers of the run cannot run.
struct UnmetNeed : Error {
  using Error::Error;
};

// Throws UnmetNeed with the setting, the capability, the program without it, and the schemes that are
// possible. `besides` is needed of every participant.
void expect_capabilities(const scene::Scene& scene, const std::vector<Need>& besides,
                         const std::vector<Offer>& offers);

}  // namespace tandem::launch
