// The model of cost of several ranks, against the measured rates that it comes from and its page.
#include "launch/sizing/cost_model.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/page_table.hpp"

namespace tandem::launch {
namespace {

std::vector<std::string> lines_of(const std::string& file) {
  std::ifstream stream(std::string(TANDEM_SOURCE_DIR) + "/" + file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Whether one line of the file has all of these words.
bool has_row(const std::string& file, const std::vector<std::string>& words) {
  for (const std::string& line : lines_of("tests/benchmark/results/" + file)) {
    bool all = true;
    for (const std::string& word : words) all = all && line.find(word) != std::string::npos;
    if (all) return true;
  }
  return false;
}

TEST(CostModel, HasTheRatesOfTheResults) {
  for (const MeasuredRun& run : {settled_on_gpu, smaller_on_gpu, frictionless_on_gpu, drum_on_gpu,
                                 small_drum_on_gpu, settled_on_core, drum_on_core})
    EXPECT_TRUE(has_row(run.file,
                        {fmt::format(",{},", run.commit), fmt::format(",{},", run.scene),
                         fmt::format(",{},", run.variant), fmt::format(",{:.0f},", run.spheres),
                         fmt::format(",{:.3f},", run.us_per_micro_step), fmt::format(",{}", run.memory_MB)}))
        << run.file << ' ' << run.scene << ' ' << run.us_per_micro_step;
  for (const MeasuredMessage& message : between_cores)
    EXPECT_TRUE(has_row("ranks.csv",
                        {fmt::format("halo,2,{:.0f},", message.bytes), fmt::format(",{:.2f}", message.us)}))
        << message.bytes;
  EXPECT_TRUE(has_row("ranks.csv", {"maximum,2,", fmt::format(",{:.2f}", maximum_over_two_cores)}));
}

TEST(CostModel, HasThePairsOfTheResults) {
  for (const auto& [what, pair] :
       {std::pair{"settled,", settled_pair}, {"flowing,", flowing_pair}, {"settled,", large_pair}})
    for (const auto& [ranks, us] : {std::pair{1, pair.one_us}, {2, pair.two_us}})
      EXPECT_TRUE(has_row("rank_gpus.csv", {fmt::format("{}{:.0f},{},2,", what, ranks * pair.spheres, ranks),
                                            fmt::format(",{:.4f},", us / 1000)}))
          << what << ranks << ' ' << us;
}

// Two GPUs as measured, which the terms of the model come from.
TEST(CostModel, AddsToTheMeasuredPairs) {
  for (const auto& [flow, pair] : {std::pair{Flow::settled, settled_pair}, {Flow::flowing, flowing_pair}}) {
    const RankCost cost = cost_of(tower_of_cubes(pair.spheres, 2), gpu_kind(flow, true), 2);
    EXPECT_NEAR(cost.halo_us + cost.agreement_us + cost.ranks_us, pair.two_us - pair.one_us, 0.05);
  }
}

TEST(CostModel, HasTheMessagesOfItsPage) {
  std::string page;
  for (const std::string& line : lines_of("docs/experiments/2026-11-ranks.md")) page += line + "\n";
  for (const MeasuredMessage& message : between_gpus)
    EXPECT_NE(page.find(fmt::format("| {:.0f} B | {:.1f} us |", message.bytes, message.us)),
              std::string::npos)
        << message.bytes;
}

// A run that the model was not made from: a million spheres at rest.
TEST(CostModel, PredictsARunOnOneGpu) {
  Bed bed;
  bed.spheres = smaller_on_gpu.spheres;
  const RankCost cost = cost_of(bed, gpu_kind(Flow::settled, true), 1);
  std::printf(
      "  1,000,000 at rest: expected %.1f us, predicted %.1f us, tolerance 3 %%; memory expected %.0f MB, "
      "predicted "
      "%.0f MB, tolerance 2 %%\n",
      smaller_on_gpu.us_per_micro_step, cost.step_us(), smaller_on_gpu.memory_MB, cost.memory / 1e6);
  EXPECT_NEAR(cost.step_us(), smaller_on_gpu.us_per_micro_step, 0.03 * smaller_on_gpu.us_per_micro_step);
  EXPECT_NEAR(cost.memory / 1e6, smaller_on_gpu.memory_MB, 0.02 * smaller_on_gpu.memory_MB);
}

TEST(CostModel, AddsWhatRanksExchange) {
  const RankKind kind = gpu_kind(Flow::settled, true);
  Bed bed;
  bed.spheres = 2e6, bed.layer = 10'000, bed.bytes_per_ghost = 48, bed.bytes_of_cells = 4e6;
  const RankCost two = cost_of(bed, kind, 2), four = cost_of(bed, kind, 4);
  EXPECT_EQ(two.ghosts, 10'000);
  EXPECT_EQ(four.ghosts, 20'000) << "a slab between two others";
  EXPECT_EQ(two.halo_us, 6.6) << "480 kB";
  EXPECT_EQ(two.agreement_us, 2.25);
  EXPECT_EQ(four.agreement_us, 4.5);
  EXPECT_DOUBLE_EQ(two.work_us, kind.step_us + 1e6 * kind.us_per_sphere);
  EXPECT_DOUBLE_EQ(two.memory, 1.01e6 * kind.bytes_per_sphere + 2e6);
  // Nine GPUs are on two hosts.
  EXPECT_DOUBLE_EQ(cost_of(bed, kind, 9).halo_us, 12 + 480e3 / 20e3);
  EXPECT_DOUBLE_EQ(message_time(between_gpus, 32e6), 186);
  EXPECT_EQ(message_time(between_gpus, 10), 6.0);
}

TEST(CostModel, FitsTheLargestBedIntoMemory) {
  const RankKind kind = gpu_kind(Flow::settled, true);
  Bed bed = tower_of_cubes(1e6, 1);
  std::string limit;
  const double one = largest_bed(bed, kind, 1, limit);
  EXPECT_EQ(limit, "memory");
  EXPECT_NEAR(one * kind.bytes_per_sphere, 0.97 * kind.memory, 1);
  const double two = largest_bed(bed, kind, 2, limit);
  EXPECT_LT(two, 2 * one) << "ghosts, and the cells of the whole domain";
  EXPECT_GT(two, 1.9 * one);
  EXPECT_EQ(largest_bed(bed, kind, 64, limit), 1 << 30);
  EXPECT_EQ(limit, "ids of spheres end there");
}

TEST(CostModel, HasItsTableInTheDocs) {
  std::string table =
      "| each | GPUs | work [us] | halo [us] | agreement [us] | ranks [us] | efficiency | memory of each "
      "|\n|---|---|---|---|---|---|---|---|\n";
  for (const double each : {1e6, 1e7})
    for (const unsigned gpus : {1u, 2u, 4u, 8u, 64u, 1024u}) {
      const Bed bed = tower_of_cubes(each, gpus);
      const RankKind kind = gpu_kind(Flow::settled, true);
      const RankCost one = cost_of(tower_of_cubes(each, 1), kind, 1), cost = cost_of(bed, kind, gpus);
      const bool has_ids = bed.spheres <= std::int64_t{1} << 30;
      table += fmt::format("| {:.0f} M | {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} % | {:.2f} GB{} |\n",
                           each / 1e6, gpus, cost.work_us, cost.halo_us, cost.agreement_us, cost.ranks_us,
                           100 * one.step_us() / cost.step_us(), cost.memory / 1e9,
                           has_ids ? "" : "; too many ids");
    }
  tandem::test::expect_on_page("docs/cost_of_ranks.md", "cost", table);
}

}  // namespace
}  // namespace tandem::launch
