// Spheres by cells on the CPU: whatever was sorted before, and wherever spheres have been, starts are those
// of the spheres that are there.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "dem_server/core/exec_cpu.hpp"
#include "dem_server/coupling/state_hash.hpp"
#include "dem_server/model/view.hpp"
#include "tests/support/particle_run.hpp"
#include "tests/support/particle_scenes.hpp"

namespace tandem::test {
namespace {

using dem::CellGrid;
using dem::CpuExec;
using Numbers = std::vector<std::uint32_t>;

constexpr std::uint32_t numbers = CellGrid::numbers_of_block, blocks = 200, cells = blocks * numbers;

class Sorted {
 public:
  explicit Sorted(unsigned threads) : exec_(threads) { exec_.grow(start_, cells + numbers); }

  void sort(const Numbers& cell_of) {
    const auto n = static_cast<std::uint32_t>(cell_of.size());
    Numbers key(n), scratch(n);
    exec_.grow(source_, n);
    exec_.sort_into_cells(
        n, cells, [&](std::uint32_t i) { return cell_of[i]; }, key.data(), scratch.data(), start_, source_);
  }
  // Those between two numbers of a block, in their order.
  Numbers between(std::uint32_t first, std::uint32_t end) {
    Numbers found;
    for (std::uint32_t k = start_.data()[first]; k < start_.data()[end]; ++k)
      found.push_back(source_.data()[k]);
    return found;
  }
  Numbers all(std::uint32_t n) { return {source_.data(), source_.data() + n}; }

 private:
  CpuExec exec_;
  CpuExec::CellStarts start_;
  CpuExec::Buffer<std::uint32_t> source_;
};

// `count` spheres in the cells of blocks first to last.
Numbers scattered(std::uint32_t count, std::uint32_t first, std::uint32_t last, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::uint32_t> block(first, last), cell(0, numbers - 2);
  Numbers cell_of(count);
  for (std::uint32_t& number : cell_of) number = block(random) * numbers + cell(random);
  return cell_of;
}

class CellSort : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Threads, CellSort, testing::Values(1, 3));

TEST_P(CellSort, FindsTheSpheresOfEachCellWhereverOthersHaveBeen) {
  Sorted sorted(GetParam());
  // All over; in one corner and in another; few and none; in the last block, where parked ones are.
  for (const Numbers& cell_of :
       {scattered(3000, 0, blocks - 1, 1), scattered(500, 0, 3, 2), scattered(20, 0, blocks - 1, 3),
        scattered(500, 190, blocks - 1, 4), scattered(100, 63, 64, 5), Numbers{}, scattered(1, 7, 7, 6),
        Numbers(70, cells - 1), scattered(3000, 0, blocks - 1, 7)}) {
    sorted.sort(cell_of);
    std::vector<Numbers> in_cell(cells);
    for (std::uint32_t i = 0; i < cell_of.size(); ++i) in_cell[cell_of[i]].push_back(i);
    Numbers in_order;
    for (std::uint32_t first = 0; first < cells; ++first) {
      in_order.insert(in_order.end(), in_cell[first].begin(), in_cell[first].end());
      Numbers there;
      for (std::uint32_t end = first + 1; end % numbers != 0 && end <= first + 4; ++end) {
        there.insert(there.end(), in_cell[end - 1].begin(), in_cell[end - 1].end());
        ASSERT_EQ(sorted.between(first, end), there) << first << " to " << end;
      }
    }
    EXPECT_EQ(sorted.all(static_cast<std::uint32_t>(cell_of.size())), in_order);
  }
}

// Grains and some larger spheres, side by side.
ParticleRun heap(Vec3d corner, double speed) {
  return ParticleRun(falling_spheres("hertz_mindlin", "", 206), dem::Backend::cpu, 1, [&](dem::Spheres& s) {
    constexpr std::size_t larger = 6;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const std::size_t g = i - larger;
      s.radius[i] = i < larger ? 0.02 : 0.005;
      s.position[i] = i < larger ? corner + Vec3d{0.03, 0.03, 0.041 * double(i)}
                                 : corner + 0.01004 * Vec3d{double(g % 2), double(g / 2 % 2), double(g / 4)};
      s.velocity[i] = {0, 0, -speed * double(i % 2)};
    }
  });
}

// Spheres go on by a cell or two each time, to where they find those that others have left, by turns with
// thick skins, whose cells are wider, and with thin ones.
TEST(Cells, ForgetTheSpheresThatHaveLeftThem) {
  ParticleRun used = heap({-0.26, -0.26, 0.1}, 0);
  int thick = 0, thin = 0;
  for (int k = 0; k < 10; ++k) {
    const ParticleRun stage = heap({-0.26 + 0.015 * k, -0.26, 0.1}, k % 2 == 0 ? 3 : 0);
    const Arrays begin = written(stage);
    ParticleRun fresh = heap({}, 0);
    for (ParticleRun* run : {&used, &fresh})
      run->engine->read([&](const std::string& name) { return begin.at(name); });
    used.engine->save();
    used.advance(200, 2e-5);
    used.engine->restore();
    const dem::Control control = used.advance(100, 2e-5).control;
    fresh.advance(100, 2e-5);
    ++(control.skin > control.skins.usual ? thick : thin);
    EXPECT_GT(control.list_entries, 300u);
    const Arrays measured = written(used), expected = written(fresh);
    EXPECT_EQ(measured.at("pairs.start"), expected.at("pairs.start"));
    EXPECT_EQ(dem::state_hash(used.state()), dem::state_hash(fresh.state()));
  }
  EXPECT_EQ(thick, 5);
  EXPECT_EQ(thin, 5);
}

}  // namespace
}  // namespace tandem::test
