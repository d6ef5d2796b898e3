#include "layers/includes.hpp"

#include <algorithm>
#include <fstream>
#include <regex>

namespace bramah::layers {
namespace {

namespace fs = std::filesystem;

/// A heavy library: what its headers look like, and the only folders of engine/ that may include them.
struct Door {
  std::string name;
  std::regex header;
  std::set<std::string> folders;
};

const std::vector<Door>& doors() {
  static const std::vector<Door> all = {
      {"Eigen", std::regex("(unsupported/)?Eigen/.*"), {"sparse", "linear", "solve"}},
      {"SuiteSparse",
       std::regex("(suitesparse/)?((klu|btf|c?amd|c?colamd|cholmod|umfpack|spqr|SuiteSparse)\\w*|cs)\\.(h|hpp)"),
       {"sparse"}},
      {"SUNDIALS",
       std::regex("(sundials|idas?|kinsol|cvodes?|arkode|nvector|sunmatrix|sunlinsol|sunnonlinsol)/.*"),
       {"solve"}},
      {"LAPACK", std::regex("(lapack|cblas|openblas).*"), {"linear"}},
      {"Spectra", std::regex("Spectra/.*"), {"linear"}},
      {"nlohmann-json", std::regex("nlohmann/.*"), {"io"}},
      {"CLI11", std::regex("CLI/.*"), {"app"}},
      {"oneTBB", std::regex("(tbb|oneapi)/.*"), {"app"}},
      {"dlopen", std::regex("dlfcn\\.h"), {"plugin"}},
  };
  return all;
}

/// Headers of the standard libraries of C++ and C: all that a component and the SDK may use besides <bramah/...>.
bool is_standard(const std::string& header) {
  static const std::regex cpp("[a-z0-9_]+");
  static const std::regex c(
      "(assert|complex|ctype|errno|fenv|float|inttypes|iso646|limits|locale|math|setjmp|signal|stdalign|stdarg|"
      "stdatomic|"
      "stdbool|stddef|stdint|stdio|stdlib|stdnoreturn|string|tgmath|threads|time|uchar|wchar|wctype)\\.h");
  return std::regex_match(header, cpp) || std::regex_match(header, c);
}

bool is_source(const fs::path& file) {
  static const std::set<std::string> extensions = {".h", ".hpp", ".c", ".cpp"};
  return extensions.contains(file.extension().string());
}

std::vector<fs::path> sources(const fs::path& folder) {
  std::vector<fs::path> found;
  if (fs::is_directory(folder)) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file() && is_source(entry.path())) found.push_back(entry.path());
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

struct Include {
  std::size_t line;
  std::string header;
};

std::vector<Include> includes(const fs::path& file) {
  static const std::regex directive(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"].*)");
  std::vector<Include> found;
  std::ifstream in(file);
  std::string line;
  std::smatch match;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (std::regex_match(line, match, directive)) found.push_back({number, match[1]});
  }
  return found;
}

/// The folder of engine/ that `header` lies in, or "" where it is none of the project's headers.
std::string folder_of(const fs::path& engine, const std::string& header) {
  for (const char* exported : {"abi", "sdk"}) {
    if (fs::exists(engine / exported / header)) return exported;
  }
  return fs::exists(engine / header) ? fs::path(header).begin()->string() : "";
}

/// What is wrong with `header` in the folder `from` of engine/; "" if nothing is.
std::string fault_in_engine(const fs::path& engine, const std::string& from, const std::string& header) {
  if (header.find("..") != std::string::npos) return "a path with \"..\"; write it from engine/ down";
  const std::string to = folder_of(engine, header);
  if (!to.empty()) {
    if (to == from || floors().at(from).sees.contains(to)) return "";
    return from + "/ must not see " + to + "/";
  }
  if (header.starts_with("bramah/")) return "there is no such header";
  for (const Door& door : doors()) {
    if (std::regex_match(header, door.header) && !door.folders.contains(from)) {
      return door.name + " does not come in through " + from + "/";
    }
  }
  if ((from == "abi" || from == "sdk") && !is_standard(header)) return "the SDK needs a compiler and nothing else";
  return "";
}

/// The same for a component in `folder`: it sees the SDK, the standard library and the files beside it.
std::string fault_in_component(const fs::path& folder, const std::string& header) {
  const bool beside = header.find('/') == std::string::npos && fs::exists(folder / header);
  if (beside || header.starts_with("bramah/") || is_standard(header)) return "";
  return "a component sees <bramah/...> and the standard library only";
}

}  // namespace

const std::map<std::string, Floor>& floors() {
  static const std::map<std::string, Floor> all = {
      {"abi", {0, {}}},
      {"sdk", {1, {"abi"}}},
      {"plugin", {2, {"abi"}}},
      {"system", {3, {"abi", "plugin"}}},
      {"sparse", {3, {}}},
      {"solve", {4, {"abi", "sdk", "plugin", "system", "sparse"}}},
      {"linear", {5, {"abi", "sdk", "plugin", "system", "sparse", "solve"}}},
      {"io", {6, {"abi", "sdk", "plugin", "system", "sparse", "solve", "linear"}}},
      {"app", {7, {"abi", "sdk", "plugin", "system", "sparse", "solve", "linear", "io"}}},
  };
  return all;
}

std::vector<std::string> violations(const fs::path& root) {
  std::vector<std::string> found;
  const fs::path engine = root / "engine";
  const auto report = [&](const fs::path& file, const Include& include, const std::string& fault) {
    if (fault.empty()) return;
    found.push_back(file.lexically_relative(root).string() + ":" + std::to_string(include.line) + ": includes " +
                    include.header + ": " + fault);
  };
  for (const fs::path& file : sources(engine)) {
    const std::string from = file.lexically_relative(engine).begin()->string();
    if (!floors().contains(from)) {
      found.push_back("engine/" + from + ": a folder without a floor; give it one in tests/layers/includes.cpp");
      continue;
    }
    for (const Include& include : includes(file)) report(file, include, fault_in_engine(engine, from, include.header));
  }
  for (const fs::path& file : sources(root / "components")) {
    for (const Include& include : includes(file)) {
      report(file, include, fault_in_component(file.parent_path(), include.header));
    }
  }
  return found;
}

std::size_t files_read(const fs::path& root) {
  return sources(root / "engine").size() + sources(root / "components").size();
}

}  // namespace bramah::layers
