// The engine's members for single spheres: those that are there at the start, those that come in and go out
// between windows, and what the host is told of them, in frames and in errors.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "common/error.hpp"
#include "common/scene/fault.hpp"
#include "dem_server/step/engine_of.hpp"

namespace tandem::dem {

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::upload_spheres(const Spheres& spheres) {
  const Parameters<Real>& p = view_.parameters;
  std::vector<Place<Real>> place(n_);
  std::vector<Drift<Real>> drift(n_);
  std::vector<Spin<Real>> spin(n_);
  std::vector<Remainder<Real>> remainder(n_);
  const std::vector<std::uint32_t> kind = kinds_of(p, spheres);
  std::vector<std::uint32_t> id(n_);
  if (spheres.waiting > 0) kind_.assign(kind.begin(), kind.end());
  for (Place<Real>& none : place) none.radius = parked_radius<Real>;
  double mass = 0;  // of all, also of those that wait
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    Place<Real> sphere;
    sphere.radius = p.unit.count(spheres.radius[i]);
    mass += p.inertia(kind[i], p.radius(sphere)).mass;
    if (i + spheres.waiting >= spheres.size()) continue;
    p.centres.split(p.centres.of(spheres.position[i]), sphere, remainder[i]);
    place[i] = sphere;
    id[i] = spheres.id[i];
    drift[i].label = Label::of_kind(kind[i]);
    set_velocity(spheres.velocity[i], drift[i], remainder[i]);
    spin[i] = {spheres.spin[i].template as<Real>(), spheres.id[i]};
  }
  const double fast = 1e4;  // [m/s], above any sound flow
  quanta_ = {Quantum::for_range(mass * fast), Quantum::for_range(mass),
             Quantum::for_range(mass * fast * fast)};
  for (int side = 0; side < 2; ++side) {
    exec_.upload(now_.place[side], std::span<const Place<Real>>(place));
    exec_.upload(now_.drift[side], std::span<const Drift<Real>>(drift));
    if constexpr (Law::tangential) exec_.upload(now_.spin[side], std::span<const Spin<Real>>(spin));
  }
  if constexpr (!Law::tangential) exec_.upload(now_.id, std::span<const std::uint32_t>(id));
  if constexpr (has_remainder<Real>)
    exec_.upload(now_.remainder, std::span<const Remainder<Real>>(remainder));
}

template <class Exec, class Law, class Real>
std::uint64_t EngineOf<Exec, Law, Real>::take_out(const Region& region) {
  const auto [momentum, count] = pass(n_, TakeOut<Real>{view_, region, quanta_.momentum});
  passed_momentum_ += momentum;
  return count;
}

// What is outside leaves at the border of windows: cells hold no sphere beyond the domain.
template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::move_domain(Vec3d shift, Control& control) {
  const double range = view_.parameters.centres.range();
  for (int a = 0; a < 3; ++a)
    for (const double end : {domain_.min[a] + shift[a], domain_.max[a] + shift[a]})
      if (!(std::abs(end) <= range))
        throw Error(ErrorCode::numerics,
                    "the domain has followed its body to " + scene::rounded(end) +
                        " m, but for spheres of this size mixed precision counts to " +
                        scene::rounded(range) + " m",
                    "dem.domain.follows", "use \"precision\": \"double\"");
  const auto [momentum, count] = pass(n_, LeaveBehind<Real>{view_, shift, quanta_.momentum});
  passed_momentum_ += momentum;
  control.lost += count;
  control.domain_shift = shift;
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::bring_in(std::span<const Arrival> arrivals) {
  const auto wanted = static_cast<std::uint32_t>(arrivals.size());
  make_room_to_come_in(wanted);
  std::vector<Entrant> entrants;
  for (const Arrival& a : arrivals) entrants.push_back({a, kind_.at(a.id)});
  exec_.upload(entrants_, std::span<const Entrant>(entrants));
  Control& control = now_.host_control;
  const auto [momentum, count] =
      pass(wanted, BringIn<Real, Law::tangential>{view_, entrants_.data(), control.used, quanta_.momentum});
  if (count != wanted)
    throw Error(ErrorCode::internal, "a slot for a sphere to come in held one", "bring_in");
  passed_momentum_ += -momentum;
  control.used += wanted;
  control.progress[0].rebuild_due = 1;
}

// Runs a functor n times that books number and momentum of the spheres that it passes.
template <class Exec, class Law, class Real>
template <class Gate>
std::pair<Vec3d, std::uint64_t> EngineOf<Exec, Law, Real>::pass(std::uint32_t n, const Gate& gate) {
  tangent_poses_.clear();
  std::int64_t sum[book_count]{};
  exec_.zero(books_, book_count);
  exec_.template account<book_count>(n, gate);
  exec_.download(books_, std::span<std::int64_t>(sum));
  return {momentum_in(sum), static_cast<std::uint64_t>(sum[contact_entries])};
}

template <class Exec, class Law, class Real>
std::vector<std::uint8_t> EngineOf<Exec, Law, Real>::find_taken(std::span<const Ball> balls,
                                                                std::span<const BodyPose> poses) {
  Vec3d low = balls.front().x, high = low;
  for (const Ball& ball : balls)
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], ball.x[a] - ball.radius);
      high[a] = std::max(high[a], ball.x[a] + ball.radius);
    }
  // Rows enough to keep a GPU busy, and answers few enough to fetch; the last row is of the walls.
  const auto count = static_cast<std::uint32_t>(balls.size()),
             rows = std::clamp<std::uint32_t>((1u << 18) / count, 1, std::max<std::uint32_t>(n_ / 16, 1));
  const std::size_t of_spheres = std::size_t{rows} * count;
  std::vector<std::uint8_t> found(of_spheres + count);
  exec_.upload(body_pose_, poses);
  exec_.upload(balls_, balls);
  exec_.grow(taken_, found.size());
  exec_.zero(taken_, found.size());
  exec_.for_each(rows, FindTaken<Real>{view_, balls_.data(), count, rows, low, high, taken_.data()});
  exec_.for_each(count,
                 FindWalled<Real>{view_, balls_.data(), body_pose_.data(), taken_.data() + of_spheres});
  exec_.download(taken_, std::span<std::uint8_t>(found));
  for (std::size_t k = count; k < found.size(); ++k) found[k % count] |= found[k];
  found.resize(count);
  return found;
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::download(Spheres& out) {
  fetch_spheres(now_.host_control.progress[0].state_side, 0, out);
}

// As they are, or as the last step found them, which took `back` [s]. What Remainder has lies on one side, so
// that velocities are then those after that step.
template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::fetch_spheres(std::uint32_t side, double back, Spheres& out) {
  const std::uint32_t then = back > 0 ? side ^ 1 : side;
  auto& [place, drift, spin, remainder, id, slot] = fetched_;
  const auto make_room = [this](auto&... array) { (array.resize(n_), ...); };
  make_room(place, drift, spin, remainder, id);
  exec_.download(now_.place[side], std::span<Place<Real>>(place));
  exec_.download(now_.drift[side], std::span<Drift<Real>>(drift));
  if constexpr (has_remainder<Real>) exec_.download(now_.remainder, std::span<Remainder<Real>>(remainder));
  if constexpr (Law::tangential) {
    exec_.download(now_.spin[then], std::span<Spin<Real>>(spin));
    for (std::uint32_t i = 0; i < n_; ++i) id[i] = spin[i].id;
  } else {
    exec_.download(now_.id, std::span<std::uint32_t>(id));
  }
  std::vector<Place<Real>> place_then(back > 0 ? n_ : 0);
  if (back > 0) exec_.download(now_.place[then], std::span<Place<Real>>(place_then));
  const std::vector<Place<Real>>& before = back > 0 ? place_then : place;
  constexpr std::uint32_t none = ~0u;
  slot.assign(radius_.size(), none);
  for (std::uint32_t i = 0; i < n_; ++i)
    if (!is_parked(before[i]) && id[i] < slot.size()) slot[id[i]] = i;
  const Parameters<Real>& p = view_.parameters;
  const auto begin_anew = [this](auto&... column) { (column.clear(), ...), (column.reserve(n_), ...); };
  begin_anew(out.position, out.velocity, out.spin, out.radius, out.material, out.id);
  out.waiting = 0;
  for (const std::uint32_t i : slot) {
    if (i == none) continue;
    const Place<Real>& now = place[i];
    const Vec3d v = velocity_of(drift[i], remainder[i]);
    Vec3d x = p.centre(now, remainder[i]);
    // Those that are not finite have stayed.
    if (now.x != before[i].x || now.y != before[i].y || now.z != before[i].z) x -= back * v;
    out.position.push_back(p.periods.wrapped(x));
    out.velocity.push_back(v);
    out.spin.push_back(spin[i].w.template as<double>());
    out.radius.push_back(radius_[id[i]]);
    out.material.push_back(p.material(drift[i].kind()));
    out.id.push_back(id[i]);
  }
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::fail(const Control& c) {
  const std::uint32_t step = c.progress[0].step == 0 ? 0 : c.progress[0].step - 1;
  if (c.error & blocks_apart)
    throw Error(ErrorCode::resource,
                "the device does not run all multiprocessors at once: a barrier of theirs waited for seconds",
                "CUDA device", "leave the device to this run, or set TANDEM_CUDA_REGIONS=0");
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
