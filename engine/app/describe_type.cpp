#include "app/describe_type.hpp"

#include <cmath>
#include <span>

#include "io/json_writer.hpp"
#include "io/tables.hpp"
#include "system/energies.hpp"

namespace bramah {
namespace {

template <class T>
std::span<const T> list(const T* first, std::int32_t count) {
  return {first, static_cast<std::size_t>(count)};
}
std::string safe(const char* text) { return text == nullptr ? "" : text; }

std::vector<std::string> choices(const bramah_parameter_info& p) {
  std::vector<std::string> words;
  for (const char* const* choice = p.choices; choice != nullptr && *choice != nullptr; ++choice)
    words.emplace_back(*choice);
  return words;
}

std::string kind(const bramah_parameter_info& p) {
  switch (p.kind) {
    case BRAMAH_VECTOR: return std::to_string(p.count) + " numbers";
    case BRAMAH_LIST: return "list";
    case BRAMAH_CHOICE: return "choice";
    case BRAMAH_TEXT: return "text";
    default: return "number";
  }
}

std::string limits(const bramah_parameter_info& p) {
  if (p.kind == BRAMAH_CHOICE) {
    std::string text;
    for (const std::string& word : choices(p)) text += (text.empty() ? "" : " | ") + word;
    return text;
  }
  if (p.kind == BRAMAH_TEXT) return "";
  std::string text;
  if (std::isfinite(p.lower)) text = (p.lower_open != 0 ? "> " : ">= ") + short_number(p.lower);
  if (std::isfinite(p.upper))
    text += (text.empty() ? "" : ", ") + std::string(p.upper_open != 0 ? "< " : "<= ") + short_number(p.upper);
  return text;
}

std::string fallback(const bramah_parameter_info& p) {
  if (p.required != 0) return "required";
  if (p.kind == BRAMAH_TEXT) return '"' + safe(p.default_text) + '"';
  const std::span<const double> numbers(p.default_numbers,
                                        static_cast<std::size_t>(p.default_numbers == nullptr ? 0 : p.default_count));
  if (p.kind == BRAMAH_CHOICE && !numbers.empty()) return choices(p).at(static_cast<std::size_t>(numbers[0]));
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : ", ") + short_number(number, 10);
  return p.kind == BRAMAH_NUMBER ? text : "[" + text + "]";
}

/// What must be written at least.
std::string sample(const bramah_type& type) {
  std::string text = "  \"NAME\": { \"type\": \"" + std::string(type.name) + "\"";
  for (const auto& port : list(type.ports, type.port_count)) {
    if (port.required != 0) text += ", \"" + safe(port.name) + "\": \"...\"";
  }
  for (const auto& p : list(type.parameters, type.parameter_count)) {
    if (p.required == 0) continue;
    const bool plain = p.kind == BRAMAH_NUMBER && safe(p.unit) != "1";
    const std::string content = p.kind == BRAMAH_VECTOR || p.kind == BRAMAH_LIST ? "[...]"
                                : plain                                          ? "\"... " + safe(p.unit) + '"'
                                : p.kind == BRAMAH_NUMBER                        ? "..."
                                                                                 : "\"...\"";
    text += ", \"" + safe(p.name) + "\": " + content;
  }
  return text + " }\n";
}

void section(std::string& out, const char* heading, const Table& table) {
  if (!table.rows.empty()) out += std::string("\n") + heading + "\n" + as_text(table);
}

Table row_table(std::span<const bramah_row_info> rows) {
  Table table;
  for (const auto& row : rows) table.rows.push_back({safe(row.name), safe(row.unit), safe(row.doc)});
  return table;
}

std::span<const bramah_limit_info> limits_of(const bramah_type& type) {
  const auto* validity = extension<bramah_validity>(type, BRAMAH_EXTENSION_VALIDITY);
  return validity == nullptr ? std::span<const bramah_limit_info>{} : list(validity->info, validity->count);
}

}  // namespace

std::string type_text(const Registry& registry, const bramah_type& type) {
  const LoadedLibrary& home = registry.library_of(type);
  std::string out = safe(type.name) + ": " + safe(type.doc) + "\nfrom library " + home.library->name + " " +
                    home.library->version + '\n';
  Table ports, parameters, variables, terminals;
  for (const auto& p : list(type.ports, type.port_count)) {
    ports.rows.push_back(
        {safe(p.name), safe(p.kind), safe(p.unit), p.required != 0 ? "required" : "optional", safe(p.doc)});
  }
  for (const auto& p : list(type.parameters, type.parameter_count)) {
    parameters.rows.push_back({safe(p.name), kind(p), safe(p.unit), limits(p), fallback(p), safe(p.doc)});
  }
  if (!parameters.rows.empty()) parameters.header = {"name", "kind", "unit", "limits", "default", "meaning"};
  for (const auto& v : list(type.variables, type.variable_count)) {
    variables.rows.push_back({safe(v.name), v.family == BRAMAH_X ? "coordinate" : "first order", safe(v.unit),
                              "nominal " + short_number(v.nominal), safe(v.doc)});
  }
  for (const auto& t : list(type.terminals, type.terminal_count))
    terminals.rows.push_back({safe(t.name), safe(t.kind), safe(t.unit), safe(t.doc)});
  section(out, "Ports: what it connects to", ports);
  section(out, "Parameters", parameters);
  section(out, "Variables it brings", variables);
  section(out, "Terminals: what others connect to", terminals);
  section(out, "Holonomic rows", row_table(list(type.holonomic, type.holonomic_count)));
  section(out, "Nonholonomic rows", row_table(list(type.nonholonomic, type.nonholonomic_count)));
  section(out, "Outputs", row_table(list(type.outputs, type.output_count)));
  Table validity;
  for (const bramah_limit_info& limit : limits_of(type)) {
    const auto bound = [&](double value) { return with_unit(short_number(value), safe(limit.unit)); };
    std::string holds = (std::isfinite(limit.lower) ? "from " + bound(limit.lower) : std::string()) +
                        (std::isfinite(limit.lower) && std::isfinite(limit.upper) ? " " : "") +
                        (std::isfinite(limit.upper) ? "to " + bound(limit.upper) : std::string());
    const bool warns = limit.lowest < limit.lower || limit.highest > limit.upper;
    const double end = limit.lowest < limit.lower ? limit.lowest : limit.highest;
    holds +=
        !warns ? ", a run ends there" : ", a warning beyond" + (std::isfinite(end) ? ", the end at " + bound(end) : "");
    validity.rows.push_back({safe(limit.name), holds, safe(limit.doc)});
  }
  section(out, "Where its law holds", validity);
  if (says_energy(type)) out += "\nSays what it stores: NAME.energy\n";
  return out + "\nIn a scene\n" + sample(type);
}

std::string type_document(const Registry& registry, const bramah_type& type) {
  const LoadedLibrary& home = registry.library_of(type);
  JsonWriter json;
  json.begin_object().member("type", safe(type.name)).member("doc", safe(type.doc));
  json.member("library", home.library->name).member("version", home.library->version);
  json.key("ports").begin_list();
  for (const auto& p : list(type.ports, type.port_count)) {
    json.begin_flat_object().member("name", safe(p.name)).member("kind", safe(p.kind)).member("unit", safe(p.unit));
    json.member("required", p.required != 0).member("doc", safe(p.doc)).end_object();
  }
  json.end_list().key("parameters").begin_list();
  for (const auto& p : list(type.parameters, type.parameter_count)) {
    json.begin_flat_object().member("name", safe(p.name)).member("kind", kind(p)).member("unit", safe(p.unit));
    json.member("lower", p.lower)
        .member("lower_open", p.lower_open != 0)
        .member("upper", p.upper)
        .member("upper_open", p.upper_open != 0);
    json.member("required", p.required != 0).key("default");
    p.required != 0 ? json.null() : json.value(fallback(p));
    json.key("choices").values(choices(p)).member("doc", safe(p.doc)).end_object();
  }
  json.end_list().key("variables").begin_list();
  for (const auto& v : list(type.variables, type.variable_count)) {
    json.begin_flat_object()
        .member("name", safe(v.name))
        .member("order", v.family == BRAMAH_X ? 2 : 1)
        .member("unit", safe(v.unit));
    json.member("nominal", v.nominal).member("start", v.start).member("doc", safe(v.doc)).end_object();
  }
  json.end_list().key("terminals").begin_list();
  for (const auto& t : list(type.terminals, type.terminal_count)) {
    json.begin_flat_object()
        .member("name", safe(t.name))
        .member("kind", safe(t.kind))
        .member("unit", safe(t.unit))
        .member("doc", safe(t.doc))
        .end_object();
  }
  json.end_list();
  const auto rows = [&](const char* name, std::span<const bramah_row_info> infos) {
    json.key(name).begin_list();
    for (const auto& row : infos) {
      json.begin_flat_object()
          .member("name", safe(row.name))
          .member("unit", safe(row.unit))
          .member("doc", safe(row.doc))
          .end_object();
    }
    json.end_list();
  };
  rows("holonomic_rows", list(type.holonomic, type.holonomic_count));
  rows("nonholonomic_rows", list(type.nonholonomic, type.nonholonomic_count));
  rows("outputs", list(type.outputs, type.output_count));
  json.key("validity").begin_list();
  for (const bramah_limit_info& limit : limits_of(type)) {
    json.begin_flat_object().member("name", safe(limit.name)).member("unit", safe(limit.unit));
    json.member("lower", limit.lower).member("upper", limit.upper);
    json.member("lowest", limit.lowest).member("highest", limit.highest).member("doc", safe(limit.doc)).end_object();
  }
  json.end_list();
  json.member("says_energy", says_energy(type));
  json.end_object();
  return json.take();
}

}  // namespace bramah
