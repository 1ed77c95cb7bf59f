// The state of the liquid on disk: that of the engine, and what the solver itself keeps from window to
// window.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <span>

#include "common/error.hpp"
#include "common/state_file.hpp"
#include "sph_server/coupling/load_solver.hpp"

namespace tandem::sph {
namespace {

constexpr const char* state_kind = "tandem liquid state";
// Version of the contents. It must be raised with every change of the state that an engine keeps.
constexpr std::uint64_t state_version = 8;

std::string name_in_file(const std::string& name) {
  return "engine/" + name;
}

}  // namespace

void Solver::checkpoint(const protocol::Checkpoint& order) {
  StateWriter file(order.path, state_kind, state_version);
  file.write("precision", precision_name());
  file.write("particles_at_start", std::uint64_t{at_start_});
  file.write("particles", std::uint64_t{id_.size()});
  file.write("memory", std::as_bytes(std::span(&memory_, 1)));
  if (sensors_.any()) file.write("sensors", std::as_bytes(std::span(seen_)));
  if (traffic_.any()) file.write("passed", std::as_bytes(std::span(passed_)));
  if (!id_.empty()) file.write("ids", std::as_bytes(std::span(id_)));
  engine_->write([&](const std::string& name, std::span<const std::byte> bytes) {
    file.write(name_in_file(name), bytes);
  });
  file.commit();
}

void Solver::resume(const protocol::Checkpoint& order) {
  const StateReader file(order.path, state_kind, state_version);
  const auto expect = [&](const char* what, const std::string& found, const std::string& ours) {
    if (found != ours)
      throw Error(ErrorCode::scene, fmt::format("is a state of {} {}, the scene has {}", what, found, ours),
                  order.path, "give the scene that the state was saved from");
  };
  std::uint64_t particles = 0, at_start = 0;
  file.read("particles", particles);
  file.read("particles_at_start", at_start);
  expect("precision", file.text("precision"), precision_name());
  expect("particles at the start:", std::to_string(at_start), std::to_string(at_start_));
  Memory memory;
  file.read("memory", std::as_writable_bytes(std::span(&memory, 1)));
  if (!memory.is_possible())
    throw Error(ErrorCode::resource, "its array 'memory' is damaged: a figure is not possible", order.path,
                "continue from another checkpoint");
  if (memory.now != order.time.count)
    throw Error(ErrorCode::resource,
                fmt::format("is the state at {} s, not at {} s", to_seconds(Nanoseconds{memory.now}),
                            to_seconds(order.time)),
                order.path, "give the files of one checkpoint");
  std::vector<Sensors::Seen> seen = sensors_.nothing_seen();
  if (sensors_.any()) file.read("sensors", std::as_writable_bytes(std::span(seen)));
  for (const Sensors::Seen& one : seen)
    if (!one.is_possible())
      throw Error(ErrorCode::resource, "its array 'sensors' is damaged: a figure is not possible", order.path,
                  "continue from another checkpoint");
  std::vector<Traffic::Seen> passed = traffic_.nothing_seen();
  if (traffic_.any()) file.read("passed", std::as_writable_bytes(std::span(passed)));
  if (!traffic_.is_possible(passed))
    throw Error(ErrorCode::resource, "its array 'passed' is damaged: a figure is not possible", order.path,
                "continue from another checkpoint");
  if (const std::uint64_t most = at_start_ + traffic_.came_in(passed);
      particles > most || memory.lost > most - particles)
    throw Error(
        ErrorCode::resource,
        fmt::format("it has {} particles and {} that were lost, of {} in all", particles, memory.lost, most),
        order.path, "continue from another checkpoint");
  std::vector<std::uint32_t> id(particles);
  if (!id.empty()) file.read("ids", std::as_writable_bytes(std::span(id)));
  if (std::ranges::adjacent_find(id, std::greater_equal{}) != id.end())
    throw Error(ErrorCode::resource, "its array 'ids' is damaged: the numbers of the particles do not ascend",
                order.path, "continue from another checkpoint");
  try {
    engine_->read(
        [&](const std::string& name) {
          std::vector<std::byte> bytes(file.size(name_in_file(name)));
          file.read(name_in_file(name), std::span(bytes));
          return bytes;
        },
        id.size());
  } catch (const Error& error) {
    throw error.where().empty() ? Error(error.code(), error.problem(), order.path, error.hint()) : error;
  }
  memory_ = memory;
  seen_ = std::move(seen);
  passed_ = std::move(passed);
  id_ = std::move(id);
}

}  // namespace tandem::sph
