// The largest modulus of a matrix's eigenvalues: the asymptotic growth per application of a linear map.
#pragma once

#include <span>

namespace tandem {

// matrix: the n x n elements, by rows or by columns (a matrix and its transpose have the same eigenvalues).
double spectral_radius(std::span<const double> matrix);

}  // namespace tandem
