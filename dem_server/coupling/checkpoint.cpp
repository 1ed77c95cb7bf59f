// The state of the particle solver on disk: that of the engine, and the state that the solver itself keeps
// from window to window.
#include <fmt/format.h>

#include <cmath>

#include "common/error.hpp"
#include "common/scene/tolerance.hpp"
#include "dem_server/coupling/load_solver.hpp"
#include "particles/serving/resumed_state.hpp"

namespace tandem::dem {
namespace {

constexpr const char* kind = "tandem particle state";
// Version of the contents. It must be raised with every change of the state that an engine keeps.
constexpr std::uint64_t version = 13;

// A state belongs to its back end, because lists differ: a GPU stores a pair twice.
std::string name_of(Backend backend) {
  return backend == Backend::cuda ? "cuda" : "cpu";
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
  file.write("traffic", std::as_bytes(std::span<const Traffic::Counts>(memory_.traffic)));
  if (belts_.any()) file.write("belts", std::as_bytes(std::span<const Belts::Record>(memory_.belts)));
  if (sensors_.any()) file.write("sensors", std::as_bytes(std::span<const FlowRecord>(memory_.sensors)));
  file.write("last_motions", std::as_bytes(std::span<const LastMotion>(memory_.bodies)));
  engine_->write([&](const std::string& name, std::span<const std::byte> bytes) {
    file.write(engine_array(name), bytes);
  });
  file.commit();
}

void Solver::resume(const protocol::Checkpoint& order) {
  const ResumedState state(order, kind, version);
  const StateReader& file = state.file();
  if (const std::string found = file.text("backend"); found != name_of(choice_.backend))
    throw Error(ErrorCode::usage,
                fmt::format("is a state of back end {}, this run is on {}", found, name_of(choice_.backend)),
                order.path, "give --backend " + found);
  state.expect_same("variant", file.text("variant"), choice_.variant);
  state.expect_same("precision", file.text("precision"), precision_name());
  // The ids and sizes of spheres include the spheres that come in until the end of the run.
  state.expect_same(
      "spheres:", std::to_string(state.number("spheres")), std::to_string(spheres_),
      traffic_.follows_end()
          ? "an inlet without a count has as many spheres as come in before end_time, so this state "
            "cannot continue to another one: give inlets a count, and start anew"
          : "give the scene that the state was saved from");
  const Nanoseconds time{static_cast<std::int64_t>(state.number("time"))};
  state.expect_time(time);
  Memory memory = memory_;
  state.read("last_motions", memory.bodies);
  state.read("limits", std::span(&memory.limits, 1));
  file.read("traffic", std::as_writable_bytes(std::span(memory.traffic)));
  state.expect_sound("traffic", traffic_.is_possible(memory.traffic), "more spheres came in than there are");
  state.read("belts", memory.belts);
  state.read("sensors", memory.sensors);
  state.read_engine([&](const auto& bytes_of) { engine_->read(bytes_of); });
  memory.now = time;
  memory.micro_steps = state.number("micro_steps");
  memory.lost_reported = state.number("lost");
  state.expect_sound("lost", memory.lost_reported <= spheres_, "it has lost more spheres than there are");
  memory_ = std::move(memory);
}

}  // namespace tandem::dem
