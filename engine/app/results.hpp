// Results as JSON documents, for scripts, and as tables, for people.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "app/context.hpp"
#include "io/json_writer.hpp"
#include "io/tables.hpp"
#include "linear/census.hpp"
#include "linear/spectrum.hpp"
#include "solve/start.hpp"

namespace bramah {

/// Counts of variables and rows, in the paper's letters.
struct Sizes {
  Index n = 0, m = 0, l = 0, r = 0, u = 0, redundant = 0;
  [[nodiscard]] Index augmented() const { return 2 * n + r + u; }
  [[nodiscard]] Index reduced() const { return 2 * n - 2 * m - l + r + u + redundant_states; }
  Index redundant_states = 0;  // states that redundant rows do not remove: 2 a holonomic one, 1 a nonholonomic one
};
Sizes sizes_of(const System& system, const Partition* partition);
void write_sizes(JsonWriter& json, const Sizes& sizes);
Table sizes_table(const Sizes& sizes);

std::string equilibrium_document(const System& system, const Equilibrium& equilibrium, const Stability& stability,
                                 const std::vector<StartNote>& notes);
/// Variables, or multipliers, with value and unit.
Table variables_table(const System& system, const State& state);
Table multipliers_table(const System& system, const State& state);
std::string free_directions_text(const std::vector<FreeDirection>& directions);

std::string linear_document(const System& system, const Linearization& linear);
/// What is redundant, in terms of joints; empty where nothing is.
std::string redundancy_text(const std::vector<RedundantSet>& sets, const System& system);
/// What start_notes has to say, told on standard error unless --quiet.
std::vector<StartNote> tell_start_notes(const Context& context, bool equilibrium);
/// The same as "notes".
void write_notes(JsonWriter& json, const std::vector<StartNote>& notes);
/// The same as "redundant_sets".
void write_redundancy(JsonWriter& json, const std::vector<RedundantSet>& sets, const System& system);
/// "condition": of C_xd and D_dd.
void write_conditions(JsonWriter& json, const Conditions& conditions);
/// Notes on redundant rows and one-sided derivatives; empty where there are none.
std::string linear_notes(const System& system, const Linearization& linear);

/// A spectrum with the count of zeros that the unreduced coefficients foretell, where these are constant.
struct Census {
  Spectrum spectrum;
  std::optional<ZeroPrediction> predicted;
  std::string unpredicted;  // why not
};
Census census_of(const System& system, const Linearization& linear);

/// The verdict on stability, how zeros were counted, conserved sums, and eigenvalues that rounding alone could explain.
std::string spectrum_notes(const Census& census);
std::string spectrum_document(const System& system, const Linearization& linear, const Census& census);
/// Members of an open object: every nonzero mode in all variables, and its energies by component.
void write_modal_details(JsonWriter& json, const System& system, const Linearization& linear, const Spectrum& spectrum);
/// Where the energy of each nonzero mode is: the components with the largest shares. Empty where no mode has any.
std::string energy_text(const System& system, const Linearization& linear, const Spectrum& spectrum);
Table spectrum_table(const LinearModel& model, const Spectrum& spectrum);

/// "V2.p 52 %, crank.angle.rate 41 %": the largest three participations, without trifles.
std::string involved_states(const LinearModel& model, const Eigen::VectorXd& shares);

void write_matrix(JsonWriter& json, std::string_view name, const Eigen::MatrixXd& matrix);
void write_eigenvalues(JsonWriter& json, std::string_view name, const std::vector<std::complex<double>>& eigenvalues);
std::string complex_text(std::complex<double> value, int digits);
/// "1 hinge row", "3 hinge rows".
std::string counted(std::size_t count, const std::string& noun);

}  // namespace bramah
