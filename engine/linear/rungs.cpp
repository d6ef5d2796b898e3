#include "linear/rungs.hpp"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <tuple>

#include "linear/augmented.hpp"
#include "linear/spectrum.hpp"

namespace bramah {
namespace {

constexpr double unstable = 1e-9;

/// Other work on the machine does not count.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Median of several runs, fewer of long ones; of short ones each run is many.
template <class Work>
double median_seconds(double budget, Work&& work) {
  constexpr double readable = 2e-5;  // s, against the clock's own time
  constexpr std::size_t most = 101;
  std::vector<double> runs;
  long repeats = 1;
  for (double total = 0.0; runs.empty() || (total < budget && runs.size() < most);) {
    const double begin = cpu_seconds();
    for (long i = 0; i < repeats; ++i) work();
    const double run = cpu_seconds() - begin;
    total += run;
    if (run < readable) {
      repeats *= 2;
      runs.clear();
    } else {
      runs.push_back(run / static_cast<double>(repeats));
    }
  }
  const auto middle = runs.begin() + static_cast<std::ptrdiff_t>(runs.size() / 2);
  std::nth_element(runs.begin(), middle, runs.end());
  return *middle;
}

/// Memory of this process by Linux's own account, between two points of time.
class PeakMemory {
 public:
  PeakMemory() {
    malloc_trim(0);  // what is free but not given back would hide what is taken
    std::ofstream("/proc/self/clear_refs") << "5\n";
    before_ = entry("VmRSS:");
    works_ = std::abs(entry("VmHWM:") - before_) < 1.0;
  }
  /// MB above the start; NAN where the peak cannot be set back.
  [[nodiscard]] double megabytes() const { return works_ ? std::max(0.0, entry("VmHWM:") - before_) : NAN; }

 private:
  static double entry(std::string_view name) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with(name)) return std::strtod(line.c_str() + name.size(), nullptr) / 1024.0;
    }
    return NAN;
  }
  double before_ = NAN;
  bool works_ = false;
};

double evaluation_seconds(const System& system, const State& state, const Request& request, double budget) {
  Blocks blocks(system);
  return median_seconds(budget, [&] { blocks.evaluate(system, state, request); });
}

void measure_eigenvalues(const LinearModel& model, double budget, Contender& result) {
  result.cost.eigenvalues = median_seconds(budget, [&] { result.eigenvalues = plain_eigenvalues(model); });
}

void measure_exact(Rung rung, const System& system, const Partition& partition, const State& state,
                   const Measuring& how, Contender& result) {
  Linearizer linearizer(system, partition);
  LinearModel model;
  const double jacobian = median_seconds(how.budget, [&] {
    rung == Rung::reduced ? linearizer.linearize(state, model) : linearizer.linearize_augmented(state, model);
  });
  result.size = model.A.rows();
  result.cost.assembly = std::min(jacobian, evaluation_seconds(system, state, linearization_partials(), how.budget));
  result.cost.reduction = jacobian - result.cost.assembly;
  if (how.eigenvalues) measure_eigenvalues(model, how.budget, result);
}

void measure_differences(Rung rung, const System& system, const Partition& partition, const State& state,
                         const Measuring& how, Contender& result) {
  using Inverse = AugmentedByDifferences::Inverse;
  AugmentedByDifferences differences(system, partition, rung == Rung::differences ? Inverse::dense : Inverse::sparse);
  const Index states = differences.states();
  result.h = how.h;
  result.size = states;
  const auto velocities = static_cast<double>(system.n()), others = static_cast<double>(states) - velocities;
  result.cost.assembly = 2.0 * (others * evaluation_seconds(system, state, differences.request(), how.budget) +
                                velocities * evaluation_seconds(system, state, differences.rows(), how.budget));
  if (how.columns > 0 && how.columns < states) {
    differences.start(state);
    const double measured = median_seconds(how.budget, [&] {
      for (Index k = 0; k < how.columns; ++k) (void)differences.column(k * states / how.columns, how.h);
    });
    const double jacobian = measured * static_cast<double>(states) / static_cast<double>(how.columns);
    result.cost.assembly = std::min(jacobian, result.cost.assembly);
    result.cost.reduction = jacobian - result.cost.assembly;
    return;
  }
  Eigen::MatrixXd J;
  const double jacobian = median_seconds(how.budget, [&] { J = differences.jacobian(state, how.h); });
  result.cost.assembly = std::min(jacobian, result.cost.assembly);
  result.cost.reduction = jacobian - result.cost.assembly;
  if (how.eigenvalues)
    result.cost.eigenvalues = median_seconds(how.budget, [&] { result.eigenvalues = plain_eigenvalues(J); });
}

void measure_pencil(const System& system, const Partition& partition, const State& state, const Measuring& how,
                    Contender& result) {
  Descriptor descriptor(system, partition.rows);
  result.cost.assembly = median_seconds(how.budget, [&] { descriptor.evaluate(state); });
  result.cost.reduction = median_seconds(how.budget, [&] { AugmentedPencil(descriptor).factor(how.shift); });
  AugmentedPencil pencil(descriptor);
  pencil.factor(how.shift);
  result.size = pencil.size();
  if (how.eigenvalues) {
    result.cost.eigenvalues = median_seconds(
        how.budget, [&] { result.eigenvalues = pencil.finite(plain_eigenvalues(pencil.written_out())); });
  }
}

}  // namespace

std::string_view name_of(Rung rung) {
  constexpr std::string_view names[] = {"differences", "sparse_differences", "augmented", "pencil", "reduced"};
  return names[static_cast<std::size_t>(rung)];
}

Request linearization_rows() { return Request{}.rows("fgcrs"); }
Request linearization_partials() {
  return linearization_rows().blocks({BRAMAH_F_X, BRAMAH_F_V, BRAMAH_F_A, BRAMAH_F_Z, BRAMAH_F_U, BRAMAH_G_X,
                                      BRAMAH_G_V, BRAMAH_G_Z, BRAMAH_G_ZDOT, BRAMAH_G_U, BRAMAH_C_X, BRAMAH_R_X,
                                      BRAMAH_R_V, BRAMAH_S_X, BRAMAH_S_V, BRAMAH_L_X});
}

bool looks_unstable(const Eigenvalues& eigenvalues) {
  return std::any_of(eigenvalues.begin(), eigenvalues.end(), [](const auto& value) { return value.real() > unstable; });
}

double Contender::worst_error() const {
  if (!failure.empty()) return HUGE_VAL;
  return errors.empty() ? 0.0 : *std::max_element(errors.begin(), errors.end());
}

Contender measure(Rung rung, const System& system, const Partition& partition, const State& state,
                  const Measuring& how) {
  Contender result;
  result.rung = rung;
  const PeakMemory memory;
  switch (rung) {
    case Rung::reduced:
    case Rung::augmented: measure_exact(rung, system, partition, state, how, result); break;
    case Rung::differences:
    case Rung::sparse_differences: measure_differences(rung, system, partition, state, how, result); break;
    case Rung::pencil: measure_pencil(system, partition, state, how, result); break;
  }
  result.cost.peak_MB = memory.megabytes();
  return result;
}

void hold_against(const Eigenvalues& nonzero, std::size_t true_zeros, Contender& contender) {
  const std::size_t wanted = nonzero.size(), offered = contender.eigenvalues.size();
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < wanted; ++i) {
    for (std::size_t j = 0; j < offered; ++j)
      pairs.emplace_back(std::abs(contender.eigenvalues[j] - nonzero[i]) / std::abs(nonzero[i]), i, j);
  }
  std::sort(pairs.begin(), pairs.end());
  contender.errors.assign(wanted, NAN);
  std::vector<bool> claimed(offered, false);
  for (const auto& [error, i, j] : pairs) {
    if (claimed[j] || !std::isnan(contender.errors[i])) continue;
    contender.errors[i] = error;
    claimed[j] = true;
  }
  contender.largest_real_part = -HUGE_VAL;
  for (std::size_t j = 0; j < offered; ++j) {
    if (claimed[j]) continue;
    contender.unclaimed.push_back(contender.eigenvalues[j]);
    contender.largest_false_zero = std::max(contender.largest_false_zero, std::abs(contender.eigenvalues[j]));
    contender.largest_real_part = std::max(contender.largest_real_part, contender.eigenvalues[j].real());
  }
  contender.false_zeros = static_cast<long>(contender.unclaimed.size()) - static_cast<long>(true_zeros);
  contender.looks_unstable = looks_unstable(contender.eigenvalues);
}

}  // namespace bramah
