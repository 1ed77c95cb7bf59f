// Measured times that predictions for several ranks start from. Rates are rows of files in
// tests/benchmark/results, which a test compares. Times of messages between two GPUs are those of
// docs/experiments/2026-11-ranks.md.
#pragma once

#include <span>

namespace tandem::launch {

// A run on one GPU, or on one core.
struct MeasuredRun {
  const char *file, *commit, *scene, *variant;
  double spheres, us_per_micro_step, memory_MB;  // columns of that row
};

inline constexpr MeasuredRun settled_on_gpu{
    "h100_packed_bed.csv", "37bd0cb", "packed_bed_10000000", "hertz_mindlin", 1e7, 2155.332, 3498.228968};
inline constexpr MeasuredRun smaller_on_gpu{
    "h100_same_bed.csv", "37bd0cb", "same_bed_1000000", "hertz_mindlin", 1e6, 214.993, 344.37602};
inline constexpr MeasuredRun frictionless_on_gpu{
    "h100_same_bed.csv", "37bd0cb", "same_bed_1000000", "hertz_frictionless", 1e6, 93.771, 173.3625};
inline constexpr MeasuredRun drum_on_gpu{"drum.csv", "37bd0cb", "drum_250000", "hertz_mindlin",
                                         250000,     85.653,    95.824008};
inline constexpr MeasuredRun small_drum_on_gpu{"drum.csv", "37bd0cb", "drum_50000", "hertz_mindlin",
                                               50000,      20.357,    20.061588};
inline constexpr MeasuredRun settled_on_core{
    "resting_bed.csv", "55be182", "packed_bed_2000", "hertz_mindlin", 2000, 161.239, 1.928148};
inline constexpr MeasuredRun drum_on_core{"drum.csv", "9f04539", "drum_5000", "hertz_mindlin",
                                          5000,       728.689,   3.47552};

// A message to and from each neighbour at the same time, or a word to and from all.
struct MeasuredMessage {
  double bytes, us;
};

// Two H100s of one host, NVLink: persistent kernels that store into the memory of the other one and raise a
// flag.
inline constexpr MeasuredMessage between_gpus[] = {
    {16e3, 6.0}, {160e3, 6.2}, {480e3, 6.6}, {1.6e6, 11.3}, {16e6, 93}};
inline constexpr double flag_between_gpus = 4.5 / 2;  // one way [us]
// Two H200s of one host (results/rank_gpus.csv): the time of a step on one and on two of them, with as many
// spheres on each, and the steps between two rebuilds.
struct MeasuredPair {
  double spheres;  // of a GPU
  double one_us, two_us, steps_of_list;
};
inline constexpr MeasuredPair settled_pair{1e6, 205.8, 240.6, 5000.0 / 71},
    flowing_pair{1e6, 227.6, 301.7, 5000.0 / 236}, large_pair{1e7, 2198.7, 2386.2, 1500.0 / 78};
// Two ranks of MPI on one host: medians of results/ranks.csv.
inline constexpr MeasuredMessage between_cores[] = {
    {48, 4.45}, {4800, 9.25}, {48000, 13.10}, {480000, 74.33}, {4800000, 3314.83}};
inline constexpr double maximum_over_two_cores = 4.39;  // [us]

// Time of a message of so many bytes [us]: that of the shortest one that was measured at least, and beyond
// the longest one in proportion.
double message_time(std::span<const MeasuredMessage> measured, double bytes);

}  // namespace tandem::launch
