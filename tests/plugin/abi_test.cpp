// The border is frozen: libraries compiled years ago rely on these numbers. Within an epoch structs only grow at their
// end; a new member is a new line here and a new minor version, anything else a new epoch.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "bramah/abi.h"
#include "plugin/abi_layout.h"

extern "C" const layout_entry layout_in_c[];
extern "C" const size_t layout_in_c_count;

namespace bramah {
namespace {

// Epoch 1, minor 0, where pointers have 64 bits: size of each struct and offset of each of its members.
constexpr layout_entry frozen[] = {
    {"bramah_parameter_info", 104},
    {"bramah_parameter_info.name", 8},
    {"bramah_parameter_info.doc", 16},
    {"bramah_parameter_info.unit", 24},
    {"bramah_parameter_info.kind", 32},
    {"bramah_parameter_info.required", 36},
    {"bramah_parameter_info.count", 40},
    {"bramah_parameter_info.lower", 48},
    {"bramah_parameter_info.upper", 56},
    {"bramah_parameter_info.lower_open", 64},
    {"bramah_parameter_info.upper_open", 68},
    {"bramah_parameter_info.default_numbers", 72},
    {"bramah_parameter_info.default_count", 80},
    {"bramah_parameter_info.default_text", 88},
    {"bramah_parameter_info.choices", 96},
    {"bramah_port_info", 64},
    {"bramah_port_info.name", 8},
    {"bramah_port_info.doc", 16},
    {"bramah_port_info.kind", 24},
    {"bramah_port_info.unit", 32},
    {"bramah_port_info.family", 40},
    {"bramah_port_info.slots", 44},
    {"bramah_port_info.required", 48},
    {"bramah_port_info.rest", 56},
    {"bramah_variable_info", 56},
    {"bramah_variable_info.name", 8},
    {"bramah_variable_info.doc", 16},
    {"bramah_variable_info.unit", 24},
    {"bramah_variable_info.family", 32},
    {"bramah_variable_info.nominal", 40},
    {"bramah_variable_info.start", 48},
    {"bramah_terminal_info", 56},
    {"bramah_terminal_info.name", 8},
    {"bramah_terminal_info.doc", 16},
    {"bramah_terminal_info.kind", 24},
    {"bramah_terminal_info.unit", 32},
    {"bramah_terminal_info.family", 40},
    {"bramah_terminal_info.slots", 44},
    {"bramah_terminal_info.source", 48},
    {"bramah_terminal_info.first", 52},
    {"bramah_row_info", 32},
    {"bramah_row_info.name", 8},
    {"bramah_row_info.doc", 16},
    {"bramah_row_info.unit", 24},
    {"bramah_value", 32},
    {"bramah_value.numbers", 8},
    {"bramah_value.count", 16},
    {"bramah_value.text", 24},
    {"bramah_pattern", 40},
    {"bramah_pattern.rows", 0},
    {"bramah_pattern.columns", 8},
    {"bramah_pattern.count", 16},
    {"bramah_pattern.start", 24},
    {"bramah_pattern.row", 32},
    {"bramah_batch", 496},
    {"bramah_batch.count", 8},
    {"bramah_batch.instances", 16},
    {"bramah_batch.time", 24},
    {"bramah_batch.side", 32},
    {"bramah_batch.x", 40},
    {"bramah_batch.v", 48},
    {"bramah_batch.a", 56},
    {"bramah_batch.z", 64},
    {"bramah_batch.zdot", 72},
    {"bramah_batch.u", 80},
    {"bramah_batch.lambda", 88},
    {"bramah_batch.f", 96},
    {"bramah_batch.g", 104},
    {"bramah_batch.c", 112},
    {"bramah_batch.r", 120},
    {"bramah_batch.s", 128},
    {"bramah_batch.y", 136},
    {"bramah_batch.partials", 144},
    {"bramah_batch.patterns", 320},
    {"bramah_batch.failed", 328},
    {"bramah_batch.message", 336},
    {"bramah_type", 200},
    {"bramah_type.name", 8},
    {"bramah_type.doc", 16},
    {"bramah_type.parameters", 24},
    {"bramah_type.ports", 32},
    {"bramah_type.variables", 40},
    {"bramah_type.terminals", 48},
    {"bramah_type.holonomic", 56},
    {"bramah_type.nonholonomic", 64},
    {"bramah_type.outputs", 72},
    {"bramah_type.parameter_count", 80},
    {"bramah_type.port_count", 84},
    {"bramah_type.variable_count", 88},
    {"bramah_type.terminal_count", 92},
    {"bramah_type.holonomic_count", 96},
    {"bramah_type.nonholonomic_count", 100},
    {"bramah_type.output_count", 104},
    {"bramah_type.nx", 108},
    {"bramah_type.nz", 112},
    {"bramah_type.nu", 116},
    {"bramah_type.instance_bytes", 120},
    {"bramah_type.instance_align", 128},
    {"bramah_type.self", 136},
    {"bramah_type.configure", 144},
    {"bramah_type.destroy", 152},
    {"bramah_type.check", 160},
    {"bramah_type.start", 168},
    {"bramah_type.structure", 176},
    {"bramah_type.evaluate", 184},
    {"bramah_type.extension", 192},
    {"bramah_library", 56},
    {"bramah_library.epoch", 8},
    {"bramah_library.minor", 12},
    {"bramah_library.name", 16},
    {"bramah_library.version", 24},
    {"bramah_library.made_with", 32},
    {"bramah_library.types", 40},
    {"bramah_library.type_count", 48},
    {"bramah_constants", 24},
    {"bramah_constants.count", 8},
    {"bramah_constants.values", 16},
    {"bramah_signal", 24},
    {"bramah_signal.value", 8},
    {"bramah_signal.next_breakpoint", 16},
    {"bramah_switches", 40},
    {"bramah_switches.count", 8},
    {"bramah_switches.info", 16},
    {"bramah_switches.nominal", 24},
    {"bramah_switches.values", 32},
    // Minor 1.
    {"bramah_direction", 64},
    {"bramah_direction.x", 8},
    {"bramah_direction.v", 16},
    {"bramah_direction.a", 24},
    {"bramah_direction.z", 32},
    {"bramah_direction.zdot", 40},
    {"bramah_direction.u", 48},
    {"bramah_direction.lambda", 56},
    {"bramah_tangent", 56},
    {"bramah_tangent.differentiable", 8},
    {"bramah_tangent.configure", 16},
    {"bramah_tangent.evaluate", 24},
    {"bramah_tangent.start", 32},
    {"bramah_tangent.constants", 40},
    {"bramah_tangent.signal", 48},
    {"bramah_energy", 16},
    {"bramah_energy.values", 8},
    {"bramah_limit_info", 72},
    {"bramah_limit_info.name", 8},
    {"bramah_limit_info.doc", 16},
    {"bramah_limit_info.unit", 24},
    {"bramah_limit_info.lower", 32},
    {"bramah_limit_info.upper", 40},
    {"bramah_limit_info.lowest", 48},
    {"bramah_limit_info.highest", 56},
    {"bramah_limit_info.nominal", 64},
    {"bramah_validity", 32},
    {"bramah_validity.count", 8},
    {"bramah_validity.info", 16},
    {"bramah_validity.values", 24},
    {"bramah_typical", 24},
    {"bramah_typical.lower", 8},
    {"bramah_typical.upper", 16},
    {"bramah_fault", 16},
    {"bramah_fault.take", 8},
};

TEST(Abi, LayoutIsFrozen) {
  static_assert(sizeof(void*) == 8, "the table is for 64 bits");
  const layout_entry now[] = {LAYOUT};
  ASSERT_EQ(std::size(now), std::size(frozen));
  for (std::size_t i = 0; i < std::size(now); ++i) {
    ASSERT_STREQ(now[i].name, frozen[i].name);
    EXPECT_EQ(now[i].number, frozen[i].number) << now[i].name;
  }
}

TEST(Abi, IsTheSameInC) {
  const layout_entry here[] = {LAYOUT};
  ASSERT_EQ(layout_in_c_count, std::size(here));
  for (std::size_t i = 0; i < std::size(here); ++i) {
    ASSERT_STREQ(layout_in_c[i].name, here[i].name);
    EXPECT_EQ(layout_in_c[i].number, here[i].number) << here[i].name;
  }
}

TEST(Abi, StructsBeginWithTheirSize) {
  EXPECT_EQ(offsetof(bramah_parameter_info, size), 0U);
  EXPECT_EQ(offsetof(bramah_port_info, size), 0U);
  EXPECT_EQ(offsetof(bramah_variable_info, size), 0U);
  EXPECT_EQ(offsetof(bramah_terminal_info, size), 0U);
  EXPECT_EQ(offsetof(bramah_row_info, size), 0U);
  EXPECT_EQ(offsetof(bramah_value, size), 0U);
  EXPECT_EQ(offsetof(bramah_batch, size), 0U);
  EXPECT_EQ(offsetof(bramah_type, size), 0U);
  EXPECT_EQ(offsetof(bramah_library, size), 0U);
  EXPECT_EQ(offsetof(bramah_constants, size), 0U);
  EXPECT_EQ(offsetof(bramah_signal, size), 0U);
  EXPECT_EQ(offsetof(bramah_switches, size), 0U);
  EXPECT_EQ(offsetof(bramah_direction, size), 0U);
  EXPECT_EQ(offsetof(bramah_tangent, size), 0U);
  EXPECT_EQ(offsetof(bramah_energy, size), 0U);
  EXPECT_EQ(offsetof(bramah_limit_info, size), 0U);
  EXPECT_EQ(offsetof(bramah_validity, size), 0U);
  EXPECT_EQ(offsetof(bramah_typical, size), 0U);
  EXPECT_EQ(offsetof(bramah_fault, size), 0U);
}

TEST(Abi, StructsArePlainData) {
  EXPECT_TRUE(std::is_standard_layout_v<bramah_batch> && std::is_trivially_copyable_v<bramah_batch>);
  EXPECT_TRUE(std::is_standard_layout_v<bramah_type> && std::is_trivially_copyable_v<bramah_type>);
  EXPECT_TRUE(std::is_standard_layout_v<bramah_library> && std::is_trivially_copyable_v<bramah_library>);
}

TEST(Abi, NumbersAreFrozen) {
  EXPECT_EQ(BRAMAH_ABI_EPOCH, 1);
  EXPECT_EQ(BRAMAH_ABI_MINOR, 3);
  EXPECT_STREQ(BRAMAH_ENTRY_POINT, "bramah_library_v1");
  EXPECT_STREQ(BRAMAH_EXTENSION_CONSTANTS, "bramah.constants/1");
  EXPECT_STREQ(BRAMAH_EXTENSION_SIGNAL, "bramah.signal/1");
  EXPECT_STREQ(BRAMAH_EXTENSION_SWITCHES, "bramah.switches/1");
  EXPECT_STREQ(BRAMAH_EXTENSION_TANGENT, "bramah.tangent/1");
  EXPECT_STREQ(BRAMAH_EXTENSION_ENERGY, "bramah.energy/1");
  EXPECT_STREQ(BRAMAH_EXTENSION_VALIDITY, "bramah.validity/1");
  EXPECT_STREQ(BRAMAH_EXTENSION_TYPICAL, "bramah.typical/1");
  EXPECT_STREQ(BRAMAH_EXTENSION_FAULT, "bramah.fault/1");
  EXPECT_STREQ(BRAMAH_FAULT_POINT, "bramah_library_fault_v1");
  const std::array<int, 3> families = {BRAMAH_X, BRAMAH_Z, BRAMAH_U};
  const std::array<int, 5> kinds = {BRAMAH_NUMBER, BRAMAH_VECTOR, BRAMAH_LIST, BRAMAH_CHOICE, BRAMAH_TEXT};
  const std::array<int, 3> sources = {BRAMAH_OWN, BRAMAH_CONSTANT, BRAMAH_SIGNAL};
  const std::array<int, 23> blocks = {BRAMAH_F_X, BRAMAH_F_V, BRAMAH_F_A,    BRAMAH_F_Z,      BRAMAH_F_U,   BRAMAH_G_X,
                                      BRAMAH_G_V, BRAMAH_G_Z, BRAMAH_G_ZDOT, BRAMAH_G_U,      BRAMAH_C_X,   BRAMAH_R_X,
                                      BRAMAH_R_V, BRAMAH_S_X, BRAMAH_S_V,    BRAMAH_L_X,      BRAMAH_Y_X,   BRAMAH_Y_V,
                                      BRAMAH_Y_A, BRAMAH_Y_Z, BRAMAH_Y_U,    BRAMAH_Y_LAMBDA, BRAMAH_BLOCKS};
  for (std::size_t i = 0; i < families.size(); ++i) EXPECT_EQ(families[i], static_cast<int>(i));
  for (std::size_t i = 0; i < kinds.size(); ++i) EXPECT_EQ(kinds[i], static_cast<int>(i));
  for (std::size_t i = 0; i < sources.size(); ++i) EXPECT_EQ(sources[i], static_cast<int>(i));
  for (std::size_t i = 0; i < blocks.size(); ++i) EXPECT_EQ(blocks[i], static_cast<int>(i));
}

/// Names that a library defines for others.
std::vector<std::string> exported(const std::filesystem::path& library) {
  const std::string command = std::string("'") + BRAMAH_NM + "' -D --defined-only '" + library.string() + "'";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::vector<std::string> names;
  if (pipe == nullptr) return names;
  std::array<char, 4096> line{};
  while (std::fgets(line.data(), line.size(), pipe.get()) != nullptr) {
    std::string text = line.data();
    while (!text.empty() && text.back() == '\n') text.pop_back();
    names.push_back(text.substr(text.rfind(' ') + 1));
  }
  return names;
}

TEST(Abi, LibrariesExportTheirTableAndItsFault) {
  int libraries = 0;
  for (const auto& file : std::filesystem::directory_iterator(std::string(BRAMAH_BINARY_DIR) + "/lib/bramah/plugins")) {
    if (file.path().extension() != ".so") continue;
    ++libraries;
    EXPECT_EQ(exported(file.path()), (std::vector<std::string>{BRAMAH_FAULT_POINT, BRAMAH_ENTRY_POINT})) << file.path();
  }
  EXPECT_GE(libraries, 4);
}

}  // namespace
}  // namespace bramah
