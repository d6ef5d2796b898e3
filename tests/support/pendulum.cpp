#include "support/pendulum.hpp"

#include <cmath>

#include "support/generators.hpp"

namespace bramah::support {

std::vector<double> planar_pieces(int links) {
  return std::vector<double>(static_cast<std::size_t>(links), rod_length);
}

std::vector<double> spatial_pieces_about_y(int links) {
  std::vector<double> pieces(static_cast<std::size_t>(links / 2), 2.0 * rod_length);
  if (links % 2 == 1) pieces.push_back(rod_length);
  return pieces;
}
std::vector<double> spatial_pieces_about_x(int links) { return spatial_pieces_about_y(links - 1); }

namespace {

/// M and K of the rods, symmetric with three diagonals.
struct Tridiagonal {
  std::vector<double> diagonal, beside;
};

struct Rods {
  explicit Rods(const std::vector<double>& pieces) {
    const std::size_t n = pieces.size();
    M.diagonal.assign(n, 0.0);
    M.beside.assign(n, 0.0);
    K = M;
    double below = 0.0;
    for (std::size_t j = n; j-- > 0;) {
      const double mass = pieces[j] * rod_mass / rod_length, stiffness = (below + 0.5 * mass * gravity) / pieces[j];
      below += mass * gravity;
      M.diagonal[j] += mass / 3.0;
      K.diagonal[j] += stiffness;
      if (j == 0) continue;  // its upper end is fixed
      M.diagonal[j - 1] += mass / 3.0;
      M.beside[j] = mass / 6.0;
      K.diagonal[j - 1] += stiffness;
      K.beside[j] = -stiffness;
    }
  }
  /// Eigenvalues below `square`: negative pivots of K - square M.
  [[nodiscard]] int below(double square) const {
    int count = 0;
    double pivot = 1.0;
    for (std::size_t j = 0; j < M.diagonal.size(); ++j) {
      const double beside = K.beside[j] - square * M.beside[j];
      pivot = K.diagonal[j] - square * M.diagonal[j] - (j == 0 ? 0.0 : beside * beside / pivot);
      if (pivot == 0.0) pivot = 1e-300;
      if (pivot < 0.0) ++count;
    }
    return count;
  }
  Tridiagonal M, K;
};

}  // namespace

std::vector<double> lowest_frequencies(const std::vector<double>& pieces, int count) {
  const Rods rods(pieces);
  std::vector<double> frequencies;
  for (int k = 0; k < count && k < static_cast<int>(pieces.size()); ++k) {
    double low = 0.0, high = 1.0;
    while (rods.below(high * high) <= k) high *= 2.0;
    for (double middle = 0.5 * high; low < middle && middle < high; middle = 0.5 * (low + high))
      (rods.below(middle * middle) <= k ? low : high) = middle;
    frequencies.push_back(high);
  }
  return frequencies;
}

double ladder_angle(int loops, double t) {
  constexpr std::size_t order = 16;
  const long steps = std::lround(std::ceil(500.0 * t));  // rates are some 4 1/s: a step's last term is below 1e-30
  const auto N = static_cast<long double>(loops);
  const long double rate = gravity / rod_length * ((N + 1.0L) / 2.0L + N) / ((N + 1.0L) / 3.0L + N);
  const long double h = static_cast<long double>(t) / static_cast<long double>(steps);
  long double angle = 0.0L, speed = 1.0L;  // 1 m/s at the upper end of a rod of 1 m
  for (long step = 0; step < steps; ++step) {
    // Coefficients of phi, sin(phi) and cos(phi) in powers of time.
    long double phi[order + 2] = {angle, speed}, sine[order] = {std::sin(angle)}, cosine[order] = {std::cos(angle)};
    for (std::size_t k = 0; k < order; ++k) {
      for (std::size_t j = 1; j <= k; ++j) {
        const long double share = static_cast<long double>(j) / static_cast<long double>(k);
        sine[k] += share * phi[j] * cosine[k - j];
        cosine[k] -= share * phi[j] * sine[k - j];
      }
      phi[k + 2] = rate * sine[k] / static_cast<long double>((k + 1) * (k + 2));
    }
    angle = speed = 0.0L;
    for (std::size_t k = order + 2; k-- > 0;) {
      angle = angle * h + phi[k];
      if (k > 0) speed = speed * h + static_cast<long double>(k) * phi[k];
    }
  }
  return static_cast<double>(angle);
}

}  // namespace bramah::support
