// A state on disk: an HDF5 file with a dataset for each field, of the machine whose coordinates it names. A
// run that goes on from it gives the same bits as one that never stopped.
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

// The file is complete or not there. Error{resource} where it cannot be written.
void write_state(const std::filesystem::path& path, const Model& model, const State& state,
                 const RunTotals& totals = {});

// Error{resource} where the file cannot be read or is none of write_state()'s, Error{scene} where it is that
// of another machine.
SavedState read_state(const std::filesystem::path& path, const Model& model);

}  // namespace tandem::mbd
