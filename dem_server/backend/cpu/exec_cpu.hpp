// The CPU back end (backend/concept.hpp): host memory and a team of threads.
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include "dem_server/backend/concept.hpp"
#include "dem_server/backend/cpu/rank_exchange_cpu.hpp"
#include "dem_server/contact/close_pairs.hpp"
#include "dem_server/contact/pair_batch.hpp"
#include "dem_server/contact/pair_sum.hpp"
#include "dem_server/laws/generic.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/backend/cpu/host_exec.hpp"
#include "particles/base/fixed_point.hpp"
#include "particles/base/group.hpp"
#include "particles/geometry/facet_contact.hpp"
#include "particles/state/window_progress.hpp"

namespace tandem::dem {

// Results of one thread in a loop over spheres. Sums are sums of integers and the others are extreme values,
// so that the result does not depend on the order.
struct alignas(64) HostTally {
  float max_speed2 = 0, max_overlap_ratio = 0;
  std::uint32_t error = 0, culprit = ~0u;
  std::uint64_t lost = 0;
  std::vector<std::int64_t> load, totals;

  void observe_speed(float speed2) { max_speed2 = std::max(max_speed2, speed2); }
  void observe_overlap(float ratio) { max_overlap_ratio = std::max(max_overlap_ratio, ratio); }
  void raise(StepError what, std::uint32_t id) {
    error |= what;
    culprit = std::min(culprit, dem::culprit(what, id));
  }
  void count_lost() { ++lost; }
  void add_load(std::uint32_t row, Vec3d force, Vec3d torque, Quantum f, Quantum t) {
    std::int64_t* sum = load.data() + std::size_t{row} * 6;
    for (int a = 0; a < 3; ++a) {
      sum[a] += to_fixed(force[a], f);
      sum[3 + a] += to_fixed(torque[a], t);
    }
  }
  void add_total(int which, std::int64_t amount) { totals[static_cast<std::size_t>(which)] += amount; }
};

class CpuExec : public HostExec {
 public:
  template <class Real, bool with_spin>
  using RankExchange = CpuRankExchange<Real, with_spin>;

  explicit CpuExec(unsigned threads) : HostExec(threads), tallies_(pool_->size()) {}
  void let_host_rebuild() {}

  template <class F>
  void for_each_shared(std::uint32_t n, F f) {
    for_each(n, [f](std::uint32_t i) { f(i, OneThread{}); });
  }
  template <class Fill>
  void fill_lists(std::uint32_t n, Fill fill) {
    for_each_shared(n, fill);
  }
  template <class First, class Second>
  void at_once(First first, Second second) {
    first();
    second();
  }

  template <class Step>
  void step(std::uint32_t n, const Step& step, std::uint32_t rows) {
    WindowProgress& window = *step.view.window;
    const CurrentStep now(window, window.progress[0]);
    const StateInMemory<typename Step::Real> state(step.view, now);
    run_tallied(window.near, rows * 6, 0, [&, walls = step.walls(now, state)](Range range, HostTally& tally) {
      for (std::uint32_t near = range.begin; near < range.end; ++near) {
        if (walls.compute_few_contacts(near, tally)) continue;
        WallContactSpace space;
        walls.compute_any_contacts(near, space, tally);
      }
    });
    report(step.view, rows);
    search_close_pairs<typename Step::Law>(step.view, now);
    run_tallied(n, 0, 0,
                [&](Range range, HostTally& tally) { evaluate_pairs(step, now, state, range, tally); });
    report(step.view, 0);
    const Range owned = step.view.spheres.owned;
    run_tallied(owned.end - owned.begin, rows * 6, 0, [&](Range range, HostTally& tally) {
      for (std::uint32_t i = owned.begin + range.begin; i < owned.begin + range.end; ++i)
        move(step, now, state, i, tally);
    });
    report(step.view, rows);
  }

  template <unsigned totals, class Record>
  void account(std::uint32_t n, const Record& record) {
    run_tallied(n, 0, totals, [&](Range range, HostTally& tally) {
      for (std::uint32_t i = range.begin; i < range.end; ++i) record(i, tally);
    });
    for (const HostTally& t : tallies_)
      for (std::size_t k = 0; k < totals; ++k) record.view.totals[k] += t.totals[k];
  }

  // Runs the window that `window` describes: rebuilds the lists when that is due, and does micro steps until
  // the window is done or an error occurs.
  template <class View, class Rebuild, class Step>
  void run_window(const View&, Buffer<WindowProgress>& window, Rebuild rebuild, Step step) {
    WindowProgress& c = *window.data();
    StepProgress& p = c.progress[0];
    close_until_travel_ = no_search;  // between windows lists may have been restored or changed
    while (p.step < c.steps && c.error == 0) {
      if (p.rebuild_due != 0) rebuild();
      p = next_step(c, 0);
      if (p.open == 0) continue;
      step();
      close_step(c, 0, p);
    }
  }
  // To be called when the lists have been built.
  template <class View>
  void prepare_lists(const View&) {
    close_until_travel_ = no_search;
  }
  void forget_captured() {}
  void enlarge_regions() {}
  std::uint32_t regions() const { return 0; }

 private:
  // Searches for close pairs, unless those of the last search are still complete.
  template <class Law, class View>
  void search_close_pairs(const View& view, const CurrentStep& now) {
    const WindowProgress& window = *view.window;
    const StepProgress& progress = window.progress[0];
    if (progress.travel <= close_until_travel_) return;
    // Bound of the approach of two spheres until the next search, at the largest speed so far [m].
    const double speed = std::sqrt(static_cast<double>(std::max(window.max_speed2[0], progress.top_speed2)));
    const double margin =
        std::min(steps_between_searches * 2 * speed * now.dt, window.skin - progress.travel);
    close_until_travel_ = progress.travel + margin;
    const auto& p = view.parameters;
    const auto reach = p.unit.count(margin * (1 + 1e-6)) + p.range;  // the factor covers all rounding
    pool_->run(
        [&](unsigned thread) { find_close_pairs<Law>(view, now, share(view.spheres.count, thread), reach); });
    pool_->run([&](unsigned thread) { find_close_mirrors(view, share(view.spheres.count, thread)); });
  }
  // Evaluates the close pairs that the spheres of a range own.
  template <class Step, class State>
  static void evaluate_pairs(const Step& step, const CurrentStep& now, const State& state, Range range,
                             HostTally& tally) {
    using Real = typename Step::Real;
    using Law = typename Step::Law;
    if (range.begin == range.end) return;
    const auto pairs = step.pairs(now, state);
    const ClosePairs<Real>& close = step.view.close;
    const Range numbers{close.owned[range.begin].begin, close.owned[range.end - 1].end};
    if constexpr (Law::extended) {
      const View<Real>& view = step.view;
      if (!view.parameters.twisting && !view.dissipation.any()) {
        // The switch over the laws is outside of the loop over pairs, which therefore is a vector loop.
        with_law(static_cast<scene::ContactLaw>(view.parameters.law), [&]<class L>(L) {
          if (view.parameters.rolling)
            PairBatch<Law, Real, false, L, true>{}.evaluate(pairs, numbers, tally);
          else
            PairBatch<Law, Real, false, L>{}.evaluate(pairs, numbers, tally);
          return 0;
        });
        return;
      }
      for (std::uint32_t number = numbers.begin; number < numbers.end; ++number) {
        const ClosePair pair = close.pair[number];
        TouchingPair<Real> in_contact;
        PairResult<Real> result;
        Vec3<Real> moment;
        const bool touching = pairs(pair.owner, pair.entry, in_contact, result, moment, tally);
        store<Law>(close, number, touching ? result : PairResult<Real>{});
        if (close.moment != nullptr) close.moment[number] = {touching ? moment : Vec3<Real>{}};
      }
    } else if (step.view.parameters.kinds == 1) {
      PairBatch<Law, Real, true>{}.evaluate(pairs, numbers, tally);
    } else {
      PairBatch<Law, Real, false>{}.evaluate(pairs, numbers, tally);
    }
  }
  // Flattened into one function, so that the state of a sphere stays in registers.
  template <class Step, class State>
  [[gnu::flatten]] static void move(const Step& step, const CurrentStep& now, const State& state,
                                    std::uint32_t i, HostTally& tally) {
    const auto motion = step.motion(now, state);
    const auto own = motion.own(i);
    const ForceSum sum =
        sum_of_pairs<typename Step::Law>(step.view.close, i, step.view.parameters.radius(own.position));
    motion.translate(i, own, sum.force, tally);
    if constexpr (Step::Law::tangential) motion.rotate(i, own, sum.torque);
  }

  // Adds the results of all threads to those of the step.
  template <class View>
  void report(const View& view, std::uint32_t rows) {
    WindowProgress& window = *view.window;
    std::int64_t* load = view.load + std::size_t{window.progress[0].step} * rows * 6;
    for (const HostTally& t : tallies_) {
      window.max_speed2[0] = std::max(window.max_speed2[0], t.max_speed2);
      window.max_overlap_ratio = std::max(window.max_overlap_ratio, t.max_overlap_ratio);
      window.error |= t.error;
      window.culprit = std::min(window.culprit, t.culprit);
      window.lost += t.lost;
      for (std::size_t k = 0; k < std::size_t{rows} * 6; ++k) load[k] += t.load[k];
    }
  }
  template <class F>
  void run_tallied(std::uint32_t n, std::size_t loads, std::size_t totals, F f) {
    pool_->run([&](unsigned thread) {
      HostTally& tally = tallies_[thread];
      tally.max_speed2 = tally.max_overlap_ratio = 0;
      tally.error = 0;
      tally.culprit = ~0u;
      tally.lost = 0;
      tally.load.assign(loads, 0);
      tally.totals.assign(totals, 0);
      f(share(n, thread), tally);
    });
  }

  // A search costs a third of a step.
  static constexpr double steps_between_searches = 16, no_search = -1;

  std::vector<HostTally> tallies_;
  double close_until_travel_ = no_search;  // close pairs are complete up to this StepProgress::travel [m]
};

static_assert(BackEnd<CpuExec>);

}  // namespace tandem::dem
