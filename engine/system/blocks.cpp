#include "system/blocks.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "plugin/border.hpp"
#include "system/analysis_error.hpp"
#include "system/scene.hpp"

namespace bramah {

RowFamily row_family(int block) {
  if (block <= BRAMAH_F_U || block == BRAMAH_L_X) return RowFamily::force;
  if (block <= BRAMAH_G_U) return RowFamily::storage;
  if (block == BRAMAH_C_X) return RowFamily::holonomic;
  if (block <= BRAMAH_S_V) return RowFamily::constraint;
  return RowFamily::output;
}

ColumnFamily column_family(int block) {
  switch (block) {
    case BRAMAH_F_Z:
    case BRAMAH_G_Z:
    case BRAMAH_G_ZDOT:
    case BRAMAH_Y_Z: return ColumnFamily::z;
    case BRAMAH_F_U:
    case BRAMAH_G_U:
    case BRAMAH_Y_U: return ColumnFamily::u;
    case BRAMAH_Y_LAMBDA: return ColumnFamily::lambda;
    default: return ColumnFamily::x;
  }
}

Request& Request::rows(std::string_view letters) {
  for (const char letter : letters) {
    (letter == 'f' ? f : letter == 'g' ? g : letter == 'c' ? c : letter == 'r' ? r : letter == 's' ? s : y) = true;
  }
  return *this;
}

Request& Request::blocks(std::initializer_list<int> list) {
  for (const int b : list) block[static_cast<std::size_t>(b)] = true;
  return *this;
}

Blocks::Blocks(const System& system)
    : f(system.x.size()),
      g(system.z.size()),
      c(system.holonomic.size()),
      r(system.holonomic.size() + system.nonholonomic.size()),
      s(r.size()),
      y(system.outputs.size()),
      partials_(system.groups.size()) {
  std::size_t nx = 0, nz = 0, nu = 0, rows = 0, ny = 0;
  for (const Group& group : system.groups) {
    const bramah_type& type = *group.type;
    nx = std::max(nx, static_cast<std::size_t>(type.nx));
    nz = std::max(nz, static_cast<std::size_t>(type.nz));
    nu = std::max(nu, static_cast<std::size_t>(type.nu));
    rows = std::max(rows, static_cast<std::size_t>(type.holonomic_count + type.nonholonomic_count));
    ny = std::max(ny, static_cast<std::size_t>(type.output_count));
  }
  const auto size = static_cast<std::size_t>(chunk);
  for (Inputs* i : {&in_, &along_}) {
    for (Vector* v : {&i->x, &i->v, &i->a}) v->resize(size * nx);
    for (Vector* v : {&i->z, &i->zdot}) v->resize(size * nz);
    i->u.resize(size * nu);
    i->lambda.resize(size * rows);
  }
  lf_.resize(size * nx);
  lg_.resize(size * nz);
  for (Vector* v : {&lc_, &lr_, &ls_}) v->resize(size * rows);
  ly_.resize(size * ny);
}

void Blocks::gather(const Group& group, const State& state, Index first, Index count, Inputs& in) const {
  const bramah_type& type = *group.type;
  const auto copy = [&](const Vector& from, const std::vector<std::int32_t>& map, std::int32_t slots, Vector& to) {
    const std::int32_t* position = map.data() + first * slots;
    for (Index k = 0; k < count * slots; ++k)
      to[static_cast<std::size_t>(k)] = from[static_cast<std::size_t>(position[k])];
  };
  copy(state.x, group.x, type.nx, in.x);
  copy(state.v, group.x, type.nx, in.v);
  copy(state.a, group.x, type.nx, in.a);
  copy(state.z, group.z, type.nz, in.z);
  copy(state.zdot, group.z, type.nz, in.zdot);
  copy(state.z, group.u, type.nu, in.u);
  const Index mh = type.holonomic_count, ml = type.nonholonomic_count;
  const auto m = static_cast<Index>(c.size());
  double* lambda = in.lambda.data();
  for (Index i = first; i < first + count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (Index j = 0; j < mh; ++j) *lambda++ = state.lambda[static_cast<std::size_t>(group.first_holonomic[k] + j)];
    for (Index j = 0; j < ml; ++j)
      *lambda++ = state.lambda[static_cast<std::size_t>(m + group.first_nonholonomic[k] + j)];
  }
}

void Blocks::Inputs::give_to(bramah_batch& batch) const {
  batch.x = x.data();
  batch.v = v.data();
  batch.a = a.data();
  batch.z = z.data();
  batch.zdot = zdot.data();
  batch.u = u.data();
  batch.lambda = lambda.data();
}

Outcome Blocks::evaluate(const System& system, const State& state, const Request& request) {
  return evaluate_all(system, state, nullptr, request);
}

Outcome Blocks::evaluate_along(const System& system, const State& state, const Direction& along,
                               const Request& request) {
  return evaluate_all(system, state, &along, request);
}

Outcome Blocks::evaluate_all(const System& system, const State& state, const Direction* along, const Request& request) {
  for (auto [wanted, rows] : {std::pair{request.f, &f},
                              {request.g, &g},
                              {request.c, &c},
                              {request.r, &r},
                              {request.s, &s},
                              {request.y, &y}}) {
    if (wanted) std::fill(rows->begin(), rows->end(), 0.0);
  }
  const Index n = system.n(), nz = system.nz(), m = system.m();
  for (std::size_t k = 0; k < system.groups.size(); ++k) {
    const Group& group = system.groups[k];
    const bramah_type& type = *group.type;
    const Index mh = type.holonomic_count, ml = type.nonholonomic_count, rows = mh + ml;
    const bool reactions = request.f && request.multiplier_forces && rows > 0;
    std::array<bool, BRAMAH_BLOCKS> wanted = request.block;
    if (reactions) wanted[BRAMAH_R_V] = true;
    for (int b = 0; b < BRAMAH_BLOCKS; ++b) {
      const auto block = static_cast<std::size_t>(b);
      wanted[block] = wanted[block] && group.pattern_views[block].count > 0;
      if (wanted[block])
        partials_[k][block].resize(static_cast<std::size_t>(group.count * group.pattern_views[block].count));
    }
    bramah_batch batch = batch_of(group, state, 0, group.count);
    in_.give_to(batch);
    batch.f = request.f && type.nx > 0 ? lf_.data() : nullptr;
    batch.g = request.g && type.nz > 0 ? lg_.data() : nullptr;
    batch.c = request.c && mh > 0 ? lc_.data() : nullptr;
    batch.r = request.r && rows > 0 ? lr_.data() : nullptr;
    batch.s = request.s && rows > 0 ? ls_.data() : nullptr;
    batch.y = request.y && type.output_count > 0 ? ly_.data() : nullptr;

    Index count = 0;
    for (Index first = 0; first < group.count; first += count) {
      Run run{k, first, std::min(chunk, group.count - first), group.instances.at(first)};
      if (along != nullptr) std::tie(run.instances, run.count) = along->instances(group, first, run.count);
      count = run.count;
      gather(group, state, first, count, in_);
      if (along != nullptr) gather(group, along->state, first, count, along_);
      batch.count = count;
      batch.instances = run.instances;
      for (std::size_t b = 0; b < BRAMAH_BLOCKS; ++b) {
        batch.partials[b] = wanted[b] ? partials_[k][b].data() + first * group.pattern_views[b].count : nullptr;
      }
      // Rows that a type does not write stay what they were, so they start from zero.
      if (batch.f != nullptr) std::fill_n(lf_.begin(), count * type.nx, 0.0);
      if (batch.g != nullptr) std::fill_n(lg_.begin(), count * type.nz, 0.0);
      int status = call(system, run, along, batch);
      if (status == 0 && reactions) {
        add_reactions(group, count, batch.partials[BRAMAH_R_V], in_.lambda);
        if (along != nullptr) status = add_moving_reactions(group, run, batch);
      }
      if (status != 0) return failure(system, group, first + batch.failed, status, batch.message);
      if (request.listener != nullptr) request.listener->hear(group, first, batch);
      for (Index i = 0; i < count; ++i) {
        const auto instance = static_cast<std::size_t>(first + i);
        for (Index j = 0; batch.f != nullptr && j < type.nx; ++j) {
          const std::int32_t row = group.x[instance * static_cast<std::size_t>(type.nx) + static_cast<std::size_t>(j)];
          if (row < n) f[static_cast<std::size_t>(row)] += lf_[static_cast<std::size_t>(i * type.nx + j)];
        }
        for (Index j = 0; batch.g != nullptr && j < type.nz; ++j) {
          const std::int32_t row = group.z[instance * static_cast<std::size_t>(type.nz) + static_cast<std::size_t>(j)];
          if (row < nz) g[static_cast<std::size_t>(row)] += lg_[static_cast<std::size_t>(i * type.nz + j)];
        }
        for (Index j = 0; j < mh; ++j) {
          const auto row = static_cast<std::size_t>(group.first_holonomic[instance] + j);
          if (batch.c != nullptr) c[row] = lc_[static_cast<std::size_t>(i * mh + j)];
          if (batch.r != nullptr) r[row] = lr_[static_cast<std::size_t>(i * rows + j)];
          if (batch.s != nullptr) s[row] = ls_[static_cast<std::size_t>(i * rows + j)];
        }
        for (Index j = 0; j < ml; ++j) {
          const auto row = static_cast<std::size_t>(m + group.first_nonholonomic[instance] + j);
          if (batch.r != nullptr) r[row] = lr_[static_cast<std::size_t>(i * rows + mh + j)];
          if (batch.s != nullptr) s[row] = ls_[static_cast<std::size_t>(i * rows + mh + j)];
        }
        for (Index j = 0; batch.y != nullptr && j < type.output_count; ++j) {
          y[static_cast<std::size_t>(group.first_output[instance] + j)] =
              ly_[static_cast<std::size_t>(i * type.output_count + j)];
        }
      }
    }
  }
  Outcome outcome = check_finite(system, request, along == nullptr ? "" : "the derivative of ");
  if (!outcome.ok() && along == nullptr) blame(system, state, outcome);
  return outcome;
}

/// Adds to a failure which component's own rows are not finite: several add to one balance.
void Blocks::blame(const System& system, const State& state, Outcome& outcome) {
  for (const Group& group : system.groups) {
    const bramah_type& type = *group.type;
    const Index rows = type.holonomic_count + type.nonholonomic_count;
    for (Index i = 0; i < group.count; ++i) {
      gather(group, state, i, 1, in_);
      std::fill_n(lf_.begin(), type.nx, 0.0);
      std::fill_n(lg_.begin(), type.nz, 0.0);
      bramah_batch batch = batch_of(group, state, i, 1);
      in_.give_to(batch);
      batch.f = type.nx > 0 ? lf_.data() : nullptr;
      batch.g = type.nz > 0 ? lg_.data() : nullptr;
      batch.s = rows > 0 ? ls_.data() : nullptr;
      const std::string& name = system.component_name(group.component[static_cast<std::size_t>(i)]);
      const AtBorder at("evaluate", name.c_str(), type);
      const auto finite = [](const Vector& list, Index count) {
        return std::all_of(list.begin(), list.begin() + count, [](double value) { return std::isfinite(value); });
      };
      // What goes in must be finite for the law to be to blame.
      if (!finite(in_.x, type.nx) || !finite(in_.v, type.nx) || !finite(in_.a, type.nx) || !finite(in_.z, type.nz) ||
          !finite(in_.zdot, type.nz) || !finite(in_.u, type.nu) || type.evaluate(type.self, &batch) != 0)
        continue;
      if (finite(lf_, type.nx) && finite(lg_, type.nz) && (rows == 0 || finite(ls_, rows))) continue;
      outcome.message += ": " + name + " (" + type.name + ") gives a number that is not finite";
      return;
    }
  }
}

int Blocks::call(const System& system, const Run& run, const Direction* along, bramah_batch& batch) {
  const Group& group = system.groups[run.group];
  const bramah_type& type = *group.type;
  const AtBorder at("evaluate", system.component_name(group.component[static_cast<std::size_t>(run.first)]).c_str(),
                    type, run.count);
  if (along == nullptr) return type.evaluate(type.self, &batch);
  if (const auto* tangent = extension<bramah_tangent>(type, BRAMAH_EXTENSION_TANGENT)) {
    const bramah_direction direction{sizeof(bramah_direction), along_.x.data(),     along_.v.data(),
                                     along_.a.data(),          along_.z.data(),     along_.zdot.data(),
                                     along_.u.data(),          along_.lambda.data()};
    return tangent->evaluate(type.self, &batch, &direction);
  }
  check_still(system, run);
  const auto clear = [](double* to, Index numbers) {
    if (to != nullptr) std::fill_n(to, numbers, 0.0);
  };
  const Index mh = type.holonomic_count, rows = mh + type.nonholonomic_count;
  clear(batch.f, run.count * type.nx);
  clear(batch.g, run.count * type.nz);
  clear(batch.c, run.count * mh);
  clear(batch.r, run.count * rows);
  clear(batch.s, run.count * rows);
  clear(batch.y, run.count * type.output_count);
  for (std::size_t b = 0; b < BRAMAH_BLOCKS; ++b) clear(batch.partials[b], run.count * group.pattern_views[b].count);
  return 0;
}

/// Of a type without derivatives: where nothing moves, they are zero.
void Blocks::check_still(const System& system, const Run& run) const {
  const Group& group = system.groups[run.group];
  const bramah_type& type = *group.type;
  const Index rows = type.holonomic_count + type.nonholonomic_count;
  for (Index i = 0; i < run.count; ++i) {
    const auto moves = [i](const Vector& all, Index slots) {
      const auto first = all.begin() + i * slots;
      return std::any_of(first, first + slots, [](double d) { return d != 0.0; });
    };
    if (!moves(along_.x, type.nx) && !moves(along_.v, type.nx) && !moves(along_.a, type.nx) &&
        !moves(along_.z, type.nz) && !moves(along_.zdot, type.nz) && !moves(along_.u, type.nu) &&
        !moves(along_.lambda, rows)) {
      continue;
    }
    const std::string& name = system.component_name(group.component[static_cast<std::size_t>(run.first + i)]);
    throw AnalysisError("second derivatives", name + " (" + type.name + ") gives none, and its variables move",
                        std::string("the extension ") + BRAMAH_EXTENSION_TANGENT,
                        "build its library again with this SDK, or add the extension to it",
                        pointer("/components", name));
  }
}

/// Adds D^T lambda to the local forces; d: the entries of R_V.
void Blocks::add_reactions(const Group& group, Index count, const double* d, const Vector& lambda) {
  const bramah_pattern& p = group.pattern_views[BRAMAH_R_V];
  const Index rows = group.type->holonomic_count + group.type->nonholonomic_count, nx = group.type->nx;
  for (Index i = 0; i < count && p.count > 0; ++i) {
    for (Index j = 0; j < p.columns; ++j) {
      double force = 0.0;
      for (std::int32_t e = p.start[j]; e < p.start[j + 1]; ++e) {
        force += d[i * p.count + e] * lambda[static_cast<std::size_t>(i * rows + p.row[e])];
      }
      lf_[static_cast<std::size_t>(i * nx + j)] += force;
    }
  }
}

/// (D^T lambda)' = D'^T lambda + D^T lambda': the second term, for which D itself is needed. `batch` is a copy.
int Blocks::add_moving_reactions(const Group& group, const Run& run, bramah_batch batch) {
  const bramah_pattern& p = group.pattern_views[BRAMAH_R_V];
  if (p.count == 0) return 0;
  d_.resize(static_cast<std::size_t>(chunk * p.count));
  batch.f = batch.g = batch.c = batch.r = batch.s = batch.y = nullptr;
  std::fill(std::begin(batch.partials), std::end(batch.partials), nullptr);
  batch.partials[BRAMAH_R_V] = d_.data();
  const int status = group.type->evaluate(group.type->self, &batch);
  if (status == 0) add_reactions(group, run.count, d_.data(), along_.lambda);
  return status;
}

Outcome Blocks::failure(const System& system, const Group& group, Index instance, int status, const char* why) {
  const Index component = group.component[static_cast<std::size_t>(std::clamp<Index>(instance, 0, group.count - 1))];
  Outcome outcome;
  outcome.status = status > 0 ? Outcome::Status::recoverable : Outcome::Status::fatal;
  outcome.component = component;
  outcome.message =
      system.component_name(component) + " (" + group.type->name + ") cannot be evaluated: " +
      (why[0] != '\0' ? std::string(why) : "it gave status " + std::to_string(status) + " without a message");
  return outcome;
}

namespace {

/// Global row or column of a local index of one instance, before a consumer's map; -1 for constants.
class GlobalIndex {
 public:
  explicit GlobalIndex(const System& system) : n_(system.n()), zu_(system.nz() + system.nu()), m_(system.m()) {}

  [[nodiscard]] Index row(const Group& g, int block, std::size_t instance, Index local) const {
    switch (row_family(block)) {
      case RowFamily::force: return of_x(g, instance, local);
      case RowFamily::storage: return of_zu(g.z, g.type->nz, instance, local);
      case RowFamily::holonomic: return g.first_holonomic[instance] + local;
      case RowFamily::constraint: return of_constraint(g, instance, local);
      case RowFamily::output: return g.first_output[instance] + local;
    }
    return -1;
  }
  [[nodiscard]] Index column(const Group& g, int block, std::size_t instance, Index local) const {
    switch (column_family(block)) {
      case ColumnFamily::x: return of_x(g, instance, local);
      case ColumnFamily::z: return of_zu(g.z, g.type->nz, instance, local);
      case ColumnFamily::u: return of_zu(g.u, g.type->nu, instance, local);
      case ColumnFamily::lambda: return of_constraint(g, instance, local);
    }
    return -1;
  }

 private:
  [[nodiscard]] Index of_x(const Group& g, std::size_t instance, Index local) const {
    const Index i = g.x[instance * static_cast<std::size_t>(g.type->nx) + static_cast<std::size_t>(local)];
    return i < n_ ? i : -1;
  }
  [[nodiscard]] Index of_zu(const std::vector<std::int32_t>& map, Index slots, std::size_t instance,
                            Index local) const {
    const Index i = map[instance * static_cast<std::size_t>(slots) + static_cast<std::size_t>(local)];
    return i < zu_ ? i : -1;
  }
  [[nodiscard]] Index of_constraint(const Group& g, std::size_t instance, Index local) const {
    const Index mh = g.type->holonomic_count;
    return local < mh ? g.first_holonomic[instance] + local : m_ + g.first_nonholonomic[instance] + local - mh;
  }
  Index n_, zu_, m_;
};

/// "the force balance of m.x"; a row that leads nowhere has no name.
std::string name_of_row(const System& system, int block, Index row) {
  const auto i = static_cast<std::size_t>(row);
  if (row < 0) return "a row that leads nowhere";
  switch (row_family(block)) {
    case RowFamily::force: return "the force balance of " + system.x[i].name;
    case RowFamily::storage:
      return "the storage balance of " +
             (i < system.z.size() ? system.z[i].name : system.inputs[i - system.z.size()].name);
    case RowFamily::holonomic: return "the constraint " + system.holonomic[i].name;
    case RowFamily::constraint: return "the constraint " + system.constraint(row).name;
    case RowFamily::output: return "the output " + system.outputs[i].name;
  }
  return "";
}
std::string name_of_column(const System& system, int block, Index column) {
  const auto i = static_cast<std::size_t>(column);
  if (column < 0) return "a constant";
  switch (column_family(block)) {
    case ColumnFamily::x: {
      const bool rate = block == BRAMAH_F_V || block == BRAMAH_G_V || block == BRAMAH_R_V || block == BRAMAH_S_V ||
                        block == BRAMAH_Y_V;
      const bool second = block == BRAMAH_F_A || block == BRAMAH_Y_A;
      return system.x[i].name + (rate ? ".rate" : second ? ".acceleration" : "");
    }
    case ColumnFamily::z:
      return (i < system.z.size() ? system.z[i].name : system.inputs[i - system.z.size()].name) +
             (block == BRAMAH_G_ZDOT ? ".rate" : "");
    case ColumnFamily::u: return i < system.z.size() ? system.z[i].name : system.inputs[i - system.z.size()].name;
    case ColumnFamily::lambda: return "the multiplier of " + system.constraint(column).name;
  }
  return "";
}

}  // namespace

Outcome Blocks::check_partials(const System& system) const {
  const GlobalIndex global(system);
  for (std::size_t k = 0; k < system.groups.size(); ++k) {
    const Group& group = system.groups[k];
    for (int block = 0; block < BRAMAH_BLOCKS; ++block) {
      const std::vector<double>& entries = partials_[k][static_cast<std::size_t>(block)];
      const auto bad = std::find_if(entries.begin(), entries.end(), [](double e) { return !std::isfinite(e); });
      if (bad == entries.end()) continue;
      const bramah_pattern& pattern = group.pattern_views[static_cast<std::size_t>(block)];
      const auto instance = static_cast<std::size_t>((bad - entries.begin()) / pattern.count);
      const auto entry = static_cast<std::int32_t>((bad - entries.begin()) % pattern.count);
      const auto column =
          std::upper_bound(pattern.start, pattern.start + pattern.columns + 1, entry) - pattern.start - 1;
      Outcome outcome;
      outcome.status = Outcome::Status::recoverable;
      outcome.component = group.component[instance];
      outcome.message = system.component_name(outcome.component) + " (" + group.type->name +
                        ") has a partial derivative " + "that is not finite: of " +
                        name_of_row(system, block, global.row(group, block, instance, pattern.row[entry])) + " by " +
                        name_of_column(system, block, global.column(group, block, instance, column));
      return outcome;
    }
  }
  return {};
}

Outcome Blocks::check_finite(const System& system, const Request& request, const char* prefix) const {
  const auto look = [](bool wanted, const Vector& rows) -> Index {
    if (!wanted) return -1;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (!std::isfinite(rows[i])) return static_cast<Index>(i);
    }
    return -1;
  };
  Outcome outcome;
  const auto report = [&](const std::string& what, const auto& row) {
    outcome.status = Outcome::Status::recoverable;
    outcome.message = prefix + what + row.name + " is not finite";
    outcome.component = row.component;
  };
  if (const Index i = look(request.f, f); i >= 0) {
    report("the force balance of ", system.x[static_cast<std::size_t>(i)]);
  } else if (const Index j = look(request.g, g); j >= 0) {
    report("the storage balance of ", system.z[static_cast<std::size_t>(j)]);
  } else if (const Index k = look(request.c, c); k >= 0) {
    report("the constraint ", system.holonomic[static_cast<std::size_t>(k)]);
  } else if (const Index p = look(request.r, r); p >= 0) {
    report("the rate of constraint ", system.constraint(p));
  } else if (const Index q = look(request.s, s); q >= 0) {
    report("the acceleration of constraint ", system.constraint(q));
  } else if (const Index o = look(request.y, y); o >= 0) {
    report("the output ", system.outputs[static_cast<std::size_t>(o)]);
  }
  return outcome;
}

SparsePlan::SparsePlan(const System& system, Index rows, Index columns, std::span<const Term> terms,
                       std::span<const Diagonal> diagonals)
    : rows_(rows), columns_(columns) {
  const GlobalIndex global(system);
  // Pass 1: the matrix place of every block entry; pass 2: sort, unite, and turn places into positions.
  struct Place {
    Index row, column;
  };
  std::vector<std::vector<Place>> places;
  const auto mapped = [](std::span<const Index> map, Index i) {
    return i < 0 || i >= static_cast<Index>(map.size()) ? Index{-1} : map[static_cast<std::size_t>(i)];
  };
  for (const Term& term : terms) {
    for (std::size_t k = 0; k < system.groups.size(); ++k) {
      const Group& group = system.groups[k];
      const bramah_pattern& pattern = group.pattern_views[static_cast<std::size_t>(term.block)];
      if (pattern.count == 0) continue;
      std::vector<Place> list;
      list.reserve(static_cast<std::size_t>(group.count * pattern.count));
      bool used = false;
      for (Index i = 0; i < group.count; ++i) {
        for (Index j = 0; j < pattern.columns; ++j) {
          for (std::int32_t e = pattern.start[j]; e < pattern.start[j + 1]; ++e) {
            const auto instance = static_cast<std::size_t>(i);
            Place p{mapped(term.rows, global.row(group, term.block, instance, pattern.row[e])),
                    mapped(term.columns, global.column(group, term.block, instance, j))};
            if (term.transposed) std::swap(p.row, p.column);
            if (p.row < 0 || p.column < 0) p = {-1, -1};
            used = used || p.row >= 0;
            list.push_back(p);
          }
        }
      }
      if (!used) continue;
      scatters_.push_back({k, term.block, term.weight, {}});
      places.push_back(std::move(list));
    }
  }
  std::vector<std::vector<Place>> fixed;
  for (const Diagonal& d : diagonals) {
    std::vector<Place> list;
    for (Index i = 0; i < d.count; ++i) list.push_back({d.row + i, d.column + i});
    fixed_.push_back(
        {d.weight, {}, d.scale.empty() ? std::vector<double>(static_cast<std::size_t>(d.count), 1.0) : d.scale});
    fixed.push_back(std::move(list));
  }

  // Counting sort by column, then by row within each column.
  start_.assign(static_cast<std::size_t>(columns) + 1, 0);
  const auto each = [&](auto&& function) {
    for (const auto* all : {&places, &fixed}) {
      for (const std::vector<Place>& list : *all) {
        for (const Place& p : list) {
          if (p.row >= 0) function(p);
        }
      }
    }
  };
  each([&](const Place& p) { ++start_[static_cast<std::size_t>(p.column) + 1]; });
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  std::vector<Index> entries(static_cast<std::size_t>(start_.back())), fill(start_.begin(), start_.end() - 1);
  each([&](const Place& p) { entries[static_cast<std::size_t>(fill[static_cast<std::size_t>(p.column)]++)] = p.row; });
  Index kept = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(columns); ++j) {
    const auto begin = entries.begin() + start_[j], end = entries.begin() + start_[j + 1];
    std::sort(begin, end);
    const auto last = std::unique(begin, end);
    start_[j] = kept;
    for (auto it = begin; it != last; ++it) entries[static_cast<std::size_t>(kept++)] = *it;
  }
  start_.back() = kept;
  entries.resize(static_cast<std::size_t>(kept));
  row_ = std::move(entries);
  values_.assign(row_.size() + 1, 0.0);

  const auto positions = [&](const std::vector<Place>& list) {
    std::vector<Index> result(list.size(), static_cast<Index>(row_.size()));
    for (std::size_t e = 0; e < list.size(); ++e) {
      if (list[e].row < 0) continue;
      const auto begin = row_.begin() + start_[static_cast<std::size_t>(list[e].column)];
      const auto end = row_.begin() + start_[static_cast<std::size_t>(list[e].column) + 1];
      result[e] = std::lower_bound(begin, end, list[e].row) - row_.begin();
    }
    return result;
  };
  for (std::size_t k = 0; k < places.size(); ++k) scatters_[k].position = positions(places[k]);
  for (std::size_t k = 0; k < fixed.size(); ++k) fixed_[k].position = positions(fixed[k]);
}

void SparsePlan::fill(const Blocks& blocks, std::span<const double> weights) {
  std::fill(values_.begin(), values_.end(), 0.0);
  for (const Scatter& scatter : scatters_) {
    const double weight = weights[scatter.weight];
    const double* from = blocks.block(scatter.group, scatter.block).data();
    for (std::size_t e = 0; e < scatter.position.size(); ++e) {
      values_[static_cast<std::size_t>(scatter.position[e])] += weight * from[e];
    }
  }
  for (const Fixed& fixed : fixed_) {
    for (std::size_t i = 0; i < fixed.position.size(); ++i) {
      values_[static_cast<std::size_t>(fixed.position[i])] += weights[fixed.weight] * fixed.scale[i];
    }
  }
}

std::vector<Index> shifted(Index count, Index offset) {
  std::vector<Index> map(static_cast<std::size_t>(count));
  std::iota(map.begin(), map.end(), offset);
  return map;
}

std::vector<Index> selected(Index count, std::span<const Index> list, Index offset) {
  std::vector<Index> map(static_cast<std::size_t>(count), -1);
  for (std::size_t k = 0; k < list.size(); ++k) map[static_cast<std::size_t>(list[k])] = offset + static_cast<Index>(k);
  return map;
}

}  // namespace bramah
