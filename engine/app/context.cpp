#include "app/context.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "app/equilibrium_report.hpp"
#include "app/failure.hpp"
#include "app/hand_written.hpp"
#include "app/results.hpp"
#include "io/output_file.hpp"
#include "io/read_scene.hpp"
#include "system/analysis_error.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

/// A dense model of gigabytes helps nobody.
void refuse_too_large(const System& system, const Partition& partition) {
  constexpr Index most = 200'000'000;  // numbers in the largest dense matrix, 1.6 GB
  const Index states = static_cast<Index>(2 * partition.ai.size() + partition.ad.size()) + system.nz();
  if (states * (2 * system.n() + system.nz()) <= most) return;
  throw AnalysisError("linearize", std::to_string(states) + " states, too many for a dense Jacobian",
                      "a system of some thousand states, or a selection of its modes",
                      "select modes, --set modes.count=20, or take the sparse form, --set linearize.form=descriptor");
}

[[noreturn]] void fail_to_print() {
  throw WriteError("standard output", std::string("cannot be written: ") + std::strerror(errno),
                   "make room, or send the output elsewhere");
}

/// One line each.
void tell_warnings(const Failure& warnings) {
  constexpr std::size_t most = 20;
  const std::vector<Failure::Entry>& entries = warnings.entries();
  for (std::size_t k = 0; k < std::min(most, entries.size()); ++k) {
    const Failure::Entry& one = entries[k];
    const std::string place = one.line == 0 ? "" : ":" + std::to_string(one.line) + ":" + std::to_string(one.column);
    say(one.file + place + ": " + one_line(one.diagnostic) + '\n');
  }
  if (entries.size() > most) say("... " + std::to_string(entries.size()) + " warnings in all\n");
}

}  // namespace

void refuse_singular(const System& system, const State& state) {
  const auto note = singular_note(system, state);
  if (!note || note->kind != "singular position") return;
  throw AnalysisError("linearize", "at t = " + digits(state.t) + " s " + note->found,
                      "a position with one linear model", note->remedy, "/components");
}

Context load(const Arguments& arguments) {
  Source source{arguments.subject, ""};
  try {
    source = read_source(arguments.subject);
    std::vector<Diagnostic> of_shape;
    Scene scene = read_scene_text(source.text, source.name, &of_shape);
    for (const std::string& setting : arguments.settings) apply_setting(scene, setting);
    apply_sweep(scene, arguments.over);
    if (!arguments.outputs.empty())
      scene.root.set("outputs", Value::List(arguments.outputs.begin(), arguments.outputs.end()));
    Compiled compiled = compile(scene, std::make_shared<Registry>(), std::move(of_shape));
    for (Diagnostic& warning : examine_hand_written(compiled)) compiled.warnings.push_back(std::move(warning));
    if (arguments.strict && !compiled.warnings.empty()) throw SceneError(compiled.warnings);
    if (!arguments.quiet && !compiled.warnings.empty())
      tell_warnings(Failure::scene(source, SceneError(compiled.warnings), arguments.settings));
    return {arguments, std::move(scene), std::move(compiled)};
  } catch (const SceneError& error) {
    throw Failure::scene(source, error, arguments.settings);
  }
}

Linearization linearize(const Compiled& compiled, const Prescribed& prescribed, std::vector<Measured> outputs,
                        const State* guess) {
  const System& system = compiled.system;
  const Options& options = compiled.options;
  const double start_time = options.simulate.from_time;
  Linearization result;
  result.at_equilibrium = options.linearize.at == LinearizeOptions::At::equilibrium;
  if (result.at_equilibrium) {
    result.equilibrium = guess != nullptr ? continue_equilibrium(system, options.equilibrium, *guess)
                                          : find_equilibrium(system, options.equilibrium, start_time);
    result.state = result.equilibrium->state;
  } else {
    result.state = consistent_start(system, options, start_time);
  }
  result.state.side = options.linearize.side;
  result.partition = choose_partition(system, result.state, prescribed);
  if (!result.partition.redundant.empty()) refuse_singular(system, result.state);
  refuse_too_large(system, result.partition);
  Linearizer linearizer(system, result.partition, std::move(outputs));
  linearizer.linearize(result.state, result.model);
  linearizer.estimate_rounding(result.model);
  result.conditions = linearizer.conditions();
  result.motion = linearizer.motion();
  result.response = linearizer.response();
  return result;
}

namespace {

std::vector<StartNote> tell_start(const Context& context) {
  return tell_start_notes(context, context.options().linearize.at == LinearizeOptions::At::equilibrium);
}

}  // namespace

Linearization linearize(const Context& context) {
  std::vector<StartNote> notes = tell_start(context);
  Linearization linear = linearize(context.compiled, context.options().linearize.prescribed);
  linear.notes = std::move(notes);
  if (linear.equilibrium) tell_equilibrium(context, *linear.equilibrium);
  return linear;
}

Linearization linearize_outputs(const Context& context) {
  std::vector<StartNote> notes = tell_start(context);
  Linearization linear = linearize(context.compiled, context.options().linearize.prescribed, context.options().outputs);
  linear.notes = std::move(notes);
  if (linear.equilibrium) tell_equilibrium(context, *linear.equilibrium);
  judge(context, linear);
  return linear;
}

void print(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) fail_to_print();
}

void finish_printing() {
  if (std::fflush(stdout) != 0) fail_to_print();
}

void say(std::string_view text) { std::fwrite(text.data(), 1, text.size(), stderr); }

void deliver(const Arguments& arguments, std::string_view file, const std::string& document, const std::string& text) {
  if (!arguments.out.empty()) {
    const std::filesystem::path folder(arguments.out);
    make_folder(folder);
    write_file(folder / file, document);
    if (!arguments.quiet) say("wrote " + (folder / file).string() + "\n");
  }
  print(arguments.json ? document : text);
}

}  // namespace bramah
