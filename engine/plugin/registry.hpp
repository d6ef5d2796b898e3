// Libraries of components: found by name, opened, checked, kept for the life of the process. The only dlopen.
#pragma once

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "bramah/abi.h"

namespace bramah {

/// A library that cannot serve: what was found, what was expected, what to do.
class PluginError : public std::runtime_error {
 public:
  PluginError(std::string code, std::string found, std::string expected, std::string remedy);
  [[nodiscard]] const std::string& code() const { return code_; }
  [[nodiscard]] const std::string& found() const { return found_; }
  [[nodiscard]] const std::string& expected() const { return expected_; }
  [[nodiscard]] const std::string& remedy() const { return remedy_; }

 private:
  std::string code_, found_, expected_, remedy_;
};

/// The extension `id` of a type, as the struct that the id stands for; null where it is not offered.
template <class Extension>
const Extension* extension(const bramah_type& type, const char* id) {
  return type.extension == nullptr ? nullptr : static_cast<const Extension*>(type.extension(type.self, id));
}

/// A loaded library and the file it came from.
struct LoadedLibrary {
  const bramah_library* library = nullptr;
  std::filesystem::path file;
};

/// The component types of the libraries loaded so far. A value: two registries know nothing of each other.
class Registry {
 public:
  /// Folders in which `load` looks, in order.
  explicit Registry(const std::vector<std::filesystem::path>& search_path = default_search_path());

  /// BRAMAH_PLUGIN_PATH (folders separated by colons), then the folder lib/bramah/plugins beside the running program.
  static std::vector<std::filesystem::path> default_search_path();

  /// Loads the library `name` (a name, not a path); nothing happens if it is loaded already. On machines with AVX2 and
  /// FMA a file name.v3.so beside name.so is preferred, unless BRAMAH_ISA=base is set in the environment.
  void load(std::string_view name);

  /// Registers a table that is already in memory (tests, hosts that link their components); `origin` stands for the file.
  void add(const bramah_library* library, const std::filesystem::path& origin);

  /// The type "domain/name"; null where no loaded library has it.
  [[nodiscard]] const bramah_type* find(std::string_view type) const;
  [[nodiscard]] const LoadedLibrary& library_of(const bramah_type& type) const;
  [[nodiscard]] std::vector<const bramah_type*> types() const;  // by name
  [[nodiscard]] std::vector<std::string> type_names() const;
  [[nodiscard]] const std::map<std::string, LoadedLibrary, std::less<>>& libraries() const { return libraries_; }
  /// Names of the libraries that the search path offers, loaded or not.
  [[nodiscard]] std::vector<std::string> available() const;

 private:
  struct Entry {
    const bramah_type* type;
    std::string library;
  };
  std::vector<std::filesystem::path> search_path_;
  std::map<std::string, LoadedLibrary, std::less<>> libraries_;
  std::map<std::string, Entry, std::less<>> types_;
};

}  // namespace bramah
