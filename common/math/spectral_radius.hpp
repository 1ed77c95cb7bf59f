// The largest modulus of a matrix's eigenvalues: what a linear map makes of a state, per application, in the
// end.
#pragma once

#include <span>

namespace tandem {

// matrix: the n x n elements, by rows or by columns (a matrix and its transpose have the same eigenvalues).
double spectral_radius(std::span<const double> matrix);

}  // namespace tandem
