// A state on disk: an HDF5 file with one dataset for each field, and the names of the machine's coordinates.
// A run that continues from the file gives the same bits as a run without interruption.
#pragma once

#include <filesystem>

#include "mbd_server/io/run_totals.hpp"
#include "mbd_server/model/model.hpp"
#include "mbd_server/state/state.hpp"

namespace tandem::mbd {

struct SavedState {
  State state;
  RunTotals totals;
};

// Writes the file completely or not at all. Throws Error{resource} where it cannot be written.
void write_state(const std::filesystem::path& path, const Model& model, const State& state,
                 const RunTotals& totals = {});

// Throws Error{resource} where the file cannot be read or was not written by write_state(), Error{scene}
// where it belongs to another machine.
SavedState read_state(const std::filesystem::path& path, const Model& model);

}  // namespace tandem::mbd
