// Strongly connected components of the structure of a matrix (Tarjan 1972).
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace bramah {

/// Rows of each component, ascending, in an order in which A (n x n) is block upper triangular: A(i, j) is exactly zero
/// where the component of i stands behind that of j.
std::vector<std::vector<Eigen::Index>> strong_components(const Eigen::MatrixXd& A);

}  // namespace bramah
