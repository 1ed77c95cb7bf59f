// The stiffness for which impacts of the same energy overlap less.
#pragma once

#include <string>

#include "common/scene/model.hpp"

namespace tandem::dem {

// Describes how to stiffen the softest material, or pair of a law with stiffnesses of its own, so that the
// largest overlap becomes 0.95 `ratio` < 1 times its present value: "young = 6e+07 Pa (now 1e+07) for the
// material 'glass'". An impact of energy W compresses by Hertz's law F = k d^(3/2) to d = (5 W / (2
// k))^(2/5), by Hooke's F = k d to d = (2 W / k)^(1/2). A weight at rest needs less: d is proportional to
// k^(-2/3) and 1/k.
std::string stiffer(const scene::Dem& dem, double ratio);

// The factor by which the micro step then shrinks [-].
double step_of_stiffer(const scene::Dem& dem, double ratio);

}  // namespace tandem::dem
