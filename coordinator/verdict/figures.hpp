// What the rules' files have in common: figures of a run, each with the object that it is of.
#pragma once

#include "coordinator/verdict/verdict.hpp"

namespace tandem::launch {

using Json = nlohmann::ordered_json;
using Figures = std::optional<std::vector<Figure>>;

inline constexpr const char* whole_run = "the run";
Figures of_run(std::optional<double> value);

// part / whole; 0 where both are 0.
Figures share(std::optional<double> part, std::optional<double> whole);

// A number of an object of the summary; NaN where it is none, which exceeds every limit.
double figure_of(const Json& object, const char* key);

// What an entry of a list of the summary says that it is of.
std::string of_entry(const Json& entry);
// A figure of each entry of such a list, its share where `key` says nothing else; none without the list.
Figures figures_of(const RunFigures& run, const char* list, const char* key = "share",
                   std::string (*of)(const Json&) = of_entry);

// The entry of a list of the summary that is of this.
const Json& entry_of(const RunFigures& run, const char* list, const std::string& of,
                     std::string (*name)(const Json&) = of_entry);

// Settings of the multibody solver for an error reduced by `factor` < 1; its order is two.
std::string finer_step(const scene::Scene& scene, double factor);

}  // namespace tandem::launch
