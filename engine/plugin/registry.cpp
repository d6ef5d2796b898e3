#include "plugin/registry.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdlib>
#include <set>
#include <sstream>

namespace bramah {
namespace {

namespace fs = std::filesystem;

// Structs only grow within an epoch: what its first minor version had is enough.
constexpr std::size_t type_size_of_epoch = offsetof(bramah_type, extension) + sizeof(void*);
constexpr std::size_t library_size_of_epoch = offsetof(bramah_library, type_count) + sizeof(std::int32_t);

std::string text(const char* s) { return s == nullptr ? std::string() : std::string(s); }

bool prefers_v3() {
  const char* isa = std::getenv("BRAMAH_ISA");
  if (isa != nullptr && std::string_view(isa) == "base") return false;
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
#else
  return false;
#endif
}

bool valid_name(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

/// Why a table cannot be used, or "".
std::string defect(const bramah_type& type, std::string_view library) {
  const std::string name = text(type.name);
  if (type.size < type_size_of_epoch) return "its description is shorter than this epoch's";
  if (name.substr(0, name.find('/')) != library || name.find('/') == std::string::npos) {
    return "its name does not begin with \"" + std::string(library) + "/\"";
  }
  if (type.evaluate == nullptr || type.configure == nullptr || type.structure == nullptr) {
    return "configure, structure or evaluate is missing";
  }
  if (!std::has_single_bit(type.instance_align) || type.instance_bytes == 0 ||
      type.instance_bytes % type.instance_align != 0) {
    return "instance size or alignment is impossible";
  }
  int slots[3] = {};
  for (std::int32_t i = 0; i < type.port_count; ++i) {
    const bramah_port_info& port = type.ports[i];
    if (port.family < 0 || port.family > 2 || port.slots < 1) return "port \"" + text(port.name) + "\" has no family or slots";
    if (port.required == 0 && port.rest == nullptr) return "optional port \"" + text(port.name) + "\" has no rest values";
    slots[port.family] += port.slots;
  }
  int own[3] = {};
  std::set<std::string> names;
  for (std::int32_t i = 0; i < type.variable_count; ++i) {
    const bramah_variable_info& variable = type.variables[i];
    if (variable.family < 0 || variable.family > 1) return "variable \"" + text(variable.name) + "\" has no family";
    if (!(variable.nominal > 0.0)) return "variable \"" + text(variable.name) + "\" needs a nominal above zero";
    if (!names.insert(text(variable.name)).second) return "variable \"" + text(variable.name) + "\" is declared twice";
    own[variable.family] += 1;
  }
  if (slots[0] + own[0] != type.nx || slots[1] + own[1] != type.nz || slots[2] != type.nu) {
    return "its local variables do not add up";
  }
  for (std::int32_t i = 0; i < type.terminal_count; ++i) {
    const bramah_terminal_info& terminal = type.terminals[i];
    if (terminal.source == BRAMAH_OWN &&
        (terminal.family > 1 || terminal.first < 0 || terminal.first + terminal.slots > own[terminal.family])) {
      return "terminal \"" + text(terminal.name) + "\" shows variables that it does not have";
    }
    if (terminal.source == BRAMAH_CONSTANT && extension<bramah_constants>(type, BRAMAH_EXTENSION_CONSTANTS) == nullptr) {
      return "terminal \"" + text(terminal.name) + "\" needs a function `constants`";
    }
    if (terminal.source == BRAMAH_SIGNAL && extension<bramah_signal>(type, BRAMAH_EXTENSION_SIGNAL) == nullptr) {
      return "terminal \"" + text(terminal.name) + "\" needs functions `signal` and `next_breakpoint`";
    }
  }
  std::set<std::string> keys;
  for (std::int32_t i = 0; i < type.parameter_count; ++i) keys.insert(text(type.parameters[i].name));
  for (std::int32_t i = 0; i < type.port_count; ++i) keys.insert(text(type.ports[i].name));
  if (keys.size() != static_cast<std::size_t>(type.parameter_count + type.port_count) || keys.count("type") > 0) {
    return "two of its ports and parameters share a name, or one is called \"type\"";
  }
  return "";
}

}  // namespace

PluginError::PluginError(std::string code, std::string found, std::string expected, std::string remedy)
    : std::runtime_error(found + "; expected " + expected + "; " + remedy),
      code_(std::move(code)),
      found_(std::move(found)),
      expected_(std::move(expected)),
      remedy_(std::move(remedy)) {}

Registry::Registry(std::vector<fs::path> search_path) {
  // One folder named twice (by the environment and beside the program) is one folder.
  for (fs::path& folder : search_path) {
    std::error_code ignored;
    fs::path resolved = fs::weakly_canonical(folder, ignored);
    if (resolved.empty()) resolved = folder;
    if (std::find(search_path_.begin(), search_path_.end(), resolved) == search_path_.end()) {
      search_path_.push_back(std::move(resolved));
    }
  }
}

std::vector<fs::path> Registry::default_search_path() {
  std::vector<fs::path> path;
  if (const char* variable = std::getenv("BRAMAH_PLUGIN_PATH")) {
    std::istringstream folders(variable);
    for (std::string folder; std::getline(folders, folder, ':');) {
      if (!folder.empty()) path.emplace_back(folder);
    }
  }
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  if (!program.empty()) path.push_back(program.parent_path().parent_path() / "lib" / "bramah" / "plugins");
  return path;
}

void Registry::load(std::string_view name) {
  if (libraries_.find(name) != libraries_.end()) return;
  const std::string word(name);
  if (!valid_name(name)) {
    throw PluginError("library-name", "library \"" + word + "\"", "a name of small letters, digits and underscores",
                      "write the name of the library, not a path; folders go into BRAMAH_PLUGIN_PATH");
  }
  std::vector<fs::path> found;
  std::string looked;
  for (const fs::path& folder : search_path_) {
    std::error_code ignored;
    if (fs::exists(folder / (word + ".so"), ignored)) found.push_back(folder / (word + ".so"));
    looked += (looked.empty() ? "" : ", ") + folder.string();
  }
  if (found.empty()) {
    std::string offered;
    for (const std::string& other : available()) offered += (offered.empty() ? "" : ", ") + other;
    throw PluginError("library-missing", "no library \"" + word + "\"",
                      "a file " + word + ".so in one of: " + (looked.empty() ? "(no folders)" : looked),
                      offered.empty() ? "set BRAMAH_PLUGIN_PATH to the folder that holds it"
                                      : "use one of the libraries there (" + offered +
                                            ") or add its folder to BRAMAH_PLUGIN_PATH");
  }
  if (found.size() > 1) {
    throw PluginError("library-twice", "library \"" + word + "\" in " + found[0].string() + " and in " + found[1].string(),
                      "one file of this name in the search path", "remove one, or take its folder out of BRAMAH_PLUGIN_PATH");
  }
  fs::path file = found[0];
  const fs::path twin = file.parent_path() / (word + ".v3.so");
  std::error_code ignored;
  if (prefers_v3() && fs::exists(twin, ignored)) file = twin;

  // Never closed: instances, tables and messages live in it, and unloading is unreliable with thread-locals anyway.
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    throw PluginError("library-broken", file.string() + " cannot be opened: " + text(dlerror()), "a loadable library",
                      "rebuild it for this machine; `ldd " + file.string() + "` shows what it misses");
  }
  void* symbol = dlsym(handle, BRAMAH_ENTRY_POINT);
  if (symbol == nullptr) {
    for (int epoch = 0; epoch < 100; ++epoch) {
      const std::string other = "bramah_library_v" + std::to_string(epoch);
      if (dlsym(handle, other.c_str()) == nullptr) continue;
      throw PluginError("abi-mismatch", file.string() + " was made for border epoch " + std::to_string(epoch),
                        "epoch " + std::to_string(BRAMAH_ABI_EPOCH) + ", which this engine speaks",
                        "rebuild the library against the SDK of this engine");
    }
    throw PluginError("library-foreign", file.string() + " exports no " BRAMAH_ENTRY_POINT, "a Bramah component library",
                      "end its source with BRAMAH_LIBRARY(\"" + word + "\", \"1.0.0\", ...)");
  }
  // POSIX guarantees that a function's address survives the trip through void*.
  const auto entry = reinterpret_cast<bramah_library_function>(symbol);
  const bramah_library* library = entry();
  if (library == nullptr) {
    throw PluginError("library-broken", file.string() + " gave no table", "a table of component types",
                      "look for an exception in a component's describe");
  }
  if (text(library->name) != word) {
    throw PluginError("library-name", file.string() + " calls itself \"" + text(library->name) + "\"",
                      "the name \"" + word + "\"", "rename the file or the library");
  }
  add(library, file);
}

void Registry::add(const bramah_library* library, const fs::path& origin) {
  const std::string name = text(library->name);
  if (library->size < library_size_of_epoch || library->epoch != BRAMAH_ABI_EPOCH) {
    throw PluginError("abi-mismatch",
                      origin.string() + " was made for border epoch " + std::to_string(library->epoch) + " by " +
                          text(library->made_with),
                      "epoch " + std::to_string(BRAMAH_ABI_EPOCH) + ", which this engine speaks",
                      "rebuild the library against the SDK of this engine");
  }
  if (const auto other = libraries_.find(name); other != libraries_.end()) {
    throw PluginError("library-twice",
                      "library \"" + name + "\" from " + origin.string() + " and from " + other->second.file.string(),
                      "libraries with names of their own", "load only one of them");
  }
  for (std::int32_t i = 0; i < library->type_count; ++i) {
    const bramah_type& type = *library->types[i];
    const std::string fault = defect(type, name);
    if (!fault.empty()) {
      throw PluginError("library-broken", "type " + text(type.name) + " of " + origin.string() + ": " + fault,
                        "a consistent description", "repair the component's describe");
    }
    for (std::int32_t k = 0; k < i; ++k) {
      if (text(library->types[k]->name) != type.name) continue;
      throw PluginError("type-twice", "type " + text(type.name) + " twice in " + origin.string(), "one definition of each type", "rename one of the types");
    }
    if (const auto twin = types_.find(type.name); twin != types_.end()) {
      throw PluginError("type-twice",
                        "type " + text(type.name) + " in " + origin.string() + " and in " +
                            libraries_.at(twin->second.library).file.string(),
                        "one definition of each type", "rename one of the types");
    }
  }
  libraries_.emplace(name, LoadedLibrary{library, origin});
  for (std::int32_t i = 0; i < library->type_count; ++i) {
    types_.emplace(library->types[i]->name, Entry{library->types[i], name});
  }
}

const bramah_type* Registry::find(std::string_view type) const {
  const auto entry = types_.find(type);
  return entry == types_.end() ? nullptr : entry->second.type;
}

const LoadedLibrary& Registry::library_of(const bramah_type& type) const {
  return libraries_.at(types_.at(type.name).library);
}

std::vector<const bramah_type*> Registry::types() const {
  std::vector<const bramah_type*> list;
  for (const auto& [name, entry] : types_) list.push_back(entry.type);
  return list;
}

std::vector<std::string> Registry::type_names() const {
  std::vector<std::string> list;
  for (const auto& [name, entry] : types_) list.push_back(name);
  return list;
}

std::vector<std::string> Registry::available() const {
  std::set<std::string> names;
  for (const fs::path& folder : search_path_) {
    std::error_code ignored;
    for (fs::directory_iterator file(folder, ignored), end; file != end; file.increment(ignored)) {
      const std::string name = file->path().filename().string();
      if (name.size() > 3 && name.ends_with(".so") && !name.ends_with(".v3.so")) names.insert(name.substr(0, name.size() - 3));
    }
  }
  return {names.begin(), names.end()};
}

}  // namespace bramah
