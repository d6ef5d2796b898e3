#include "app/catalogue.hpp"
#include "app/context.hpp"
#include "app/failure.hpp"
#include "app/verbs.hpp"
#include "io/json_writer.hpp"
#include "io/tables.hpp"

namespace bramah {
namespace {

int run(const Arguments& arguments) {
  const Catalogue catalogue = load_catalogue();
  JsonWriter json;
  std::string out;
  json.begin_object().key("libraries").begin_list();
  for (const auto& [name, loaded] : catalogue.registry.libraries()) {
    const bramah_library& library = *loaded.library;
    json.begin_object().member("name", name).member("version", library.version).member("made_with", library.made_with);
    json.member("file", loaded.file.string()).key("types").begin_list();
    out += (out.empty() ? "" : "\n") + name + " " + library.version + "   " + loaded.file.string() + '\n';
    Table table;
    for (const bramah_type* type : catalogue.registry.types()) {
      if (catalogue.registry.library_of(*type).library != &library) continue;
      json.begin_flat_object().member("type", type->name).member("doc", type->doc).end_object();
      table.rows.push_back({type->name, type->doc});
    }
    out += as_text(table);
    json.end_list().end_object();
  }
  json.end_list().key("problems").values(catalogue.problems).end_object();
  if (out.empty())
    out = "no libraries found; set BRAMAH_PLUGIN_PATH to the folder that holds them\n";
  else
    out += "\n`bramah describe TYPE` tells ports and parameters of one.\n";
  deliver(arguments, "list.json", json.take(), out);
  return exit_ok;
}

}  // namespace

constinit const Verb verb_list = {
    "list", "", "list the component types of all libraries that can be found",
    R"(Prints every component type with one line of documentation, library by library. Libraries are looked for in the
folders of BRAMAH_PLUGIN_PATH (separated by colons), then in lib/bramah/plugins beside the program.

Example
  bramah list
)",
    run};

}  // namespace bramah
