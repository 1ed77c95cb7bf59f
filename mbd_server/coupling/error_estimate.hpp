// Estimates the error of a run with fixed steps at its end, by comparison with two runs of the same motion
// with steps r and 2 r times as long. The error of a method of second order is
//   (y(r h) - y(h)) / (r^2 - 1)
// (Richardson; Hairer, Norsett, Wanner, Solving ODEs I, II.4), provided that all three runs are in the
// asymptotic range. There the differences of the two runs from y(h) have the ratio (4 r^2 - 1) / (r^2 - 1):
// where it is off by more than a factor of two, no estimate is given.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mbd_server/io/observation.hpp"
#include "protocol/facts.hpp"

namespace tandem::mbd {

struct ErrorEstimate {
  // The largest values over all bodies: distance of the centre of mass from its exact position, and angle
  // from the exact orientation.
  std::optional<double> position{}, rotation{};  // [m], [rad]
  // The largest error of a coordinate, relative to how far it has moved in the run.
  std::optional<double> motion{};     // [-]
  std::optional<double> energy{};     // [J]
  std::string reason{};               // why one of them is absent
  double steps = 0, cpu_seconds = 0;  // cost of the two further runs
};

inline constexpr const char* unresolved =
    "longer steps, with which it is measured, do not resolve the motion";

// The end of one run.
struct RunEnd {
  std::vector<Pose> bodies;
  double energy = 0;  // [J]
  double steps = 0;   // taken
  // The error of a method of second order grows with the sum of the cubes of its steps [s3].
  double cubed_steps = 0;
  // Largest difference of a coordinate from the run that is judged, relative to how far it has moved [-].
  double motion = 0;
};

ErrorEstimate estimate_error(const RunEnd& run, const RunEnd& coarse, const RunEnd& coarser);

// The same where these runs are not in the asymptotic range, but with steps that are only twice and four
// times as long: the difference of the first one counts as if it were.
void complete_estimate(const RunEnd& run, const RunEnd& coarse, ErrorEstimate& estimate);

// Estimate from one run with steps that are s times shorter: (y(h) - y(h / s)) s^2 / (s^2 - 1). Where the
// steps are `halved`, this is four thirds of the difference, as the numbers of steps do not give s more
// accurately. Two runs cannot show whether they are in the asymptotic range; where they are not, or where
// chaos separates them, the estimate has the size of their distance.
ErrorEstimate estimate_error(const RunEnd& run, const RunEnd& fine, bool halved);

// Adds the estimate to what is reported: `facts`, of which `size` is known, and `others`, upon which nobody
// acts.
void add_error_facts(const ErrorEstimate& error, protocol::MbdFacts& facts, nlohmann::ordered_json& others);

}  // namespace tandem::mbd
