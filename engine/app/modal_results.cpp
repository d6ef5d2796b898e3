// Modes in all variables, and their energies by component.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "app/results.hpp"
#include "linear/modes.hpp"

namespace bramah {
namespace {

using Part = double ModalEnergy::*;
struct Column {
  const char* name;
  Part part;
};
constexpr Column columns[] = {{"kinetic", &ModalEnergy::kinetic},
                              {"potential", &ModalEnergy::potential},
                              {"pressure", &ModalEnergy::pressure},
                              {"dissipated", &ModalEnergy::dissipated}};

/// Of all components: the sum of magnitudes, since springs may give and take in one mode.
double magnitude(const ModalEnergies& energies, Part part) {
  return std::accumulate(energies.components.begin(), energies.components.end(), 0.0,
                         [&](double sum, const ModalEnergy& energy) { return sum + std::abs(energy.*part); });
}

/// What is rounding beside the mode's other energies; a power counts by what it does in one radian.
double trifle(const ModalEnergies& energies, double rate) {
  constexpr double negligible = 1e-9;
  double sum = magnitude(energies, &ModalEnergy::dissipated) / rate;
  for (const Part part : {&ModalEnergy::kinetic, &ModalEnergy::potential, &ModalEnergy::pressure})
    sum += magnitude(energies, part);
  return negligible * sum;
}

double share(const ModalEnergies& energies, std::size_t component, Part part) {
  const double sum = magnitude(energies, part);
  return sum > 0.0 ? energies.components[component].*part / sum : 0.0;
}

/// "boom 78 %, load 20 %": the largest two, without trifles.
std::string leaders(const System& system, const ModalEnergies& energies, Part part) {
  std::vector<std::size_t> order(energies.components.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(energies.components[a].*part) > std::abs(energies.components[b].*part);
  });
  std::string text;
  for (std::size_t k = 0; k < std::min<std::size_t>(2, order.size()); ++k) {
    const double percent = std::round(100.0 * share(energies, order[k], part));
    if (std::abs(percent) < 5.0) break;
    text += (k == 0 ? "" : ", ") + system.components[order[k]].name + " " + short_number(percent, 3) + " %";
  }
  return text;
}

std::vector<ModalEnergies> energies_of(const System& system, const Linearization& linear, const Spectrum& spectrum) {
  return modal_energies(system, linear.state, spectrum, mode_shapes(spectrum, linear.motion, linear.response));
}

}  // namespace

void write_modal_details(JsonWriter& json, const System& system, const Linearization& linear,
                         const Spectrum& spectrum) {
  const ModeShapes shapes = mode_shapes(spectrum, linear.motion, linear.response);
  const auto n = static_cast<Eigen::Index>(system.x.size());
  const auto write = [&](const std::string& name, std::complex<double> value) {
    json.key(name).values(std::vector<double>{value.real(), value.imag()});
  };
  json.key("full_shapes").begin_list();
  for (Eigen::Index k = 0; k < shapes.motion.cols(); ++k) {
    json.begin_object().key("variables").begin_object();
    Eigen::Index row = 0;
    for (const Variable& variable : system.x) write(variable.name, shapes.motion(row++, k));
    for (const Variable& variable : system.x) write(variable.name + ".rate", shapes.motion(row++, k));
    for (const Variable& variable : system.z) write(variable.name, shapes.motion(row++, k));
    json.end_object().key("multipliers").begin_object();
    row = n;
    for (const auto constraint : linear.partition.rows)
      write(system.multiplier_name(constraint), shapes.response(row++, k));
    json.end_object().end_object();
  }
  json.end_list().key("energies").begin_list();
  for (const ModalEnergies& mode : energies_of(system, linear, spectrum)) {
    json.begin_object();
    for (const Column& column : columns) json.member(column.name, mode.total.*column.part);
    json.key("components").begin_object();
    for (std::size_t k = 0; k < mode.components.size(); ++k) {
      const bool takes_part = std::any_of(std::begin(columns), std::end(columns),
                                          [&](const Column& column) { return mode.components[k].*column.part != 0.0; });
      if (!takes_part) continue;
      json.key(system.components[k].name).begin_flat_object();
      for (const Column& column : columns) json.member(column.name, share(mode, k, column.part));
      json.end_object();
    }
    json.end_object().end_object();
  }
  json.end_list();
}

std::string energy_text(const System& system, const Linearization& linear, const Spectrum& spectrum) {
  Table table{{"energy of", "kinetic", "potential", "pressure", "dissipated by"}, {}, ""};
  const std::vector<ModalEnergies> energies = energies_of(system, linear, spectrum);
  for (std::size_t k = 0; k < energies.size(); ++k) {
    const std::complex<double> value = spectrum.modes[k].eigenvalue;
    if (value.imag() < 0.0 || spectrum.modes[k].doubtful) continue;
    std::vector<std::string> row = {complex_text(value, 6)};
    const double rate = std::abs(value), least = trifle(energies[k], rate);
    for (const Column& column : columns) {
      const double size = magnitude(energies[k], column.part) / (column.part == &ModalEnergy::dissipated ? rate : 1.0);
      row.push_back(size > least ? leaders(system, energies[k], column.part) : "");
    }
    table.rows.push_back(std::move(row));
  }
  return table.rows.empty() ? "" : as_text(table);
}

}  // namespace bramah
