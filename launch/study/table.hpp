// Rows of a study: made from the folders of its runs, written as CSV.
#pragma once

#include "launch/study/measures.hpp"
#include "launch/study/reading.hpp"

namespace tandem::launch {

// Whether the run completed, whatever its verdict.
bool came_to_its_end(const nlohmann::json& summary);

// The results of timing k = 1, 2, ... of a run, of which the first are in `folder`.
std::filesystem::path timing_folder(const std::filesystem::path& folder, int k);

// Whether the run need not be repeated: it completed, or it diverged, which it would do again.
bool is_complete(const std::filesystem::path& folder);

// Errors are those of the first timing; times are those of all that came to their ends.
Row row_of(const PlannedRun& run, const std::filesystem::path& folder, const Study& study,
           const Truth& truth);

// One row per run. A cell is empty where a value is unknown.
void write_table(const std::filesystem::path& file, const Study& study, const std::vector<Row>& rows);

}  // namespace tandem::launch
