// Machines on a steady motion: started, linearized with a prescribed partition, compared with a reference.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <string>
#include <utility>
#include <vector>

#include "linear/spectrum.hpp"
#include "solve/start.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"
#include "support/reference.hpp"

namespace bramah::testing {

using Eigenvalues = std::vector<std::complex<double>>;

/// A machine at its consistent start.
struct Moving {
  explicit Moving(const std::string& file, const std::vector<std::string>& settings = {})
      : Moving(load(file, settings)) {}
  explicit Moving(Machine loaded)
      : machine(std::move(loaded)), state(consistent_start(machine.system(), machine.options(), 0.0)) {
    state.side = machine.options().linearize.side;
  }
  [[nodiscard]] const System& system() const { return machine.system(); }
  [[nodiscard]] double value(const std::string& name) const { return machine.value(state, name); }
  [[nodiscard]] LinearModel model() const { return linear_model(machine, state); }

  /// The model with these coordinates as x_ai and x_ad.
  [[nodiscard]] LinearModel model(const std::vector<std::string>& ai, const std::vector<std::string>& ad) const {
    const auto indices = [&](const std::vector<std::string>& names) {
      std::vector<Index> list;
      for (const std::string& name : names) list.push_back(system().find_x(name));
      return list;
    };
    const Partition partition = choose_partition(system(), state, {indices(ai), indices(ad)});
    Linearizer linearizer(system(), partition);
    LinearModel result;
    linearizer.linearize(state, result);
    return result;
  }

  Machine machine;
  State state;
};

inline Eigenvalues pairs(const nlohmann::json& list) {
  Eigenvalues result;
  for (const auto& pair : list) result.emplace_back(number(pair[0]), number(pair[1]));
  return result;
}

/// Every expected eigenvalue to `tolerance`, and `zeros` more that are told to be zero.
inline void expect_spectrum(const LinearModel& model, const Eigenvalues& nonzero, std::size_t zeros, double tolerance) {
  const Spectrum spectrum = find_spectrum(model);
  Eigenvalues found;
  std::size_t zeros_found = 0;
  for (const Mode& mode : spectrum.modes) {
    if (mode.zero) {
      ++zeros_found;
    } else {
      found.push_back(mode.eigenvalue);
    }
  }
  EXPECT_EQ(zeros_found, zeros);
  for (const std::complex<double>& expected : nonzero) EXPECT_TRUE(take_nearest(found, expected, tolerance));
  for (const std::complex<double>& more : found) ADD_FAILURE() << "one more eigenvalue, " << more;
}

/// Entry by entry; what should be zero, against the largest term of its row with every state moved by its nominal.
inline void expect_matrix(const LinearModel& model, const nlohmann::json& J, double tolerance) {
  ASSERT_EQ(static_cast<std::size_t>(model.A.rows()), J.size());
  for (Eigen::Index i = 0; i < model.A.rows(); ++i) {
    const std::vector<double> row = numbers(J[static_cast<std::size_t>(i)]);
    const auto nominal = [&](Eigen::Index j) { return model.states[static_cast<std::size_t>(j)].nominal; };
    double scale = nominal(i);  // 1/s
    for (Eigen::Index k = 0; k < model.A.cols(); ++k) {
      scale = std::max(scale, std::abs(row[static_cast<std::size_t>(k)]) * nominal(k));
    }
    for (Eigen::Index j = 0; j < model.A.cols(); ++j) {
      const double expected = row[static_cast<std::size_t>(j)];
      EXPECT_TRUE(close(model.A(i, j), expected, tolerance, expected == 0.0 ? scale / nominal(j) : 0.0))
          << "J(" << i << ", " << j << ")";
    }
  }
}

}  // namespace bramah::testing
