#include "coordinator/watch/sphere_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "particles/io/inlets.hpp"

namespace tandem::launch {
namespace {

using protocol::BodyMotion;

// Accounts may count overlaps less often than at each step: only what nobody can overlook counts.
constexpr double clear_overlap = 0.05, clear_factor = 2;
// Of a larger frame only a part of this size is searched for overlaps, with at most so many distances.
constexpr std::size_t searched_spheres = 50'000, most_distances = 10'000'000, small_frame = 2'000;
constexpr double block_edge = 10;  // of the largest radius
// A window may begin and end while a sphere is held by a contact, with less energy than between them.
constexpr double way_factor = 1.2, way_of_radius = 0.1;
// Of larger frames every so many spheres are compared with planes, others in each frame, and with their own
// places before.
constexpr std::size_t compared_with_planes = 1'000'000, compared_paths = 200'000;
constexpr double windows_to_come_in = 10;

Vec3d position_of(const protocol::ParticlesFrame& frame, std::size_t i) {
  return {frame.position[3 * i], frame.position[3 * i + 1], frame.position[3 * i + 2]};
}
Vec3d velocity_of(const protocol::ParticlesFrame& frame, std::size_t i) {
  return Vec3f{frame.velocity[3 * i], frame.velocity[3 * i + 1], frame.velocity[3 * i + 2]}.as<double>();
}
double radius_of(const protocol::ParticlesFrame& frame, std::size_t i) {
  return static_cast<double>(frame.radius[i]);
}
float single(double x) {
  return static_cast<float>(std::clamp(x, -1e30, 1e30));
}
// Of translation [J].
double energy_of(const SceneSpheres& spheres, const protocol::ParticlesFrame& frame) {
  double energy = 0;
  for (std::size_t i = 0; i < frame.id.size(); ++i)
    if (frame.id[i] < spheres.in_all)
      energy += 0.5 * sphere_mass(spheres.group_of(frame.id[i]).density, radius_of(frame, i)) *
                norm2(velocity_of(frame, i));
  return energy;
}
double fastest(const protocol::ParticlesFrame& frame) {
  double squared = 0;
  for (std::size_t i = 0; i < frame.id.size(); ++i) squared = std::max(squared, norm2(velocity_of(frame, i)));
  return std::sqrt(squared);
}

std::uint64_t mixed(std::uint64_t a, std::uint64_t b) {
  std::uint64_t z = (a ^ (b * 0x9e3779b97f4a7c15ULL)) + 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

// How far a place is inside a region; below 0: outside [m].
double depth_in(const scene::Outlet& outlet, Vec3d x) {
  if (const auto* beyond = std::get_if<scene::HalfSpace>(&outlet.region))
    return dot(x - beyond->point, beyond->normal);
  const auto& box = std::get<scene::Box>(outlet.region);
  double depth = x.x - box.min.x;
  for (int a = 0; a < 3; ++a) depth = std::min({depth, x[a] - box.min[a], box.max[a] - x[a]});
  return depth;
}

}  // namespace

SphereWatch::SphereWatch(const scene::Scene& scene, const SceneSpheres& spheres)
    : dem_(scene.dem.value()), spheres_(spheres), gravity_(scene.gravity) {
  origin_ = 0.5 * (dem_.domain.min + dem_.domain.max);
  for (const scene::Wall& wall : dem_.walls)
    if (const auto* shape = std::get_if<scene::PlaneShape>(&wall.shape)) {
      Plane plane;
      plane.wall = &wall;
      plane.point = wall.pose.p_WB + wall.pose.q_WB.rotate(shape->point);
      plane.normal = (1 / norm(shape->normal)) * wall.pose.q_WB.rotate(shape->normal);
      before_.planes.push_back({plane.point, plane.normal});
      planes_.push_back(plane);
    }
  auto first = static_cast<std::uint32_t>(spheres.at_start);
  for (particles::Inlet& inlet : particles::make_inlets(scene)) {
    const auto count = static_cast<std::uint32_t>(inlet.due.size());
    entrances_.push_back({inlet.name, inlet.fill, inlet.velocity, first, std::move(inlet.due)});
    first += count;
  }
}

std::size_t SphereWatch::Entrance::due_by(double time) const {
  return static_cast<std::size_t>(std::ranges::upper_bound(due, time) - due.begin());
}

template <class Example>
void SphereWatch::take(Kind kind, std::uint64_t spheres, double time, const Example& example) {
  FalseSpheres& worst = false_spheres_[static_cast<std::size_t>(kind)];
  if (spheres > worst.spheres) worst = {spheres, time, example()};
}

double SphereWatch::allowed_overlap() const {
  return clear_overlap + clear_factor * windows_.account->max_overlap_ratio;
}

void SphereWatch::record(const Exchange& exchange) {
  const protocol::LoadSet& load = exchange.load;
  before_.account = load.account;
  before_.window = load.window.length();
  before_.longest_window = std::max(before_.longest_window, before_.window);
  std::rotate(energies_.begin(), energies_.begin() + 1, energies_.end());
  energies_.back() = before_.account->kinetic_energy;
  before_.way += before_.window * std::sqrt(2 * *std::ranges::max_element(energies_));
  if (const double g = norm2(gravity_); g > 0) {
    const double mass = dot(before_.account->gravity_impulse, gravity_) / (g * before_.window);
    if (before_.mass_there >= 0 && mass > before_.mass_there * (1 + 1e-9)) before_.mass_rose = true;
    before_.mass_there = mass;
  }
  for (std::size_t k = 0; k < planes_.size(); ++k) {
    const Plane& plane = planes_[k];
    const std::uint32_t of = plane.wall->body.value;
    const auto path = std::ranges::find(exchange.path.bodies, of, &BodyMotion::body);
    if (path == exchange.path.bodies.end()) continue;
    const Pose& pose = path->end_pose;
    before_.planes[k] = {pose.p_WB + pose.q_WB.rotate(plane.point), pose.q_WB.rotate(plane.normal)};
  }
}

void SphereWatch::begin(const Frame& frame) {
  if (!std::exchange(framed_, true)) energies_.fill(energy_of(spheres_, frame));
}

SphereWatch::Before SphereWatch::take_before() {
  Before before = before_;
  before_.way = 0;
  return before;
}

// ---- overlaps

// Sweeps along x in blocks of the domain, whose spheres are next to each other after sorting.
void SphereWatch::count_overlaps(const Frame& frame) {
  struct Ball {
    std::uint64_t block;
    Vec3d x;
    double radius;
    std::uint32_t id;
  };
  const std::size_t n = frame.id.size();
  const auto largest_float = std::ranges::max_element(frame.radius);
  if (n < 2 || !(*largest_float > 0)) return;
  const auto largest = static_cast<double>(*largest_float);
  const std::uint64_t parts = (n + searched_spheres - 1) / searched_spheres;
  const double per_edge = 1 / (block_edge * largest);
  // Blocks that are displaced by half their length in each second frame: a pair is on both sides of a face in
  // one frame only.
  const double displaced =
      (frames_ % 2 == 0 ? 0.0 : 0.5) + 0x1p40;  // positive, so that the conversion rounds down
  std::vector<Ball> balls;
  balls.reserve(std::min(n, 2 * searched_spheres));
  for (std::size_t i = 0; i < n && balls.size() < 2 * searched_spheres; ++i) {
    const Vec3d x = position_of(frame, i) - origin_;
    std::uint64_t block = 0;
    if (n > small_frame) {
      for (int a = 0; a < 3; ++a)
        block = block * 0x9e3779b97f4a7c15ULL +
                static_cast<std::uint64_t>(std::clamp(x[a] * per_edge + displaced, 0.0, 1e15));
      block = mixed(block, frames_);
      if (parts > 1 && block % parts != 0) continue;
    }
    balls.push_back({block, x, radius_of(frame, i), frame.id[i]});
  }
  std::ranges::sort(balls, [](const Ball& a, const Ball& b) {
    return a.block != b.block ? a.block < b.block : a.x.x < b.x.x;
  });
  const double allowed = allowed_overlap();
  std::size_t distances = 0;
  std::uint64_t found = 0;
  double deepest = 0;
  std::size_t first = 0, second = 0;
  for (std::size_t i = 0; i < balls.size() && distances < most_distances; ++i)
    for (std::size_t j = i + 1; j < balls.size() && balls[j].block == balls[i].block; ++j) {
      const double reach = balls[i].radius + balls[j].radius;
      if (balls[j].x.x - balls[i].x.x >= balls[i].radius + largest || ++distances >= most_distances) break;
      const double squared = norm2(balls[j].x - balls[i].x);
      if (squared >= reach * reach) continue;
      const double ratio = (reach - std::sqrt(squared)) / std::min(balls[i].radius, balls[j].radius);
      if (!(ratio > allowed)) continue;
      found += 2;
      if (ratio > deepest) deepest = ratio, first = i, second = j;
    }
  take(Kind::overlap, std::min<std::uint64_t>(found, n), to_seconds(frame.time), [&] {
    return fmt::format(
        "its spheres {} and {} overlap by {:.3g} of the smaller radius, and by at most {:.3g} in the account",
        balls[first].id, balls[second].id, deepest, windows_.account->max_overlap_ratio);
  });
}

// Planes are solid without end.
void SphereWatch::count_in_planes(const Frame& frame) {
  const std::size_t n = frame.id.size();
  const std::size_t stride = n * planes_.size() / compared_with_planes + 1;
  const double allowed = allowed_overlap(), time = to_seconds(frame.time);
  for (std::size_t k = 0; k < planes_.size(); ++k) {
    const PlaneInWorld& plane = windows_.planes[k];
    std::uint64_t too_deep = 0;
    std::size_t first_deep = 0;
    for (std::size_t i = frames_ % stride; i < n; i += stride) {
      const Vec3d x = position_of(frame, i);
      const double radius = radius_of(frame, i), depth = radius - dot(x - plane.point, plane.normal);
      if (depth > allowed * radius && ++too_deep == 1) first_deep = i;
    }
    take(Kind::plane, too_deep, time, [&] {
      return fmt::format(
          "its sphere {} is {:.3g} of its radius inside the plane '{}', and the largest overlap of the "
          "account "
          "is {:.3g}",
          frame.id[first_deep],
          1 - dot(position_of(frame, first_deep) - plane.point, plane.normal) / radius_of(frame, first_deep),
          planes_[k].wall->name, windows_.account->max_overlap_ratio);
    });
  }
}

// ---- paths

// The root of the sum of m |displacement|^2 is at most the integral of the root of the sum of m |v|^2, which
// is that of twice the kinetic energy, whatever forces act. Spheres whose ids are exchanged go farther.
void SphereWatch::compare_paths(const Frame& frame) {
  const std::uint64_t stride = spheres_.in_all / compared_paths + 1;
  now_.clear();
  double size = 0;
  for (std::size_t i = 0; i < frame.id.size(); ++i) {
    if (frame.id[i] >= spheres_.in_all || frame.id[i] % stride != 0) continue;
    const Vec3d x = position_of(frame, i) - origin_;
    now_.push_back({frame.id[i], single(x.x), single(x.y), single(x.z), frame.radius[i]});
    size = std::max({size, std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  }
  if (has_last_) compare_places(to_seconds(frame.time), size);
  std::swap(last_, now_);
  has_last_ = true;
}

void SphereWatch::compare_places(double time, double size) {
  const Vec3d period = dem_.domain.max - dem_.domain.min;
  auto group = spheres_.groups.begin();
  auto before = last_.begin();
  double moved = 0, mass = 0, of_radii = 0;
  std::uint64_t common = 0, changed = 0;
  Place first_now{}, first_before{};  // of those whose radius changed
  for (const Place& now : now_) {
    while (now.id >= group->end) ++group;
    while (before != last_.end() && before->id < now.id) ++before;
    if (before == last_.end()) break;
    if (before->id != now.id) continue;
    Vec3d d = Vec3f{now.x - before->x, now.y - before->y, now.z - before->z}.as<double>();
    for (int a = 0; a < 3; ++a)
      if (dem_.periodic[static_cast<std::size_t>(a)]) d[a] -= period[a] * std::round(d[a] / period[a]);
    const auto radius = static_cast<double>(now.radius);
    const double m = sphere_mass(group->density, radius);
    moved += m * norm2(d);
    mass += m;
    of_radii += m * radius * radius;
    ++common;
    if (!(std::abs(now.radius - before->radius) <= 1e-6F * now.radius) && ++changed == 1)
      first_now = now, first_before = *before;
  }
  take(Kind::changed_radius, changed, time, [&] {
    return fmt::format("its sphere {} has the radius {:.6g} m, and had {:.6g} m before", first_now.id,
                       static_cast<double>(first_now.radius), static_cast<double>(first_before.radius));
  });
  const double most =
      way_factor * windows_.way + way_of_radius * std::sqrt(of_radii) + std::sqrt(mass) * 1e-6 * size;
  take(Kind::path, common > 1 && std::sqrt(moved) > most ? common : 0, time, [&] {
    return fmt::format(
        "since the frame before, its spheres have moved by {:.3g} m, and by at most {:.3g} m with the "
        "kinetic "
        "energy of the account (root of the mean square, weighted by mass), as if their ids were exchanged",
        std::sqrt(moved / mass), most / std::sqrt(mass));
  });
}

// ---- inlets and outlets

void SphereWatch::count_inlets(const Frame& frame) {
  const double time = to_seconds(frame.time);
  for (Entrance& e : entrances_) {
    const auto after = std::ranges::lower_bound(frame.id, e.first + static_cast<std::uint32_t>(e.due.size()));
    if (after != frame.id.begin() && *(after - 1) >= e.first)
      e.entered = std::max(e.entered, *(after - 1) - e.first + 1);
    const auto due = static_cast<std::uint32_t>(e.due_by(time + 1e-9));
    take(Kind::inlet, e.entered > due ? e.entered - due : 0, time, [&] {
      return fmt::format("its sphere {} of inlet '{}' is not due before t = {:.6g} s",
                         e.first + e.entered - 1, e.name, e.due[e.entered - 1]);
    });
    if (!windows_.account || dem_.follows) continue;
    // Spheres wait while their box is full. Those that no frame has had may have left again.
    const std::uint64_t expected = e.due_by(time - windows_to_come_in * windows_.longest_window),
                        gone = e.entered + windows_.account->lost_particles;
    const bool may_have_left =
        !dem_.outlets.empty() && (e.entered > 0 || windows_.mass_rose || windows_.mass_there < 0);
    if (expected <= gone || may_have_left) continue;
    const double reach = windows_to_come_in * windows_.longest_window,
                 speed = fastest(frame) + norm(e.velocity) + reach * norm(gravity_);
    std::size_t i = 0;
    for (; i < frame.id.size(); ++i) {
      const Vec3d x = position_of(frame, i);
      const double margin = 2 * radius_of(frame, i) + 4 * windows_.window * speed;
      bool near = true;
      for (int a = 0; a < 3; ++a)
        near = near && x[a] > e.fill.min[a] - margin && x[a] < e.fill.max[a] + margin;
      if (near) break;
    }
    if (i < frame.id.size()) continue;
    take(Kind::inlet, expected - gone, time, [&] {
      return fmt::format(
          "{} spheres of inlet '{}' are due, {} have come in, and no sphere is in its box (walls may fill "
          "it)",
          expected, e.name, e.entered);
    });
  }
}

// Outlets act between windows: a sphere deeper in one than its way in a window was there before.
void SphereWatch::count_in_outlets(const Frame& frame) {
  if (dem_.outlets.empty() || dem_.follows) return;
  const double way = 2 * windows_.window * (fastest(frame) + windows_.window * norm(gravity_));
  for (const scene::Outlet& of : dem_.outlets) {
    std::uint64_t inside = 0;
    std::size_t first = 0;
    for (std::size_t i = 0; i < frame.id.size(); ++i)
      if (depth_in(of, position_of(frame, i)) > way && ++inside == 1) first = i;
    take(Kind::outlet, inside, to_seconds(frame.time), [&] {
      const Vec3d x = position_of(frame, first);
      return fmt::format("its sphere {} is at ({:.6g}, {:.6g}, {:.6g}) m, inside the outlet '{}'",
                         frame.id[first], x.x, x.y, x.z, of.name);
    });
  }
}

void SphereWatch::check(const Frame& frame, const Before& before) {
  windows_ = before;
  compare_paths(frame);
  count_inlets(frame);
  if (windows_.account) {
    count_overlaps(frame);
    count_in_planes(frame);
    count_in_outlets(frame);
  }
  ++frames_;
  const std::scoped_lock lock(*published_mutex_);
  published_ = false_spheres_;
}

}  // namespace tandem::launch
