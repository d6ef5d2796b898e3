// Sparsity patterns of the groups, made once, and what they tell: variables without an equation.
#include <algorithm>
#include <array>
#include <span>

#include "plugin/border.hpp"
#include "system/compiler.hpp"

namespace bramah::compiling {

void Compiler::make_patterns() {
  for (Group& group : system().groups) {
    const bramah_type& type = *group.type;
    const Index mh = type.holonomic_count, rows = mh + type.nonholonomic_count;
    const auto row_count = [&](int block) -> Index {
      switch (row_family(block)) {
        case RowFamily::force: return type.nx;
        case RowFamily::storage: return type.nz;
        case RowFamily::holonomic: return mh;
        case RowFamily::constraint: return rows;
        default: return type.output_count;
      }
    };
    const auto column_count = [&](int block) -> Index {
      switch (column_family(block)) {
        case ColumnFamily::x: return type.nx;
        case ColumnFamily::z: return type.nz;
        case ColumnFamily::u: return type.nu;
        default: return rows;
      }
    };
    std::array<std::vector<std::uint8_t>, BRAMAH_BLOCKS> marks;
    std::uint8_t* pointers[BRAMAH_BLOCKS];
    for (int b = 0; b < BRAMAH_BLOCKS; ++b) {
      const auto k = static_cast<std::size_t>(b);
      marks[k].assign(static_cast<std::size_t>(row_count(b) * column_count(b)) + 1, 0);
      pointers[k] = marks[k].data();
    }
    for (Index i = 0; i < group.count; ++i) {
      const Draft& draft = drafts_[static_cast<std::size_t>(group.component[static_cast<std::size_t>(i)])];
      const AtBorder at("structure", draft.name.c_str(), type);
      if (type.structure(type.self, group.instances.at(i), pointers) == 0) continue;
      const std::string why = take_fault(type);
      faults_.add(
          "component-broken", draft.where, std::string(type.name) + " cannot be used" + (why.empty() ? "" : ": " + why),
          "laws that read and write what describe declares, forces of t, x, v, a, z, u and storages of t, x, v, z, "
          "zdot, u",
          "mend the component, or give it a variable of its own");
      return;
    }
    // Entries that no instance connects to a variable are never asked for: ground's columns, unconnected ports.
    const System& s = system();
    const auto live = [&](const std::vector<std::int32_t>& map, std::int32_t slots, Index limit) {
      std::vector<bool> result(static_cast<std::size_t>(slots), false);
      for (std::size_t e = 0; e < map.size(); ++e) {
        if (map[e] < limit) result[e % static_cast<std::size_t>(slots)] = true;
      }
      return result;
    };
    const std::vector<bool> live_x = live(group.x, type.nx, s.n()), live_z = live(group.z, type.nz, s.nz()),
                            live_zu = live(group.z, type.nz, s.nz() + s.nu()),
                            live_u = live(group.u, type.nu, s.nz() + s.nu());
    for (int b = 0; b < BRAMAH_BLOCKS; ++b) {
      const auto k = static_cast<std::size_t>(b);
      BlockPattern& pattern = group.patterns[k];
      pattern.rows = row_count(b);
      pattern.columns = column_count(b);
      pattern.start.assign(static_cast<std::size_t>(pattern.columns) + 1, 0);
      for (Index j = 0; j < pattern.columns; ++j) {
        const auto column = static_cast<std::size_t>(j);
        const bool live_column = column_family(b) == ColumnFamily::x ? live_x[column]
                                 : column_family(b) == ColumnFamily::z
                                     ? (b == BRAMAH_G_ZDOT ? live_z[column] : live_zu[column])
                                 : column_family(b) == ColumnFamily::u ? live_u[column]
                                                                       : true;
        for (Index i = 0; live_column && i < pattern.rows; ++i) {
          const auto row = static_cast<std::size_t>(i);
          const bool live_row = row_family(b) == RowFamily::force     ? live_x[row]
                                : row_family(b) == RowFamily::storage ? live_z[row]
                                                                      : true;
          if (live_row && marks[k][static_cast<std::size_t>(i * pattern.columns + j)] != 0)
            pattern.row.push_back(static_cast<std::int32_t>(i));
        }
        pattern.start[column + 1] = static_cast<std::int32_t>(pattern.row.size());
      }
      group.pattern_views[k] = {pattern.rows, pattern.columns, static_cast<Index>(pattern.row.size()),
                                pattern.start.data(), pattern.row.data()};
    }
  }
}

void Compiler::drop_without_storage(std::vector<bool>& stored) const {
  const System& s = compiled_.system;
  std::vector<bool> seen(s.z.size(), false);
  Blocks blocks(s);
  bool evaluated = false;
  for (int trial = 0; trial < 4 && seen != stored; ++trial) {
    State state = initial_state(s);
    const auto move = [&](Vector& values, const std::vector<Variable>& variables, double share) {
      for (std::size_t i = 0; i < variables.size(); ++i) {
        values[i] += trial * share * variables[i].nominal * (1.0 + 0.618 * static_cast<double>(i % 7));
      }
    };
    move(state.x, s.x, 0.0137);
    move(state.v, s.x, 0.0253);
    move(state.z, s.z, 0.0371);
    if (!blocks.evaluate(s, state, Request{}.blocks({BRAMAH_G_ZDOT})).ok()) continue;
    evaluated = true;
    for (std::size_t k = 0; k < s.groups.size(); ++k) {
      const Group& group = s.groups[k];
      const bramah_pattern& p = group.pattern_views[BRAMAH_G_ZDOT];
      const std::span<const double> values = blocks.block(k, BRAMAH_G_ZDOT);
      for (std::size_t e = 0; e < values.size(); ++e) {
        const auto count = static_cast<std::size_t>(p.count), slots = static_cast<std::size_t>(group.type->nz);
        const std::int32_t row = group.z[e / count * slots + static_cast<std::size_t>(p.row[e % count])];
        if (row < s.nz() && values[e] != 0.0) seen[static_cast<std::size_t>(row)] = true;
      }
    }
  }
  for (std::size_t i = 0; evaluated && i < stored.size(); ++i) stored[i] = stored[i] && seen[i];
}

void Compiler::check_structure() {
  if (!faults_.list.empty()) return;
  const System& s = system();
  std::vector<bool> x_held(s.x.size(), false), z_held(s.z.size(), false);
  for (const Group& group : s.groups) {
    const bramah_type& type = *group.type;
    const auto touches = [&](int block, bool by_column, Index local) {
      const bramah_pattern& p = group.pattern_views[static_cast<std::size_t>(block)];
      if (by_column) return p.start[local + 1] > p.start[local];
      return std::find(p.row, p.row + p.count, local) != p.row + p.count;
    };
    for (Index j = 0; j < type.nx; ++j) {
      const bool held = touches(BRAMAH_F_A, false, j) || touches(BRAMAH_R_V, true, j);
      for (Index i = 0; held && i < group.count; ++i) {
        const std::int32_t global = group.x[static_cast<std::size_t>(i * type.nx + j)];
        if (global < s.n()) x_held[static_cast<std::size_t>(global)] = true;
      }
    }
    for (Index j = 0; j < type.nz; ++j) {
      for (Index i = 0; touches(BRAMAH_G_ZDOT, false, j) && i < group.count; ++i) {
        const std::int32_t global = group.z[static_cast<std::size_t>(i * type.nz + j)];
        if (global < s.nz()) z_held[static_cast<std::size_t>(global)] = true;
      }
    }
  }
  const auto of = [&](const Variable& v) { return drafts_[static_cast<std::size_t>(v.component)].where; };
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    if (x_held[i]) continue;
    faults_.add("no-equation", of(s.x[i]), "coordinate " + s.x[i].name + " has neither inertia nor a constraint",
                "a body's mass or a constraint that acts on it", "connect what has mass or constrains it, or remove it",
                true);
  }
  drop_without_storage(z_held);
  for (std::size_t i = 0; i < s.z.size(); ++i) {
    if (z_held[i]) continue;
    const bool pressure = s.z[i].kind == "pressure";
    faults_.add("no-equation", of(s.z[i]), s.z[i].name + " has no storage, so its rate is undefined",
                pressure ? "a hose, a cylinder chamber or another component that stores there"
                         : "a component that stores there",
                pressure ? "connect one, or make it a pressure source" : "connect one, or remove it", true);
  }
}

}  // namespace bramah::compiling
