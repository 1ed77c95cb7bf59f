// Evaluates each pair once; the CPU only. Close pairs are gathered into columns with one row per pair, so
// that a compiler can evaluate several rows at once. The law is that of all back ends
// (contact/pair_forces.hpp), inlined into the loop over rows.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "dem_server/contact/pair_forces.hpp"

namespace tandem::dem {

// Not with sanitizers: they instrument the function that selects the clone, which runs at program start
// before they are initialised.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__SANITIZE_ADDRESS__)
#define TANDEM_WIDE_VECTORS __attribute__((target_clones("default", "arch=x86-64-v3")))
#else
#define TANDEM_WIDE_VECTORS
#endif

template <class Law, class Real>
void store(const ClosePairs<Real>& close, std::uint32_t number, const PairResult<Real>& r) {
  close.force[number] = {r.force, r.overlap};
  if constexpr (Law::tangential) close.couple[number] = {r.couple};
}

// one_kind: all spheres have one material and one size, so that quantities that depend on these alone need no
// column.
template <class Law, class Real, bool one_kind>
class PairBatch {
 public:
  PairBatch() = default;
  PairBatch(const PairBatch&) = delete;
  PairBatch& operator=(const PairBatch&) = delete;

  // Evaluates the close pairs with these numbers.
  template <class Tally>
  void evaluate(const PairForces<Law, Real>& forces, Range numbers, Tally& tally) {
    const ClosePairs<Real>& close = forces.view.close;
    for (std::uint32_t number = numbers.begin; number < numbers.end; ++number) {
      const ClosePair pair = close.pair[number];
      TouchingPair<Real> m;
      if (!forces.find_touching(pair.owner, pair.entry, m)) {
        store<Law>(close, number, {});
        forces.end_contact(pair.entry, forces.state.neighbour(pair.entry));
        continue;
      }
      number_[count_] = number;
      put(count_, m);
      if constexpr (Law::tangential)
        spring_.put(count_, forces.spring(pair.entry, forces.state.neighbour(pair.entry)));
      if (++count_ == capacity) evaluate_gathered(forces, tally);
    }
    evaluate_gathered(forces, tally);
  }

 private:
  template <class Tally>
  void evaluate_gathered(const PairForces<Law, Real>& forces, Tally& tally) {
    const ClosePairs<Real>& close = forces.view.close;
    evaluate_rows(forces.view.parameters, forces.dt);
    Real deepest = 0;
    for (std::size_t row = 0; row < count_; ++row) {
      const PairResult<Real> r = result(row);
      store<Law>(close, number_[row], r);
      const std::uint32_t entry = close.pair[number_[row]].entry;
      forces.store_contact(entry, forces.state.neighbour(entry), r);
      deepest = std::max(deepest, overlap_ratio_[row]);
    }
    tally.observe_overlap(static_cast<float>(deepest));
    count_ = 0;
  }

  // Compiled once for every processor and once for those with 256-bit vectors; both give the same bits.
  TANDEM_WIDE_VECTORS void evaluate_rows(const Parameters<Real>& p, Real dt) {
    const std::size_t count = count_;
    const LengthUnit<Real> unit = p.unit;
    const std::uint32_t law = p.law;
    [[maybe_unused]] const Real radius = p.kind_radius[0];
    [[maybe_unused]] const Coefficients<Real> k = p.kind_pair[0];
#pragma GCC ivdep
    for (std::size_t row = 0; row < count; ++row) {
      TouchingPair<Real> m = get(row);
      if constexpr (one_kind) {
        m.radius = m.other_radius = radius;
        m.k = k;
      }
      const Contact<Real> c = contact_of<Law>(m, unit, Real(0), dt);
      Vec3<Real> spring;
      if constexpr (Law::tangential) spring = spring_.get(row);
      const ContactForce<Real> f = Law{}(c, m.k, law, spring);
      const PairResult<Real> r = result_of(c, f, spring);
      put(row, r);
      overlap_ratio_[row] = r.overlap * m.k.curvature;
    }
  }

  static constexpr std::size_t capacity = 128;  // the columns stay in the first-level cache

  struct Column {
    alignas(64) Real row[capacity];
    Real operator[](std::size_t r) const { return row[r]; }
    Real& operator[](std::size_t r) { return row[r]; }
  };
  struct Columns3 {
    Column x, y, z;
    Vec3<Real> get(std::size_t r) const { return {x[r], y[r], z[r]}; }
    void put(std::size_t r, Vec3<Real> v) {
      x[r] = v.x;
      y[r] = v.y;
      z[r] = v.z;
    }
  };

  void put(std::size_t r, const TouchingPair<Real>& m) {
    d_.put(r, m.separation.d);
    d2_[r] = m.separation.d2;
    reach_[r] = m.separation.reach;
    depth2_[r] = m.separation.depth2;
    u_.put(r, m.u);
    if constexpr (Law::tangential) {
      w_.put(r, m.w);
      other_w_.put(r, m.other_w);
    }
    if constexpr (!one_kind) {
      if constexpr (Law::tangential) {
        radius_[r] = m.radius;
        other_radius_[r] = m.other_radius;
        k_t_[r] = m.k.k_t;
        c_t_[r] = m.k.c_t;
        friction_[r] = m.k.friction;
      }
      k_n_[r] = m.k.k_n;
      c_n_[r] = m.k.c_n;
      curvature_[r] = m.k.curvature;
    }
  }
  TouchingPair<Real> get(std::size_t r) const {
    TouchingPair<Real> m;
    m.separation = {d_.get(r), d2_[r], reach_[r], depth2_[r]};
    m.u = u_.get(r);
    if constexpr (Law::tangential) {
      m.w = w_.get(r);
      m.other_w = other_w_.get(r);
    }
    if constexpr (!one_kind) {
      if constexpr (Law::tangential) {
        m.radius = radius_[r];
        m.other_radius = other_radius_[r];
        m.k.k_t = k_t_[r];
        m.k.c_t = c_t_[r];
        m.k.friction = friction_[r];
      }
      m.k.k_n = k_n_[r];
      m.k.c_n = c_n_[r];
      m.k.curvature = curvature_[r];
    }
    return m;
  }
  // Results overwrite the columns of the pair that they come from.
  void put(std::size_t r, const PairResult<Real>& result) {
    u_.put(r, result.force);
    d2_[r] = result.overlap;
    if constexpr (Law::tangential) {
      w_.put(r, result.couple);
      spring_.put(r, result.spring);
    }
  }
  PairResult<Real> result(std::size_t r) const {
    PairResult<Real> result;
    result.force = u_.get(r);
    result.overlap = d2_[r];
    if constexpr (Law::tangential) {
      result.couple = w_.get(r);
      result.spring = spring_.get(r);
    }
    return result;
  }

  Columns3 d_, u_, w_, other_w_, spring_;
  Column d2_, reach_, depth2_, overlap_ratio_;
  Column radius_, other_radius_, k_n_, c_n_, k_t_, c_t_, friction_, curvature_;
  std::uint32_t number_[capacity];
  std::size_t count_ = 0;
};

}  // namespace tandem::dem
