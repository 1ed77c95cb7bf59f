// Whether the explicit method of the multibody solver would be faster: what a study says of it.
#pragma once

#include "common/scene/model.hpp"
#include "launch/study/reading.hpp"

namespace tandem::launch {

// Whether the explicit method may be tried: the joints form a tree, and none has limits or stiction.
bool suits_explicit_method(const scene::Mbd& mbd);

// Whether the run sets the method, by itself or with the whole integrator.
std::optional<scene::IntegrationMethod> method_of(const PlannedRun& run);

// Compares the rows of both methods at the smallest error that both have reached. Empty where one of them has
// no row that counts.
std::string compare_methods(const std::vector<Row>& rows, std::size_t measure);

}  // namespace tandem::launch
