// The numbers of summary.json that a check may name, before there is a summary.
#pragma once

#include <string>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::scene {

// Of runs of this scene: "windows", "border.crate.omega_H".
std::vector<std::string> summary_keys(const Scene& scene);

// Which scenes have this number in their summary: "scenes with 'mbd'"; empty where none has.
std::string runs_with(const std::string& key);

}  // namespace tandem::scene
