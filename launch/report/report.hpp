// The picture of the last frame (POV-Ray renders it) and report.html (made by report.py with matplotlib),
// from a finished run's folder. Both are conveniences: where the tool is missing, a warning says which Debian
// package brings it, and the run's status stands.
#pragma once

#include <filesystem>

#include "common/scene/model.hpp"

namespace tandem::launch {

// Writes FOLDER/picture.png; returns false after a warning.
bool render_picture(const std::filesystem::path& folder, const scene::Scene& scene);
// Writes FOLDER/report.html; returns false after a warning.
bool write_report(const std::filesystem::path& folder);

}  // namespace tandem::launch
