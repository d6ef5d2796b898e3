// What the documentation says is so: scenes compile, plugins compile, commands run and print what is shown, links lead
// somewhere, names exist.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "docs/markdown.hpp"
#include "io/read_scene.hpp"
#include "support/machine.hpp"

namespace bramah::docs {
namespace {

namespace fs = std::filesystem;

const fs::path root = BRAMAH_SOURCE_DIR;

/// A folder of its own with the repository's scenes and plugins in it.
class Workshop {
 public:
  Workshop() {
    std::string pattern = (fs::temp_directory_path() / "bramah_docs_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
    folder_ = pattern;
    for (const char* name : {"scenes", "plugins"}) fs::create_directory_symlink(root / name, folder_ / name);
  }
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;
  ~Workshop() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  /// Runs a script with bash in the folder: exit code and output.
  std::pair<int, std::string> run(const std::string& script, const std::string& errors = "2>&1") const {
    const fs::path file = write("script.sh", "cd \"" + folder_.string() + "\"\n" + script);
    std::FILE* pipe = popen(("bash -eu -o pipefail " + file.string() + " " + errors + " </dev/null").c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error("cannot run bash");
    std::string out;
    char buffer[4096];
    for (std::size_t count = 0; (count = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, count);
    const int status = pclose(pipe);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, out};
  }

 private:
  fs::path folder_;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Whether a word is what `shown` shows: numbers to 9 digits, since the last ones depend on the processor; "5.054..."
/// stands for all that begin so.
bool fits_word(const std::string& word, const std::string& shown) {
  if (word == shown) return true;
  if (shown.ends_with("...")) return word.starts_with(shown.substr(0, shown.size() - 3));
  char *end = nullptr, *shown_end = nullptr;
  const double number = std::strtod(word.c_str(), &end), expected = std::strtod(shown.c_str(), &shown_end);
  const bool numbers = end != word.c_str() && shown_end != shown.c_str() && std::string(end) == shown_end;
  return numbers && std::abs(number - expected) <= 1e-9 * std::abs(expected);
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

/// The same for lines, whatever the width of their columns; a word "..." stands for any words.
bool fits(const std::vector<std::string>& line, std::size_t i, const std::vector<std::string>& shown, std::size_t j) {
  if (j == shown.size()) return i == line.size();
  if (shown[j] == "...") {
    for (std::size_t k = i; k <= line.size(); ++k) {
      if (fits(line, k, shown, j + 1)) return true;
    }
    return false;
  }
  return i < line.size() && fits_word(line[i], shown[j]) && fits(line, i + 1, shown, j + 1);
}
bool fits(const std::string& line, const std::string& shown) {
  // Rules between the lines of tables are as wide as what varies.
  static const std::regex rule("[- ]*--[- ]*");
  if (std::regex_match(shown, rule)) return std::regex_match(line, rule);
  return fits(words_of(line), 0, words_of(shown), 0);
}

/// The first shown line that the output does not have where it should be; "" where it has all. A line of "..." stands
/// for any number of lines.
std::string missing_line(const std::string& output, const std::string& shown) {
  const std::vector<std::string> have = lines_of(output);
  std::size_t at = 0;
  bool anywhere = false;
  for (const std::string& line : lines_of(shown)) {
    if (words_of(line) == std::vector<std::string>{"..."}) {
      anywhere = true;
      continue;
    }
    while (anywhere && at < have.size() && !fits(have[at], line)) ++at;
    if (at >= have.size() || !fits(have[at], line)) return line;
    ++at;
    anywhere = false;
  }
  return "";
}

TEST(Documents, LinksLeadSomewhere) {
  for (const Document& document : documents()) {
    for (const Line& line : document.prose()) {
      for (const std::string& link : links(line.text)) {
        if (link.starts_with("http")) continue;
        const std::string path = link.substr(0, link.find('#'));
        const fs::path target =
            path.empty() ? document.file() : (document.file().parent_path() / path).lexically_normal();
        ASSERT_TRUE(fs::exists(root / target)) << document.place(line) << ": " << link;
        if (link.find('#') == std::string::npos) continue;
        const std::vector<std::string> anchors = Document(target).anchors();
        EXPECT_NE(std::find(anchors.begin(), anchors.end(), link.substr(link.find('#') + 1)), anchors.end())
            << document.place(line) << ": no heading for " << link;
      }
    }
  }
}

TEST(Documents, TypesOfLibrariesExist) {
  const std::shared_ptr<Registry> registry = testing::registry();
  std::vector<std::string> libraries = registry->available();
  for (const std::string& library : libraries) registry->load(library);
  static const std::regex type("([a-z0-9_]+)/[a-z0-9_]+");
  std::size_t found = 0;
  for (const Document& document : documents()) {
    for (const Line& line : document.prose()) {
      for (const std::string& word : code_words(line.text)) {
        std::smatch match;
        if (!std::regex_match(word, match, type)) continue;
        if (std::find(libraries.begin(), libraries.end(), match[1]) == libraries.end()) continue;
        EXPECT_NE(registry->find(word), nullptr) << document.place(line) << ": " << word;
        ++found;
      }
    }
  }
  EXPECT_GT(found, 20U);
}

TEST(Documents, NamesOfFilesExist) {
  static const std::regex path(R"((engine|components|plugins|scenes|tests|docs|bench|cmake)/[A-Za-z0-9_./]+)");
  for (const Document& document : documents()) {
    for (const Line& line : document.prose()) {
      for (const std::string& word : code_words(line.text)) {
        if (std::regex_match(word, path)) {
          EXPECT_TRUE(fs::exists(root / word)) << document.place(line) << ": " << word;
        }
      }
    }
  }
}

TEST(Documents, NamesOfTheBorderExist) {
  std::string headers = contents("engine/abi/bramah/abi.h");
  for (const auto& entry : fs::directory_iterator(root / "engine/sdk/bramah"))
    headers += contents(entry.path().lexically_relative(root));
  headers +=
      contents("cmake/BramahPlugin.cmake") + contents("engine/plugin/registry.cpp") + contents("tests/CMakeLists.txt");
  static const std::regex name("(bramah_[a-z0-9_]+|BRAMAH_[A-Z0-9_]+|bramah\\.[a-z]+/[0-9]+)");
  for (const Document& document : documents()) {
    for (const Line& line : document.prose()) {
      for (const std::string& word : code_words(line.text)) {
        if (std::regex_match(word, name)) {
          EXPECT_NE(headers.find(word), std::string::npos) << document.place(line) << ": " << word;
        }
      }
    }
  }
}

TEST(Theory, SymbolsStandWhereTheMapSays) {
  // Rows "| paper | code | file |": every `name` of the second cell occurs in every `file` of the third.
  std::size_t rows = 0;
  const Document theory("docs/theory.md");
  for (const Line& line : theory.prose()) {
    const std::vector<std::string> row = cells(line.text);
    if (row.size() < 3) continue;
    const std::vector<std::string> files = code_words(row[2]);
    if (files.empty() || !files[0].starts_with("engine/")) continue;
    ++rows;
    for (const std::string& file : files) {
      const std::string text = contents(file);
      for (const std::string& name : code_words(row[1])) {
        EXPECT_NE(text.find(name), std::string::npos)
            << "docs/theory.md:" << line.number << ": no " << name << " in " << file;
      }
    }
  }
  EXPECT_GT(rows, 20U);
}

TEST(Scenes, Compile) {
  std::size_t found = 0;
  for (const Document& document : documents()) {
    for (const Block& block : document.blocks()) {
      if (!block.is("json", "scene")) continue;
      ++found;
      try {
        compile(read_scene_text(block.text, block.place), testing::registry());
      } catch (const SceneError& error) {
        ADD_FAILURE() << render({block.place, block.text}, error);
      }
    }
  }
  EXPECT_GE(found, 4U);
}

TEST(Scenes, EveryKeyIsDocumented) {
  // The engine's own complaint about an unknown key lists the keys that it knows.
  const std::string text = contents("docs/scenes.md");
  const auto check = [&](const std::string& scene) {
    try {
      compile(read_scene_text(scene, "scene"), testing::registry());
      ADD_FAILURE() << "accepted: " << scene;
    } catch (const SceneError& error) {
      static const std::regex quoted("\"([a-z_]+)\"");
      const std::string& known = error.diagnostics().front().expected;
      std::size_t count = 0;
      for (std::sregex_iterator match(known.begin(), known.end(), quoted), end; match != end; ++match, ++count) {
        EXPECT_NE(text.find("`" + (*match)[1].str() + "`"), std::string::npos)
            << "docs/scenes.md does not mention " << (*match)[1] << " of " << scene;
      }
      EXPECT_GT(count, 0U) << known;
    }
  };
  const std::string body =
      R"("bramah": 1, "libraries": ["hydraulics"], "components": { "V": { "type": "hydraulics/volume" },
    "h": { "type": "hydraulics/hose", "volume": "V", "V_h": 1, "B_h": 1, "B_oil": 1 } })";
  check("{ " + body + ", \"no_such_key\": 1 }");
  for (const char* section : {"assembly", "equilibrium", "simulate", "linearize", "compare", "study", "sweep", "vary"}) {
    check("{ " + body + ", \"" + section + "\": { \"no_such_key\": 1 } }");
  }
}

TEST(Plugins, Compile) {
  const Workshop workshop;
  const std::string include = " -I" + (root / "engine/sdk").string() + " -I" + (root / "engine/abi").string();
  std::size_t found = 0;
  for (const Document& document : documents()) {
    for (const Block& block : document.blocks()) {
      const bool cpp = block.is("cpp", "plugin"), c = block.is("c", "plugin");
      if (!cpp && !c) continue;
      ++found;
      const fs::path file = workshop.write(cpp ? "plugin.cpp" : "plugin.c", block.text);
      const auto [status, output] =
          workshop.run(std::string(cpp ? BRAMAH_CXX " -std=c++20" : BRAMAH_CC " -std=c11") +
                       " -fsyntax-only -Wall -Wextra -Werror -Wno-psabi" + include + " " + file.string());
      EXPECT_EQ(status, 0) << block.place << "\n" << output;
    }
  }
  EXPECT_GE(found, 3U);
}

TEST(Plugins, ReadmeShowsTheTemplate) {
  const std::string source = contents("plugins/template/strut.cpp");
  std::vector<std::string> shown;
  const Document readme("README.md");
  for (const Block& block : readme.blocks()) {
    if (block.is("cpp", "plugin")) shown.push_back(block.text);
  }
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_EQ(shown[0], source);
}

#ifdef BRAMAH_PROGRAM

/// Whether a document has what a path like "eigenvalues[].re" names; lists are looked into at their first element.
bool has(const nlohmann::json& document, const std::string& path) {
  const nlohmann::json* at = &document;
  std::istringstream in(path);
  for (std::string step; std::getline(in, step, '.');) {
    const std::string name = step.substr(0, step.find('['));
    if (!at->is_object() || !at->contains(name)) return false;
    at = &(*at)[name];
    for (std::size_t bracket = name.size(); bracket < step.size(); bracket += 2) {
      if (!at->is_array() || at->empty()) return false;
      at = &(*at)[0];
    }
  }
  return true;
}

/// Makes `bramah` and `./run` in a script mean the program that was built.
std::string prepared(std::string script) {
  const std::string run = "\n./run\n";  // without arguments: the study of the paper's machine
  script = "\n" + script;
  for (std::size_t at = script.find(run); at != std::string::npos; at = script.find(run)) {
    script.replace(at, run.size(), "\nbramah study scenes/four_bar/overdamped.json --out results/four_bar\n");
  }
  script = std::regex_replace(script, std::regex("\\./run "), "bramah ");
  return "export PATH=\"" + fs::path(BRAMAH_PROGRAM).parent_path().string() + ":$PATH\"\n" +
         "export BRAMAH_PLUGIN_PATH=\"" BRAMAH_BINARY_DIR "/tests/plugins\"\n" + script;
}

TEST(Commands, PrintWhatIsShown) {
  std::size_t found = 0;
  for (const Document& document : documents()) {
    const Workshop workshop;  // one per document: a command may use what an earlier one wrote
    const std::vector<Block>& blocks = document.blocks();
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      // "```json file=boom.json" and the like: what commands of this document read.
      for (const std::string& word : blocks[k].words) {
        if (word.starts_with("file=")) workshop.write(word.substr(5), blocks[k].text);
      }
      if (!blocks[k].is("sh", "run")) continue;
      ++found;
      const Block* next = k + 1 < blocks.size() ? &blocks[k + 1] : nullptr;
      const bool is_document = next != nullptr && next->is("text", "keys");
      const auto [status, output] = workshop.run(prepared(blocks[k].text), is_document ? "2>/dev/null" : "2>&1");
      EXPECT_EQ(status, blocks[k].number("exit", 0)) << blocks[k].place << "\n" << output;
      if (is_document) {
        const nlohmann::json document_printed = nlohmann::json::parse(output, nullptr, false);
        EXPECT_FALSE(document_printed.is_discarded()) << blocks[k].place << ": this is no JSON:\n" << output;
        for (const std::string& path : lines_of(next->text)) {
          EXPECT_TRUE(has(document_printed, path)) << next->place << ": there is no " << path;
        }
      } else if (next != nullptr && next->is("text", "output")) {
        const std::string missing = missing_line(output, next->text);
        EXPECT_EQ(missing, "") << next->place << ": this line is shown and not printed:\n"
                               << missing << "\nprinted:\n"
                               << output;
      }
    }
  }
  EXPECT_GE(found, 5U);
}

TEST(Components, PageIsFresh) {
  const Workshop workshop;
  const auto [status, output] =
      workshop.run(prepared("bash \"" + (root / "docs/make_components.sh").string() + "\" bramah"));
  ASSERT_EQ(status, 0) << output;
  EXPECT_EQ(output, contents("docs/components.md")) << "regenerate it: docs/make_components.sh > docs/components.md";
}

#endif

}  // namespace
}  // namespace bramah::docs
