// Directions of a body in which a matrix and its mass act apart from each other.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "common/scene/freedoms.hpp"

namespace tandem::launch {

using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// Of the body about its centre of mass, axes of the world.
Matrix6 mass_matrix(const scene::Body& body, const Pose& pose);

struct BodyMode {
  double value = 0;  // of the matrix, over the mass
  Vector6 shape;     // velocity and angular velocity, of unit modal mass
};
// Eigenvectors of the symmetric part of `matrix` (6 x 6 by rows) with the mass, in the directions that
// `freedom` leaves.
std::vector<BodyMode> modes_of(const std::array<double, 36>& matrix, const scene::Body& body,
                               const scene::Freedom& freedom, const Pose& pose);

}  // namespace tandem::launch
