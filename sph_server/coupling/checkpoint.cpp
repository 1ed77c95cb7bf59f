// The state of the liquid on disk: that of the engine, and what the solver itself keeps from window to
// window.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <span>

#include "common/error.hpp"
#include "particles/serving/resumed_state.hpp"
#include "sph_server/coupling/load_solver.hpp"

namespace tandem::sph {
namespace {

constexpr const char* state_kind = "tandem liquid state";
// Version of the contents. It must be raised with every change of the state that an engine keeps.
constexpr std::uint64_t state_version = 8;

}  // namespace

void Solver::checkpoint(const protocol::Checkpoint& order) {
  StateWriter file(order.path, state_kind, state_version);
  file.write("precision", precision_name());
  file.write("particles_at_start", std::uint64_t{at_start_});
  file.write("particles", std::uint64_t{id_.size()});
  file.write("memory", std::as_bytes(std::span(&memory_, 1)));
  if (sensors_.any()) file.write("sensors", std::as_bytes(std::span(flows_)));
  if (traffic_.any()) file.write("passed", std::as_bytes(std::span(passed_)));
  if (!id_.empty()) file.write("ids", std::as_bytes(std::span(id_)));
  engine_->write([&](const std::string& name, std::span<const std::byte> bytes) {
    file.write(particles::engine_array(name), bytes);
  });
  file.commit();
}

void Solver::resume(const protocol::Checkpoint& order) {
  const particles::ResumedState state(order, state_kind, state_version);
  const std::uint64_t particles = state.number("particles");
  state.expect_same("precision", state.file().text("precision"), precision_name());
  state.expect_same("particles at the start:", std::to_string(state.number("particles_at_start")),
                    std::to_string(at_start_));
  Memory memory;
  state.read("memory", std::span(&memory, 1));
  state.expect_time(Nanoseconds{memory.now});
  std::vector<particles::FlowRecord> flows = sensors_.no_flows();
  state.read("sensors", flows);
  std::vector<Traffic::Counts> passed = traffic_.no_counts();
  if (traffic_.any()) state.file().read("passed", std::as_writable_bytes(std::span(passed)));
  state.expect_sound("passed", traffic_.is_possible(passed), "a figure is not possible");
  if (const std::uint64_t most = at_start_ + traffic_.came_in(passed);
      particles > most || memory.lost > most - particles)
    throw Error(
        ErrorCode::resource,
        fmt::format("it has {} particles and {} that were lost, of {} in all", particles, memory.lost, most),
        order.path, "continue from another checkpoint");
  std::vector<std::uint32_t> id(particles);
  if (!id.empty()) state.file().read("ids", std::as_writable_bytes(std::span(id)));
  state.expect_sound("ids", std::ranges::adjacent_find(id, std::greater_equal{}) == id.end(),
                     "the numbers of the particles do not ascend");
  state.read_engine([&](const auto& bytes_of) { engine_->read(bytes_of, id.size()); });
  memory_ = memory;
  flows_ = std::move(flows);
  passed_ = std::move(passed);
  id_ = std::move(id);
}

}  // namespace tandem::sph
