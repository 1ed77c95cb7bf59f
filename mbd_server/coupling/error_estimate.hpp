// How wrong a run with fixed steps is at its end, by comparison with two runs of the same motion with steps r
// and 2 r times as long. The error of a method of second order is
//   (y(r h) - y(h)) / (r^2 - 1)
// (Richardson; Hairer, Norsett, Wanner, Solving ODEs I, II.4), provided that all three runs are in the range
// of that order. There the differences of the two runs from y(h) are as (4 r^2 - 1) to (r^2 - 1): where they
// are not within a factor of two of that, nothing is estimated.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbd_server/io/observation.hpp"

namespace tandem::mbd {

struct ErrorEstimate {
  // The largest of all bodies: distance of the centre of mass from its true place, angle from the true
  // orientation.
  std::optional<double> position, rotation;  // [m], [rad]
  std::optional<double> energy;              // [J]
  std::string reason;                        // why one of them is absent
  double steps = 0, cpu_seconds = 0;         // that the two further runs took
};

inline constexpr const char* unresolved =
    "longer steps, with which it is measured, do not resolve the motion";

// The end of one run.
struct RunEnd {
  std::vector<Pose> bodies;
  double energy = 0;  // [J]
  double steps = 0;   // taken
};

// Steps of the first of the two further runs, the second has half as many: both together a thirteenth of the
// steps of the run. Longer steps take more Newton iterations: in processor time the share is up to a tenth.
double steps_for_estimate(double steps);

ErrorEstimate estimate_error(const RunEnd& run, const RunEnd& coarse, const RunEnd& coarser);

// By one run with shorter steps, s times as many: (y(h) - y(h / s)) s^2 / (s^2 - 1), four thirds of the
// difference where steps are `halved`, and not known better by their numbers. Nothing tells whether both runs
// are in the range of the order; where they are not, or chaos takes them apart, the figure is of the size of
// their distance.
ErrorEstimate estimate_error(const RunEnd& run, const RunEnd& fine, bool halved);

// Keys of summary.json, as a JSON object; `size` of the machine [m].
std::string error_facts(const ErrorEstimate& error, double size);

}  // namespace tandem::mbd
