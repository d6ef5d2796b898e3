// What is measured: machines by family and size, prepared once and kept.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "solve/partition.hpp"
#include "system/compile.hpp"

namespace bramah::bench {

/// A machine ready for measurement.
struct Machine {
  Compiled model;
  State state;  // consistent and general: chains bent, the four-bar at its equilibrium
  Partition partition;
  [[nodiscard]] const System& system() const { return model.system; }
};

/// A family of machines at one size.
class Case {
 public:
  /// What is measured of the machine: everything but selected modes, or only these or its partition, up to sizes at which
  /// the rest takes too long.
  enum class Extent { all, partition, modes };
  Case(std::string family, int size, Scene (*rest)(int), Scene (*general)(int), Extent extent = Extent::all);

  [[nodiscard]] const std::string& family() const { return family_; }
  [[nodiscard]] int bodies() const { return size_; }
  [[nodiscard]] Extent extent() const { return extent_; }
  [[nodiscard]] std::string name() const;
  /// The scene whose equilibrium is sought: assembled, at rest, multipliers zero.
  [[nodiscard]] Scene at_rest() const { return at_rest_(size_); }
  /// Everything else; made on first use.
  [[nodiscard]] const Machine& machine() const;

 private:
  std::string family_;
  int size_;
  Scene (*at_rest_)(int);
  Scene (*general_)(int);
  Extent extent_;
  mutable std::unique_ptr<Machine> machine_;
};

/// The four-bar, the chains of 10, 100 and 1000 bodies, and longer ones and ladders for the partition and for modes.
const std::vector<Case>& cases();

}  // namespace bramah::bench
