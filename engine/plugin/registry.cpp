#include "plugin/registry.hpp"

#include "plugin/border.hpp"
#include "plugin/library_file.hpp"

#include <dlfcn.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

namespace bramah {
namespace {

namespace fs = std::filesystem;

// Structs only grow within an epoch: what its first minor version had is enough.
constexpr std::size_t type_size_of_epoch = offsetof(bramah_type, extension) + sizeof(void*);
constexpr std::size_t library_size_of_epoch = offsetof(bramah_library, type_count) + sizeof(std::int32_t);

constexpr std::int32_t most_slots = 65536;  // of one port or terminal: sums of them are numbers

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

/// False where reading would end the process. Where the system cannot tell, it is taken to be readable.
bool readable(const void* from, std::size_t count) {
  std::array<unsigned char, 512> copy;
  if (from == nullptr || count > copy.size()) return false;
  const iovec here{copy.data(), count}, there{const_cast<void*>(from), count};
  const ssize_t done = ::process_vm_readv(::getpid(), &here, 1, &there, 1, 0);
  return done < 0 ? errno != EFAULT : static_cast<std::size_t>(done) == count;
}

/// A text that ends; null is one, too.
bool is_text(const char* from) {
  constexpr std::size_t longest = 65536, block = 64;  // blocks do not cross pages
  if (from == nullptr) return true;
  for (std::size_t k = 0; k < longest;) {
    const std::size_t count = block - reinterpret_cast<std::uintptr_t>(from + k) % block;
    if (!readable(from + k, count)) return false;
    if (std::memchr(from + k, '\0', count) != nullptr) return true;
    k += count;
  }
  return false;
}

bool all_said(std::initializer_list<const char*> texts) {
  return std::none_of(texts.begin(), texts.end(), [](const char* t) { return t == nullptr; });
}

/// What is wrong with one parameter, or "".
std::string defect(const bramah_parameter_info& info) {
  if (!all_said({info.doc, info.unit})) return "has no doc or no unit (\"\" will do)";
  if (info.kind < BRAMAH_NUMBER || info.kind > BRAMAH_TEXT) return "is of no known kind";
  if (!(info.lower <= info.upper)) return "has a lower limit above the upper one";
  if (info.kind == BRAMAH_VECTOR && info.count < 1) return "is a vector of no numbers";
  if (info.kind == BRAMAH_CHOICE && (info.choices == nullptr || info.choices[0] == nullptr)) return "has no choices";
  if (info.required != 0 || info.kind == BRAMAH_TEXT) return "";
  if (info.kind == BRAMAH_CHOICE && info.default_text != nullptr) {
    for (const char* const* word = info.choices; *word != nullptr; ++word) {
      if (text(*word) == info.default_text) return "";
    }
    return "has a default that is none of its choices";
  }
  const std::int64_t wanted = info.kind == BRAMAH_VECTOR ? info.count
                              : info.kind == BRAMAH_LIST ? info.default_count
                                                         : 1;
  if (info.default_count != wanted || wanted < 0 || (wanted > 0 && info.default_numbers == nullptr)) {
    return "has a default of " + std::to_string(info.default_count) + " numbers, not " + std::to_string(wanted);
  }
  if (info.kind != BRAMAH_CHOICE) return "";
  std::int64_t choices = 0;
  while (info.choices[choices] != nullptr) ++choices;
  const double chosen = info.default_numbers[0];
  return chosen >= 0.0 && chosen < static_cast<double>(choices) ? "" : "has a default that is none of its choices";
}

/// What is wrong with one terminal, or ""; `own` are the type's own variables by family.
std::string defect(const bramah_type& type, const bramah_terminal_info& terminal, const int (&own)[3]) {
  if (!all_said({terminal.doc, terminal.kind, terminal.unit}))
    return "has no doc, kind or unit (\"\" will do for a unit)";
  if (terminal.family < BRAMAH_X || terminal.family > BRAMAH_U || terminal.slots < 1 || terminal.slots > most_slots ||
      terminal.first < 0 || terminal.first > most_slots)
    return "has no family or slots";
  switch (terminal.source) {
    case BRAMAH_OWN:
      if (terminal.family > BRAMAH_Z || terminal.first + terminal.slots > own[terminal.family])
        return "shows variables that it does not have";
      return "";
    case BRAMAH_CONSTANT: {
      const auto* constants = extension<bramah_constants>(type, BRAMAH_EXTENSION_CONSTANTS);
      if (constants == nullptr || constants->values == nullptr) return "needs a function `constants`";
      if (terminal.first + terminal.slots > constants->count) return "shows constants that it does not have";
      return "";
    }
    case BRAMAH_SIGNAL: {
      const auto* signal = extension<bramah_signal>(type, BRAMAH_EXTENSION_SIGNAL);
      if (signal == nullptr || signal->value == nullptr || signal->next_breakpoint == nullptr) {
        return "needs functions `signal` and `next_breakpoint`";
      }
      return terminal.slots == 1 ? "" : "is a signal of several slots";
    }
    default: return "comes from no known source";
  }
}

/// Names of one kind, told apart; a fault of the first that is missing or repeated goes to `fault`.
template <class Info>
void collect(const char* what, const Info* list, std::int32_t count, std::set<std::string>& names, std::string& fault) {
  if (fault.empty() && (count < 0 || (count > 0 && list == nullptr)))
    fault = std::string("its list of ") + what + "s is missing";
  for (std::int32_t i = 0; fault.empty() && i < count; ++i) {
    // A count beyond the end of the list: what stands there has no size of its own, or cannot be read.
    if (!readable(list + i, sizeof(Info)) || list[i].size != sizeof(Info) || !is_text(list[i].name)) {
      fault = std::string(what) + " " + std::to_string(i + 1) + " of " + std::to_string(count) + " is no " + what +
              ": is the count right?";
    } else if (text(list[i].name).empty()) {
      fault = std::string("a ") + what + " has no name";
    } else if (!names.insert(text(list[i].name)).second) {
      fault = std::string(what) + " \"" + text(list[i].name) + "\" is declared twice";
    }
  }
}

/// Why a table cannot be used, or "".
std::string defect(const bramah_type& type, std::string_view library) {
  if (type.size < type_size_of_epoch) return "its description is shorter than this epoch's";
  const std::string name = text(type.name);
  if (name.substr(0, name.find('/')) != library || name.find('/') == std::string::npos) {
    return "its name does not begin with \"" + std::string(library) + "/\"";
  }
  if (type.doc == nullptr) return "it has no doc";
  if (type.evaluate == nullptr || type.configure == nullptr || type.structure == nullptr) {
    return "configure, structure or evaluate is missing";
  }
  if (!std::has_single_bit(type.instance_align) || type.instance_bytes == 0 ||
      type.instance_bytes % type.instance_align != 0) {
    return "instance size or alignment is impossible";
  }
  // One name stands for one thing wherever a scene may write it.
  std::string fault;
  std::set<std::string> keys = {"type"}, variables, terminals;
  collect("parameter", type.parameters, type.parameter_count, keys, fault);
  collect("port", type.ports, type.port_count, keys, fault);
  collect("variable", type.variables, type.variable_count, variables, fault);
  collect("output", type.outputs, type.output_count, variables, fault);
  collect("terminal", type.terminals, type.terminal_count, terminals, fault);
  for (const char* taken : {"energy", "power"}) {
    if (fault.empty() && variables.contains(taken))
      fault = std::string("\"") + taken + "\" is a variable or an output; every component has one already";
  }
  std::set<std::string> rows;
  collect("constraint", type.holonomic, type.holonomic_count, rows, fault);
  collect("constraint", type.nonholonomic, type.nonholonomic_count, rows, fault);
  if (!fault.empty()) return fault;

  for (std::int32_t i = 0; i < type.parameter_count; ++i) {
    fault = defect(type.parameters[i]);
    if (!fault.empty()) return "parameter \"" + text(type.parameters[i].name) + "\" " + fault;
  }
  int slots[3] = {};
  for (std::int32_t i = 0; i < type.port_count; ++i) {
    const bramah_port_info& port = type.ports[i];
    const std::string who = "port \"" + text(port.name) + "\" ";
    if (!all_said({port.doc, port.kind, port.unit})) return who + "has no doc, kind or unit (\"\" will do for a unit)";
    if (port.family < 0 || port.family > 2 || port.slots < 1 || port.slots > most_slots)
      return who + "has no family or slots";
    if (port.required == 0 && port.rest == nullptr) return who + "is optional and has no rest values";
    slots[port.family] += port.slots;
  }
  int own[3] = {};
  for (std::int32_t i = 0; i < type.variable_count; ++i) {
    const bramah_variable_info& variable = type.variables[i];
    const std::string who = "variable \"" + text(variable.name) + "\" ";
    if (variable.unit == nullptr) return who + "has no unit (\"1\" for none)";
    if (variable.family < 0 || variable.family > 1) return who + "has no family";
    if (!(variable.nominal > 0.0 && std::isfinite(variable.nominal))) return who + "needs a nominal above zero";
    own[variable.family] += 1;
  }
  if (slots[0] + own[0] != type.nx || slots[1] + own[1] != type.nz || slots[2] != type.nu) {
    return "its local variables do not add up";
  }
  if (const auto* switches = extension<bramah_switches>(type, BRAMAH_EXTENSION_SWITCHES)) {
    std::set<std::string> names;
    if (switches->values == nullptr || switches->count < 0 || (switches->count > 0 && switches->nominal == nullptr))
      return "its switching functions are incomplete";
    collect("switching function", switches->info, switches->count, names, fault);
    if (!fault.empty()) return fault;
    for (std::int32_t i = 0; i < switches->count; ++i) {
      if (!all_said({switches->info[i].name, switches->info[i].unit}) || !(switches->nominal[i] > 0.0))
        return "a switching function has no name, unit or nominal above zero";
    }
  }
  if (const auto* validity = extension<bramah_validity>(type, BRAMAH_EXTENSION_VALIDITY)) {
    std::set<std::string> names;
    if (validity->values == nullptr) return "its limits are incomplete";
    collect("limit", validity->info, validity->count, names, fault);
    if (!fault.empty()) return fault;
    for (std::int32_t i = 0; i < validity->count; ++i) {
      const bramah_limit_info& limit = validity->info[i];
      if (!all_said({limit.name, limit.doc, limit.unit}) || !(limit.nominal > 0.0))
        return "a limit has no name, doc, unit or nominal above zero";
      if (!(limit.lowest <= limit.lower && limit.lower < limit.upper && limit.upper <= limit.highest))
        return "limit \"" + text(limit.name) + "\" has bounds in a wrong order";
    }
  }
  for (std::int32_t i = 0; i < type.terminal_count; ++i) {
    fault = defect(type, type.terminals[i], own);
    if (!fault.empty()) return "terminal \"" + text(type.terminals[i].name) + "\" " + fault;
  }
  for (const auto& [list, count] : {std::pair{type.holonomic, type.holonomic_count},
                                    {type.nonholonomic, type.nonholonomic_count},
                                    {type.outputs, type.output_count}}) {
    for (std::int32_t i = 0; i < count; ++i) {
      if (list[i].unit == nullptr) return "row \"" + text(list[i].name) + "\" has no unit (\"1\" for none)";
    }
  }
  return "";
}

/// "mechanics" from "./lib/mechanics.so".
std::string name_in_path(const std::string& path) {
  std::string name = fs::path(path).filename().string();
  for (const std::string_view ending : {".v3.so", ".so"}) {
    if (name.ends_with(ending)) name.resize(name.size() - ending.size());
  }
  return name;
}

/// One letter added, left out, wrong, or two swapped; floor 2 does not know the engine's better one.
bool resembles(const std::string& a, const std::string& b) {
  if (a.size() < 3 || b.size() < 3 || a.size() + 1 < b.size() || b.size() + 1 < a.size()) return false;
  std::size_t front = 0, back = 0;
  const std::size_t shorter = std::min(a.size(), b.size());
  while (front < shorter && a[front] == b[front]) ++front;
  while (back < shorter - front && a[a.size() - 1 - back] == b[b.size() - 1 - back]) ++back;
  const std::size_t rest_a = a.size() - front - back, rest_b = b.size() - front - back;
  if (rest_a <= 1 && rest_b <= 1) return true;
  return rest_a == 2 && rest_b == 2 && a[front] == b[front + 1] && a[front + 1] == b[front];
}

}  // namespace

PluginError::PluginError(std::string code, std::string found, std::string expected, std::string remedy)
    : std::runtime_error(found + "; expected " + expected + "; " + remedy),
      code_(std::move(code)),
      found_(std::move(found)),
      expected_(std::move(expected)),
      remedy_(std::move(remedy)) {}

Registry::Registry(const std::vector<fs::path>& search_path) {
  // One folder named twice (by the environment and beside the program) is one folder.
  for (const fs::path& folder : search_path) {
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

namespace {

/// Nothing else of a table may be read before this.
void check_epoch(const bramah_library& library, const fs::path& file) {
  const bool known = library.size >= library_size_of_epoch;
  if (known && library.epoch == BRAMAH_ABI_EPOCH) return;
  throw PluginError(
      "abi-mismatch",
      file.string() +
          (known ? " was made for border epoch " + std::to_string(library.epoch) + " by " + text(library.made_with)
                 : " has a table shorter than that of epoch " + std::to_string(BRAMAH_ABI_EPOCH)),
      "epoch " + std::to_string(BRAMAH_ABI_EPOCH) + ", which this engine speaks",
      "build the library again with the SDK of this engine");
}

}  // namespace

void Registry::load(std::string_view name) {
  if (libraries_.find(name) != libraries_.end()) return;
  const std::string word(name);
  if (!valid_name(name)) {
    const std::string inner = name_in_path(word);
    throw PluginError("library-name", "library \"" + word + "\"",
                      "a name of small letters, digits and underscores, not a path",
                      (valid_name(inner) ? "write \"" + inner + "\"" : std::string("write the name of the library")) +
                          "; a folder of libraries goes into BRAMAH_PLUGIN_PATH");
  }
  std::vector<fs::path> found;
  std::string looked;
  for (const fs::path& folder : search_path_) {
    std::error_code ignored;
    if (fs::exists(folder / (word + ".so"), ignored)) found.push_back(folder / (word + ".so"));
    looked += (looked.empty() ? "" : ", ") + folder.string();
  }
  if (found.empty()) {
    for (const fs::path& folder : search_path_) {
      std::error_code ignored;
      const fs::path file = folder / (word + ".so");
      if (fs::is_symlink(file, ignored)) {
        throw PluginError(
            "library-missing",
            file.string() + " is a link to " + fs::read_symlink(file, ignored).string() + ", which does not exist",
            "a library file", "mend the link, or build the library");
      }
      if (fs::is_regular_file(folder, ignored)) {
        throw PluginError("library-missing", folder.string() + " in BRAMAH_PLUGIN_PATH is a file",
                          "a folder of libraries", "name its folder, " + folder.parent_path().string());
      }
    }
    std::string offered, meant;
    for (const std::string& other : available()) {
      offered += (offered.empty() ? "" : ", ") + other;
      if (meant.empty() && resembles(word, other)) meant = other;
    }
    throw PluginError("library-missing", "there is no library \"" + word + "\"",
                      "a file " + word + ".so in one of: " + (looked.empty() ? "(no folders)" : looked),
                      !meant.empty()    ? "did you mean \"" + meant + "\"?"
                      : offered.empty() ? "set BRAMAH_PLUGIN_PATH to the folder that holds it"
                                        : "use one of the libraries there (" + offered +
                                              ") or add the folder of this one to BRAMAH_PLUGIN_PATH");
  }
  if (found.size() > 1) {
    throw PluginError(
        "library-twice", "library \"" + word + "\" in " + found[0].string() + " and in " + found[1].string(),
        "one file of this name in the search path", "remove one, or take its folder out of BRAMAH_PLUGIN_PATH");
  }
  fs::path file = found[0];
  const fs::path twin = file.parent_path() / (word + ".v3.so");
  std::error_code ignored;
  if (fs::exists(twin, ignored)) {
    const std::string base = stamp_of(file), v3 = stamp_of(twin);
    if (base != v3) {
      const auto said = [](const std::string& stamp) {
        return stamp.empty() ? "no stamp" : "the stamp " + stamp.substr(0, 12);
      };
      throw PluginError("library-twin",
                        file.string() + " has " + said(base) + " and " + twin.string() + " has " + said(v3) +
                            ": they come from different sources or flags",
                        "two files of one build",
                        "build both with bramah_add_plugin, or remove " + twin.filename().string());
    }
    if (prefers_v3()) file = twin;
  }

  if (const std::string cut = cut_short(file); !cut.empty()) {
    throw PluginError("library-broken", file.string() + " is cut short: " + cut, "a whole library file",
                      "copy or build it again; an interrupted copy leaves such a file");
  }

  // Never closed: instances, tables and messages live in it, and unloading is unreliable with thread-locals anyway.
  border_call() = {"dlopen", file.c_str(), nullptr, 1};
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  border_call() = {};
  if (handle == nullptr) {
    std::string why = text(dlerror());
    if (why.starts_with(file.string() + ": ")) why.erase(0, file.string().size() + 2);
    throw PluginError("library-broken", file.string() + " cannot be opened: " + why,
                      "a library that this machine can load",
                      "build it again for this machine; `file` and `ldd` show what it is and what it misses");
  }
  void* symbol = dlsym(handle, BRAMAH_ENTRY_POINT);
  if (symbol == nullptr) {
    for (int epoch = 0; epoch < 100; ++epoch) {
      const std::string other = "bramah_library_v" + std::to_string(epoch);
      if (dlsym(handle, other.c_str()) == nullptr) continue;
      throw PluginError("abi-mismatch", file.string() + " was made for border epoch " + std::to_string(epoch),
                        "epoch " + std::to_string(BRAMAH_ABI_EPOCH) + ", which this engine speaks",
                        "build the library again with the SDK of this engine");
    }
    throw PluginError("library-foreign", file.string() + " exports no " BRAMAH_ENTRY_POINT,
                      "a Bramah component library",
                      "end its source with BRAMAH_LIBRARY(\"" + word + "\", \"1.0.0\", ...)");
  }
  // POSIX guarantees that a function's address survives the trip through void*.
  const auto entry = reinterpret_cast<bramah_library_function>(symbol);
  border_call() = {BRAMAH_ENTRY_POINT, file.c_str(), nullptr, 1};
  const bramah_library* library = entry();
  border_call() = {};
  if (library == nullptr) {
    void* fault = dlsym(handle, BRAMAH_FAULT_POINT);
    const std::string why =
        fault == nullptr ? std::string() : text(reinterpret_cast<bramah_library_fault_function>(fault)());
    throw PluginError("library-broken", file.string() + " gave no table" + (why.empty() ? "" : ": " + why),
                      "a table of component types",
                      why.empty() ? "look for an exception in a component's describe"
                                  : "mend the component, and build the library again");
  }
  check_epoch(*library, file);
  if (text(library->name) != word) {
    throw PluginError("library-name", file.string() + " calls itself \"" + text(library->name) + "\"",
                      "the name of its file, \"" + word + "\"", "rename the file or the library");
  }
  add(library, file);
}

void Registry::add(const bramah_library* library, const fs::path& origin) {
  check_epoch(*library, origin);
  const std::string name = text(library->name);
  if (library->type_count < 0 || (library->type_count > 0 && library->types == nullptr)) {
    throw PluginError("library-broken", origin.string() + " has no list of types", "a list of component types",
                      "repair its table");
  }
  if (const auto other = libraries_.find(name); other != libraries_.end()) {
    throw PluginError("library-twice",
                      "library \"" + name + "\" from " + origin.string() + " and from " + other->second.file.string(),
                      "libraries with names of their own", "load only one of them");
  }
  for (std::int32_t i = 0; i < library->type_count; ++i) {
    if (!readable(library->types + i, sizeof(void*)) || library->types[i] == nullptr) {
      throw PluginError("library-broken", origin.string() + " has a type without a description",
                        "a list of component types", "repair its table");
    }
    const bramah_type& type = *library->types[i];
    constexpr std::size_t most = 65536;  // bytes of a type of any later minor
    if (!readable(library->types[i], type_size_of_epoch) || type.size > most || !is_text(type.name)) {
      throw PluginError("library-broken",
                        "type " + std::to_string(i + 1) + " of " + std::to_string(library->type_count) + " in " +
                            origin.string() + " is no description of a type",
                        "as many types as type_count says", "repair its table");
    }
    const std::string fault = defect(type, name);
    if (!fault.empty()) {
      throw PluginError("library-broken", "type " + text(type.name) + " of " + origin.string() + ": " + fault,
                        "a consistent description of the type",
                        "repair the component's describe, and build the library again");
    }
    for (std::int32_t k = 0; k < i; ++k) {
      if (text(library->types[k]->name) != type.name) continue;
      throw PluginError("type-twice", "type " + text(type.name) + " twice in " + origin.string(),
                        "one definition of each type", "rename one of the types");
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

const char* file_of(const bramah_type& type) {
  Dl_info file{};
  return dladdr(reinterpret_cast<const void*>(type.evaluate), &file) == 0 ? nullptr : file.dli_fname;
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
      if (name.size() > 3 && name.ends_with(".so") && !name.ends_with(".v3.so"))
        names.insert(name.substr(0, name.size() - 3));
    }
  }
  return {names.begin(), names.end()};
}

}  // namespace bramah
