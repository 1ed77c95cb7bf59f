#include "launch/coordinator/summary.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "common/file_draft.hpp"
#include "common/scene/element_columns.hpp"
#include "common/scene/sensor_columns.hpp"
#include "common/utf8.hpp"
#include "launch/build_info.hpp"
#include "launch/coordinator/geometry_review.hpp"
#include "launch/results/reduction.hpp"
#include "protocol/version.hpp"

namespace tandem::launch {
namespace {

using Json = nlohmann::ordered_json;

// FNV-1a hash of the solvers' hashes.
std::string combined_hash(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return fmt::format("{:016x}", hash);
}

struct OwnKey {
  std::string_view key;
  const char* meaning;
};
constexpr std::array own_keys{
#define COORDINATOR_KEY(key, meaning) OwnKey{key, meaning},
#include "launch/coordinator/coordinator_keys.def"
#undef COORDINATOR_KEY
};

bool is_own(std::string_view key) {
  return std::ranges::find(own_keys, key, &OwnKey::key) != own_keys.end();
}

// What the coordinator itself writes into the object "sph", beside the facts of the solver.
constexpr std::array<std::string_view, 4> keys_of_liquid{"micro_steps", "largest_micro_step_s",
                                                         "momentum_balance", "momentum_balance_windows"};

// Whether only the coordinator writes this key where the facts of the solver are.
bool is_reserved(protocol::Role role, std::string_view key) {
  return role == protocol::Role::sph ? std::ranges::find(keys_of_liquid, key) != keys_of_liquid.end()
                                     : is_own(key);
}

std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  return value.dump();
}

}  // namespace

Json& Summary::own(const char* key) {
  if (!is_own(key))
    throw Error(ErrorCode::internal, fmt::format("the key '{}' is not in coordinator_keys.def", key),
                "summary.json");
  return json_[key];
}

std::string coordinator_keys_as_markdown() {
  std::string table = "| key | meaning |\n|---|---|\n";
  for (const OwnKey& row : own_keys) table += fmt::format("| `{}` | {} |\n", row.key, row.meaning);
  return table;
}

Summary::Summary(const SceneFile& file, const RunOptions& options) : scene_(file.scene) {
  const scene::Scene& scene = file.scene;
  if (scene.mbd)
    for (const scene::Body& body : scene.mbd->bodies) bodies_.push_back(body.name);
  own("scene") = scene.name;
  own("scene_file") = file.origin;
  own("version") = version;
  own("protocol") = fmt::format("{}.{}", protocol::protocol_version.major, protocol::protocol_version.minor);
  own("transport") = name(options.transport);
  if (options.transport == Transport::dds) own("dds_security") = dds_security(options);
  own("scheme") = name(scene.coupling.scheme);
  own("window_s") = scene.coupling.window;
  for (const PlacedGroup& placed : file.placed) {
    Json& fill = own("fills")[placed.group] = {{"spheres", placed.spheres}, {"mass_kg", placed.mass}};
    if (placed.void_fraction) fill["void_fraction"] = *placed.void_fraction;
  }
  if (file.settled)
    own("settle") = {{"time_s", file.settled->time},
                     {"kinetic_energy_J", file.settled->kinetic_energy},
                     {"from_cache", file.settled->from_cache}};
  // Values that only a solver knows are null until it has reported them.
  for (const char* key : {"backend", "device", "precision", "variant"}) json_[key] = nullptr;
  for (const protocol::Role role : {protocol::Role::mbd, protocol::Role::dem})
    own(protocol::name(role)) = nullptr;
  if (scene.sph) {
    own("sph_server") = nullptr;
    own("sph") = Json::object();
  }
  json_["left_out"] = Json::array();
  json_["spheres"] = scene.dem ? Json(nullptr) : Json(0);
  json_["bodies"] = scene.mbd ? scene.mbd->bodies.size() : 0;
  if (scene.mbd)
    for (const scene::Joint& joint : scene.mbd->joints) {
      using scene::JointType;
      if (joint.type == JointType::prismatic)
        own("joint_units")[joint.name] = "m";
      else if (joint.type == JointType::revolute || joint.type == JointType::screw)
        own("joint_units")[joint.name] = "rad";
    }
  declare_columns(scene);
  if (!scene.output.plots.empty()) own("plots") = scene.output.plots;
  for (const char* key : {"windows", "micro_steps"}) own(key) = 0;
  own("simulated_s") = 0.0;
  own("end_time_s") = scene.end_time;
  own("wall_s") = 0.0;
  for (const char* key : {"sphere_steps_per_s", "us_per_micro_step"}) own(key) = nullptr;
  set_time_split({});
  for (const char* key : {"impulse_closure", "impulse_outstanding", "energy_residual", "momentum_balance",
                          "constraint_violation", "max_overlap_ratio"})
    json_[key] = nullptr;
  own("lost_particles") = 0;
  own("meshes") = to_json(file.mesh_facts);
  json_["warnings"] = Json::array();
  own("state_hash") = nullptr;
  own("status") = name(status_);
  own("process") = this_process();
  own("checks") = Json::array();
}

void Summary::set_server(protocol::Role role, const protocol::Hello& hello,
                         const std::optional<ServerCommand>& foreign) {
  Json& server = own(protocol::name(role)) = {{"program", printable(shortened(hello.program))}};
  if (foreign) server["command"] = printable(foreign->text);
}

std::string Summary::not_reported(protocol::Role role) const {
  const Json& server = json_[protocol::name(role)];
  if (!server.is_object()) return fmt::format("not reported by {}", protocol::name(role));
  const auto program = server["program"].get<std::string>();
  const bool as_ours = program.starts_with(protocol::name(role)) && server.contains("command");
  return "not reported by " + program +
         (as_ours ? fmt::format(" ('{}')", shortened(server["command"].get<std::string>())) : "");
}

void Summary::add_facts(protocol::Role role, const std::string& facts) {
  const Json sent = protocol::decode_facts(role, facts, facts_);
  for (const auto& item : sent.items())
    if (is_reserved(role, item.key()))
      throw Error(ErrorCode::protocol,
                  "sent the fact '" + item.key() + "', which only the coordinator writes",
                  protocol::name(role), "send it under another name");
  const std::string prefix = std::string(protocol::word_of(role)) + "_";
  for (const auto& [key, value] : sent.items()) {
    if (value.is_array() && json_.contains(key) && json_[key].is_array()) {
      for (const Json& item : value) {
        if (std::find(json_[key].begin(), json_[key].end(), item) == json_[key].end())
          json_[key].push_back(item);
      }
    } else if (role == protocol::Role::sph) {
      own("sph")[key] = value;
    } else if (key == "solver_seconds") {
      json_[prefix + key] = value;
    } else {
      json_[key] = value;
    }
  }
  const std::string hashes = facts_.mbd.state_hash.value_or("") + facts_.dem.state_hash.value_or("") +
                             facts_.sph.state_hash.value_or("");
  if (!hashes.empty()) own("state_hash") = combined_hash(hashes);
}

void Summary::add_warning(const std::string& sentence) {
  Json& all = json_["warnings"];
  const std::string text = printable(sentence);
  if (std::find(all.begin(), all.end(), text) == all.end()) all.push_back(text);
}

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
    block[std::string(keys_of_liquid[key])] = value;
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

namespace {

// Where a column "lift.force.x" is in the list of elements or sensors: at lift, force, x.
Json& place_of(Json& list, const std::string& column) {
  Json* at = &list;
  for (std::size_t begin = 0; begin <= column.size();) {
    const std::size_t end = std::min(column.find('.', begin), column.size());
    at = &(*at)[column.substr(begin, end - begin)];
    begin = end + 1;
  }
  return *at;
}

}  // namespace

// Units are there from the start: a report of a run that was killed needs them as well.
void Summary::declare_columns(const scene::Scene& scene) {
  for (const scene::ElementOfScene& element : scene::elements_of(scene)) {
    Json& all = own("elements");
    all[element.name]["type"] = element.kind;
    for (const scene::ElementColumn& column : element.columns)
      place_of(all, column.name)["unit"] = scene::unit(column.channel);
  }
  scene::each_sensor(
      scene, [&](const std::string& sensor, const std::vector<scene::SensorChannel>& channels) {
        for (const scene::SensorChannel channel : channels)
          place_of(own("sensors")[sensor], scene::name(channel))["unit"] = scene::unit(channel);
      });
}

void Summary::set_columns(const char* list, const Signals& rows) {
  if (rows.rows() == 0) return;
  const std::vector<std::string>& columns = rows.names();
  std::vector<Reduction> means(columns.size(), Reduction("mean", 0, 0));
  std::vector<double> largest(columns.size(), 0.0);
  rows.visit(columns, [&](std::span<const double> values) {
    for (std::size_t i = 1; i < values.size(); ++i) {
      means[i].add(values[0], values[i]);
      if (std::abs(values[i]) > std::abs(largest[i])) largest[i] = values[i];
    }
  });
  for (std::size_t i = 1; i < columns.size(); ++i) {
    Json& column = place_of(own(list), columns[i]);
    column["largest"] = largest[i];
    column["mean"] = means[i].value();
  }
}

void Summary::set_checks(const std::vector<CheckResult>& checks) {
  own("checks") = Json::array();
  for (const CheckResult& result : checks) {
    own("checks").push_back({{"name", result.check.name},
                             {"of", result.check.of},
                             {"reduce", result.check.reduce},
                             {"value", result.value},
                             {"expected", result.check.expected},
                             {"tolerance", result.check.tolerance},
                             {"absolute", result.check.absolute},
                             {"error", result.error},
                             {"passed", result.passed},
                             {"why", result.check.why}});
  }
}

void Summary::set_particles(const ParticleWatch& watch, const SphereWatch& spheres) {
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
  for (std::size_t i = 0; i < spheres.kinds.size(); ++i)
    add(spheres.kinds[i].name, spheres.kinds[i].check, spheres.false_spheres()[i]);
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

void Summary::set_leaving(const std::vector<Participants::Leaving>& complaints) {
  Json& all = own("bad_endings") = Json::array();
  for (const Participants::Leaving& leaving : complaints)
    if (leaving.ending.empty())
      add_warning(leaving.program + " did not leave within 1 s of the end of the run");
    else
      all.push_back({{"of", printable(leaving.program)}, {"what", printable(leaving.ending)}});
}

// Rules that our servers always have a figure for, and that a foreign one has left without.
void Summary::add_rules_without_figures() {
  const auto judged = [&](const char* rule) {
    return std::ranges::find(verdict_.judged, rule) != verdict_.judged.end();
  };
  const auto note = [&](protocol::Role role, std::initializer_list<const char*> rules) {
    const Json& server = json_[protocol::name(role)];
    if (!server.is_object() || !server.contains("command") || number("windows") == 0) return;
    std::vector<std::string> missing;
    for (const char* rule : rules)
      if (!judged(rule)) missing.emplace_back(rule);
    if (!missing.empty())
      verdict_.not_judged.push_back(
          fmt::format("{}: figures {}", fmt::join(missing, ", "), not_reported(role)));
  };
  note(protocol::Role::mbd, {"energy_mbd", "constraints", "position_error", "energy_error"});
  note(protocol::Role::dem, {"lost", "collision_steps", "critical_step"});
  if (scene_.sph) note(protocol::Role::sph, {"liquid_density", "mach", "passed_walls", "energy_liquid"});
}

void Summary::judge() {
  verdict_ = launch::judge({scene_, json_, facts_});
  verdict_.not_judged = not_judged_;
  add_rules_without_figures();
  own("verdict") = to_json(verdict_);
}

void Summary::end(Status status, const char* reason, int exit_status) {
  status_ = status;
  exit_status_ = exit_status;
  own("status") = name(status);
  if (reason) own("reason") = reason;
  own("exit_status") = exit_status;
}

void Summary::complete(bool checks_passed, bool strict) {
  judge();
  if (!checks_passed)
    end(Status::failed, reason_checks, 1);
  else if (verdict_.suspect())
    end(Status::suspect, nullptr, strict ? 1 : 0);
  else
    end(Status::ok, nullptr, 0);
}

void Summary::interrupt() {
  judge();
  end(Status::failed, reason_interrupted, tandem::exit_status(ErrorCode::interrupted));
}

void Summary::fail(const Error& error) {
  judge();
  end(Status::failed, std::string(tandem::name(error.code())).c_str(), tandem::exit_status(error.code()));
  own("error") = {{"code", tandem::name(error.code())},
                  {"what", printable(error.problem())},
                  {"where", printable(error.where())},
                  {"hint", printable(error.hint())}};
}

double Summary::number(const char* key) const {
  const auto found = json_.find(key);
  return found != json_.end() && found->is_number() ? found->get<double>() : 0;
}

void Summary::write(const std::filesystem::path& file) const {
  replace_file(file, json_.dump(2, ' ', false, Json::error_handler_t::replace) + '\n', Durability::power);
}

std::string Summary::table() const {
  const bool suspect = status_ == Status::suspect;
  std::string text =
      fmt::format("{}: {}\n", json_["scene"].get<std::string>(), suspect ? "SUSPECT" : name(status_));
  const auto row = [&](const char* title, const std::string& value) {
    text += fmt::format("  {:<22}{}\n", title, value);
  };
  const auto number_row = [&](const char* title, const char* key, const char* unit) {
    if (json_.contains(key) && !json_[key].is_null()) row(title, text_of(json_[key]) + unit);
  };
  for (const VerdictLine& line : verdict_.lines) row("SUSPECT", line.sentence);
  for (const protocol::Role role : protocol::all_roles) {
    const auto server = json_.find(protocol::name(role));
    if (server != json_.end() && server->is_object() && server->contains("command"))
      row(protocol::name(role),
          fmt::format("{}, started by {}", text_of((*server)["program"]), text_of((*server)["command"])));
  }
  const protocol::DemFacts& dem = facts_.dem;
  if (dem.backend || dem.spheres) {
    std::string particles =
        dem.spheres ? fmt::format("{} spheres", *dem.spheres) : std::string("number of spheres unknown");
    if (dem.backend) particles += " on " + *dem.backend;
    if (dem.device) particles += " (" + *dem.device + ")";
    for (const auto& word : {dem.variant, dem.precision})
      if (word) particles += ", " + *word;
    row("particles", particles);
  } else if (json_["dem_server"].is_object()) {
    row("particles", not_reported(protocol::Role::dem));
  }
  if (const protocol::SphFacts& sph = facts_.sph; sph.particles) {
    std::string liquid = fmt::format("{} particles", *sph.particles);
    if (sph.backend) liquid += " on " + *sph.backend;
    if (sph.precision) liquid += ", " + *sph.precision;
    row("liquid", liquid);
  } else if (json_.contains("sph_server") && json_["sph_server"].is_object()) {
    row("liquid", not_reported(protocol::Role::sph));
  }
  std::string course =
      fmt::format("{:.6g} s in {} windows", number("simulated_s"), text_of(json_["windows"]));
  if (number("windows_rejected") > 0)
    course += fmt::format(" (and {} taken back)", text_of(json_["windows_rejected"]));
  if (number("iterations_per_window") > 1)
    course += fmt::format(", {} iterations each", text_of(json_["iterations_per_window"]));
  if (number("micro_steps") > 0) course += fmt::format(" and {} micro steps", text_of(json_["micro_steps"]));
  row("simulated", course);
  const Json& split = json_["time_split"];
  // A program that does not take part is left out.
  std::string parts;
  for (const char* part : {"dem", "mbd", "sph", "exchange", "output"}) {
    const auto program = json_.find(std::string(part) + "_server");
    if (split.contains(part) && (program == json_.end() || program->is_object()))
      parts += fmt::format("{} {} {:.3g}", parts.empty() ? ":" : ",", part, split[part].get<double>());
  }
  row("wall time", fmt::format("{:.3g} s{}", number("wall_s"), parts));
  number_row("per micro step", "us_per_micro_step", " us");
  number_row("sphere-steps", "sphere_steps_per_s", " /s");
  number_row("impulse closure", "impulse_closure", "");
  if (number("impulse_outstanding") > 0) number_row("impulse outstanding", "impulse_outstanding", "");
  number_row("energy residual", "energy_residual", "");
  number_row("momentum balance", "momentum_balance", "");
  if (facts_.mbd.constraint_violation)
    row("constraint violation", fmt::format("{:.6g}", *facts_.mbd.constraint_violation));
  number_row("largest overlap", "max_overlap_ratio", " of the radius");
  if (json_.contains("sph")) {
    const Json& liquid = json_["sph"];
    const auto liquid_row = [&](const char* title, const char* key, const char* unit) {
      if (liquid.contains(key)) row(title, text_of(liquid[key]) + unit);
    };
    liquid_row("liquid momentum", "momentum_balance", "");
    liquid_row("liquid density error", "density_error", "");
    liquid_row("liquid volume error", "volume_error", "");
    liquid_row("liquid Mach number", "mach", "");
    liquid_row("liquid came in", "came_in", " particles");
    liquid_row("liquid went out", "went_out", " particles");
  }
  if (dem.spheres > 0 || number("lost_particles") > 0) number_row("lost particles", "lost_particles", "");
  if (dem.came_in) row("came in", fmt::format("{} spheres", *dem.came_in));
  if (dem.went_out) row("went out", fmt::format("{} spheres", *dem.went_out));
  number_row("state hash", "state_hash", "");
  for (const Json& check : json_["checks"]) {
    row(check["passed"].get<bool>() ? "check passed" : "CHECK FAILED",
        fmt::format("{}: {} (expected {}, tolerance {}{})", check["name"].get<std::string>(),
                    text_of(check["value"]), text_of(check["expected"]), text_of(check["tolerance"]),
                    check["absolute"].get<bool>() ? "" : " relative"));
  }
  for (const Json& warning : json_["warnings"]) row("warning", text_of(warning));
  for (const std::string& what : verdict_.not_judged) row("not judged", what);
  return text;
}

}  // namespace tandem::launch
