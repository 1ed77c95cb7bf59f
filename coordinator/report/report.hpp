// The picture of the last frame (rendered by POV-Ray) and report.html (made by report.py with matplotlib),
// from a finished run's folder. Both are optional: where the tool is missing, a warning names the Debian
// package, and the run's status is unchanged.
#pragma once

#include <filesystem>

#include "common/scene/model.hpp"

namespace tandem::launch {

// Writes FOLDER/picture.png; returns false after a warning.
bool render_picture(const std::filesystem::path& folder, const scene::Scene& scene);
// Writes FOLDER/report.html; returns false after a warning.
bool write_report(const std::filesystem::path& folder);

}  // namespace tandem::launch
