// What the windows of a run and the watches of its participants have shown.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coordinator/run/summary.hpp"

namespace tandem::launch {

using Json = nlohmann::ordered_json;

// Per body: impulses and work of both sides over the run, and the vibration on its contacts.
void Summary::set_interface(const Coupler& coupler) {
  const auto list = [](Vec3d v) { return Json{v.x, v.y, v.z}; };
  own("border") = Json::object();
  for (const auto& [index, balance] : coupler.accounts().bodies()) {
    if (!balance.loaded) continue;
    Json body{{"impulse_booked", list(balance.recorded.force)},
              {"impulse_applied", list(balance.applied.force)},
              {"impulse_outstanding", list(balance.outstanding.force)},
              {"angular_impulse_booked", list(balance.recorded.torque)},
              {"angular_impulse_applied", list(balance.applied.torque)},
              {"angular_impulse_outstanding", list(balance.outstanding.torque)},
              {"work_given_J", balance.given},
              {"work_received_J", balance.received}};
    const auto figures = coupler.watch().bodies().find(index);
    if (figures != coupler.watch().bodies().end()) {
      const StabilityFigures& f = figures->second;
      body["omega_H"] = f.worst.omega_H;
      body["zeta"] = f.worst.zeta;
      body["growth_per_window"] = std::max(1.0, f.worst.growth);
      body["windows_beyond_stability"] = f.windows_beyond;
      const StabilityRemedy stable = coupler.watch().remedy(f.worst);
      if (std::isfinite(stable.omega_H)) body["stable_omega_H"] = stable.omega_H;
      if (f.windows_beyond > 0) {
        if (stable.window > 0) body["stable_window_s"] = stable.window;
        if (!stable.scheme.empty()) body["stable_scheme"] = stable.scheme;
      }
    }
    const auto liquid = coupler.liquid_watch().bodies().find(index);
    if (liquid != coupler.liquid_watch().bodies().end()) {
      body["added_mass_ratio"] = liquid->second.added;
      body["passed_to_liquid"] = liquid->second.passed;
      body["liquid_growth_per_window"] = liquid->second.growth;
      body["windows_beyond_liquid"] = liquid->second.windows_beyond;
    }
    const auto momentum = coupler.body_momentum().sums().find(index);
    if (momentum != coupler.body_momentum().sums().end()) {
      body["momentum_residual"] = momentum->second.linear();
      body["angular_momentum_residual"] = momentum->second.angular();
    }
    own("border")[bodies_.at(index)] = body;
  }
}

// The bodies whose motion, as the multibody participant has sent it, contradicts itself.
void Summary::set_contradictions(const MotionWatch& watch) {
  const auto add = [this](const char* key, std::uint32_t body, const StateDifference& d, double share) {
    json_[key].push_back({{"body", bodies_.at(body)},
                          {"share", share},
                          {"position_m", d.position},
                          {"rotation_rad", d.rotation},
                          {"velocity_m_per_s", d.speed},
                          {"angular_velocity_rad_per_s", d.spin},
                          {"time_s", d.time}});
  };
  own("motion_jumps") = own("frame_differences") = Json::array();
  for (const auto& [body, jumps] : watch.jumps()) add("motion_jumps", body, jumps.largest, jumps.sum);
  for (const auto& [body, d] : watch.false_frames()) add("frame_differences", body, d, d.share);
}

void Summary::set_path_differences(const PathWatch& watch) {
  Json& all = own("path_differences") = Json::array();
  const auto add = [&](const char* what, const char* key, std::uint32_t body, const PathWatch::Sums& sums) {
    if (sums.share > 0)
      all.push_back({{"of", fmt::format("{} of body '{}'", what, bodies_.at(body))},
                     {"share", sums.share},
                     {key, sums.largest},
                     {"time_s", sums.time}});
  };
  for (const auto& [body, of] : watch.bodies()) {
    add("position", "open_m", body, of.displacement);
    add("orientation", "open_rad", body, of.rotation);
  }
}

// The frames of a multibody participant, against the joints and the masses of the scene.
void Summary::set_machine(const JointWatch& joints, const EnergyWatch& energy) {
  if (joints.judges()) {
    Json& all = own("joint_violations") = Json::array();
    for (const auto& [index, violation] : joints.violations())
      all.push_back({{"of", fmt::format("joint '{}'", scene_.mbd->joints.at(index).name)},
                     {"share", violation.share},
                     {"what", violation.text()},
                     {"time_s", violation.time}});
  }
  if (const auto& largest = energy.largest())
    own("body_energy_differences") = Json::array({{{"of", "the run"},
                                                   {"share", largest->share},
                                                   {"reported_J", largest->reported},
                                                   {"computed_J", largest->computed},
                                                   {"time_s", largest->time}}});
}

void Summary::set_restart(const std::filesystem::path& checkpoint, const Coupler& coupler) {
  steps_before_ = coupler.accounts().particles().micro_steps();
  own("restarted_from") = checkpoint.string();
  own("restarted_at_s") = to_seconds(coupler.now());
}

void Summary::set_time_split(const TimeSplit& split) {
  Json& parts = own("time_split") = {{"dem", split.dem}, {"mbd", split.mbd}};
  if (scene_.sph) parts["sph"] = split.sph;
  parts["exchange"] = split.exchange;
  parts["output"] = split.output;
}

void Summary::set_liquid(const ParticleBalance& balance) {
  if (balance.micro_steps() == 0) return;
  Json& block = own("sph");
  const auto set = [&block](std::size_t key, const Json& value) {
    block[std::string(own_keys_of_liquid[key])] = value;
  };
  set(0, balance.micro_steps());
  set(1, balance.largest_micro_step());
  set(2, balance.momentum());
  set(3, balance.momentum_windows());
}

void Summary::set_course(const Coupler& coupler, Nanoseconds now, double wall, const TimeSplit& split) {
  const Accounts& accounts = coupler.accounts();
  for (const std::string& warning : coupler.warnings()) add_warning(warning);
  if (scene_.coupling.adaptive) own("windows_of_too_large_error") = coupler.too_wrong();
  if (coupler.too_wrong() > 0)
    add_warning(
        fmt::format("{} windows of the shortest length allowed were less accurate than asked for: use a "
                    "coupling.adaptive.min_window below {:.3g} s, or larger tolerances",
                    coupler.too_wrong(), scene_.coupling.adaptive->min_window));
  own("windows") = accounts.windows();
  own("windows_rejected") = coupler.counters().rejected;
  if (accounts.windows() > 0)
    own("iterations_per_window") = static_cast<double>(coupler.counters().iterations) /
                                   static_cast<double>(accounts.windows() + coupler.counters().rejected);
  own("most_iterations") = coupler.counters().most_iterations;
  own("micro_steps") = accounts.micro_steps();
  own("simulated_s") = to_seconds(now);
  own("wall_s") = wall;
  set_time_split(split);
  if (scene_.sph) set_liquid(accounts.particles(place_of_liquid(scene_)));
  if (const ParticleBalance& particles = accounts.particles(); scene_.dem && particles.micro_steps() > 0) {
    // In `parallel` the coordinator waits only for the slower solver: its reported time counts.
    const double reported_time = facts_.dem.solver_seconds.value_or(0),
                 dem = reported_time > 0 ? reported_time : split.dem;
    const auto steps = static_cast<double>(particles.micro_steps() - steps_before_);
    if (steps > 0) own("us_per_micro_step") = 1e6 * dem / steps;
    // Spheres enter and leave: a run that has ended knows the sum.
    const std::optional<double> reported = facts_.dem.sphere_steps, spheres = facts_.dem.spheres;
    if (dem > 0 && (reported > 0 || spheres))
      own("sphere_steps_per_s") = (reported > 0 ? *reported : *spheres * steps) / dem;
    own("momentum_balance") = particles.momentum();
    own("momentum_balance_windows") = particles.momentum_windows();
    own("largest_micro_step_s") = particles.largest_micro_step();
    own("max_overlap_ratio") = particles.account().max_overlap_ratio;
    own("lost_particles") = particles.account().lost_particles;
  }
  set_machine(coupler.joint_watch(), coupler.energy_watch());
  if (accounts.coupled()) {
    own("impulse_closure") = accounts.impulse_closure();
    own("impulse_outstanding") = accounts.impulse_outstanding();
    own("energy_residual") = accounts.energy_residual();
    own("energy_exchanged_J") = accounts.energy_exchanged();
    set_interface(coupler);
    set_contradictions(coupler.motion_watch());
    set_path_differences(coupler.path_watch());
  }
}

void Summary::set_particles(const ParticleWatch& watch, const SphereWatch* spheres) {
  if (std::isfinite(watch.spheres().critical_time))
    own("critical_time_of_scene_s") = watch.spheres().critical_time;
  if (!watch.compared()) return;
  const auto false_spheres = watch.false_spheres();
  const auto differences = watch.differences();
  own("false_spheres") = own("particle_frame_differences") = Json::array();
  const auto add = [&](const char* kind, const char* check, const FalseSpheres& found) {
    if (found.spheres > 0)
      own("false_spheres")
          .push_back({{"of", kind},
                      {"spheres", found.spheres},
                      {"time_s", found.time},
                      {"example", found.example},
                      {"check", check}});
  };
  for (std::size_t i = 0; i < watch.kinds.size(); ++i)
    add(watch.kinds[i], "observe_particles", false_spheres[i]);
  for (std::size_t i = 0; spheres && i < spheres->kinds.size(); ++i)
    add(spheres->kinds[i].name, spheres->kinds[i].check, spheres->false_spheres()[i]);
  for (std::size_t i = 0; i < watch.figures.size(); ++i)
    if (const FrameDifference& d = differences[i]; d.share != 0)
      own("particle_frame_differences")
          .push_back(
              {{"of", watch.figures[i]}, {"share", d.share}, {"time_s", d.time}, {"values", d.values}});
  if (const auto balance = watch.angular_momentum_balance()) own("angular_momentum_balance") = *balance;
}

void Summary::set_wall_loads(const WallLoadWatch& watch) {
  if (!watch.judges() || !scene_.output.particles) return;
  Json& all = own("unloaded_walls") = Json::array();
  for (const auto& [index, found] : watch.unloaded())
    all.push_back({{"of", index == ground.value ? std::string("the ground")
                                                : fmt::format("body '{}'", bodies_.at(index))},
                   {"spheres", found.spheres},
                   {"time_s", found.time},
                   {"example", found.example}});
}

void Summary::set_walls(const WallWatch& watch) {
  not_judged_ = watch.not_judged();
  if (!watch.judges()) return;
  Json& all = own("wall_crossings") = Json::array();
  for (const WallCrossing& c : watch.crossings())
    all.push_back({{"wall_a", c.wall_a},
                   {"body_a", c.body_a},
                   {"wall_b", c.wall_b},
                   {"body_b", c.body_b},
                   {"time_s", c.time},
                   {"depth_m", c.depth},
                   {"share", c.share}});
}

}  // namespace tandem::launch
