// What a bed of grains costs on several ranks, by measured rates and times of messages. docs/cost_of_ranks.md
// has the assumptions.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "launch/sizing/measured.hpp"

namespace tandem::launch {

inline constexpr double packed_share = 0.6;  // of a bed's volume that spheres fill

// What a rank runs on, and how it reaches the others.
struct RankKind {
  bool gpu = false;
  double step_us = 0;                         // of a micro step without spheres [us]
  double us_per_sphere = 0;                   // and for each sphere [us]
  double bytes_per_sphere = 0;                // in the memory of a rank
  double memory = 0;                          // of a rank [bytes]; 0: not limited here
  std::span<const MeasuredMessage> messages;  // between neighbours of one host
  double agreement_us = 0;                    // per doubling of the ranks of one host [us]
  // What several ranks add beside the messages: to each micro step, and to each rebuild of the lists [us].
  double exchange_us = 0, rebuild_us = 0, rebuild_us_per_sphere = 0;
  double steps_of_list = 1;  // micro steps between two rebuilds
  unsigned per_host = 1;
  // Between hosts. Assumed: nothing of it was measured.
  double network_us = 0;  // latency [us]
  double network_bytes_per_us = 1;
};

struct Bed {
  double spheres = 0;
  double layer = 0;            // spheres that a rank has as ghosts beyond one face
  double bytes_per_ghost = 0;  // that a micro step sends
  double bytes_of_cells = 0;   // of the whole domain, which each rank has
};

struct RankCost {
  double spheres = 0, ghosts = 0;  // of the rank with most
  double memory = 0;               // [bytes]
  double work_us = 0, halo_us = 0, agreement_us = 0;
  double ranks_us = 0;  // kernels that pack and unpack messages, and the share of a rebuild's exchange
  // Of a micro step, whose messages wait for its work [us].
  double step_us() const { return work_us + halo_us + agreement_us + ranks_us; }
};

RankCost cost_of(const Bed& bed, const RankKind& kind, unsigned ranks);

// Spheres of the largest bed of the same shape, density and sizes that fits into so many ranks; `limit`
// receives what ends it.
double largest_bed(const Bed& bed, const RankKind& kind, unsigned ranks, std::string& limit);

enum class Flow { settled, flowing };
// One H100, and one core, under `hertz_mindlin` or without friction, in mixed precision. Other variants take
// longer (Plan says so).
RankKind gpu_kind(Flow flow, bool friction);
RankKind core_kind(Flow flow);

// A cube of a settled bed of this many spheres for each rank, on top of each other: the bed of weak scaling.
Bed tower_of_cubes(double spheres_per_rank, unsigned ranks);

}  // namespace tandem::launch
