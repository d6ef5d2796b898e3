// The command line: parsed here and nowhere else, then one verb is run. Failures end here.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <string>

#include "app/context.hpp"
#include "app/crash.hpp"
#include "app/failure.hpp"
#include "app/verbs.hpp"
#include "io/read_scene.hpp"
#include "io/tables.hpp"

namespace bramah {
namespace {

constexpr const char* kOptions =
    "Options of every verb\n"
    "  --set COMPONENT.PARAMETER=VALUE  change the scene for this run, also SECTION.KEY=VALUE; may be repeated.\n"
    "                                   VALUE as in the scene: 3.5e6, \"3.5 MPa\", true\n"
    "  --out DIR                        write the results there; files appear when they are complete\n"
    "  --strict                         warnings about the scene are errors\n"
    "  --quiet                          no progress bar, no word about files that are written\n"
    "  --json                           one JSON document on standard output, everything else on standard error\n";

std::string main_help() {
  Table verbs;
  for (const Verb* verb : all_verbs())
    verbs.rows.push_back({std::string(verb->name) + " " + verb->argument, verb->brief});
  verbs.rows.push_back({"help VERB", "what a verb does, an example, what it prints"});
  return "bramah: machines of bodies, joints, oil and friction, assembled from a JSON scene\n\n"
         "  bramah VERB SCENE [--set COMPONENT.PARAMETER=VALUE]... [--out DIR] [--json]\n\nVerbs\n" +
         as_text(verbs) + '\n' + kOptions +
         "  --help, --version\n\n"
         "Begin with\n"
         "  bramah check scenes/four_bar/overdamped.json\n"
         "  bramah study scenes/four_bar/overdamped.json --out results\n\n"
         "Exit codes\n"
         "  0    done\n"
         "  1    the analysis has no answer: no equilibrium, an integrator that gives up, ...\n"
         "  2    the scene is wrong; every fault is told\n"
         "  3    the command line is wrong\n"
         "  4    results cannot be written\n"
         "  130  interrupted by Ctrl-C; results so far are kept\n\n"
         "Libraries of components are looked for in the folders of BRAMAH_PLUGIN_PATH (separated by colons), then beside the\n"
         "program.\n";
}

std::string verb_help(const Verb& verb) {
  std::string argument = verb.argument;
  if (!argument.empty()) argument = " " + argument;
  return "bramah " + std::string(verb.name) + argument + ": " + verb.brief + "\n\n" + verb.help + '\n' + kOptions;
}

const Verb* find_verb(const std::string& name) {
  for (const Verb* verb : all_verbs()) {
    if (name == verb->name) return verb;
  }
  return nullptr;
}

[[noreturn]] void refuse_verb(const std::string& word) {
  std::vector<std::string> names;
  for (const Verb* verb : all_verbs()) names.emplace_back(verb->name);
  std::string remedy = suggestion(word, names, "`bramah --help` explains them");
  if (word.ends_with(".json")) remedy = "put a verb before the scene: bramah study " + word;
  throw Failure::usage("no verb \"" + word + "\"", "one of: " + quoted_list(names), remedy);
}

[[noreturn]] void refuse_rest(const Verb& verb, const std::vector<std::string>& rest) {
  const std::string& word = rest.front();
  const std::string help = "`bramah help " + std::string(verb.name) + "` explains the verb";
  if (!word.starts_with('-')) {
    throw Failure::usage("\"" + word + "\" is one word too many",
                         "bramah " + std::string(verb.name) + " " + verb.argument + " [options]",
                         word.find('=') != std::string::npos
                             ? "write --set before it; put quotation marks around values with blanks"
                             : help);
  }
  std::vector<std::string> known = {"--set", "--out", "--quiet", "--strict", "--json", "--help"};
  known.insert(known.begin(), verb.options.begin(), verb.options.end());
  std::string list;
  for (const std::string& option : known) list += (list.empty() ? "" : ", ") + option;
  throw Failure::usage("no option \"" + word + "\"", "one of: " + list, suggestion(word, known, help));
}

int run_verb(const Verb& verb, int argc, char** argv) {
  Arguments arguments;
  CLI::App app;
  app.set_help_flag("--help,-h");
  app.allow_extras();
  if (*verb.argument != '\0') app.add_option("subject", arguments.subject);
  app.add_option("--set", arguments.settings)->allow_extra_args(false);
  app.add_option("--out", arguments.out);
  app.add_flag("--quiet", arguments.quiet);
  app.add_flag("--strict", arguments.strict);
  app.add_flag("--json", arguments.json);
  const auto offers = [&](const char* option) {
    return std::any_of(verb.options.begin(), verb.options.end(),
                       [&](const char* own) { return own == std::string(option); });
  };
  if (offers("--over")) app.add_option("--over", arguments.over)->allow_extra_args(false);
  if (offers("--by")) app.add_option("--by", arguments.by)->allow_extra_args(false);
  if (offers("--threads")) app.add_option("--threads", arguments.threads)->check(CLI::Range(1, 1024));
  if (offers("--input")) app.add_option("--input", arguments.inputs)->allow_extra_args(false);
  if (offers("--output")) app.add_option("--output", arguments.outputs)->allow_extra_args(false);
  if (offers("--step")) app.add_option("--step", arguments.step);
  if (offers("--resume")) app.add_option("--resume", arguments.resume);
  if (offers("--save-every")) app.add_option("--save-every", arguments.save_every)->check(CLI::PositiveNumber);
  if (offers("--binary")) app.add_flag("--binary", arguments.binary);
  if (offers("--impulse")) app.add_option("--impulse", arguments.impulse);
  try {
    app.parse(argc - 1, argv + 1);
  } catch (const CLI::CallForHelp&) {
    print(verb_help(verb));
    return exit_ok;
  } catch (const CLI::ParseError& error) {
    throw Failure::usage(error.what(), "bramah " + std::string(verb.name) + " " + verb.argument + " [options]",
                         "`bramah help " + std::string(verb.name) + "` explains the verb");
  }
  if (!app.remaining().empty()) refuse_rest(verb, app.remaining());
  if (std::strcmp(verb.argument, "SCENE") == 0 && arguments.subject.empty()) {
    throw Failure::usage("`" + std::string(verb.name) + "` without a scene",
                         "bramah " + std::string(verb.name) + " SCENE", "name a scene file");
  }
  return verb.run(arguments);
}

int run(int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  if (first == "--version") {
    print("bramah " BRAMAH_VERSION "\n");
    return exit_ok;
  }
  if (first == "--help" || first == "-h" || (first == "help" && argc == 2)) {
    print(main_help());
    return exit_ok;
  }
  if (first.empty()) {
    say(main_help());
    return exit_usage;
  }
  if (first == "help") {
    const Verb* verb = find_verb(argv[2]);
    if (verb == nullptr) refuse_verb(argv[2]);
    print(verb_help(*verb));
    return exit_ok;
  }
  const Verb* verb = find_verb(first);
  if (verb == nullptr) refuse_verb(first);
  return run_verb(*verb, argc, argv);
}

int report(const Failure& failure, bool json) {
  say(failure.text());
  if (json) {
    // A failure to print cannot be printed.
    const std::string document = failure.document();
    std::fwrite(document.data(), 1, document.size(), stdout);
    std::fflush(stdout);
  }
  return failure.code();
}

int guarded_run(int argc, char** argv) {
  bool json = false;
  std::string scene;
  for (int i = 1; i < argc; ++i) json = json || std::strcmp(argv[i], "--json") == 0;
  for (int i = argc - 1; i > 1; --i) {
    const std::string before = argv[i - 1];
    const bool is_value = before.starts_with("--") && before != "--json" && before != "--quiet" && before != "--strict";
    if (argv[i][0] != '-' && !is_value) scene = argv[i];
  }
  try {
    const int code = run(argc, argv);
    finish_printing();
    return code;
  } catch (const Failure& failure) {
    return report(failure, json);
  } catch (const AnalysisError& error) {
    Source source{scene, ""};
    try {
      source = read_source(scene);
    } catch (const SceneError&) {  // gone since it was read: the message then has no place
    }
    return report(Failure::analysis(source, error), json);
  } catch (const WriteError& error) {
    return report(Failure::write(error), json);
  } catch (const std::bad_alloc&) {
    return report(Failure::unexpected("not enough memory"), json);
  } catch (const std::exception& error) {
    return report(Failure::unexpected(error.what()), json);
  }
}

}  // namespace
}  // namespace bramah

int main(int argc, char** argv) {
  bramah::tell_of_crashes();
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes is a failure to write, with a message
  return bramah::guarded_run(argc, argv);
}
