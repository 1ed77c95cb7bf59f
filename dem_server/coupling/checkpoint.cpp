// The state of the particle solver on disk: that of the engine, and the state that the solver itself keeps
// from window to window.
#include <fmt/format.h>

#include <cmath>

#include "common/error.hpp"
#include "common/scene/tolerance.hpp"
#include "common/state_file.hpp"
#include "dem_server/coupling/load_solver.hpp"

namespace tandem::dem {
namespace {

constexpr const char* kind = "tandem particle state";
// Version of the contents. It must be raised with every change of the state that an engine keeps.
constexpr std::uint64_t version = 13;

// A state belongs to its back end, because lists differ: a GPU stores a pair twice.
std::string name_of(Backend backend) {
  return backend == Backend::cuda ? "cuda" : "cpu";
}

std::string engine_array(const std::string& name) {
  return "engine/" + name;
}

}  // namespace

void Solver::checkpoint(const protocol::Checkpoint& order) {
  if (ranks_ != nullptr && ranks_->rank() > 0) return engine_->write({});
  StateWriter file(order.path, kind, version);
  file.write("backend", name_of(choice_.backend));
  file.write("variant", choice_.variant);
  file.write("precision", precision_name());
  file.write("spheres", std::uint64_t{spheres_});
  file.write("time", static_cast<std::uint64_t>(memory_.now.count));
  file.write("micro_steps", memory_.micro_steps);
  file.write("lost", memory_.lost_reported);
  file.write("limits", std::as_bytes(std::span(&memory_.limits, 1)));
  file.write("traffic", std::as_bytes(std::span<const Traffic::Seen>(memory_.traffic)));
  if (belts_.any()) file.write("belts", std::as_bytes(std::span<const Belts::Seen>(memory_.belts)));
  if (sensors_.any()) file.write("sensors", std::as_bytes(std::span<const Sensors::Seen>(memory_.sensors)));
  file.write("last_motions", std::as_bytes(std::span<const LastMotion>(memory_.bodies)));
  engine_->write([&](const std::string& name, std::span<const std::byte> bytes) {
    file.write(engine_array(name), bytes);
  });
  file.commit();
}

void Solver::resume(const protocol::Checkpoint& order) {
  const StateReader file(order.path, kind, version);
  const auto expect_sound = [&](const char* name, bool sound, const char* problem) {
    if (!sound)
      throw Error(ErrorCode::resource, fmt::format("its array '{}' is damaged: {}", name, problem),
                  order.path, "continue from another checkpoint");
  };
  const auto expect = [&](const char* what, const std::string& found, const std::string& ours,
                          const char* hint = "give the scene that the state was saved from") {
    if (found != ours)
      throw Error(ErrorCode::scene, fmt::format("is a state of {} {}, the scene has {}", what, found, ours),
                  order.path, hint);
  };
  const auto number = [&](const char* name) {
    std::uint64_t value = 0;
    file.read(name, value);
    return value;
  };
  if (const std::string found = file.text("backend"); found != name_of(choice_.backend))
    throw Error(ErrorCode::usage,
                fmt::format("is a state of back end {}, this run is on {}", found, name_of(choice_.backend)),
                order.path, "give --backend " + found);
  expect("variant", file.text("variant"), choice_.variant);
  expect("precision", file.text("precision"), precision_name());
  // The ids and sizes of spheres include the spheres that come in until the end of the run.
  expect("spheres:", std::to_string(number("spheres")), std::to_string(spheres_),
         traffic_.follows_end()
             ? "an inlet without a count has as many spheres as come in before end_time, so this state "
               "cannot continue to another one: give inlets a count, and start anew"
             : "give the scene that the state was saved from");
  const Nanoseconds time{static_cast<std::int64_t>(number("time"))};
  if (time != order.time)
    throw Error(ErrorCode::resource,
                fmt::format("is the state at {} s, not at {} s", to_seconds(time), to_seconds(order.time)),
                order.path, "give the files of one checkpoint");
  Memory memory = memory_;
  file.read("last_motions", std::as_writable_bytes(std::span(memory.bodies)));
  for (const LastMotion& last : memory.bodies)
    expect_sound("last_motions", last.is_possible(), "a body has no such pose and velocity");
  file.read("limits", std::as_writable_bytes(std::span(&memory.limits, 1)));
  expect_sound("limits", memory.limits.is_possible(), "a figure is not finite");
  file.read("traffic", std::as_writable_bytes(std::span(memory.traffic)));
  expect_sound("traffic", traffic_.is_possible(memory.traffic), "more spheres came in than there are");
  if (belts_.any()) {
    file.read("belts", std::as_writable_bytes(std::span(memory.belts)));
    for (const Belts::Seen& seen : memory.belts)
      expect_sound("belts", seen.is_possible(), "a figure is not finite");
  }
  if (sensors_.any()) {
    file.read("sensors", std::as_writable_bytes(std::span(memory.sensors)));
    for (const Sensors::Seen& seen : memory.sensors)
      expect_sound("sensors", seen.is_possible(), "a figure is not finite");
  }
  try {
    engine_->read([&](const std::string& name) {
      std::vector<std::byte> bytes(file.size(engine_array(name)));
      file.read(engine_array(name), std::span(bytes));
      return bytes;
    });
  } catch (const Error& error) {
    throw error.where().empty() ? Error(error.code(), error.problem(), order.path, error.hint()) : error;
  }
  memory.now = time;
  memory.micro_steps = number("micro_steps");
  memory.lost_reported = number("lost");
  expect_sound("lost", memory.lost_reported <= spheres_, "it has lost more spheres than there are");
  memory_ = std::move(memory);
}

}  // namespace tandem::dem
