// The CPU back end of a liquid: loops and sums on the threads of a team.
// sph_server/engine/liquid_engine_of.hpp is written against its members, which backend/cuda/exec_cuda.cuh has
// as well.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "particles/backend/cpu/host_exec.hpp"
#include "sph_server/backend/list.hpp"
#include "sph_server/step/body_sum.hpp"
#include "sph_server/step/pair_rows.hpp"
#include "sph_server/step/team.hpp"

namespace tandem::sph {

// Sums of one thread, one per body.
struct BodySums {
  std::vector<BodySum> of;
  void add(std::uint32_t body, Vec3d acceleration, Vec3d torque, const Quanta& q) {
    of[body].add(acceleration, torque, q);
  }
  void add(std::uint32_t body, const BodySum& sum) { of[body].add(sum); }
};

class CpuExec : public particles::HostExec {
 public:
  using HostExec::HostExec;

  // find: see neighbours/find.hpp.
  template <class Entry, class Find>
  void build_list(std::uint32_t n, Find find, List<CpuExec, Entry>& list) {
    // Each thread lists a range of particles; the ranges are joined in order.
    std::vector<std::vector<Entry>> found(pool_->size());
    grow(list.start, std::size_t{n} + 1);
    std::uint32_t* const count = list.start.data();
    pool_->run([&](unsigned thread) {
      const particles::Range range = share(n, thread);
      for (std::uint32_t i = range.begin; i < range.end; ++i) {
        const std::size_t before = found[thread].size();
        find(i, particles::OneThread{}, [&](Entry entry, bool exists) {
          if (exists) found[thread].push_back(entry);
        });
        count[i] = static_cast<std::uint32_t>(found[thread].size() - before);
      }
    });
    std::size_t total = 0;
    for (const auto& part : found) total += part.size();
    list.total = checked_total(total);
    std::uint32_t begin = 0;
    for (std::uint32_t i = 0; i < n; ++i) begin += std::exchange(count[i], begin);
    count[n] = begin;
    grow(list.entry, total);
    Entry* to = list.entry.data();
    for (const auto& part : found) to = std::copy(part.begin(), part.end(), to);
    if constexpr (Find::by_warps) {
      grow(list.end, n);
      std::copy(count + 1, count + n + 1, list.end.data());
    }
  }

  // Of the n particles listed, drops the entries for which keep(i, entry) does not hold.
  template <class Entry, class Keep>
  void keep_entries(std::uint32_t n, const std::uint32_t* particle, Keep keep, List<CpuExec, Entry>& list) {
    for_each(
        n, [=, start = list.start.data(), end = list.end.data(), entry = list.entry.data()](std::uint32_t k) {
          const std::uint32_t i = particle[k];
          end[i] = static_cast<std::uint32_t>(
              std::remove_if(entry + start[i], entry + end[i], [&](Entry e) { return !keep(i, e); }) - entry);
        });
  }

  // f(i) for those numbers below n of which where(i) holds.
  template <class Where, class F>
  void for_each_where(std::uint32_t n, Where where, F f) {
    for_each(n, [=](std::uint32_t i) {
      if (where(i)) f(i);
    });
  }

  // f(i) for those of which a(i) holds, and g(i) for those of which b(i) holds.
  template <class A, class F, class B, class G>
  void for_each_of_two(std::uint32_t n, A a, F f, B b, G g) {
    for_each_where(n, a, f);
    for_each_where(n, b, g);
  }

  // Two works of which neither needs what the other one does.
  template <class A, class B>
  void side_by_side(A a, B b) {
    a();
    b();
  }

  // sum.of_lane(i, lane) yields the sums of a lane; sum.take(i, s) gets those of all lanes.
  template <class Sum>
  void sum_over_lanes(std::uint32_t n, Sum sum) {
    for_each(n, [sum](std::uint32_t i) {
      auto s = lane_sums(sum, i, 0), s2 = lane_sums(sum, i, 2);
      s.add(lane_sums(sum, i, 1));
      s2.add(lane_sums(sum, i, 3));
      s.add(s2);
      sum.take(i, s);
    });
  }

  template <bool shifting>
  void sum_over_lanes(std::uint32_t n, SumPairs<float, shifting> sum) {
    pool_->run([&](unsigned thread) {
      const auto rows = std::make_unique<PairRows<shifting>>();
      const particles::Range range = share(n, thread);
      for (std::uint32_t i = range.begin; i < range.end; ++i) sum.take(i, rows->of(sum, i));
    });
  }

  // f(i, tally) adds to a tally of its thread; the sum of all is returned. Tally::add must be exact, so that
  // the order does not matter.
  template <class Tally, class F>
  Tally reduce(std::uint32_t n, F f) {
    std::vector<Tally> tallies(pool_->size());
    pool_->run([&](unsigned thread) {
      const particles::Range range = share(n, thread);
      for (std::uint32_t i = range.begin; i < range.end; ++i) f(i, tallies[thread]);
    });
    Tally sum;
    for (const Tally& tally : tallies) sum.add(tally);
    return sum;
  }
  // The same for one part after the other, with sums for each body, see SumOver.
  template <class Tally, class... F>
  Tally reduce(std::vector<BodySum>& of_bodies, SumOver<F>... parts) {
    std::vector<Tally> tallies(pool_->size());
    std::vector<BodySums> bodies(pool_->size(), BodySums{std::vector<BodySum>(of_bodies.size())});
    const auto add = [&](const auto& part) {
      pool_->run([&](unsigned thread) {
        const particles::Range range = share(part.n, thread);
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
          if constexpr (std::decay_t<decltype(part.f)>::by_teams)
            part.f(i, OneThreadTeam{}, tallies[thread], bodies[thread]);
          else
            part.f(i, tallies[thread], bodies[thread]);
        }
      });
    };
    (add(parts), ...);
    Tally sum;
    of_bodies.assign(of_bodies.size(), {});
    for (unsigned t = 0; t < pool_->size(); ++t) {
      sum.add(tallies[t]);
      for (std::size_t b = 0; b < of_bodies.size(); ++b) of_bodies[b].add(bodies[t].of[b]);
    }
    return sum;
  }

 private:
  // Flattened, since a call for each neighbour takes longer than its arithmetic.
  template <class Sum>
  [[gnu::flatten]] static auto lane_sums(const Sum& sum, std::uint32_t i, std::uint32_t lane) {
    return sum.of_lane(i, lane);
  }
};

}  // namespace tandem::sph
