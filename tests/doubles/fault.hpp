// The fault of a faulty server (faulty_mbd_server.cpp, faulty_dem_server.cpp, faulty_sph_server.cpp). The
// environment variable TANDEM_FAULT is a JSON object: "share" is the part of the loads that gets lost;
// "torques" and "forces" are the parts of torques and forces that get lost although they are reported as
// applied; "late" is the part of a load that is given in the next window; "report" has keys of the final
// report with false values; and in window "spoil" one number of an answer of advance is wrong by 0.125. The
// particle solver fails in window "fails", and with "on_ground" gives the loads of all bodies to the ground.
// The energy of the bodies in the results is wrong by "energy" [J], the poses of a body by the share "stray"
// of its way, with "no_joints" its joints hold nothing, with "frozen" bodies with walls keep their
// orientation, and the multibody server ends with the status "status". The bodies of the multibody solver are
// displaced along z [m]: by "start" in the state before the first window, by "jump" at the begin of each
// window, by "frame" in the results, by "resume" after they were read from a file. The liquid reports
// "passed" particles that passed walls, and the share "energy_share" of its energy as the residual of the
// balance.
#pragma once

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "protocol/messages.hpp"

namespace tandem::test {

inline nlohmann::ordered_json fault() {
  const char* text = std::getenv("TANDEM_FAULT");
  return nlohmann::ordered_json::parse(text ? text : "{}");
}

inline protocol::Report with_fault(protocol::Report report) {
  const auto replaced = fault().value("report", nlohmann::ordered_json::object());
  auto facts = nlohmann::ordered_json::parse(report.facts);
  facts.update(replaced);
  report.facts = facts.dump();
  return report;
}

}  // namespace tandem::test
