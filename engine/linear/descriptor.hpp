// The linear model before any reduction, sparse: for systems too large for a dense Jacobian, and as a second way to every
// result of the reduced one. With y = (x, lambda, z), lambda of the independent rows, and s = d/dt:
//
//            [ M s^2 + f_v s + f_x   D^T   f_z           ] [ x      ]   Eq. (23)
//   P(s) y = [ c_x | b_v s + b_x     0     0             ] [ lambda ] = 0      Eqs. (41) | (47)
//            [ g_v s + g_x           0     K s + g_z     ] [ z      ]   Eqs. (26), (28)
//
// P(s) = P0 + s P1 + s^2 P2 is singular exactly where s is an eigenvalue of the smallest Jacobian J. It needs no
// partition: only which rows are independent.
#pragma once

#include <complex>
#include <span>
#include <string>
#include <vector>

#include "solve/kkt.hpp"
#include "system/blocks.hpp"

namespace bramah {

class Descriptor {
 public:
  /// `rows`: independent rows of [c; b], holonomic ones first.
  Descriptor(const System& system, std::span<const Index> rows);

  /// Takes the coefficients at `state`.
  void evaluate(const State& state);
  /// What changes along the reference motion, empty where all coefficients are constant. Where one changes, J is a
  /// snapshot that no equation with constant coefficients has, P(s) least of all.
  [[nodiscard]] const std::string& changing() const { return changing_; }
  /// AnalysisError where something changes.
  void require_constant() const;

  [[nodiscard]] Index size() const { return plan_.rows(); }
  [[nodiscard]] Index n() const { return system_.n(); }
  [[nodiscard]] Index nz() const { return system_.nz(); }
  [[nodiscard]] Index row_count() const { return size() - n() - nz(); }
  /// Eigenvalues of P, zeros included: 2n - 2m - l + r + u.
  [[nodiscard]] Index states() const { return states_; }
  [[nodiscard]] const System& system() const { return system_; }

  /// P0, P1 or P2; one pattern serves all three.
  [[nodiscard]] sparse::CscView coefficient(int power) const;
  /// Values of P(s) on that pattern.
  void at(double s, std::vector<double>& values) const;
  void at(std::complex<double> s, std::vector<std::complex<double>>& values) const;
  template <class Scalar>
  [[nodiscard]] sparse::BasicCscView<Scalar> view(const std::vector<Scalar>& values) const {
    return {plan_.rows(), plan_.columns(), plan_.start().data(), plan_.row().data(), values.data()};
  }
  /// Typical size of each entry of y: nominals of variables; of a multiplier, its row's largest force over that of D.
  [[nodiscard]] const Vector& nominal() const { return nominal_; }
  /// The machine's own: P0, P1 / time and P2 / time^2 are of one size.
  [[nodiscard]] double time() const { return time_; }
  /// "crank.angle", "hinge.lambda_x", "V1.p".
  [[nodiscard]] std::string unknown_name(Index i) const;

 private:
  void find_changes(const State& state);
  void find_rates(const State& state);
  void find_second_rates(const State& state);
  void find_nominals();
  void name_change(const SparsePlan& rates, double factor, const char* unit);
  [[nodiscard]] std::string row_name(Index row) const;

  const System& system_;
  std::vector<Index> rows_;
  Index holonomic_ = 0, states_ = 0;
  double time_ = 1.0;
  Blocks blocks_;
  SparsePlan plan_, second_rates_;  // of P(s); of d2/dt2 C_x, made where it is needed
  Vector coefficient_[3], nominal_;
  Vector largest_;  // term of each row, of unknowns in their nominals and the machine's time
  std::string changing_;
};

/// One entry of E or A.
struct Entry {
  Index row, column;
  double value;
};
/// E dX/dt = A X with X = (x, v, lambda, z), for other programs.
struct FirstOrderForm {
  std::vector<Entry> E, A;
  std::vector<std::string> states;
};
FirstOrderForm first_order_form(const Descriptor& descriptor);

}  // namespace bramah
