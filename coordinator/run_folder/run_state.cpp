#include "coordinator/run_folder/run_state.hpp"

#include "common/input_file.hpp"
#include "coordinator/run_folder/own_files.hpp"
#include "coordinator/verdict/status.hpp"

namespace tandem::launch {
namespace {

nlohmann::json summary_in(const std::filesystem::path& folder) {
  try {
    nlohmann::json summary =
        nlohmann::json::parse(read_input(folder / summary_name, {.largest = largest_text}), nullptr, false);
    if (summary.is_object()) return summary;
  } catch (const Error&) {  // the run has none, or somebody put something else there
  }
  return nlohmann::json::object();
}

}  // namespace

RunState read_run(const std::filesystem::path& folder) {
  RunState state;
  // The marker is read first: a run that ends in between has written its last summary before it releases
  // the lock.
  state.marker = read_marker(folder);
  state.summary = summary_in(folder);
  state.status = status_now(state.summary);
  if (!state.marker) return state;
  const Life life = life_of(*state.marker);
  const bool none = state.summary.empty() || state.status.empty();
  if (none) state.status = life == Life::gone ? name(Status::died) : name(Status::running);
  if (state.status == name(Status::running) && life == Life::gone) state.status = name(Status::died);
  if (state.status == name(Status::died) && life == Life::lives) state.status = name(Status::running);
  return state;
}

}  // namespace tandem::launch
