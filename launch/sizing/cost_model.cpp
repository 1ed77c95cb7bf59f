#include "launch/sizing/cost_model.hpp"

#include <algorithm>
#include <cmath>

namespace tandem::launch {
namespace {

// A GPU has some memory for its driver, and for the arrays of a window.
constexpr double usable_memory = 0.97;
// Spheres that can be told apart (particles/state/window_progress.hpp).
constexpr double most_spheres = std::int64_t{1} << 30;
// Ghosts reach a diameter and a skin deep, of a tenth.
constexpr double ghost_depth = 1.1;

double doublings(double count) {
  return count > 1 ? std::ceil(std::log2(count)) : 0;
}

// Slope of the time between two runs [us per sphere].
constexpr double slope(const MeasuredRun& small, const MeasuredRun& large) {
  return (large.us_per_micro_step - small.us_per_micro_step) / (large.spheres - small.spheres);
}

double added(const MeasuredPair& pair) {
  return pair.two_us - pair.one_us;
}

// What is added to a step and to a rebuild, from the three pairs: both are of a million spheres in the first
// two, whose lists last for other times.
void add_ranks_of_gpus(RankKind& kind, Flow flow) {
  const double of_rebuild = (added(flowing_pair) - added(settled_pair)) /
                            (1 / flowing_pair.steps_of_list - 1 / settled_pair.steps_of_list),
               of_step = added(settled_pair) - of_rebuild / settled_pair.steps_of_list,
               bytes = 48 * tower_of_cubes(settled_pair.spheres, 2).layer;
  kind.exchange_us = of_step - message_time(between_gpus, bytes) - flag_between_gpus;
  const double large_bytes = 48 * tower_of_cubes(large_pair.spheres, 2).layer,
               of_large = (added(large_pair) - kind.exchange_us - message_time(between_gpus, large_bytes) -
                           flag_between_gpus) *
                          large_pair.steps_of_list;
  kind.rebuild_us_per_sphere = (of_large - of_rebuild) / (large_pair.spheres - settled_pair.spheres);
  kind.rebuild_us = of_rebuild - kind.rebuild_us_per_sphere * settled_pair.spheres;
  kind.steps_of_list = (flow == Flow::settled ? settled_pair : flowing_pair).steps_of_list;
}

}  // namespace

double message_time(std::span<const MeasuredMessage> measured, double bytes) {
  if (bytes <= measured.front().bytes) return measured.front().us;
  const auto above = std::ranges::find_if(measured, [&](const auto& m) { return m.bytes >= bytes; });
  if (above == measured.end()) return measured.back().us * bytes / measured.back().bytes;
  const auto below = std::prev(above);
  return below->us + (above->us - below->us) * (bytes - below->bytes) / (above->bytes - below->bytes);
}

// Ranks are slabs: one has a face to the rank below and one to that above.
RankCost cost_of(const Bed& bed, const RankKind& kind, unsigned ranks) {
  RankCost cost;
  cost.spheres = bed.spheres / ranks;
  const double faces = std::min(ranks - 1, 2u), hosts = std::ceil(static_cast<double>(ranks) / kind.per_host);
  // A rank cannot have more ghosts than the others have spheres.
  cost.ghosts = std::min(faces * bed.layer, bed.spheres - cost.spheres);
  cost.memory = (cost.spheres + cost.ghosts) * kind.bytes_per_sphere;
  if (ranks > 1) cost.memory += bed.bytes_of_cells * (1 - 1.0 / ranks);
  cost.work_us = kind.step_us + kind.us_per_sphere * cost.spheres;
  if (ranks == 1) return cost;
  // Pairs across a face are computed on both sides where a pair is computed once: half of the pairs of a
  // sphere in its layer, of which half belong to the other rank.
  if (!kind.gpu) cost.work_us += kind.us_per_sphere * 0.25 * cost.ghosts;
  cost.halo_us = message_time(kind.messages, cost.ghosts * bed.bytes_per_ghost);
  cost.agreement_us = kind.agreement_us * doublings(std::min(ranks, kind.per_host));
  cost.ranks_us =
      kind.exchange_us + (kind.rebuild_us + kind.rebuild_us_per_sphere * cost.spheres) / kind.steps_of_list;
  if (hosts > 1) {
    const double across = kind.network_us + bed.layer * bed.bytes_per_ghost / kind.network_bytes_per_us;
    cost.halo_us = std::max(cost.halo_us, across);
    cost.agreement_us += kind.network_us * doublings(hosts);
  }
  return cost;
}

double largest_bed(const Bed& bed, const RankKind& kind, unsigned ranks, std::string& limit) {
  const auto memory_of = [&](double spheres) {
    Bed larger = bed;
    const double size = spheres / bed.spheres;
    larger.spheres = spheres;
    larger.layer *= std::pow(size, 2.0 / 3);
    larger.bytes_of_cells *= size;
    return cost_of(larger, kind, ranks).memory;
  };
  limit = "ids of spheres end there";
  if (kind.memory <= 0 || memory_of(most_spheres) <= usable_memory * kind.memory) return most_spheres;
  limit = "memory";
  double low = 0, high = most_spheres;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (memory_of(middle) <= usable_memory * kind.memory ? low : high) = middle;
  }
  return low;
}

RankKind gpu_kind(Flow flow, bool friction) {
  RankKind kind;
  kind.gpu = true;
  // Without spheres: where the line through two drums begins.
  const double of_drum = slope(small_drum_on_gpu, drum_on_gpu);
  kind.step_us = small_drum_on_gpu.us_per_micro_step - of_drum * small_drum_on_gpu.spheres;
  const MeasuredRun& settled = friction ? settled_on_gpu : frictionless_on_gpu;
  const double of_settled = settled.us_per_micro_step / settled.spheres,
               with_friction = settled_on_gpu.us_per_micro_step / settled_on_gpu.spheres;
  // Flowing beds without friction were not measured: as much longer as those with it.
  kind.us_per_sphere = flow == Flow::settled ? of_settled : of_drum * of_settled / with_friction;
  kind.bytes_per_sphere = settled.memory_MB * 1e6 / settled.spheres;
  kind.memory = 80e9;
  kind.messages = between_gpus;
  kind.agreement_us = flag_between_gpus;
  add_ranks_of_gpus(kind, flow);
  kind.per_host = 8;
  kind.network_us = 12;
  kind.network_bytes_per_us = 20e3;  // 20 GB/s
  return kind;
}

RankKind core_kind(Flow flow) {
  RankKind kind;
  const MeasuredRun& run = flow == Flow::settled ? settled_on_core : drum_on_core;
  kind.us_per_sphere = run.us_per_micro_step / run.spheres;
  kind.bytes_per_sphere = drum_on_core.memory_MB * 1e6 / drum_on_core.spheres;
  kind.messages = between_cores;
  kind.agreement_us = maximum_over_two_cores;
  kind.per_host = ~0u;
  return kind;
}

Bed tower_of_cubes(double spheres_per_rank, unsigned ranks) {
  constexpr double sphere = 0.5235987755982988;                             // of the cube of a diameter
  const double edge = std::cbrt(spheres_per_rank * sphere / packed_share);  // [diameters]
  Bed bed;
  bed.spheres = spheres_per_rank * ranks;
  bed.layer = edge * edge * ghost_depth * packed_share / sphere;
  bed.bytes_per_ghost = 48;
  bed.bytes_of_cells = 4 * bed.spheres * sphere / packed_share / std::pow(ghost_depth, 3);
  return bed;
}

}  // namespace tandem::launch
