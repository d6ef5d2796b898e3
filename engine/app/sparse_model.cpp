#include "app/sparse_model.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "app/failure.hpp"
#include "app/results.hpp"
#include "io/matrix_files.hpp"
#include "io/output_file.hpp"
#include "linear/census.hpp"
#include "linear/eigenpairs.hpp"
#include "solve/start.hpp"

namespace bramah {
namespace {

Descriptor descriptor_of(const Context& context) {
  const System& system = context.system();
  const LinearizeOptions& options = context.options().linearize;
  State state =
      reference_state(system, context.options(), options.at == LinearizeOptions::At::equilibrium, context.start_time());
  state.side = options.side;
  Descriptor descriptor(system, choose_partition(system, state).rows);
  descriptor.evaluate(state);
  descriptor.require_constant();
  return descriptor;
}

std::string hertz(std::complex<double> s) {
  return s.imag() == 0.0 ? "" : short_number(std::abs(s.imag()) / (2.0 * std::numbers::pi), 5) + " Hz";
}

/// The variables that move most, in nominals: "link_3.x, link_2.x".
std::string largest_names(const Descriptor& descriptor, const Eigen::VectorXcd& vector) {
  const Eigen::VectorXd size =
      vector.cwiseAbs().cwiseQuotient(Eigen::Map<const Eigen::VectorXd>(descriptor.nominal().data(), vector.size()));
  std::string text;
  Eigen::VectorXd left = size;
  left.segment(descriptor.n(), descriptor.row_count()).setZero();
  for (int k = 0; k < 3; ++k) {
    Eigen::Index largest = 0;
    if (left.size() == 0 || left.maxCoeff(&largest) < 0.1 * size.maxCoeff()) break;
    text += (k == 0 ? "" : ", ") + descriptor.unknown_name(largest);
    left(largest) = 0.0;
  }
  return text;
}

std::vector<SparseEntry> entries(const std::vector<Entry>& list) {
  std::vector<SparseEntry> result;
  result.reserve(list.size());
  for (const Entry& e : list) result.push_back({e.row, e.column, e.value});
  return result;
}

Eigenpairs selected(const Descriptor& descriptor, const ModesOptions& options, Index zeros) {
  const Proof proof = options.prove ? Proof::wanted : Proof::skip;
  constexpr double turn = 2.0 * std::numbers::pi;
  switch (options.select) {
    case ModesOptions::Select::band: {
      const double middle = turn * 0.5 * (options.band_from + options.band_to);
      return find_inside(descriptor, {{0.0, middle}, turn * 0.5 * (options.band_to - options.band_from)}, zeros, proof);
    }
    case ModesOptions::Select::within: {
      Eigenpairs found = find_inside(descriptor, {0.0, options.within}, zeros, proof);
      std::stable_sort(found.pairs.begin(), found.pairs.end(), [](const Eigenpair& a, const Eigenpair& b) {
        return a.eigenvalue.real() > b.eigenvalue.real();
      });
      return found;
    }
    default: return find_nearest(descriptor, options.count, options.shift, zeros, proof);
  }
}

std::string document(const Descriptor& descriptor, const Eigenpairs& found, const ZeroPrediction& zeros) {
  JsonWriter json;
  json.begin_object();
  json.member("states", descriptor.states()).member("unknowns", descriptor.size());
  json.key("shift").values(std::vector<double>{found.shift.real(), found.shift.imag()});
  json.key("disk").begin_flat_object();
  json.key("centre").values(std::vector<double>{found.disk.centre.real(), found.disk.centre.imag()});
  json.member("radius", found.disk.radius).end_object();
  json.member("proven", found.proven).member("zeros", zeros.count()).key("zero_blocks").begin_list(true);
  for (const int size : zeros.block_sizes) json.value(size);
  json.end_list().key("eigenvalues").begin_list();
  for (const Eigenpair& pair : found.pairs) {
    const std::complex<double> s = pair.eigenvalue;
    json.begin_flat_object().member("re", s.real()).member("im", s.imag());
    json.member("damping_ratio", -s.real() / std::abs(s));
    json.member("frequency_hz", std::abs(s.imag()) / (2.0 * std::numbers::pi));
    json.member("residual", pair.residual).end_object();
  }
  json.end_list().member("solves", found.solves).member("factorizations", found.factorizations).end_object();
  return json.take();
}

/// Real and imaginary part of every mode by unknown.
std::string shapes_csv(const Descriptor& descriptor, const Eigenpairs& found) {
  Eigen::MatrixXd table(descriptor.size(), 2 * static_cast<Index>(found.pairs.size()));
  std::vector<std::string> rows, columns;
  for (Index i = 0; i < descriptor.size(); ++i) rows.push_back(descriptor.unknown_name(i));
  for (std::size_t k = 0; k < found.pairs.size(); ++k) {
    const auto column = static_cast<Index>(2 * k);
    table.col(column) = found.pairs[k].vector.real();
    table.col(column + 1) = found.pairs[k].vector.imag();
    columns.push_back("mode_" + std::to_string(k + 1) + ".re");
    columns.push_back("mode_" + std::to_string(k + 1) + ".im");
  }
  return csv_of({table.data(), static_cast<std::size_t>(table.rows()), static_cast<std::size_t>(table.cols())}, rows,
                columns);
}

}  // namespace

int run_selected_modes(const Context& context) {
  const Descriptor descriptor = descriptor_of(context);
  const ZeroPrediction zeros = predict_zeros(descriptor);
  const Eigenpairs found = selected(descriptor, context.options().modes, zeros.count());
  Table table{{"eigenvalue (1/s)", "damping", "frequency", "residual", "moves most"}, {}, "lrrrl"};
  for (const Eigenpair& pair : found.pairs) {
    table.rows.push_back({complex_text(pair.eigenvalue, 15),
                          short_number(-pair.eigenvalue.real() / std::abs(pair.eigenvalue), 4), hertz(pair.eigenvalue),
                          short_number(pair.residual, 2), largest_names(descriptor, pair.vector)});
  }
  std::string out = as_text(table) + '\n' + std::to_string(found.pairs.size()) + " of " +
                    std::to_string(descriptor.states()) + " eigenvalues, a conjugate pair counted once; " +
                    counted(static_cast<std::size_t>(zeros.count()), "zero") + " by ranks.\n";
  const std::string where =
      "|s - (" + complex_text(found.disk.centre, 6) + ")| < " + short_number(found.disk.radius, 6) + " 1/s";
  out += (found.proven ? "No other eigenvalue lies in " : "Not proven to be all in ") + where + ".\n";
  if (!context.arguments.out.empty()) {
    const std::filesystem::path folder(context.arguments.out);
    make_folder(folder);
    write_file(folder / "mode_shapes.csv", shapes_csv(descriptor, found));
  }
  deliver(context.arguments, "selected_modes.json", document(descriptor, found, zeros), out);
  return exit_ok;
}

int run_descriptor(const Context& context) {
  const Descriptor descriptor = descriptor_of(context);
  const FirstOrderForm form = first_order_form(descriptor);
  const auto size = static_cast<std::int64_t>(form.states.size());
  JsonWriter json;
  json.begin_object().member("form", "descriptor").key("states").values(form.states);
  const auto write = [&](const char* name, const std::vector<Entry>& list) {
    json.key(name).begin_list();
    for (const Entry& e : list) json.begin_list(true).value(e.row).value(e.column).value(e.value).end_list();
    json.end_list();
  };
  write("E", form.E);
  write("A", form.A);
  json.end_object();
  if (!context.arguments.out.empty()) {
    const std::filesystem::path folder(context.arguments.out);
    make_folder(folder);
    write_file(folder / "E.mtx", matrix_market(size, size, entries(form.E)));
    write_file(folder / "A.mtx", matrix_market(size, size, entries(form.A)));
  }
  Table table{{}, {}, "lr"};
  table.rows = {{"states (x, v, lambda, z)", std::to_string(size)},
                {"eigenvalues", std::to_string(descriptor.states())},
                {"nonzeros of E", std::to_string(form.E.size())},
                {"nonzeros of A", std::to_string(form.A.size())}};
  deliver(context.arguments, "descriptor.json", json.take(),
          "E dX/dt = A X, sparse and unreduced, all SI\n\n" + as_text(table) +
              "\n--out DIR writes E.mtx and A.mtx (Matrix Market), --json prints the entries.\n");
  return exit_ok;
}

}  // namespace bramah
