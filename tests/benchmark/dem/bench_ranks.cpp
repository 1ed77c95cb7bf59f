// Time of what ranks exchange in each micro step: messages of N bytes with each neighbour in a row of ranks,
// and a maximum over all. The least of many, and the median, which other programs on the machine disturb.
//
//   mpirun -n 2 --mca btl self,vader --mca btl_vader_single_copy_mechanism none bench_ranks
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "particles/base/mpi_ranks.hpp"

namespace {

template <class Work>
std::vector<double> sorted_microseconds(int rounds, Work work) {
  std::vector<double> all;
  for (int k = 0; k < rounds; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    all.push_back(
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
  }
  std::ranges::sort(all);
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace tandem::particles;
  MpiRanks ranks(argc, argv);
  const auto report = [&](const char* what, std::size_t bytes, const std::vector<double>& us) {
    if (ranks.rank() == 0)
      fmt::print("{},{},{},{:.2f},{:.2f}\n", what, ranks.size(), bytes, us.front(), us[us.size() / 2]);
  };
  if (ranks.rank() == 0) fmt::print("what,ranks,bytes,least_us,median_us\n");
  for (const std::size_t bytes : {48u, 4'800u, 48'000u, 480'000u, 4'800'000u}) {
    std::vector<Ranks::Bytes> buffers(4, Ranks::Bytes(bytes));
    std::vector<Ranks::Parcel> to, from;
    for (const int side : {-1, 1}) {
      const int other = static_cast<int>(ranks.rank()) + side;
      if (other < 0 || other >= static_cast<int>(ranks.size())) continue;
      to.push_back({static_cast<unsigned>(other), buffers[to.size()]});
      from.push_back({static_cast<unsigned>(other), buffers[2 + from.size()]});
    }
    std::uint64_t values[3] = {ranks.rank(), 0, 0};
    report("halo and maximum", bytes, sorted_microseconds(bytes > 1'000'000 ? 100 : 1000, [&] {
             ranks.begin_swap(to, from);
             ranks.maximum(values);
             ranks.end_swap();
           }));
    report("halo then maximum", bytes, sorted_microseconds(bytes > 1'000'000 ? 100 : 1000, [&] {
             ranks.swap(to, from);
             ranks.maximum(values);
           }));
    report("halo", bytes, sorted_microseconds(bytes > 1'000'000 ? 100 : 1000, [&] { ranks.swap(to, from); }));
  }
  std::uint64_t values[3] = {ranks.rank(), 0, 0};
  report("maximum", sizeof values, sorted_microseconds(1000, [&] { ranks.maximum(values); }));
}
