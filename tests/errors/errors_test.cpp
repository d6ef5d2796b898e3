// Broken scenes: each NAME.json has beside it, in NAME.txt, the message that its user reads.
//
// The first word of a name says how far the scene goes: assembly_*, start_*, equilibrium_* and partition_* compile and
// fail in that analysis; all others fail before. After a change of wording, BRAMAH_UPDATE_GOLDEN=1 writes the messages
// anew; read them before you commit them. Folders of libraries are written <plugins>, <libraries>, <more_libraries>.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/read_scene.hpp"
#include "solve/assemble.hpp"
#include "solve/start.hpp"
#include "system/compile.hpp"

namespace bramah {
namespace {

namespace fs = std::filesystem;

const fs::path folder = fs::path(BRAMAH_SOURCE_DIR) / "tests" / "errors";
const std::string plugins = std::string(BRAMAH_BINARY_DIR) + "/lib/bramah/plugins";
const std::string libraries = std::string(BRAMAH_TEST_LIBRARIES) + "/libraries";
const std::string more_libraries = std::string(BRAMAH_TEST_LIBRARIES) + "/more_libraries";

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> names_of(const std::string& ending) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ending) names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

void replace(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

/// A fault tells everything: what it is, what was expected, what to do; and where, unless it is about the document.
void expect_complete(const Diagnostic& fault) {
  EXPECT_FALSE(fault.code.empty()) << fault.found;
  EXPECT_FALSE(fault.found.empty()) << fault.code;
  EXPECT_FALSE(fault.expected.empty()) << fault.found;
  EXPECT_FALSE(fault.remedy.empty()) << fault.found;
  const bool of_document = fault.code == "empty-file" || fault.code == "not-an-object" || fault.code == "no-components";
  EXPECT_TRUE(of_document || fault.byte >= 0 || !fault.pointer.empty()) << fault.found;
}

void analyse(const std::string& name, const Compiled& compiled) {
  const System& system = compiled.system;
  if (name.starts_with("assembly_")) {
    State state = initial_state(system);
    assemble_positions(system, state, compiled.options.equilibrium.hold_x);
  } else if (name.starts_with("start_")) {
    consistent_start(system, compiled.options, 0.0);
  } else if (name.starts_with("equilibrium_")) {
    find_equilibrium(system, compiled.options.equilibrium);
  } else if (name.starts_with("partition_")) {
    choose_partition(system, consistent_start(system, compiled.options, 0.0), compiled.options.linearize.prescribed);
  }
}

/// What the user of the scene reads, or "" where nothing is wrong with it.
std::string message(const std::string& name) {
  const Source source{name + ".json", contents(folder / (name + ".json"))};
  auto registry = std::make_shared<Registry>(std::vector<fs::path>{plugins, libraries, more_libraries});
  std::string text;
  try {
    std::vector<Diagnostic> of_shape;
    const Scene scene = read_scene_text(source.text, source.name, &of_shape);
    analyse(name, compile(scene, registry, of_shape));
  } catch (const SceneError& error) {
    for (const Diagnostic& fault : error.diagnostics()) expect_complete(fault);
    text = render(source, error);
  } catch (const AnalysisError& error) {
    expect_complete(error.diagnostic());
    text = render(source, error);
  }
  replace(text, more_libraries, "<more_libraries>");
  replace(text, libraries, "<libraries>");
  replace(text, plugins, "<plugins>");
  // What else is there changes with every new library.
  const std::string list = "use one of the libraries there (";
  if (const std::size_t at = text.find(list); at != std::string::npos) {
    text.replace(at + list.size(), text.find(')', at) - at - list.size(), "...");
  }
  return text;
}

class BrokenScene : public testing::TestWithParam<std::string> {};

TEST_P(BrokenScene, SaysWhatIsWrong) {
  const std::string found = message(GetParam());
  EXPECT_FALSE(found.empty()) << "the scene is accepted";
  EXPECT_EQ(found.find(BRAMAH_SOURCE_DIR), std::string::npos) << found;
  const fs::path golden = folder / (GetParam() + ".txt");
  const char* update = std::getenv("BRAMAH_UPDATE_GOLDEN");
  if (update != nullptr && std::string_view(update) == "1") {
    std::ofstream(golden, std::ios::binary) << found;
    return;
  }
  EXPECT_EQ(found, contents(golden));
}

INSTANTIATE_TEST_SUITE_P(Errors, BrokenScene, testing::ValuesIn(names_of(".json")),
                         [](const auto& p) { return p.param; });

TEST(Goldens, BelongToAScene) {
  const std::vector<std::string> scenes = names_of(".json");
  EXPECT_GE(scenes.size(), 45U);
  for (const std::string& name : names_of(".txt")) {
    if (name == "CMakeLists") continue;
    EXPECT_TRUE(std::binary_search(scenes.begin(), scenes.end(), name)) << name << ".txt has no scene";
  }
}

}  // namespace
}  // namespace bramah
