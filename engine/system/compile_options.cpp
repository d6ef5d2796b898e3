#include <algorithm>

#include "system/option_reader.hpp"

namespace bramah::compiling {
namespace {

void read_modes(const Value& root, OptionReader& reader, Faults& faults, ModesOptions& modes) {
  std::vector<std::string> selections;
  const auto selects = [&](const std::string& key, ModesOptions::Select select) {
    selections.push_back(key);
    modes.select = select;
  };
  reader.section(root, "modes", {"count", "shift", "band", "within", "prove"},
                 [&](const std::string& key, const Value& value, const std::string& where) {
                   if (key == "count") {
                     selects(key, ModesOptions::Select::nearest);
                     double count = 0.0;
                     reader.number(value, where, "1", 1.0, count, false);
                     modes.count = static_cast<Index>(std::min(count, 1e6));
                   } else if (key == "shift") {
                     reader.number(value, where, "1/s", 0.0, modes.shift, true);
                   } else if (key == "within") {
                     selects(key, ModesOptions::Select::within);
                     reader.number(value, where, "1/s", 0.0, modes.within, true);
                   } else if (key == "band") {
                     selects(key, ModesOptions::Select::band);
                     std::vector<double> ends;
                     reader.numbers(value, where, "Hz", ends);
                     if (ends.size() == 2 && ends[0] >= 0.0 && ends[1] > ends[0]) {
                       modes.band_from = ends[0];
                       modes.band_to = ends[1];
                     } else {
                       faults.add("out-of-range", where, "\"band\" is " + description(value),
                                  "two frequencies, the lower first", "write [\"1 Hz\", \"5 Hz\"]");
                     }
                   } else {
                     reader.flag(value, where, modes.prove);
                   }
                 });
  if (root.find("modes") != nullptr && selections.size() != 1) {
    faults.add("wrong-choice", "/modes",
               selections.empty() ? "\"modes\" without a selection"
                                  : "\"modes\" with several selections: " + quoted_list(selections),
               "one of: \"count\", \"band\", \"within\"",
               selections.empty() ? "add one, or remove \"modes\" to have all modes" : "keep one of them");
  }
  if (modes.shift > 0.0 && modes.select != ModesOptions::Select::nearest)
    faults.add("wrong-choice", "/modes/shift", "\"shift\" without \"count\"", "a shift for the nearest modes only",
               "remove it");
}

}  // namespace

void read_options(const Value& root, const System& system, Numbers& numbers, Faults& faults, Options& options) {
  OptionReader reader(system, numbers, faults);
  if (const Value* hold = root.find("hold")) {
    reader.variables(*hold, "/hold", options.equilibrium.hold_x, &options.equilibrium.hold_z);
  }
  reader.outputs(root, options.outputs);

  reader.section(root, "assembly", {"tolerance"},
                 [&](const std::string&, const Value& value, const std::string& where) {
                   reader.number(value, where, "m", 0.0, options.assembly.tolerance, true);
                 });

  EquilibriumOptions& equilibrium = options.equilibrium;
  reader.section(root, "equilibrium", {"tolerance", "max_iterations", "stability"},
                 [&](const std::string& key, const Value& value, const std::string& where) {
                   if (key == "tolerance") {
                     reader.number(value, where, "1", 0.0, equilibrium.tolerance, true);
                   } else if (key == "stability") {
                     using Stability = EquilibriumOptions::Stability;
                     reader.word<Stability>(value, where,
                                            {{"nearest", Stability::nearest}, {"stable", Stability::stable}},
                                            equilibrium.stability);
                   } else {
                     double count = equilibrium.max_iterations;
                     reader.number(value, where, "1", 1.0, count, false);
                     equilibrium.max_iterations = static_cast<int>(std::min(count, 1e6));
                   }
                 });

  SimulateOptions& simulate = options.simulate;
  simulate.asked = root.find("simulate") != nullptr;
  reader.section(root, "simulate",
                 {"from", "from_time", "to_time", "output_step", "output_times", "integrator", "rel_tol", "max_step",
                  "most_rows", "step", "rho_infinity", "switches", "events"},
                 [&](const std::string& key, const Value& value, const std::string& where) {
                   if (key == "from") {
                     reader.word<SimulateOptions::From>(
                         value, where,
                         {{"start", SimulateOptions::From::start}, {"equilibrium", SimulateOptions::From::equilibrium}},
                         simulate.from);
                   } else if (key == "from_time") {
                     reader.number(value, where, "s", -1e300, simulate.from_time, false);
                   } else if (key == "to_time") {
                     reader.number(value, where, "s", -1e300, simulate.to_time, false);
                   } else if (key == "output_step") {
                     reader.number(value, where, "s", 0.0, simulate.output_step, true);
                   } else if (key == "output_times") {
                     reader.numbers(value, where, "s", simulate.output_times);
                   } else if (key == "integrator") {
                     using Integrator = SimulateOptions::Integrator;
                     reader.word<Integrator>(value, where,
                                             {{"auto", Integrator::automatic},
                                              {"ida", Integrator::ida},
                                              {"explicit", Integrator::explicit_one_step},
                                              {"implicit", Integrator::implicit_one_step},
                                              {"generalized_alpha", Integrator::generalized_alpha}},
                                             simulate.integrator);
                   } else if (key == "rel_tol") {
                     reader.number(value, where, "1", 0.0, simulate.rel_tol, true);
                   } else if (key == "max_step") {
                     reader.number(value, where, "s", 0.0, simulate.max_step, true);
                   } else if (key == "most_rows") {
                     reader.number(value, where, "1", 0.0, simulate.most_rows, true);
                   } else if (key == "step") {
                     reader.number(value, where, "s", 0.0, simulate.step, true);
                   } else if (key == "switches") {
                     reader.word<bool>(value, where, {{"meet", true}, {"pass", false}}, simulate.meet_switches);
                   } else if (key == "events") {
                     reader.events(value, where, simulate.events);
                   } else {
                     reader.number(value, where, "1", 0.0, simulate.rho_infinity, false);
                   }
                 });
  if (simulate.asked && !(simulate.to_time > simulate.from_time)) {
    faults.add("out-of-range", "/simulate/to_time",
               "the simulation ends at to_time = " + with_unit(simulate.to_time, "s"),
               "a time after from_time = " + with_unit(simulate.from_time, "s"), "set \"to_time\"");
  }
  const bool fixed = simulate.integrator == SimulateOptions::Integrator::generalized_alpha;
  if (fixed != (simulate.step > 0.0)) {
    faults.add("conflict", "/simulate",
               fixed ? "generalized_alpha without \"step\"" : "\"step\" without generalized_alpha",
               "a fixed \"step\" with \"integrator\": \"generalized_alpha\", and with no other",
               fixed ? "give \"step\", for example \"1 ms\"" : "limit the steps of other integrators by \"max_step\"");
  }
  if (simulate.rho_infinity > 1.0) {
    faults.add("out-of-range", "/simulate/rho_infinity", "rho_infinity = " + with_unit(simulate.rho_infinity, "1"),
               "0 ... 1: the part of the fastest motions that a step keeps", "0.8 is a good start");
  }
  if (!std::is_sorted(simulate.output_times.begin(), simulate.output_times.end())) {
    faults.add("out-of-range", "/simulate/output_times", "\"output_times\" go back", "ascending times", "sort them");
  }

  LinearizeOptions& linearize = options.linearize;
  linearize.asked = root.find("linearize") != nullptr;
  reader.section(root, "linearize", {"at", "form", "independent", "admissible_dependent", "side", "times"},
                 [&](const std::string& key, const Value& value, const std::string& where) {
                   if (key == "at") {
                     reader.word<LinearizeOptions::At>(
                         value, where,
                         {{"equilibrium", LinearizeOptions::At::equilibrium}, {"start", LinearizeOptions::At::start}},
                         linearize.at);
                   } else if (key == "form") {
                     reader.word<LinearizeOptions::Form>(value, where,
                                                         {{"reduced", LinearizeOptions::Form::reduced},
                                                          {"descriptor", LinearizeOptions::Form::descriptor}},
                                                         linearize.form);
                   } else if (key == "independent") {
                     reader.variables(value, where, linearize.prescribed.independent, nullptr);
                   } else if (key == "admissible_dependent") {
                     reader.variables(value, where, linearize.prescribed.admissible_dependent, nullptr);
                   } else if (key == "times") {
                     reader.numbers(value, where, "s", linearize.times);
                   } else {
                     reader.word<int>(value, where, {{"+", 1}, {"-", -1}}, linearize.side);
                   }
                 });
  for (const Index i : linearize.prescribed.admissible_dependent) {
    const std::vector<Index>& independent = linearize.prescribed.independent;
    if (std::find(independent.begin(), independent.end(), i) == independent.end()) continue;
    faults.add("repeated", "/linearize/admissible_dependent",
               "\"" + system.x[static_cast<std::size_t>(i)].name + "\" is prescribed as independent too",
               "each coordinate in one of the two lists", "remove it from one");
  }
  const auto outside = [&](double t) { return t < simulate.from_time || t > simulate.to_time; };
  if (!std::is_sorted(linearize.times.begin(), linearize.times.end()) ||
      std::any_of(linearize.times.begin(), linearize.times.end(), outside)) {
    faults.add("out-of-range", "/linearize/times", "\"times\" that go back or leave the simulation",
               "ascending times between from_time and to_time of \"simulate\"", "sort them, or simulate longer");
  }

  read_modes(root, reader, faults, options.modes);

  reader.section(root, "compare", {"steps"}, [&](const std::string&, const Value& value, const std::string& where) {
    reader.numbers(value, where, "1", options.compare.steps);
    if (std::any_of(options.compare.steps.begin(), options.compare.steps.end(), [](double h) { return !(h > 0.0); })) {
      faults.add("out-of-range", where, "\"steps\" are not all above 0", "step sizes h > 0 of Eq. (100)",
                 "remove or correct them");
    }
  });
  reader.section(root, "study", {"linear_from"}, [&](const std::string&, const Value& value, const std::string& where) {
    reader.number(value, where, "s", 0.0, options.study.linear_from, false);
  });
  if (const Value* sweep = root.find("sweep"); sweep != nullptr && sweep->object() != nullptr) {
    reader.swept(root, *sweep, "/sweep", options.sweep.over);
    if (const Value* second = sweep->find("second"); second != nullptr && second->object() != nullptr) {
      reader.swept(root, *second, "/sweep/second", options.sweep.over);
      constexpr double most_points = 1e6;
      const double points = grid_size(options.sweep.over);
      if (points > most_points)
        faults.add("out-of-range", "/sweep", "the sweep asks for " + number_text(points) + " points",
                   "at most " + number_text(most_points), "take fewer values", true);
    } else if (second != nullptr) {
      faults.add("wrong-kind", "/sweep/second", "\"second\" is " + description(*second), "an object",
                 "write it as the sweep itself: { \"parameter\": ... }");
    }
  }
  reader.vary(root, options.outputs, options.vary);
  if (const Value* title = root.find("title"); title != nullptr && title->text() != nullptr)
    options.study.title = *title->text();
  if (const Value* text = root.find("description"); text != nullptr && text->text() != nullptr)
    options.study.description = *text->text();
}

}  // namespace bramah::compiling
