// The engine's members for single spheres: upload at the start, inflow and outflow between windows, and
// download for frames and errors.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "common/error.hpp"
#include "common/scene/fault.hpp"
#include "dem_server/engine/engine_of.hpp"

namespace tandem::dem {

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::upload_spheres(const Spheres& spheres, Range share) {
  const Parameters<Real>& p = view_.parameters;
  std::vector<PositionRadius<Real>> position(memory_.n);
  std::vector<VelocityKind<Real>> velocity(memory_.n);
  std::vector<Spin<Real>> spin(memory_.n);
  std::vector<FinePart<Real>> fine(memory_.n);
  const std::vector<std::uint32_t> kind = kinds_of(p, spheres);
  std::vector<std::uint32_t> id(memory_.n);
  if (spheres.waiting > 0) kind_.assign(kind.begin(), kind.end());
  for (PositionRadius<Real>& none : position) none.radius = parked_radius<Real>;
  double mass = 0, volume = 0;  // of all spheres, including those that wait
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    PositionRadius<Real> sphere;
    sphere.radius = p.unit.count(spheres.radius[i]);
    mass += p.inertia(kind[i], p.radius(sphere)).mass;
    volume += 4.2 * spheres.radius[i] * spheres.radius[i] * spheres.radius[i];
    if (i < share.begin || i >= share.end) continue;
    const std::size_t at = i - share.begin;
    p.centres.split(p.centres.of(spheres.position[i]), sphere, fine[at]);
    position[at] = sphere;
    id[at] = spheres.id[i];
    velocity[at].label = Label::of_kind(kind[i]);
    set_velocity(spheres.velocity[i], velocity[at], fine[at]);
    spin[at] = {spheres.spin[i].template as<Real>(), spheres.id[i]};
  }
  const double fast = 1e4;  // [m/s], above any sound flow
  quanta_ = {Quantum::for_range(mass * fast), Quantum::for_range(mass),
             Quantum::for_range(mass * fast * fast), Quantum::for_range(volume)};
  for (int side = 0; side < 2; ++side) {
    exec_.upload(memory_.now.spheres.position[side], std::span<const PositionRadius<Real>>(position));
    exec_.upload(memory_.now.spheres.velocity[side], std::span<const VelocityKind<Real>>(velocity));
    if constexpr (Law::tangential)
      exec_.upload(memory_.now.spheres.spin[side], std::span<const Spin<Real>>(spin));
  }
  if constexpr (!Law::tangential) exec_.upload(memory_.now.spheres.id, std::span<const std::uint32_t>(id));
  if constexpr (has_fine_part<Real>)
    exec_.upload(memory_.now.spheres.fine, std::span<const FinePart<Real>>(fine));
}

template <BackEnd Exec, class Law, class Real>
std::uint64_t EngineOf<Exec, Law, Real>::remove(const OutletRegion& region) {
  const auto [momentum, count] =
      pass(memory_.n, RemoveSpheres<Real, InRegion>{view_, {region}, quanta_.momentum});
  passed_momentum_ += momentum;
  return count;
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::make_room_to_come_in(std::uint32_t count) {
  const std::uint32_t before = memory_.n, wanted = memory_.now.host_window.used + count;
  if (wanted <= before) return;
  enlarge_spheres(memory_.room_for(wanted));
}

// Enlarges the number of indices in use; the new ones hold no sphere.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::enlarge_spheres(std::uint32_t count) {
  const std::uint32_t before = memory_.n;
  memory_.resize_spheres(exec_, count);
  refresh_view();
  exec_.for_each(memory_.n - before, ParkFrom<Real>{view_, before});
}

// Reduces the number of indices in use where most spheres have gone, so that loops skip the others. Their
// memory is kept.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::shrink_spheres() {
  const std::uint32_t enough = memory_.room_for(memory_.now.host_window.used);
  if (ranks_ != nullptr || memory_.n / 2 <= enough) return;
  memory_.resize_spheres(exec_, enough);
  refresh_view();
}

// Moves the domain between two windows. Spheres that are then outside leave at once, since no cell can hold
// them.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::move_domain(Vec3d shift, WindowProgress& window) {
  const double range = view_.parameters.centres.range();
  for (int a = 0; a < 3; ++a)
    for (const double end : {domain_.min[a] + shift[a], domain_.max[a] + shift[a]})
      if (!(std::abs(end) <= range))
        throw Error(ErrorCode::numerics,
                    "the domain has followed its body to " + scene::rounded(end) +
                        " m, but for spheres of this size mixed precision counts to " +
                        scene::rounded(range) + " m",
                    "dem.domain.follows", "use \"precision\": \"double\"");
  const auto [momentum, count] =
      pass(memory_.n, RemoveSpheres<Real, OutsideDomain>{view_, {shift}, quanta_.momentum});
  passed_momentum_ += momentum;
  window.lost += count;
  window.domain_shift = shift;
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::insert(std::span<const Arrival> arrivals) {
  const auto wanted = static_cast<std::uint32_t>(arrivals.size());
  WindowProgress& window = memory_.now.host_window;
  std::uint32_t first = window.used;
  if (ranks_ == nullptr)
    make_room_to_come_in(wanted);
  else
    first = make_room_on_last_rank(wanted);
  std::vector<NewSphere> new_spheres;
  for (const Arrival& a : arrivals) new_spheres.push_back({a, kind_.at(a.id)});
  exec_.upload(inflow_.spheres, std::span<const NewSphere>(new_spheres));
  const bool here = ranks_ == nullptr || ranks_->rank() + 1 == ranks_->size();
  const auto [momentum, count] =
      pass(here ? wanted : 0,
           InsertSpheres<Real, Law::tangential>{view_, inflow_.spheres.data(), first, quanta_.momentum});
  if (count != wanted)
    throw Error(ErrorCode::internal, "a sphere comes in at an index that is taken", "insert");
  passed_momentum_ += -momentum;
  window.used += wanted;
  window.progress[0].rebuild_due = 1;
}

// Runs a functor n times that records the number and the momentum of the spheres that come in or go out.
// Returns both.
template <BackEnd Exec, class Law, class Real>
template <class Gate>
std::pair<Vec3d, std::uint64_t> EngineOf<Exec, Law, Real>::pass(std::uint32_t n, const Gate& gate) {
  tangents_.poses.clear();
  std::int64_t sum[total_count]{};
  exec_.zero(memory_.window.totals, total_count);
  exec_.template account<total_count>(n, gate);
  exec_.download(memory_.window.totals, std::span<std::int64_t>(sum));
  if (ranks_ != nullptr) {
    ranks_->sum(sum);
    rank_exchange_.refresh(exec_, view_, memory_.now.host_window.progress[0].state_side);
  }
  return {momentum_in(sum), static_cast<std::uint64_t>(sum[contact_entries])};
}

template <BackEnd Exec, class Law, class Real>
const std::vector<RegionSums>& EngineOf<Exec, Law, Real>::measure(std::span<const MeasuredRegion> regions) {
  auto& [totals, fixed, sums] = measured_;
  fixed.resize(regions.size() * region_total_count);
  sums.resize(regions.size());
  exec_.grow(totals, fixed.size());
  exec_.zero(totals, fixed.size());
  for (std::size_t k = 0; k < regions.size(); ++k) {
    View<Real> view = view_;
    view.totals = totals.data() + k * region_total_count;
    exec_.template account<region_total_count>(memory_.n,
                                               Measure<Real, Law::tangential>{view, quanta_, regions[k]});
  }
  exec_.download(totals, std::span<std::int64_t>(fixed));
  if (ranks_ != nullptr) ranks_->sum(fixed);
  for (std::size_t k = 0; k < regions.size(); ++k) {
    const std::int64_t* sum = fixed.data() + k * region_total_count;
    sums[k] = {
        .count = static_cast<std::uint64_t>(sum[contact_entries]),
        .mass = from_fixed(sum[total_mass], quanta_.mass),
        .volume = from_fixed(sum[region_volume], quanta_.volume),
        .moment = {from_fixed(sum[moment_x], quanta_.momentum), from_fixed(sum[moment_y], quanta_.momentum),
                   from_fixed(sum[moment_z], quanta_.momentum)},
        .momentum = momentum_in(sum),
        .kinetic_energy = with_rest(sum[kinetic_energy], sum[kinetic_energy_rest], quanta_.energy),
        .flow_momentum = with_rest(sum[flow_momentum], sum[flow_momentum_rest], quanta_.momentum)};
  }
  return measured_.sums;  // nvcc takes a name of the structured binding for a local variable
}

template <BackEnd Exec, class Law, class Real>
std::vector<std::uint8_t> EngineOf<Exec, Law, Real>::find_overlapping(std::span<const Ball> balls,
                                                                      std::span<const BodyPose> poses) {
  Vec3d low = balls.front().x, high = low;
  for (const Ball& ball : balls)
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], ball.x[a] - ball.radius);
      high[a] = std::max(high[a], ball.x[a] + ball.radius);
    }
  // Enough rows to keep a GPU busy, but not too many results to download. The last row is for the walls.
  const auto count = static_cast<std::uint32_t>(balls.size()),
             rows =
                 std::clamp<std::uint32_t>((1u << 18) / count, 1, std::max<std::uint32_t>(memory_.n / 16, 1));
  const std::size_t of_spheres = std::size_t{rows} * count;
  std::vector<std::uint8_t> found(of_spheres + count);
  exec_.upload(inflow_.body_pose, poses);
  exec_.upload(inflow_.balls, balls);
  exec_.grow(inflow_.taken, found.size());
  exec_.zero(inflow_.taken, found.size());
  exec_.for_each(rows, FindBallsOnSpheres<Real>{view_, inflow_.balls.data(), count, rows, low, high,
                                                inflow_.taken.data()});
  exec_.for_each(count, FindBallsOnWalls<Real>{view_, inflow_.balls.data(), inflow_.body_pose.data(),
                                               inflow_.taken.data() + of_spheres});
  exec_.download(inflow_.taken, std::span<std::uint8_t>(found));
  for (std::size_t k = count; k < found.size(); ++k) found[k % count] |= found[k];
  found.resize(count);
  if (ranks_ != nullptr) {
    std::vector<std::uint64_t> on_any(found.begin(), found.end());
    ranks_->maximum(on_any);
    std::ranges::transform(on_any, found.begin(),
                           [](std::uint64_t x) { return static_cast<std::uint8_t>(x); });
  }
  return found;
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::download(Spheres& out) {
  fetch_spheres(memory_.now.host_window.progress[0].state_side, 0, out);
}

// Downloads the present spheres (back = 0), or those before the last step, whose length is `back` [s].
// FinePart is not double buffered, so that velocities are those after that step.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::fetch_spheres(std::uint32_t side, double back, Spheres& out) {
  const std::uint32_t then = back > 0 ? side ^ 1 : side;
  fetch_arrays(side, then);
  const auto& [position, velocity, spin, fine, id, index] = fetched_;
  std::vector<PositionRadius<Real>> position_then(back > 0 ? memory_.n : 0);
  if (back > 0)
    exec_.download(memory_.now.spheres.position[then], std::span<PositionRadius<Real>>(position_then));
  if (back > 0 && ranks_ != nullptr) gather_at_first(position_then);
  const std::vector<PositionRadius<Real>>& before = back > 0 ? position_then : position;
  fetched_.sort_present(before, radius_.size());
  const Parameters<Real>& p = view_.parameters;
  const auto begin_anew = [this](auto&... column) {
    (column.clear(), ...), (column.reserve(memory_.n), ...);
  };
  begin_anew(out.position, out.velocity, out.spin, out.radius, out.material, out.id);
  out.waiting = 0;
  for (const std::uint32_t i : index) {
    const PositionRadius<Real>& now = position[i];
    const Vec3d v = velocity_of(velocity[i], fine[i]);
    Vec3d x = p.centre(now, fine[i]);
    // A sphere whose velocity is not finite has not moved.
    if (now.x != before[i].x || now.y != before[i].y || now.z != before[i].z) x -= back * v;
    out.position.push_back(p.periods.wrapped(x));
    out.velocity.push_back(v);
    out.spin.push_back(spin[i].w.template as<double>());
    out.radius.push_back(radius_[id[i]]);
    out.material.push_back(p.material(velocity[i].kind()));
    out.id.push_back(id[i]);
  }
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::download(SphereFrame& frame) {
  const std::uint32_t side = memory_.now.host_window.progress[0].state_side;
  fetch_arrays(side, side);
  fetched_.sort_present(fetched_.position, radius_.size());
  fill_frame(fetched_, view_.parameters, frame);
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::snapshot() {
  const std::uint32_t side = memory_.now.host_window.progress[0].state_side;
  if (ranks_ != nullptr) return download(snapshot_.gathered);
  memory_.snapshot.for_each(memory_.now.spheres, side, memory_.needs,
                            [this](const auto& from, auto& to) { exec_.copy(from, to); });
  exec_.mark();
  snapshot_.fetched.resize(memory_.n);
  snapshot_.parameters = view_.parameters;
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::read_snapshot(SphereFrame& frame) {
  if (ranks_ != nullptr) return std::swap(frame, snapshot_.gathered);
  auto& f = snapshot_.fetched;
  const auto& from = memory_.snapshot;
  exec_.download_marked(from.position, std::span<PositionRadius<Real>>(f.position));
  exec_.download_marked(from.velocity, std::span<VelocityKind<Real>>(f.velocity));
  if constexpr (has_fine_part<Real>) exec_.download_marked(from.fine, std::span<FinePart<Real>>(f.fine));
  if constexpr (Law::tangential) {
    exec_.download_marked(from.spin, std::span<Spin<Real>>(f.spin));
    f.take_ids_of_spins();
  } else {
    exec_.download_marked(from.id, std::span<std::uint32_t>(f.id));
  }
  f.sort_present(f.position, radius_.size());
  fill_frame(f, snapshot_.parameters, frame);
}

// The states are where the lists want them, far apart for neighbouring ids: they are requested some spheres
// ahead.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::fill_frame(const Fetched& from, const Parameters<Real>& p,
                                           SphereFrame& frame) const {
  constexpr std::size_t ahead = 16;
  const auto& [position, velocity, spin, fine, id, index] = from;
  const std::size_t count = index.size();
  frame.id.resize(count), frame.radius.resize(count);
  frame.position.resize(3 * count), frame.velocity.resize(3 * count), frame.spin.resize(3 * count);
  for (std::size_t k = 0; k < count; ++k) {
    if (k + ahead < count) {
      const std::uint32_t next = index[k + ahead];
      __builtin_prefetch(&position[next]);
      __builtin_prefetch(&velocity[next]);
      __builtin_prefetch(&spin[next]);
      __builtin_prefetch(&fine[next]);
    }
    const std::uint32_t i = index[k];
    const Vec3d x = p.periods.wrapped(p.centre(position[i], fine[i])), v = velocity_of(velocity[i], fine[i]);
    for (int a = 0; a < 3; ++a) {
      const std::size_t at = 3 * k + static_cast<std::size_t>(a);
      frame.position[at] = x[a];
      frame.velocity[at] = static_cast<float>(v[a]);
      frame.spin[at] = static_cast<float>(spin[i].w[a]);
    }
    frame.id[k] = id[i];
    frame.radius[k] = static_cast<float>(radius_[id[i]]);
  }
}

// `fetched_`, but for the index.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::fetch_arrays(std::uint32_t side, std::uint32_t spin_side) {
  auto& f = fetched_;
  f.resize(memory_.n);
  exec_.download(memory_.now.spheres.position[side], std::span<PositionRadius<Real>>(f.position));
  exec_.download(memory_.now.spheres.velocity[side], std::span<VelocityKind<Real>>(f.velocity));
  if constexpr (has_fine_part<Real>)
    exec_.download(memory_.now.spheres.fine, std::span<FinePart<Real>>(f.fine));
  if constexpr (Law::tangential) {
    exec_.download(memory_.now.spheres.spin[spin_side], std::span<Spin<Real>>(f.spin));
    f.take_ids_of_spins();
  } else {
    exec_.download(memory_.now.spheres.id, std::span<std::uint32_t>(f.id));
  }
  if (ranks_ == nullptr) return;
  gather_at_first(f.position), gather_at_first(f.velocity), gather_at_first(f.spin), gather_at_first(f.fine);
  gather_at_first(f.id);
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::Fetched::sort_present(const std::vector<PositionRadius<Real>>& positions,
                                                      std::size_t ids) {
  constexpr std::uint32_t none = ~0u;
  index.assign(ids, none);
  for (std::uint32_t i = 0; i < id.size(); ++i)
    if (!is_parked(positions[i]) && id[i] < ids) index[id[i]] = i;
  std::erase(index, none);
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::fail(const WindowProgress& c) {
  const std::uint32_t step = c.progress[0].step == 0 ? 0 : c.progress[0].step - 1;
  if (c.error & blocks_apart)
    throw Error(ErrorCode::resource,
                "the device does not run all multiprocessors at once: a barrier of theirs waited for seconds",
                "CUDA device", "leave the device to this run, or set TANDEM_CUDA_REGIONS=0");
  if (c.error & ranks_apart)
    throw Error(ErrorCode::resource, "another rank has sent nothing for a minute", "--ranks",
                "see the logs of the ranks, and whether other programs use their devices");
  const std::uint32_t id = id_of_culprit(c.culprit);
  const std::string where =
      "sphere " + std::to_string(id) + ", micro step " + std::to_string(c.progress[0].step);
  Spheres before;
  fetch_spheres(c.progress[0].state_side, c.dt, before);
  if (c.error & not_finite)
    throw SphereError(
        Error(ErrorCode::numerics,
              "a sphere's velocity is not finite or above " +
                  scene::rounded(static_cast<double>(view_.parameters.speed_limit)) + " m/s",
              where, "use a smaller dem.micro_step, softer materials, or a start without overlaps"),
        id, step, std::move(before));
  if (c.error & wall_contacts_overflow)
    throw SphereError(
        Error(ErrorCode::numerics,
              "a sphere touches more than " + std::to_string(max_wall_contacts) + " surfaces of one body",
              where, "use a coarser mesh, or one that is smooth on the scale of the sphere"),
        id, step, std::move(before));
  throw SphereError(
      Error(
          ErrorCode::numerics, "a wall force exceeds the range of the exact sums", where,
          "overlaps are beyond a tenth of the radius: use a smaller dem.micro_step, slower walls, a stiffer "
          "material or less cohesion"),
      id, step, std::move(before));
}

}  // namespace tandem::dem
