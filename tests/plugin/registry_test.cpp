#include "plugin/registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace bramah {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const fs::path first = fs::path(BRAMAH_TEST_LIBRARIES) / "first";
const fs::path second = fs::path(BRAMAH_TEST_LIBRARIES) / "second";
const std::vector<fs::path> nowhere;

/// An environment variable for the length of a test; null: not set.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    set(value);
  }
  ~Environment() { set(before_ ? before_->c_str() : nullptr); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  void set(const char* value) { value == nullptr ? unsetenv(name_) : setenv(name_, value, 1); }
  const char* name_;
  std::optional<std::string> before_;
};

bool has_avx2() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
#else
  return false;
#endif
}

template <class Action>
std::optional<PluginError> refusal(Action&& action) {
  try {
    action();
  } catch (const PluginError& error) {
    EXPECT_FALSE(error.found().empty());
    EXPECT_FALSE(error.expected().empty()) << error.found();
    EXPECT_FALSE(error.remedy().empty()) << error.found();
    return error;
  }
  return std::nullopt;
}

// ---- where libraries are found ----

TEST(SearchPath, IsTheVariableAndThenTheInstallation) {
  const Environment path("BRAMAH_PLUGIN_PATH", "/one::relative:/two:");
  const std::vector<fs::path> found = Registry::default_search_path();
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0], "/one");
  EXPECT_EQ(found[1], "relative");
  EXPECT_EQ(found[2], "/two");
  const fs::path program = fs::read_symlink("/proc/self/exe");
  EXPECT_EQ(found[3], program.parent_path().parent_path() / "lib" / "bramah" / "plugins");
}

TEST(SearchPath, IsTheInstallationAloneWithoutTheVariable) {
  for (const char* value : {static_cast<const char*>(nullptr), "", "::"}) {
    const Environment path("BRAMAH_PLUGIN_PATH", value);
    EXPECT_EQ(Registry::default_search_path().size(), 1U);
  }
}

TEST(SearchPath, OfTheVariableLoads) {
  const Environment path("BRAMAH_PLUGIN_PATH", first.c_str());
  Registry registry;
  registry.load("alone");
  EXPECT_EQ(registry.libraries().at("alone").file, fs::canonical(first / "alone.so"));
}

TEST(SearchPath, ServesFromEveryFolder) {
  Registry registry({first, second});
  registry.load("alone");
  registry.load("other");
  EXPECT_THAT(registry.type_names(), ElementsAre("alone/thing", "other/thing"));
  ASSERT_NE(registry.find("other/thing"), nullptr);
  EXPECT_EQ(registry.find("other/nothing"), nullptr);
  EXPECT_EQ(registry.library_of(*registry.find("other/thing")).file.parent_path(), fs::canonical(second));
}

TEST(SearchPath, OffersNamesOnceAndWithoutTwins) {
  EXPECT_THAT(Registry({first, second}).available(),
              ElementsAre("alone", "half", "other", "shared", "stale", "stamped", "twin"));
  EXPECT_TRUE(Registry({first / "nowhere"}).available().empty());
}

TEST(SearchPath, IsNamedInItsOrderWhereNothingIsFound) {
  const auto error = refusal([] { Registry({second, first}).load("absent"); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), "library-missing");
  EXPECT_EQ(error->expected(),
            "a file absent.so in one of: " + fs::canonical(second).string() + ", " + fs::canonical(first).string());
  EXPECT_THAT(error->remedy(), HasSubstr("alone, half, other, shared, stale, stamped, twin"));
  EXPECT_EQ(refusal([] { Registry({first}).load("aloen"); })->remedy(), "did you mean \"alone\"?");
  EXPECT_EQ(refusal([] { Registry({first}).load("allone"); })->remedy(), "did you mean \"alone\"?");
  EXPECT_THAT(refusal([] { Registry(nowhere).load("alone"); })->remedy(), HasSubstr("BRAMAH_PLUGIN_PATH"));
}

TEST(SearchPath, RefusesOneLibraryInTwoFolders) {
  const auto error = refusal([] { Registry({first, second}).load("shared"); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), "library-twice");
  EXPECT_THAT(error->found(), HasSubstr((first / "shared.so").lexically_normal().string()));
  EXPECT_THAT(error->found(), HasSubstr((second / "shared.so").lexically_normal().string()));
}

TEST(SearchPath, CountsAFolderNamedTwiceOnce) {
  Registry registry({first, first / "." / "", second / ".." / "first"});
  EXPECT_NO_THROW(registry.load("shared"));
}

// ---- names ----

TEST(Load, WantsNamesAndNotPaths) {
  for (const char* name :
       {"./alone", "alone.so", "/lib/alone.so", "../first/alone", "Alone", "", "a b", "a-b", "al\nne"}) {
    const auto error = refusal([&] { Registry({first}).load(name); });
    ASSERT_TRUE(error) << name;
    EXPECT_EQ(error->code(), "library-name") << name;
  }
  EXPECT_THAT(refusal([] { Registry({first}).load("/lib/alone.v3.so"); })->remedy(), HasSubstr("write \"alone\""));
}

TEST(Load, IsDoneOnce) {
  Registry registry({first});
  registry.load("alone");
  const bramah_type* type = registry.find("alone/thing");
  registry.load("alone");
  EXPECT_EQ(registry.find("alone/thing"), type);
  EXPECT_EQ(registry.types().size(), 1U);
}

TEST(Load, LeavesOtherRegistriesAlone) {
  Registry one({first}), other({first});
  one.load("alone");
  EXPECT_TRUE(other.types().empty());
}

TEST(Load, LeavesNothingBehindWhereItFails) {
  Registry registry({first, second});
  EXPECT_THROW(registry.load("shared"), PluginError);
  EXPECT_TRUE(registry.types().empty());
  EXPECT_TRUE(registry.libraries().empty());
}

// ---- the twin for AVX2 ----

TEST(Twin, IsPreferredWhereTheProcessorHasIt) {
  const Environment isa("BRAMAH_ISA", nullptr);
  Registry registry({first});
  registry.load("twin");
  EXPECT_STREQ(registry.libraries().at("twin").library->version, has_avx2() ? "v3" : "base");
  EXPECT_EQ(registry.libraries().at("twin").file.filename(), has_avx2() ? "twin.v3.so" : "twin.so");
}

TEST(Twin, OfAnotherBuildIsRefused) {
  for (const char* isa_name : {static_cast<const char*>(nullptr), "base"}) {
    const Environment isa("BRAMAH_ISA", isa_name);
    for (const char* name : {"stale", "half"}) {
      const auto error = refusal([&] { Registry({first}).load(name); });
      ASSERT_TRUE(error) << name;
      EXPECT_EQ(error->code(), "library-twin");
      EXPECT_THAT(error->found(), HasSubstr(std::string(name) + ".v3.so has the stamp ab"));
      EXPECT_THAT(error->remedy(), HasSubstr("remove " + std::string(name) + ".v3.so"));
    }
    EXPECT_NO_THROW(Registry({first}).load("stamped"));
  }
}

TEST(Twin, StaysAwayOnRequest) {
  const Environment isa("BRAMAH_ISA", "base");
  Registry registry({first});
  registry.load("twin");
  EXPECT_STREQ(registry.libraries().at("twin").library->version, "base");
}

TEST(Twin, IsNotNeeded) {
  const Environment isa("BRAMAH_ISA", nullptr);
  Registry registry({first});
  registry.load("alone");
  EXPECT_EQ(registry.libraries().at("alone").file.filename(), "alone.so");
}

// ---- tables ----

int configure(const void*, void*, const bramah_value*) { return 0; }
int structure(const void*, const void*, std::uint8_t* const*) { return 0; }
int evaluate(const void*, bramah_batch*) { return 0; }
double signal_value(const void*, const void*, double, std::int32_t) { return 0.0; }
double no_breakpoint(const void*, const void*, double) { return HUGE_VAL; }
void two_constants(const void*, const void*, double* values) { values[0] = values[1] = 0.0; }
const bramah_signal signal_functions{sizeof(bramah_signal), signal_value, no_breakpoint};
const bramah_constants constant_functions{sizeof(bramah_constants), 2, two_constants};
const void* offers(const void*, const char* id) {
  const std::string_view name = id;
  if (name == BRAMAH_EXTENSION_SIGNAL) return &signal_functions;
  return name == BRAMAH_EXTENSION_CONSTANTS ? &constant_functions : nullptr;
}
const void* offers_nothing(const void*, const char*) { return nullptr; }

/// A sound table with one of everything, for each test to spoil.
struct Table {
  double half = 0.5, rest = 0.0, pair[2] = {1.0, 2.0};
  const char* words[3] = {"one", "two", nullptr};
  std::vector<bramah_parameter_info> parameters = {
      {sizeof(bramah_parameter_info), "number", "", "m", BRAMAH_NUMBER, 0, 1, 0.0, 1.0, 0, 0, &half, 1, nullptr,
       nullptr},
      {sizeof(bramah_parameter_info), "vector", "", "1", BRAMAH_VECTOR, 0, 2, -HUGE_VAL, HUGE_VAL, 0, 0, pair, 2,
       nullptr, nullptr},
      {sizeof(bramah_parameter_info), "choice", "", "", BRAMAH_CHOICE, 0, 1, -HUGE_VAL, HUGE_VAL, 0, 0, nullptr, 0,
       "two", words},
  };
  std::vector<bramah_port_info> ports = {{sizeof(bramah_port_info), "a", "", "pressure", "Pa", BRAMAH_Z, 1, 1, nullptr},
                                         {sizeof(bramah_port_info), "b", "", "pressure", "Pa", BRAMAH_Z, 1, 0, &rest}};
  std::vector<bramah_variable_info> variables = {{sizeof(bramah_variable_info), "p", "", "Pa", BRAMAH_Z, 1e6, 0.0},
                                                 {sizeof(bramah_variable_info), "s", "", "m", BRAMAH_X, 1.0, 0.0}};
  std::vector<bramah_terminal_info> terminals = {
      {sizeof(bramah_terminal_info), "p", "", "pressure", "Pa", BRAMAH_Z, 1, BRAMAH_OWN, 0},
      {sizeof(bramah_terminal_info), "pair", "", "pair", "", BRAMAH_X, 2, BRAMAH_CONSTANT, 0},
      {sizeof(bramah_terminal_info), "value", "", "input", "1", BRAMAH_U, 1, BRAMAH_SIGNAL, 0}};
  std::vector<bramah_row_info> holonomic = {{sizeof(bramah_row_info), "length", "", "m"}};
  std::vector<bramah_row_info> outputs = {{sizeof(bramah_row_info), "flow", "", "m^3/s"}};
  bramah_type type{};
  const bramah_type* types[2] = {&type, &type};
  bramah_library library{};

  Table() {
    type.size = sizeof(bramah_type);
    type.name = "made/thing";
    type.doc = "a thing";
    type.nx = 1;
    type.nz = 3;
    type.instance_bytes = 16;
    type.instance_align = 8;
    type.configure = configure;
    type.structure = structure;
    type.evaluate = evaluate;
    type.extension = offers;
    library.size = sizeof(bramah_library);
    library.epoch = BRAMAH_ABI_EPOCH;
    library.name = "made";
    library.version = "1";
    library.made_with = "a test";
    library.types = types;
    library.type_count = 1;
    tie();
  }
  Table(const Table&) = delete;
  Table& operator=(const Table&) = delete;
  void tie() {
    type.parameters = parameters.data(), type.parameter_count = static_cast<std::int32_t>(parameters.size());
    type.ports = ports.data(), type.port_count = static_cast<std::int32_t>(ports.size());
    type.variables = variables.data(), type.variable_count = static_cast<std::int32_t>(variables.size());
    type.terminals = terminals.data(), type.terminal_count = static_cast<std::int32_t>(terminals.size());
    type.holonomic = holonomic.data(), type.holonomic_count = static_cast<std::int32_t>(holonomic.size());
    type.outputs = outputs.data(), type.output_count = static_cast<std::int32_t>(outputs.size());
  }
};

TEST(Add, TakesASoundTable) {
  Table table;
  Registry registry(nowhere);
  EXPECT_NO_THROW(registry.add(&table.library, "memory"));
  EXPECT_EQ(registry.find("made/thing"), &table.type);
  table.type.extension = nullptr;  // optional functions may be null, but not where a terminal needs them
  EXPECT_THROW(Registry(nowhere).add(&table.library, "memory"), PluginError);
  table.terminals.resize(1);
  table.tie();
  EXPECT_NO_THROW(Registry(nowhere).add(&table.library, "memory"));
}

struct Spoiled {
  const char* said;  // part of the message
  std::function<void(Table&)> spoil;
};

TEST(Add, RefusesTablesThatContradictThemselves) {
  const Spoiled cases[] = {
      {"does not begin with \"made/\"", [](Table& t) { t.type.name = "other/thing"; }},
      {"does not begin with \"made/\"", [](Table& t) { t.type.name = "made"; }},
      {"does not begin with \"made/\"", [](Table& t) { t.type.name = nullptr; }},
      {"no doc", [](Table& t) { t.type.doc = nullptr; }},
      {"shorter than this epoch's", [](Table& t) { t.type.size = 8; }},
      {"configure, structure or evaluate is missing", [](Table& t) { t.type.evaluate = nullptr; }},
      {"size or alignment", [](Table& t) { t.type.instance_bytes = 0; }},
      {"size or alignment", [](Table& t) { t.type.instance_align = 3; }},
      {"size or alignment", [](Table& t) { t.type.instance_bytes = 12; }},
      {"do not add up", [](Table& t) { t.type.nx = 2; }},
      {"do not add up", [](Table& t) { t.type.nu = 1; }},
      {"list of parameters is missing", [](Table& t) { t.type.parameters = nullptr; }},
      {"list of ports is missing", [](Table& t) { t.type.port_count = -1; }},
      {"a variable has no name", [](Table& t) { t.variables[0].name = ""; }},
      {"port \"a\" is declared twice", [](Table& t) { t.ports[1].name = "a"; }},
      {"port \"number\" is declared twice", [](Table& t) { t.ports[1].name = "number"; }},
      {"parameter \"type\" is declared twice", [](Table& t) { t.parameters[0].name = "type"; }},
      {"variable \"p\" is declared twice", [](Table& t) { t.variables[1].name = "p"; }},
      {"output \"p\" is declared twice", [](Table& t) { t.outputs[0].name = "p"; }},
      {"\"power\" is a variable or an output; every component has one already",
       [](Table& t) { t.outputs[0].name = "power"; }},
      {"\"energy\" is a variable or an output; every component has one already",
       [](Table& t) { t.variables[1].name = "energy"; }},
      {"terminal \"p\" is declared twice", [](Table& t) { t.terminals[1].name = "p"; }},
      {"parameter \"number\" is of no known kind", [](Table& t) { t.parameters[0].kind = 99; }},
      {"parameter \"number\" has no doc or no unit", [](Table& t) { t.parameters[0].unit = nullptr; }},
      {"parameter \"number\" has a lower limit above", [](Table& t) { t.parameters[0].lower = 2.0; }},
      {"parameter \"number\" has a lower limit above", [](Table& t) { t.parameters[0].upper = std::nan(""); }},
      {"parameter \"number\" has a default of 0 numbers", [](Table& t) { t.parameters[0].default_count = 0; }},
      {"parameter \"vector\" has a default of 1 numbers, not 2", [](Table& t) { t.parameters[1].default_count = 1; }},
      {"parameter \"vector\" is a vector of no numbers", [](Table& t) { t.parameters[1].count = 0; }},
      {"parameter \"choice\" has no choices", [](Table& t) { t.parameters[2].choices = nullptr; }},
      {"parameter \"choice\" has a default that is none", [](Table& t) { t.parameters[2].default_text = "three"; }},
      {"port \"a\" has no doc, kind or unit", [](Table& t) { t.ports[0].kind = nullptr; }},
      {"port \"a\" has no family or slots", [](Table& t) { t.ports[0].family = 3; }},
      {"port \"b\" is optional and has no rest values", [](Table& t) { t.ports[1].rest = nullptr; }},
      {"variable \"p\" needs a nominal above zero", [](Table& t) { t.variables[0].nominal = 0.0; }},
      {"variable \"p\" needs a nominal above zero", [](Table& t) { t.variables[0].nominal = std::nan(""); }},
      {"variable \"p\" has no family", [](Table& t) { t.variables[0].family = BRAMAH_U; }},
      {"variable \"p\" has no unit", [](Table& t) { t.variables[0].unit = nullptr; }},
      {"terminal \"p\" shows variables that it does not have", [](Table& t) { t.terminals[0].first = 1; }},
      {"terminal \"p\" has no family or slots", [](Table& t) { t.terminals[0].family = -1; }},
      {"terminal \"p\" comes from no known source", [](Table& t) { t.terminals[0].source = 7; }},
      {"terminal \"pair\" shows constants that it does not have", [](Table& t) { t.terminals[1].first = 1; }},
      {"terminal \"pair\" needs a function `constants`", [](Table& t) { t.type.extension = offers_nothing; }},
      {"terminal \"value\" needs functions `signal`",
       [](Table& t) {
         t.terminals.erase(t.terminals.begin() + 1);
         t.type.extension = offers_nothing;
         t.tie();
       }},
      {"terminal \"value\" is a signal of several slots", [](Table& t) { t.terminals[2].slots = 2; }},
      {"row \"flow\" has no unit", [](Table& t) { t.outputs[0].unit = nullptr; }},
  };
  for (const Spoiled& spoiled : cases) {
    Table table;
    spoiled.spoil(table);
    Registry registry(nowhere);
    const auto error = refusal([&] { registry.add(&table.library, "memory"); });
    ASSERT_TRUE(error) << spoiled.said;
    EXPECT_EQ(error->code(), "library-broken") << spoiled.said;
    EXPECT_THAT(error->found(), HasSubstr(spoiled.said));
    EXPECT_THAT(error->found(), HasSubstr("memory"));
    EXPECT_TRUE(registry.types().empty());
  }
}

TEST(Add, RefusesOtherEpochsBeforeItReadsOn) {
  Table table;
  table.library.epoch = 2;
  table.library.type_count = 1000000;
  auto error = refusal([&] { Registry(nowhere).add(&table.library, "memory"); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), "abi-mismatch");
  EXPECT_EQ(error->found(), "memory was made for border epoch 2 by a test");
  table.library.size = sizeof(std::size_t);
  table.library.name = reinterpret_cast<const char*>(1);  // must not be touched
  error = refusal([&] { Registry(nowhere).add(&table.library, "memory"); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), "abi-mismatch");
}

TEST(Add, TakesTablesThatHaveGrown) {
  Table table;
  table.library.size += 64;
  table.library.minor = 9;
  table.type.size += 64;
  EXPECT_NO_THROW(Registry(nowhere).add(&table.library, "memory"));
}

TEST(Add, RefusesLibrariesWithoutTypes) {
  Table table;
  table.library.types = nullptr;
  EXPECT_EQ(refusal([&] { Registry(nowhere).add(&table.library, "memory"); })->code(), "library-broken");
  table.library.types = table.types;
  table.types[0] = nullptr;
  EXPECT_EQ(refusal([&] { Registry(nowhere).add(&table.library, "memory"); })->code(), "library-broken");
}

TEST(Add, RefusesASecondLibraryOfTheName) {
  Table one, other;
  Registry registry(nowhere);
  registry.add(&one.library, "one");
  const auto error = refusal([&] { registry.add(&other.library, "other"); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), "library-twice");
  EXPECT_EQ(error->found(), "library \"made\" from other and from one");
}

TEST(Add, RefusesATypeTwice) {
  Table table;
  table.library.type_count = 2;
  const auto error = refusal([&] { Registry(nowhere).add(&table.library, "memory"); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), "type-twice");
  EXPECT_EQ(error->found(), "type made/thing twice in memory");
}

}  // namespace
}  // namespace bramah
