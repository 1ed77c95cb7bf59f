#include "coordinator/run/summary.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "common/file_draft.hpp"
#include "common/scene/element_columns.hpp"
#include "common/scene/sensor_columns.hpp"
#include "common/scene/summary_keys.hpp"
#include "common/utf8.hpp"
#include "coordinator/results/reduction.hpp"
#include "coordinator/scene/geometry_review.hpp"
#include "coordinator/start/build_info.hpp"
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
#define COORDINATOR_KEY(runs, key, meaning) OwnKey{key, meaning},
#include "common/scene/figures.def"
};

bool is_own(std::string_view key) {
  return std::ranges::find(own_keys, key, &OwnKey::key) != own_keys.end();
}

// Whether only the coordinator writes this key where the facts of the solver are.
bool is_reserved(protocol::Role role, std::string_view key) {
  return role == protocol::Role::sph
             ? std::ranges::find(Summary::own_keys_of_liquid, key) != Summary::own_keys_of_liquid.end()
             : is_own(key);
}

}  // namespace

Json& Summary::own(const char* key) {
  if (!is_own(key))
    throw Error(ErrorCode::internal, fmt::format("the key '{}' is not in common/scene/figures.def", key),
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
  // A scene that a program hands over has no file.
  own("scene_file") =
      file.origin.empty() ? "" : std::filesystem::absolute(file.origin).lexically_normal().string();
  own("version") = version;
  own("protocol") = fmt::format("{}.{}", protocol::protocol_version.major, protocol::protocol_version.minor);
  own("transport") = name(options.transport);
  if (options.transport == Transport::dds) own("dds_security") = dds_security(options);
  own("scheme") = name(scene.coupling.scheme);
  own("window_s") = scene.coupling.window;
  for (const scene::Parameter& parameter : file.parameters)
    own("parameters")[parameter.name] = {{"value", parameter.value}, {"unit", parameter.unit}};
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
  for (const auto& [key, value] : sent.items()) {
    if (value.is_array() && json_.contains(key) && json_[key].is_array()) {
      for (const Json& item : value) {
        if (std::find(json_[key].begin(), json_[key].end(), item) == json_[key].end())
          json_[key].push_back(item);
      }
    } else if (role == protocol::Role::sph) {
      own("sph")[key] = value;
    } else {
      json_[scene::summary_key(protocol::word_of(role), key)] = value;
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
  if (scene_.contact && scene_.contact->impacts == scene::Impacts::time_stepping)
    verdict_.not_judged.push_back(
        "what the steps leave out: time stepping does not estimate it; halve mbd.integrator.step and "
        "compare");
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

void Summary::interrupt_estimate() {
  exit_status_ = tandem::exit_status(ErrorCode::interrupted);
  own("exit_status") = exit_status_;
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

}  // namespace tandem::launch
