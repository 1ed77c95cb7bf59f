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
// column. RowLaw: the law that an extended Law stands for in this scene. rolling: with moments against
// rolling; the batch has neither those against twisting nor sums of the dissipated energy.
template <class Law, class Real, bool one_kind, class RowLaw = Law, bool rolling = false>
class PairBatch {
 public:
  PairBatch() = default;
  PairBatch(const PairBatch&) = delete;
  PairBatch& operator=(const PairBatch&) = delete;

  // Evaluates the close pairs with these numbers. Flattened, so that a pair goes from registers to its
  // columns.
  template <class Tally>
  [[gnu::flatten]] void evaluate(const PairForces<Law, Real>& forces, Range numbers, Tally& tally) {
    const ClosePairs<Real>& close = forces.view.close;
    for (std::uint32_t number = numbers.begin; number < numbers.end; ++number) {
      const ClosePair pair = close.pair[number];
      TouchingPair<Real> m;
      if (!forces.template find_touching<false>(pair.owner, pair.entry, m)) {
        store<Law>(close, number, {});
        if constexpr (Law::extended)
          if (close.moment != nullptr) close.moment[number] = {};
        forces.end_contact(pair.entry, forces.state.neighbour(pair.entry));
        continue;
      }
      number_[count_] = number;
      put(count_, m);
      const Neighbour neighbour = forces.state.neighbour(pair.entry);
      if constexpr (Law::tangential) spring_.put(count_, forces.spring(pair.entry, neighbour));
      if constexpr (!one_kind) {
        const Parameters<Real>& p = forces.view.parameters;
        put(count_, forces.view, p.material(forces.state.kind(pair.owner)),
            p.material(forces.state.kind(neighbour.index())));
      }
      if constexpr (Law::extended) existed_[count_] = neighbour.in_contact() ? 1 : 0;
      if constexpr (rolling)
        rolled_.put(count_, neighbour.in_contact() ? forces.list.rolling[pair.entry].rolled : Vec3<Real>{});
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
      const std::uint32_t number = number_[row], entry = close.pair[number].entry;
      const Neighbour neighbour = forces.state.neighbour(entry);
      if constexpr (Law::extended)
        if (lasts_[row] == 0) {
          store<Law>(close, number, {});
          if (close.moment != nullptr) close.moment[number] = {};
          forces.end_contact(entry, neighbour);
          continue;
        }
      store<Law>(close, number, r);
      if constexpr (rolling) {
        close.moment[number] = {moment_.get(row)};
        forces.list.rolling[entry] = {rolled_.get(row), 0};
      }
      forces.store_contact(entry, neighbour, r);
      deepest = std::max(deepest, overlap_ratio_[row]);
    }
    tally.observe_overlap(static_cast<float>(deepest));
    count_ = 0;
  }

  // Compiled once for every processor and once for those with 256-bit vectors; both give the same bits.
  // Flattened, since a call in the loop would leave no vector loop.
  TANDEM_WIDE_VECTORS [[gnu::flatten]] void evaluate_rows(const Parameters<Real>& p, Real dt) {
    const std::size_t count = count_;
    const LengthUnit<Real> unit = p.unit;
    const std::uint32_t law = p.law;
    Real range = 0;
    if constexpr (Law::extended) range = unit.metres(p.range);
    [[maybe_unused]] const Real radius = p.kind_radius[0];
    [[maybe_unused]] const Coefficients<Real> k = p.kind_pair[0];
#pragma GCC ivdep
    for (std::size_t row = 0; row < count; ++row) {
      TouchingPair<Real> m = get(row);
      Real mass = 0, other_mass = 0;
      if constexpr (one_kind) {
        m.radius = m.other_radius = radius;
        m.k = k;
      } else {
        mass = sphere_mass(mass_per_volume_[row], m.radius);
        other_mass = sphere_mass(other_mass_per_volume_[row], m.other_radius);
        const PairConstants<Real> pair{constants(row), RowLaw::sized};
        m.k = coefficients_of_spheres(pair, mass, m.radius, other_mass, m.other_radius);
      }
      Contact<Real> c = contact_of<Law>(m, unit, range, dt);
      if constexpr (Law::extended) {
        set_sizes(c, mass, m.radius, other_mass, m.other_radius);
        c.adhesion = adhesion_[row];
        lasts_[row] = in_contact<RowLaw>(c, m.k, existed_[row] != 0) ? 1 : 0;
      }
      Vec3<Real> spring;
      if constexpr (Law::tangential) spring = spring_.get(row);
      const ContactForce<Real> f = RowLaw{}(c, m.k, law, spring);
      const PairResult<Real> r = result_of(c, f, spring);
      if constexpr (rolling) {
        Vec3<Real> rolled = rolled_.get(row), moment;
        moment += RollingResistance{}(c, f, m.w - m.other_w, {rolling_friction_[row], rolling_damping_[row]},
                                      rolling_inertia(mass, m.radius, other_mass, m.other_radius), rolled);
        rolled_.put(row, rolled);
        moment_.put(row, moment);
      }
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
      radius_[r] = m.radius;
      other_radius_[r] = m.other_radius;
    }
  }
  // What the materials of two spheres contribute.
  void put(std::size_t r, const View<Real>& view, std::uint32_t material, std::uint32_t other_material) {
    const Parameters<Real>& p = view.parameters;
    const std::uint32_t pair = material * max_materials + other_material;
    mass_per_volume_[r] = p.mass_per_volume[material];
    other_mass_per_volume_[r] = p.mass_per_volume[other_material];
    const Coefficients<Real>& k = p.pair[pair].c;
    k_n_[r] = k.k_n;
    c_n_[r] = k.c_n;
    if constexpr (Law::tangential) {
      k_t_[r] = k.k_t;
      c_t_[r] = k.c_t;
      friction_[r] = k.friction;
    }
    if constexpr (Law::extended) adhesion_[r] = view.extras[pair].adhesion;
    if constexpr (rolling) {
      rolling_friction_[r] = view.extras[pair].rolling.friction;
      rolling_damping_[r] = view.extras[pair].rolling.damping;
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
      m.radius = radius_[r];
      m.other_radius = other_radius_[r];
    }
    return m;
  }
  Coefficients<Real> constants(std::size_t r) const {
    Coefficients<Real> c;
    c.k_n = k_n_[r];
    c.c_n = c_n_[r];
    if constexpr (Law::tangential) {
      c.k_t = k_t_[r];
      c.c_t = c_t_[r];
      c.friction = friction_[r];
    }
    return c;
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
  // Where spheres are not all of one kind.
  Column radius_, other_radius_, mass_per_volume_, other_mass_per_volume_;
  Column k_n_, c_n_, k_t_, c_t_, friction_;  // constants of the two materials
  // Of extended laws; in existed_ and lasts_ 1 means yes.
  Column adhesion_, existed_, lasts_;
  // Of rolling.
  Column rolling_friction_, rolling_damping_;
  Columns3 rolled_, moment_;
  std::uint32_t number_[capacity];
  std::size_t count_ = 0;
};

}  // namespace tandem::dem
