#include "coordinator/watch/particle_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

using protocol::BodyLoad;
using protocol::BodyMotion;
using protocol::ParticlesFrame;

// Participants may compute the mass of a sphere in single precision.
constexpr double mass_share = 1e-5;
constexpr double allowed_place = 1e-3;  // of the radius
// Share of the energy of a run below which spheres are at rest: a millionth of its velocities.
constexpr double rest_share = 1e-12;
// Frames resolve this share of a radius: their single precision.
constexpr double place_share = 0x1p-24;
// Lever arm of the forces on a body, of the largest radius, that counts as torque: forces whose torques
// cancel leave their rounding, and a solver that gives no torques at all is judged by its forces.
constexpr double smallest_arm = 0.1;

Vec3d vector_at(const std::vector<double>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}
Vec3d vector_at(const std::vector<float>& values, std::size_t i) {
  return Vec3f{values[3 * i], values[3 * i + 1], values[3 * i + 2]}.as<double>();
}

std::string vector_text(Vec3d v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}

[[noreturn]] void refuse_particles(const std::string& problem, const char* check) {
  throw Error(
      ErrorCode::protocol, problem, "dem_server",
      fmt::format("use a particle participant that follows the scene: tandem conform --role dem --check {}",
                  check));
}

template <class Records>
auto* record_of(Records& records, std::uint32_t body) {
  const auto found =
      std::ranges::find_if(records, [body](const auto& record) { return record.body == body; });
  return found == records.end() ? nullptr : &*found;
}

}  // namespace

ParticleWatch::ParticleWatch(const SceneFile& file) : scene_(file.scene), spheres_(spheres_of(file)) {
  const scene::Dem& dem = scene_.dem.value();
  origin_ = 0.5 * (dem.domain.min + dem.domain.max);
  for (const SceneSpheres::Group& group : spheres_.groups)
    largest_radius_ = std::max(largest_radius_, group.largest);
  open_ = !dem.outlets.empty() || spheres_.in_all != spheres_.at_start;
  periodic_ = std::ranges::any_of(dem.periodic, [](bool axis) { return axis; });
}

// ---- the account

// Sums of the first window, in which no sphere has come or gone.
void ParticleWatch::expect_start(const protocol::LoadSet& load) const {
  const protocol::ParticleAccount& a = load.account;
  if (open_) return;
  const double length = load.window.length(), gravity = length * norm(scene_.gravity);
  const Vec3d begin = a.momentum_begin;
  if (!(norm(begin - spheres_.momentum) <=
        mass_share * (spheres_.momentum_size + spheres_.mass * gravity) + spheres_.momentum_spread))
    refuse_particles(
        fmt::format("the particles start with the momentum {} kg m/s, and the scene gives them {} kg m/s",
                    vector_text(begin), vector_text(spheres_.momentum)),
        "free_flight");
  if (a.lost_particles > 0) return;
  const Vec3d expected = (spheres_.mass * length) * scene_.gravity;
  if (!(norm(a.gravity_impulse - expected) <=
        mass_share * spheres_.mass * gravity + spheres_.mass_spread * gravity))
    refuse_particles(
        fmt::format("gravity gives the particles {} N s in the first window of {:.6g} s, and {} N s by the "
                    "spheres of the scene, whose mass is {:.6g} kg",
                    vector_text(a.gravity_impulse), length, vector_text(expected), spheres_.mass),
        "free_flight");
}

void ParticleWatch::expect_possible(const protocol::ParticleAccount& a) const {
  if (a.lost_particles > spheres_.in_all)
    refuse_particles(fmt::format("the account has {} lost particles, and the scene {} spheres",
                                 a.lost_particles, spheres_.in_all),
                     "lost_particle");
  if (before_.account && a.lost_particles < before_.account->lost_particles)
    refuse_particles(
        fmt::format("the account has {} lost particles since the start, after {} in the window before",
                    a.lost_particles, before_.account->lost_particles),
        "lost_particle");
  const std::optional<double> step = scene_.dem->micro_step;
  if (step && !(a.micro_step <= *step * (1 + 1e-9)))
    refuse_particles(
        fmt::format("the account has micro steps of {:.6g} s, and dem.micro_step of the scene is {:.6g} s",
                    a.micro_step, *step),
        "micro_steps");
}

void ParticleWatch::record(const Exchange& exchange) {
  expect_possible(exchange.load.account);
  if (exchange.load.window.index == 0) expect_start(exchange.load);
  add(exchange);
}

void ParticleWatch::add(const Exchange& exchange) {
  const protocol::LoadSet& load = exchange.load;
  before_.domain_shift = {};
  if (scene_.dem->follows)
    if (const BodyMotion* path = record_of(exchange.path.bodies, scene_.dem->follows->value)) {
      const Vec3d start = scene_.mbd->bodies[path->body].pose.p_WB;
      before_.domain_shift = {path->begin_pose.p_WB - start, path->end_pose.p_WB - start};
    }
  if (framed_) add_torques(exchange);
  before_.lost_before = before_.account ? before_.account->lost_particles : lost_at_begin_;
  before_.account = load.account;
  before_.window = load.window.length();
}

// ---- angular momentum

// The integral over the window of what the bodies and the ground exert on the particles, about `origin_`: the
// place of a body is that of its prescribed path, whose mean and mean velocity count.
void ParticleWatch::add_torques(const Exchange& exchange) {
  const protocol::LoadSet& load = exchange.load;
  const double H = load.window.length();
  Interval& interval = before_.interval;
  for (const BodyLoad& body : load.bodies) {
    Vec3d arm = -origin_, velocity;
    if (const BodyMotion* path = record_of(exchange.path.bodies, body.body)) {
      arm += 0.5 * (path->begin_pose.p_WB + path->end_pose.p_WB) +
             (H / 12) * (path->begin_twist.v_WB - path->end_twist.v_WB);
      velocity = (1 / H) * (path->end_pose.p_WB - path->begin_pose.p_WB);
    }
    interval.torque +=
        -H * (body.mean.torque + cross(arm, body.mean.force) + cross(velocity, body.first_moment.force));
    // The torque of the ground is about the world's origin, which may be far away.
    const Vec3d torque =
        body.body == ground.value ? body.mean.torque - cross(origin_, body.mean.force) : body.mean.torque;
    interval.torques += H * (norm(torque) + smallest_arm * largest_radius_ * norm(body.mean.force));
  }
  const protocol::ParticleAccount& a = load.account;
  interval.travelled_twice +=
      H * interval.travelled + (H * H / 6) * (2.0 * a.momentum_begin + a.momentum_end);
  interval.travelled += (0.5 * H) * (a.momentum_begin + a.momentum_end);
  interval.change += H * norm(a.momentum_end - a.momentum_begin);
  interval.time += H;
}

void ParticleWatch::compare_angular(const Sums& sums, const Interval& interval, double time,
                                    Found& found) const {
  const bool same_spheres = last_ && !periodic_ && !open_ && last_->lost == sums.lost &&
                            last_->spheres == sums.spheres && interval.time > 0;
  if (!same_spheres) return;
  const Vec3d moved = sums.first - last_->first;
  const scene::Box& domain = scene_.dem->domain;
  const double size = sums.mass * norm(domain.max - domain.min);
  FrameDifference& centre = found.differences[2];
  // Inside a window the momentum is only known to lie between its ends.
  const double share = std::max(0.0, norm(moved - interval.travelled) - 0.5 * interval.change) / size;
  if (share > centre.share)
    centre = {
        share, time,
        fmt::format("moves by {} m, and by {} m with the momentum of the account",
                    vector_text((1 / sums.mass) * moved), vector_text((1 / sums.mass) * interval.travelled))};
  const Vec3d by_gravity = cross(interval.time * last_->first + interval.travelled_twice, scene_.gravity);
  // Velocities of a frame are single precision.
  const double rounding = 1e-6 * (sums.angular_size + last_->angular_size);
  found.angular_residual +=
      std::max(0.0, norm(sums.angular - last_->angular - interval.torque - by_gravity) - rounding);
  found.angular_scale += interval.torques;
}

std::optional<double> ParticleWatch::angular_momentum_balance() const {
  const Found all = found();
  return all.angular_scale > 0 ? std::optional(all.angular_residual / all.angular_scale) : std::nullopt;
}

// ---- frames

void ParticleWatch::expect_start(const ParticlesFrame& frame) {
  const particles::Fill start = std::exchange(spheres_.start, {});
  if (frame.time != Nanoseconds{}) return;
  for (std::size_t i = 0; i < frame.id.size(); ++i) {
    const std::uint32_t id = frame.id[i];
    if (id >= spheres_.at_start) continue;
    const SceneSpheres::Group& group = spheres_.group_of(id);
    const Vec3d x = vector_at(frame.position, i), v = vector_at(frame.velocity, i),
                expected = start.velocity[id];
    const double allowed = allowed_place * start.radius[id] + group.place_tolerance;
    if (!scene_.dem->relax_start && !(norm(x - start.position[id]) <= std::sqrt(3.0) * allowed))
      refuse_particles(fmt::format("sphere {} of '{}' starts at {} m, and the scene has it at {} m", id,
                                   group.name, vector_text(x), vector_text(start.position[id])),
                       "free_flight");
    if (!(norm(v - expected) <= mass_share * norm(expected)))
      refuse_particles(
          fmt::format("sphere {} of '{}' starts with the velocity {} m/s, and the scene gives it {} m/s", id,
                      group.name, vector_text(v), vector_text(expected)),
          "free_flight");
  }
}

ParticleWatch::Sums ParticleWatch::count_false_and_sum(const ParticlesFrame& frame, const Before& before,
                                                       Found& found) const {
  const double time = to_seconds(frame.time);
  const auto take = [&](std::size_t kind, std::uint64_t spheres, const auto& example) {
    FalseSpheres& worst = found.false_spheres[kind];
    if (spheres > worst.spheres) worst = {spheres, time, example()};
  };
  Sums sums;
  sums.lost = before.account ? before.account->lost_particles : lost_at_begin_;
  sums.spheres = frame.id.size();
  const std::uint64_t count = sums.spheres, most = spheres_.in_all - std::min(sums.lost, spheres_.in_all);
  const std::uint64_t least = open_ ? 0 : most;
  const std::uint64_t nearest = std::clamp(count, least, most);
  take(0, std::max(count, nearest) - std::min(count, nearest), [&] {
    return fmt::format("it has {} spheres, and {}{} of the scene's spheres remain", count,
                       open_ ? "at most " : "", most);
  });

  std::uint64_t wrong_radius = 0, outside = 0;
  std::size_t first_radius = 0, first_outside = 0;
  Vec3d low = scene_.dem->domain.min, high = scene_.dem->domain.max;
  for (int a = 0; a < 3; ++a) {
    low[a] += std::min(before.domain_shift[0][a], before.domain_shift[1][a]);
    high[a] += std::max(before.domain_shift[0][a], before.domain_shift[1][a]);
  }
  // Ids ascend, and groups are in their order.
  auto of_sphere = spheres_.groups.begin();
  for (std::size_t i = 0; i < frame.id.size(); ++i) {
    const std::uint32_t id = frame.id[i];
    const bool known = id < spheres_.in_all;
    while (known && id >= of_sphere->end) ++of_sphere;
    const auto radius = static_cast<double>(frame.radius[i]);
    const Vec3d x = vector_at(frame.position, i), v = vector_at(frame.velocity, i);
    const double speed = norm(v);
    if (!(known && radius >= of_sphere->smallest * (1 - mass_share) &&
          radius <= of_sphere->largest * (1 + mass_share)) &&
        ++wrong_radius == 1)
      first_radius = i;
    // A sphere is taken out when it is outside, at the latest in the next window.
    const double margin = radius + before.window * speed;
    bool inside = true;
    for (int a = 0; a < 3; ++a) inside = inside && x[a] >= low[a] - margin && x[a] <= high[a] + margin;
    if (!inside && ++outside == 1) first_outside = i;

    if (!known) continue;
    const double mass = sphere_mass(of_sphere->density, radius), inertia = 0.4 * mass * radius * radius;
    const Vec3d arm = x - origin_, w = vector_at(frame.spin, i);
    sums.mass += mass;
    sums.first += mass * arm;
    sums.momentum += mass * v;
    sums.momentum_size += mass * speed;
    sums.energy += 0.5 * (mass * norm2(v) + inertia * norm2(w));
    sums.angular += mass * cross(arm, v) + inertia * w;
    sums.angular_size += mass * norm(arm) * speed + inertia * norm(w);
  }
  take(1, wrong_radius, [&] {
    const std::uint32_t id = frame.id[first_radius];
    if (id >= spheres_.in_all)
      return fmt::format("its sphere {} is none of the scene, whose spheres are 0 to {}", id,
                         spheres_.in_all - 1);
    const SceneSpheres::Group& group = spheres_.group_of(id);
    return fmt::format("its sphere {} has the radius {:.6g} m, and its group '{}' has {:.6g} to {:.6g} m", id,
                       static_cast<double>(frame.radius[first_radius]), group.name, group.smallest,
                       group.largest);
  });
  take(2, outside, [&] {
    return fmt::format("its sphere {} is at {} m, outside dem.domain, which is from {} to {} m",
                       frame.id[first_outside], vector_text(vector_at(frame.position, first_outside)),
                       vector_text(low), vector_text(high));
  });
  return sums;
}

void ParticleWatch::compare_account(const Sums& sums, const protocol::ParticleAccount& account, double window,
                                    double time, Found& found) const {
  found.compared = true;
  // Spheres at rest have what rounding leaves. The energy is compared with a share of that of a fall of all
  // of them through the largest radius, or of the largest energy so far.
  found.largest_energy = std::max({found.largest_energy, sums.energy, account.kinetic_energy,
                                   sums.mass * norm(scene_.gravity) * largest_radius_});
  // Where nothing has moved and nothing falls, what moves no sphere within a window by what frames resolve is
  // at rest.
  const double unseen = place_share * largest_radius_ / window;  // [m/s]
  const double least_energy = rest_share * found.largest_energy + 0.5 * sums.mass * unseen * unseen,
               least_momentum = std::sqrt(2 * sums.mass * least_energy);
  const double momentum = norm(sums.momentum - account.momentum_end);
  const double share =
      momentum == 0 ? 0
                    : momentum / std::max({sums.momentum_size, norm(account.momentum_end), least_momentum});
  if (!(share <= found.differences[0].share))
    found.differences[0] = {share, time,
                            fmt::format("is {} kg m/s, and {} kg m/s in the account",
                                        vector_text(sums.momentum), vector_text(account.momentum_end))};
  const double energy = std::abs(sums.energy - account.kinetic_energy);
  const double of_energy =
      energy == 0 ? 0 : energy / std::max({sums.energy, account.kinetic_energy, least_energy});
  if (!(of_energy <= found.differences[1].share))
    found.differences[1] = {
        of_energy, time,
        fmt::format("is {:.6g} J, and {:.6g} J in the account", sums.energy, account.kinetic_energy)};
}

ParticleWatch::Before ParticleWatch::take_before() {
  Before before = before_;
  before_.interval = {};
  framed_ = true;
  return before;
}

ParticleWatch::Found ParticleWatch::found() const {
  const std::scoped_lock lock(*found_mutex_);
  return found_;
}

void ParticleWatch::check(const ParticlesFrame& frame, const Before& before) {
  Found all = found();
  const Sums sums = count_false_and_sum(frame, before, all);
  const double time = to_seconds(frame.time);
  if (before.account) {
    compare_account(sums, *before.account, before.window, time, all);
    compare_gravity(sums, before, time, all);
    compare_angular(sums, before.interval, time, all);
  }
  last_ = sums;
  const std::scoped_lock lock(*found_mutex_);
  found_ = std::move(all);
}

// Spheres come and go between windows, so that those of a frame are those of the window before it.
void ParticleWatch::compare_gravity(const Sums& sums, const Before& before, double time, Found& found) const {
  const Vec3d expected = (sums.mass * before.window) * scene_.gravity;
  if (before.account->lost_particles != before.lost_before || norm2(expected) == 0) return;
  const double share = norm(before.account->gravity_impulse - expected) / norm(expected);
  if (!(share <= found.differences[3].share))
    found.differences[3] = {
        share, time,
        fmt::format("is {} N s in the window before by the mass of its spheres, and {} N s in the account",
                    vector_text(expected), vector_text(before.account->gravity_impulse))};
}

void ParticleWatch::observe(const ParticlesFrame& frame) {
  expect_start(frame);
  check(frame, take_before());
}

}  // namespace tandem::launch
