// What the parts of compile share: collecting faults, reading numbers with units.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "system/blocks.hpp"
#include "system/diagnostic.hpp"
#include "system/options.hpp"
#include "system/scene.hpp"
#include "system/units.hpp"

namespace bramah::compiling {

/// 10 digits: for messages only.
std::string number_text(double value);
std::string with_unit(double value, std::string_view unit);
/// "m" -> "m/s".
inline std::string rate_unit(const std::string& unit) {
  return unit == "1" ? "1/s" : unit.find('/') != std::string::npos ? "(" + unit + ")/s" : unit + "/s";
}

/// The words of "a, b, c".
std::vector<std::string> split(const std::string& list);
/// How many points a grid over all of them has, times `count`.
double grid_size(const std::vector<SweptParameter>& over, std::size_t count = 1);

/// The last key of a JSON pointer, for messages: `"mass"`, or `an element of "position"`.
std::string named(const std::string& where);
/// Those of `names` that belong to the component that `word` begins with; all of them where there are none.
std::vector<std::string> related(std::string_view word, const std::vector<std::string>& names);

struct Faults {
  std::vector<Diagnostic> list;
  /// Components whose variables are unknown, because their type is: names that begin with one of them are not judged.
  std::set<std::string, std::less<>> unread;
  [[nodiscard]] bool is_unread(std::string_view name) const {
    return unread.find(name.substr(0, name.find('.'))) != unread.end();
  }
  void add(std::string code, std::string where, std::string found, std::string expected, std::string remedy,
           bool at_key = false);
  /// What is allowed and rarely meant.
  std::vector<Diagnostic> warnings;
  void warn(std::string code, std::string where, std::string found, std::string expected, std::string remedy);
};

/// Numbers of a scene: plain (SI), with a unit ("80 mm"), or a reference to the section "constants" ("=B_oil").
class Numbers {
 public:
  explicit Numbers(Faults& faults) : faults_(faults) {}
  void read_constants(const Value* section);
  /// The SI value of a quantity that must have the dimension of `unit`; a fault and nothing otherwise. `drives` is told
  /// the constant that the number was read from, if it was.
  using Drives = std::function<void(Constant&)>;
  std::optional<double> read(const Value& value, const std::string& where, std::string_view unit,
                             const Drives& drives = {});
  /// The constants by name, each with the numbers that it drives.
  [[nodiscard]] std::vector<Constant> constants() const;
  void report_unused(const Value& root);

 private:
  struct Known : Constant {
    Unit unit;
    bool plain = true;  // without a unit: fits every dimension
    bool sound = false;
    std::string written;  // for messages
  };
  bool is_finite(double value, const std::string& where);
  std::optional<Quantity> quantity_of(const std::string& text, const std::string& where, std::string_view unit);
  std::optional<Unit> unit_of(const Quantity& quantity, const std::string& text, const std::string& where,
                              const Unit* wanted, const std::string& shown);
  Known* find_constant(const std::string& name, const std::string& where, const std::optional<Unit>& wanted,
                       const std::string& shown);
  Faults& faults_;
  std::map<std::string, Known, std::less<>> constants_;
  std::set<std::string> used_;
};

/// The sections hold, outputs, equilibrium, simulate, linearize, compare, study, sweep and vary.
void read_options(const Value& root, const System& system, Numbers& numbers, Faults& faults, Options& options);

}  // namespace bramah::compiling
