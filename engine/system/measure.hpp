// Numbers of a state by name.
#pragma once

#include <memory>
#include <vector>

#include "system/energies.hpp"
#include "system/options.hpp"

namespace bramah {

class Meter {
 public:
  Meter(const System& system, std::vector<Measured> columns);

  /// Values of the columns at `state`, which is complete where they are outputs, energies or powers. Throws AnalysisError
  /// for an output that is not finite, and for the energy of the whole where a component does not say what it stores.
  const Vector& read(const State& state);
  [[nodiscard]] const std::vector<Measured>& columns() const { return columns_; }

 private:
  void read_energies(const State& state);
  const System& system_;
  std::vector<Measured> columns_;
  std::unique_ptr<Blocks> blocks_;      // where a column is an output
  std::unique_ptr<Energies> energies_;  // where one is an energy or a power
  Vector values_;
};

}  // namespace bramah
