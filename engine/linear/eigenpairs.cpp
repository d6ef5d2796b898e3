#include "linear/eigenpairs.hpp"

#include <Spectra/GenEigsSolver.h>
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "system/analysis_error.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

using Complex = std::complex<double>;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using Sparse = Eigen::Map<const Eigen::SparseMatrix<double, Eigen::ColMajor, Index>>;

Sparse coefficient(const Descriptor& descriptor, int power) {
  const sparse::CscView view = descriptor.coefficient(power);
  return {view.rows, view.columns, view.start[view.columns], view.start, view.row, view.value};
}

/// P(s) factored at any s, real ones in real arithmetic; the analysis is made once for each.
template <class Scalar>
class Factors {
 public:
  explicit Factors(const Descriptor& descriptor) : descriptor_(descriptor) {}
  bool factor(Scalar s) {
    descriptor_.at(s, values_);
    if (!lu_.analyzed()) lu_.analyze(descriptor_.view(values_), descriptor_.nominal());
    return lu_.factor(descriptor_.view(values_));
  }
  [[nodiscard]] const sparse::BasicKlu<Scalar>& lu() const { return lu_; }

 private:
  const Descriptor& descriptor_;
  std::vector<Scalar> values_;
  sparse::BasicKlu<Scalar> lu_;
};

/// (sigma E - A)^-1 E on the states X = (x, v, z) in nominals, v in those of the machine's time; its eigenvalues are 1 / (sigma - s).
///
///   P(sigma) (x', lambda', z') = P1 (x, 0, z) + P2 (v + sigma x),   v' = sigma x' - x
class ShiftInvert {
 public:
  using Scalar = double;  // what the solver asks for
  explicit ShiftInvert(const Descriptor& descriptor)
      : d_(descriptor),
        real_(descriptor),
        complex_(descriptor),
        P1_(coefficient(descriptor, 1)),
        P2_(coefficient(descriptor, 2)),
        nominal_(Eigen::Map<const VectorXd>(descriptor.nominal().data(), descriptor.size())) {}
  /// Factors P(shift); false where it is singular.
  bool factor(Complex shift) {
    shift_ = shift;
    ++factorizations_;
    return shift.imag() == 0.0 ? real_.factor(shift.real()) : complex_.factor(shift);
  }

  [[nodiscard]] Index rows() const { return 2 * d_.n() + d_.nz(); }
  [[nodiscard]] Index cols() const { return rows(); }
  /// The operator on real vectors; of a complex one its real part, which has the same vectors.
  void perform_op(const double* in, double* out) const {
    const VectorXd X = Eigen::Map<const VectorXd>(in, rows());
    Eigen::Map<VectorXd> result(out, rows());
    if (shift_.imag() == 0.0) {
      result = states<double>(X, solved<double>(X, shift_.real(), real_), shift_.real());
    } else {
      const VectorXcd complex = X.cast<Complex>();
      result = states<Complex>(complex, solved<Complex>(complex, shift_, complex_), shift_).real();
    }
  }
  /// y' = (x', lambda', z') in SI for a complex X.
  [[nodiscard]] VectorXcd unknowns(const VectorXcd& X) const {
    if (shift_.imag() != 0.0) return solved<Complex>(X, shift_, complex_);
    VectorXcd y(d_.size());
    y.real() = solved<double>(X.real(), shift_.real(), real_);
    y.imag() = solved<double>(X.imag(), shift_.real(), real_);
    return y;
  }
  [[nodiscard]] VectorXcd states(const VectorXcd& X, const VectorXcd& y) const { return states<Complex>(X, y, shift_); }
  [[nodiscard]] int solves() const { return solves_; }
  [[nodiscard]] int factorizations() const { return factorizations_; }

 private:
  template <class T>
  using Column = Eigen::Matrix<T, Eigen::Dynamic, 1>;

  template <class T>
  [[nodiscard]] Column<T> solved(const Column<T>& X, T shift, const Factors<T>& factors) const {
    const Index n = d_.n(), nz = d_.nz();
    Column<T> y = Column<T>::Zero(d_.size());
    y.head(n) = X.head(n).cwiseProduct(nominal_.head(n));
    y.tail(nz) = X.tail(nz).cwiseProduct(nominal_.tail(nz));
    Column<T> right = P1_ * y;
    y.head(n) = shift * y.head(n) + X.segment(n, n).cwiseProduct(nominal_.head(n)) / d_.time();
    y.tail(nz).setZero();
    right += P2_ * y;
    factors.lu().solve({right.data(), static_cast<std::size_t>(right.size())});
    ++solves_;
    return right;
  }
  template <class T>
  [[nodiscard]] Column<T> states(const Column<T>& X, const Column<T>& y, T shift) const {
    const Index n = d_.n(), nz = d_.nz();
    Column<T> result(X.size());
    result.head(n) = y.head(n).cwiseQuotient(nominal_.head(n));
    result.segment(n, n) = d_.time() * (shift * result.head(n) - X.head(n));
    result.tail(nz) = y.tail(nz).cwiseQuotient(nominal_.tail(nz));
    return result;
  }

  const Descriptor& d_;
  Complex shift_ = 0.0;
  Factors<double> real_;
  Factors<Complex> complex_;
  Sparse P1_, P2_;
  VectorXd nominal_;
  int factorizations_ = 0;
  mutable int solves_ = 0;
};

/// Norms of P0, P1, P2 in the machine's time with columns in nominals and each row over its largest entry in any of them.
struct RowScaled {
  explicit RowScaled(const Descriptor& descriptor) {
    const VectorXd nominal = Eigen::Map<const VectorXd>(descriptor.nominal().data(), descriptor.size());
    VectorXd largest = VectorXd::Zero(descriptor.size());
    const auto each = [&](int power, auto&& visit) {
      const sparse::CscView P = descriptor.coefficient(power);
      const double per_time = std::pow(descriptor.time(), -power);
      for (Index j = 0; j < P.columns; ++j) {
        for (Index e = P.start[j]; e < P.start[j + 1]; ++e)
          visit(P.row[e], std::abs(P.value[e]) * nominal(j) * per_time);
      }
    };
    for (int power = 0; power < 3; ++power)
      each(power, [&](Index i, double size) { largest(i) = std::max(largest(i), size); });
    row = largest.unaryExpr([](double size) { return size > 0.0 ? 1.0 / size : 1.0; });
    for (int power = 0; power < 3; ++power) {
      double sum = 0.0;
      each(power, [&](Index i, double size) { sum += size * size * row(i) * row(i); });
      norm[power] = std::sqrt(sum / static_cast<double>(std::max<Index>(descriptor.size(), 1)));
    }
  }
  VectorXd row;
  double norm[3] = {};
};

double backward_error(const Descriptor& descriptor, const RowScaled& scaled, Complex s, const VectorXcd& y) {
  const VectorXcd residual =
      coefficient(descriptor, 0) * y + s * (coefficient(descriptor, 1) * y) + s * s * (coefficient(descriptor, 2) * y);
  const VectorXd nominal = Eigen::Map<const VectorXd>(descriptor.nominal().data(), descriptor.size());
  const double size = std::abs(s) * descriptor.time();
  const double terms = scaled.norm[0] + size * (scaled.norm[1] + size * scaled.norm[2]);
  return residual.cwiseProduct(scaled.row).norm() / (terms * y.cwiseQuotient(nominal).norm());
}

constexpr double tolerance = 1e-13;  // of Arnoldi's method, relative to 1 / (shift - s)

/// What belongs to infinite eigenvalues of the index-3 pencil leaves a vector after three applications.
VectorXd start_vector(const ShiftInvert& op) {
  VectorXd start =
      VectorXd::NullaryExpr(op.rows(), [](Index i) { return std::cos(1.0 + 1.7 * static_cast<double>(i)); });
  VectorXd next(op.rows());
  for (int k = 0; k < 3; ++k) {
    op.perform_op(start.data(), next.data());
    start = next.normalized();
  }
  return start;
}

/// Factors at `shift`, or beside it where it is an eigenvalue; returns the shift taken.
Complex factor_near(ShiftInvert& op, Complex shift) {
  constexpr double moved = 1.0 + 1.0 / 64.0;
  for (int trial = 0; trial < 4; ++trial, shift *= moved) {
    if (op.factor(shift)) return shift;
  }
  throw AnalysisError(
      "modes",
      "the matrix P(s) is singular at every s near " + digits(shift.real()) + " + " + digits(shift.imag()) + "i",
      "independent constraint rows, and mass for every motion that they leave free",
      "run `bramah linearize` on the scene: it names what is redundant or without mass");
}

/// The rate of the slowest motions, |v| / |x| of vectors that the operator has drawn towards them. Three applications
/// slow a free motion down by three as well: that is as far as a shift should follow it.
double slow_rate(const Descriptor& descriptor, ShiftInvert& op) {
  const double time = descriptor.time();
  double shift = 1.0 / time;
  const Index n = descriptor.n();
  for (int trial = 0; trial < 4 && n > 0; ++trial) {
    shift = factor_near(op, shift).real();
    const VectorXd X = start_vector(op);
    const double rate = X.segment(n, n).norm() / (X.head(n).norm() * time);
    if (!(rate > 0.0) || !std::isfinite(rate) || (rate < 2.0 * shift && rate > 0.5 * shift)) break;
    const bool slower = rate < shift;
    shift = slower ? std::max(rate, shift / 30.0) : std::min(rate, shift * 1e3);
    if (slower) break;
  }
  return shift;
}

/// One step of Newton's method on P(s) y = 0 with y scaled by itself: u = P(s)^-1 P'(s) y, s -= |y|^2 / (y^H u).
void polish(const Descriptor& descriptor, Factors<Complex>& factors, const VectorXd& nominal, Eigenpair& pair) {
  const Complex s = pair.eigenvalue;
  if (!factors.factor(s)) return;  // exactly singular: nothing is left to gain
  VectorXcd u = coefficient(descriptor, 1) * pair.vector + 2.0 * s * (coefficient(descriptor, 2) * pair.vector);
  factors.lu().solve({u.data(), static_cast<std::size_t>(u.size())});
  const VectorXcd y = pair.vector.cwiseQuotient(nominal), next = u.cwiseQuotient(nominal);
  pair.eigenvalue -= y.squaredNorm() / y.dot(next);
  pair.vector = u;
}

/// Vectors of the `wanted` largest eigenvalues of the operator.
Eigen::MatrixXcd by_arnoldi(ShiftInvert& op, Index wanted, Index basis) {
  Spectra::GenEigsSolver<ShiftInvert> solver(op, wanted, basis);
  solver.init(start_vector(op).data());
  const Index converged = solver.compute(Spectra::SortRule::LargestMagn, 300, tolerance);
  if (converged < wanted)
    throw AnalysisError(
        "modes",
        "Arnoldi's method found " + std::to_string(converged) + " of " + std::to_string(wanted) + " eigenvalues",
        "as many as were asked for", "ask for fewer, or move the shift");
  return solver.eigenvectors();
}

/// The same of a small system, from the operator written out.
Eigen::MatrixXcd all_at_once(const ShiftInvert& op, Index wanted) {
  Eigen::MatrixXd G(op.rows(), op.rows());
  for (Index j = 0; j < G.cols(); ++j) op.perform_op(VectorXd::Unit(G.rows(), j).eval().data(), G.col(j).data());
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(G);
  std::vector<Index> order(static_cast<std::size_t>(G.cols()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return std::abs(solver.eigenvalues()(a)) > std::abs(solver.eigenvalues()(b));
  });
  Eigen::MatrixXcd vectors(G.rows(), wanted);
  for (Index k = 0; k < wanted; ++k) vectors.col(k) = solver.eigenvectors().col(order[static_cast<std::size_t>(k)]);
  return vectors;
}

void sort_by_distance(Eigenpairs& list, Complex from) {
  std::stable_sort(list.pairs.begin(), list.pairs.end(), [&](const Eigenpair& a, const Eigenpair& b) {
    return std::abs(a.eigenvalue - from) < std::abs(b.eigenvalue - from);
  });
}

/// Takes `wanted` eigenvalues nearest to the shift, conjugates counted, into `result`.
void iterate(const Descriptor& descriptor, ShiftInvert& op, Index wanted, Eigenpairs& result) {
  wanted = std::min(wanted, descriptor.states());
  if (wanted == 0) return;
  const Index basis = wanted + std::max<Index>(wanted / 2, 20);
  const Eigen::MatrixXcd vectors = basis < op.rows() ? by_arnoldi(op, wanted, basis) : all_at_once(op, wanted);
  for (Index k = 0; k < vectors.cols(); ++k) {
    const VectorXcd X = vectors.col(k);
    Eigenpair pair;
    pair.vector = op.unknowns(X);
    const VectorXcd next = op.states(X, pair.vector);
    pair.eigenvalue = result.shift - next.dot(X) / next.squaredNorm();  // next = X / (shift - s)
    if (std::abs(pair.eigenvalue.imag()) <= 1e-12 * std::abs(pair.eigenvalue)) pair.eigenvalue.imag(0.0);
    if (pair.eigenvalue.imag() < 0.0 && result.shift.imag() >= 0.0) continue;  // its partner tells the same
    result.pairs.push_back(std::move(pair));
  }
  sort_by_distance(result, result.shift);
}

/// Takes the eigenvalue 0 of known multiplicity out of the pairs: rounding scatters it, ranks do not.
void take_zeros(Eigenpairs& result, Index zeros) {
  if (zeros == 0) return;
  sort_by_distance(result, 0.0);
  std::size_t taken = 0;
  while (result.zeros < zeros && taken < result.pairs.size())
    result.zeros += result.pairs[taken++].eigenvalue.imag() == 0.0 ? 1 : 2;
  if (result.zeros != zeros)
    throw AnalysisError(
        "modes",
        std::to_string(result.zeros) + " eigenvalues at zero by iteration and " + std::to_string(zeros) + " by ranks",
        "the same count", "move the shift away from zero");
  result.pairs.erase(result.pairs.begin(), result.pairs.begin() + static_cast<std::ptrdiff_t>(taken));
  sort_by_distance(result, result.shift);
}

/// Residuals and scales of all pairs, and a step of Newton's method where the iteration left digits: where the residual
/// is large, and where the eigenvalue is small beside the shift that it was a difference to.
void finish(const Descriptor& descriptor, Eigenpairs& result) {
  constexpr double good = 1e-13, small = 0.02;
  const RowScaled scaled(descriptor);
  const VectorXd nominal = Eigen::Map<const VectorXd>(descriptor.nominal().data(), descriptor.size());
  Factors<Complex> factors(descriptor);
  for (Eigenpair& pair : result.pairs) {
    pair.residual = backward_error(descriptor, scaled, pair.eigenvalue, pair.vector);
    if (pair.residual > good || std::abs(pair.eigenvalue) < small * std::abs(result.shift)) {
      polish(descriptor, factors, nominal, pair);
      pair.residual = backward_error(descriptor, scaled, pair.eigenvalue, pair.vector);
    }
    Index largest = 0;
    pair.vector.cwiseQuotient(nominal).cwiseAbs().maxCoeff(&largest);
    pair.vector *= nominal(largest) / pair.vector(largest);
  }
}

/// Proves that the disk holds no eigenvalue beside pairs and zeros.
void prove(const Descriptor& descriptor, Eigenpairs& result) {
  std::vector<Complex> known(static_cast<std::size_t>(result.zeros), 0.0);
  for (const Eigenpair& pair : result.pairs) known.push_back(pair.eigenvalue);
  const Index unknown = count_unknown(descriptor, result.disk, known);
  if (unknown != 0)
    throw AnalysisError("modes", std::to_string(unknown) + " eigenvalues that the iteration missed",
                        "none, by the turns of det P(s) around the disk", "ask for more modes, or move the shift");
  result.proven = true;
}

}  // namespace

Eigenpairs find_nearest(const Descriptor& descriptor, Index count, double shift, Index zeros, Proof proof) {
  Eigenpairs result;
  ShiftInvert op(descriptor);
  const auto search = [&](double from) {
    result = Eigenpairs{};
    result.shift = factor_near(op, from);
    // One more than asked for: the circle of the proof runs between the last and the next.
    iterate(descriptor, op, 2 * (count + 1) + zeros, result);
    take_zeros(result, zeros);
  };
  search(shift > 0.0 ? shift : slow_rate(descriptor, op));
  // Zeros draw the estimate of the slowest rate down: what they hid is found more exactly from nearby.
  if (shift <= 0.0 && !result.pairs.empty() && std::abs(result.pairs.front().eigenvalue) > 8.0 * std::abs(result.shift))
    search(std::abs(result.pairs.front().eigenvalue));
  finish(descriptor, result);
  const auto kept = std::min(static_cast<std::size_t>(count), result.pairs.size());
  const auto distance = [&](std::size_t k) { return std::abs(result.pairs[k].eigenvalue - result.shift); };
  result.disk.centre = result.shift;
  if (kept > 0)
    result.disk.radius =
        kept < result.pairs.size() ? 0.5 * (distance(kept - 1) + distance(kept)) : (1.0 + 1e-6) * distance(kept - 1);
  if (!result.disk.contains(0.0)) result.zeros = 0;
  if (proof == Proof::wanted) prove(descriptor, result);
  result.pairs.resize(kept);
  result.solves = op.solves();
  result.factorizations = op.factorizations();
  return result;
}

Eigenpairs find_inside(const Descriptor& descriptor, const Disk& disk, Index zeros, Proof proof) {
  ShiftInvert op(descriptor);
  Eigenpairs result;
  // The centre, but never zero: a little to the right of it.
  const Complex shift = factor_near(op, disk.centre == 0.0 ? Complex(disk.radius / 16.0) : disk.centre);
  const Disk reach{shift, disk.radius + std::abs(shift - disk.centre)};
  for (Index wanted = 40 + zeros;; wanted *= 2) {
    result = Eigenpairs{};
    result.shift = shift;
    iterate(descriptor, op, wanted, result);
    const bool all = wanted >= descriptor.states();
    if (all || result.pairs.empty() || !reach.contains(result.pairs.back().eigenvalue)) break;
  }
  result.disk = disk;
  if (disk.contains(0.0)) take_zeros(result, zeros);
  finish(descriptor, result);
  if (proof == Proof::wanted) prove(descriptor, result);
  std::erase_if(result.pairs, [&](const Eigenpair& pair) { return !disk.contains(pair.eigenvalue); });
  result.solves = op.solves();
  result.factorizations = op.factorizations();
  return result;
}

namespace {

/// Turns of g(s) = det P(s) / prod(s - known) along a circle, by its phase and the rate of its phase: a step is taken when
/// the rates at its ends foretell the phase between them. Phases alone could miss whole turns.
class Turning {
 public:
  Turning(const Descriptor& descriptor, std::span<const Complex> known, const Disk& disk)
      : factors_(descriptor), known_(known), disk_(disk) {}

  double along(double from, double to, int segments) {
    double sum = 0.0;
    Sample before = sample(from);
    for (int k = 1; k <= segments; ++k) {
      const Sample after = sample(from + (to - from) * k / segments);
      sum += between(before, after);
      before = after;
    }
    return sum;
  }

 private:
  struct Sample {
    double angle;   // on the circle
    Complex phase;  // g / |g|
    double rate;    // d(arg g)/d(angle)
  };

  double between(const Sample& a, const Sample& b) {
    constexpr double small = std::numbers::pi / 2.0, agree = std::numbers::pi / 8.0;
    const double step = b.angle - a.angle, foretold = 0.5 * (a.rate + b.rate) * step,
                 found = std::arg(b.phase / a.phase);
    if (std::abs(a.rate) * step < small && std::abs(b.rate) * step < small && std::abs(found - foretold) < agree)
      return found;
    const Sample middle = sample(0.5 * (a.angle + b.angle));
    return between(a, middle) + between(middle, b);
  }
  Sample sample(double angle) {
    constexpr double apart = 1e-5;
    const Complex before = phase(angle - 0.5 * apart), after = phase(angle + 0.5 * apart);
    return {angle, before, std::arg(after / before) / apart};
  }
  Complex phase(double angle) {
    const Complex s = disk_.centre + std::polar(disk_.radius, angle);
    Complex rest = 1.0;
    bool hit = left_-- <= 0 || !factors_.factor(s);
    for (const Complex eigenvalue : known_) {
      const Complex distance = s - eigenvalue;
      hit = hit || distance == 0.0;
      rest *= std::conj(distance) / std::abs(distance);
    }
    if (hit)
      throw AnalysisError("modes",
                          "an eigenvalue too near the circle at " + digits(s.real()) + " + " + digits(s.imag()) + "i",
                          "a circle that keeps away from eigenvalues", "ask for more or fewer modes");
    return rest * factors_.lu().determinant_phase();
  }

  Factors<Complex> factors_;
  std::span<const Complex> known_;
  Disk disk_;
  int left_ = 4000;
};

Index turns(double radians) { return std::llround(radians / (2.0 * std::numbers::pi)); }

std::vector<Complex> with_conjugates(std::span<const Complex> list) {
  std::vector<Complex> all(list.begin(), list.end());
  for (const Complex value : list) {
    if (value.imag() != 0.0) all.push_back(std::conj(value));
  }
  return all;
}

}  // namespace

Index count_unknown(const Descriptor& descriptor, const Disk& disk, std::span<const Complex> known) {
  constexpr double pi = std::numbers::pi;
  const std::vector<Complex> all = with_conjugates(known);
  Turning turning(descriptor, all, disk);
  // det P(conj s) = conj det P(s): half a circle about a real centre tells the other half.
  if (disk.centre.imag() == 0.0) return turns(2.0 * turning.along(0.0, pi, 8));
  return turns(turning.along(0.0, 2.0 * pi, 16));
}

}  // namespace bramah
