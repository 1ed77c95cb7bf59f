// Each pair once, the CPU's way: pairs that touch are gathered, one column per number and one row per pair,
// so that a compiler can evaluate several at once. The law is that of everybody (contact/pair_forces.hpp),
// inlined into the loop over rows.
#pragma once

#include <cstddef>
#include <cstdint>

#include "dem_server/contact/pair_forces.hpp"

namespace tandem::dem {

// Sanitizers instrument the choice that is made when a program starts, before they are ready for it.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__SANITIZE_ADDRESS__)
#define TANDEM_WIDE_VECTORS __attribute__((target_clones("default", "arch=x86-64-v3")))
#else
#define TANDEM_WIDE_VECTORS
#endif

template <class Law, class Real>
void store(const View<Real>& view, std::uint32_t k, const PairResult<Real>& r) {
  view.pair_force[k] = {r.force, r.overlap};
  if constexpr (Law::tangential) view.pair_couple[k] = {r.couple};
}

template <class Law, class Real>
class PairBatch {
 public:
  PairBatch() = default;
  PairBatch(const PairBatch&) = delete;
  PairBatch& operator=(const PairBatch&) = delete;

  bool full() const { return count_ == capacity; }

  // Takes pair k, which sphere i owns, if it touches; says whether.
  bool add(const PairForces<Law, Real>& forces, std::uint32_t i, std::uint32_t k) {
    PairMeeting<Real> m;
    if (!forces.meet(i, k, m)) return false;
    pair_[count_] = k;
    put(count_, m);
    if constexpr (Law::tangential) spring_.put(count_, forces.spring(k));
    ++count_;
    return true;
  }

  template <class Tally>
  void evaluate(const PairForces<Law, Real>& forces, Tally& tally) {
    evaluate_rows(forces.view.parameters.unit, forces.view.parameters.law, forces.dt);
    for (std::size_t row = 0; row < count_; ++row) {
      store<Law>(forces.view, pair_[row], result(row));
      forces.remember(pair_[row], result(row));
      tally.observe_overlap(static_cast<float>(curvature_[row]));
    }
    count_ = 0;
  }

 private:
  // Once for every processor, once for those with vectors of 256 bits; the bits are the same.
  TANDEM_WIDE_VECTORS void evaluate_rows(LengthUnit<Real> unit, std::uint32_t law, Real dt) {
    const std::size_t count = count_;
#pragma GCC ivdep
    for (std::size_t row = 0; row < count; ++row) {
      const PairMeeting<Real> m = get(row);
      const Contact<Real> c = contact_of<Law>(m, unit, Real(0), dt);
      Vec3<Real> spring;
      if constexpr (Law::tangential) spring = spring_.get(row);
      const ContactForce<Real> f = Law{}(c, m.k, law, spring);
      const PairResult<Real> r = result_of(c, f, spring);
      put(row, r);
      curvature_[row] = r.overlap * m.k.curvature;
    }
  }

  static constexpr std::size_t capacity = 128;  // its columns stay in the first cache

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

  void put(std::size_t r, const PairMeeting<Real>& m) {
    d_.put(r, m.separation.d);
    d2_[r] = m.separation.d2;
    reach_[r] = m.separation.reach;
    depth2_[r] = m.separation.depth2;
    u_.put(r, m.u);
    if constexpr (Law::tangential) {
      radius_[r] = m.radius;
      other_radius_[r] = m.other_radius;
      w_.put(r, m.w);
      other_w_.put(r, m.other_w);
      k_t_[r] = m.k.k_t;
      c_t_[r] = m.k.c_t;
      friction_[r] = m.k.friction;
    }
    k_n_[r] = m.k.k_n;
    c_n_[r] = m.k.c_n;
    curvature_[r] = m.k.curvature;
  }
  PairMeeting<Real> get(std::size_t r) const {
    PairMeeting<Real> m;
    m.separation = {d_.get(r), d2_[r], reach_[r], depth2_[r]};
    m.u = u_.get(r);
    if constexpr (Law::tangential) {
      m.radius = radius_[r];
      m.other_radius = other_radius_[r];
      m.w = w_.get(r);
      m.other_w = other_w_.get(r);
      m.k.k_t = k_t_[r];
      m.k.c_t = c_t_[r];
      m.k.friction = friction_[r];
    }
    m.k.k_n = k_n_[r];
    m.k.c_n = c_n_[r];
    m.k.curvature = curvature_[r];
    return m;
  }
  // Results go where the meeting was that they come from.
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
  Column d2_, reach_, depth2_, radius_, other_radius_, k_n_, c_n_, k_t_, c_t_, friction_, curvature_;
  std::uint32_t pair_[capacity];
  std::size_t count_ = 0;
};

}  // namespace tandem::dem
