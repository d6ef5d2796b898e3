#include "solve/energy_book.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "system/analysis_error.hpp"

namespace bramah {
namespace {

// Work within a step that is rounding, as part of the energy of motion: where nothing brings in power, steps are not halved.
constexpr double trifle = 1e-14;

double total(const Vector& shares) { return std::accumulate(shares.begin(), shares.end(), 0.0); }
double total_magnitude(const Vector& shares) {
  return std::accumulate(shares.begin(), shares.end(), 0.0, [](double sum, double s) { return sum + std::abs(s); });
}

}  // namespace

double EnergyBalance::relative() const {
  // Steps keep positions to a tolerance, and so the energies that are stored there: below this part of them nothing is
  // resolved, however little moves.
  constexpr double rounding = 1e-12, resolved = 1e-7;
  const double turned_over = std::max({activity, brought_in + taken_out, resolved * size});
  return unaccounted > rounding * size ? unaccounted / turned_over : 0.0;
}

EnergyBook::EnergyBook(const System& system, std::span<const Index> rows)
    : system_(system),
      rows_(rows.begin(), rows.end()),
      energies_(system),
      blocks_(system),
      brought_in_(system.components.size()),
      taken_out_(system.components.size()) {}

void EnergyBook::take_rows(std::span<const Index> rows) {
  rows_.assign(rows.begin(), rows.end());
  kkt_.reset();
}

/// Whether a constraint would be violated by standing still: c_t or b(t, x, 0) is not zero.
bool EnergyBook::constraints_move(const State& state) {
  if (kkt_ != nullptr || rows_.empty()) return kkt_ != nullptr;
  now_ = state;
  std::fill(now_.v.begin(), now_.v.end(), 0.0);
  if (!blocks_.evaluate(system_, now_, Request{}.rows("r")).ok()) return false;
  if (std::all_of(blocks_.r.begin(), blocks_.r.end(), [](double rate) { return rate == 0.0; })) return false;
  kkt_ = std::make_unique<Kkt>(system_, rows_);
  return true;
}

bool EnergyBook::evaluate(const State& state) {
  if (!balance_.unknown.empty()) return false;
  const bool reactions = constraints_move(state);
  if (reactions) {
    now_ = state;
    try {
      kkt_->complete(now_, blocks_);
    } catch (const AnalysisError& error) {  // the run goes on, as its integrator can
      balance_.unknown = error.found();
      return false;
    }
  }
  const Outcome outcome = energies_.evaluate(reactions ? now_ : state, reactions);
  if (!outcome.ok()) {
    balance_.unknown = outcome.message;
  } else if (!energies_.unsaid().empty()) {
    const Component& mute = system_.components[static_cast<std::size_t>(energies_.unsaid().front())];
    balance_.unknown = mute.name + " (" + mute.type->name + ") does not say what it stores";
  }
  balance_.activity = std::max(balance_.activity, energies_.activity());
  balance_.size = std::max(balance_.size, total_magnitude(energies_.energy()));
  return balance_.unknown.empty();
}

void EnergyBook::begin(const State& state) {
  if (!evaluate(state)) return;
  time_ = state.t;
  after_ = energies_.power();
  if (begun_) return;
  begun_ = true;
  balance_.at_start = balance_.at_end = total(energies_.energy());
}

void EnergyBook::step(const State& end, const Interpolate& interpolate, State& middle) {
  const double before = time_, length = end.t - before;
  before_.swap(after_);
  if (!evaluate(end)) return;
  time_ = end.t;
  after_ = energies_.power();
  balance_.at_end = total(energies_.energy());

  if ((total_magnitude(before_) + total_magnitude(after_)) * length > trifle * balance_.activity) {
    interpolate(before + 0.5 * length, middle);
    if (!evaluate(middle)) return;
    for (std::size_t c = 0; c < after_.size(); ++c) {
      const double work = length / 6.0 * (before_[c] + 4.0 * energies_.power()[c] + after_[c]);
      work_ += work;
      (work > 0.0 ? brought_in_ : taken_out_)[c] += std::abs(work);
    }
  }
  balance_.unaccounted = std::max(balance_.unaccounted, std::abs(balance_.at_end - balance_.at_start - work_));
}

EnergyBalance EnergyBook::balance() const {
  EnergyBalance balance = balance_;
  const auto sum = [&](const Vector& shares, std::string& most) {
    const auto largest = std::max_element(shares.begin(), shares.end());
    if (largest != shares.end() && *largest > 0.0) most = system_.component_name(largest - shares.begin());
    return total(shares);
  };
  balance.brought_in = sum(brought_in_, balance.most_brought_in);
  balance.taken_out = sum(taken_out_, balance.most_taken_out);
  return balance;
}

}  // namespace bramah
