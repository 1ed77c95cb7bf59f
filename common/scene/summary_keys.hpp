// The numbers of summary.json that a check may name, known before there is a summary.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::scene {

// For runs of this scene: "windows", "border.crate.omega_H".
std::vector<std::string> summary_keys(const Scene& scene);

// Where summary.json has a fact of a solver, `mbd`, `dem` or `sph`: "sph.mach", "mbd_solver_seconds".
std::string summary_key(std::string_view solver, const std::string& fact);

// The scenes with this number in their summary: "scenes with 'mbd'"; empty where there is none.
std::string runs_with(const std::string& key);

}  // namespace tandem::scene
