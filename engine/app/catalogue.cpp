#include "app/catalogue.hpp"

#include "app/context.hpp"
#include "io/read_scene.hpp"

namespace bramah {

Catalogue load_catalogue() {
  Catalogue catalogue;
  for (const std::string& name : catalogue.registry.available()) {
    try {
      catalogue.registry.load(name);
    } catch (const PluginError& error) {
      catalogue.problems.emplace_back(error.what());
      Diagnostic warning;
      warning.code = error.code();
      warning.found = error.found();
      warning.expected = error.expected();
      warning.remedy = error.remedy();
      warning.severity = Diagnostic::Severity::warning;
      say(render({"library " + name, ""}, SceneError(warning)));
    }
  }
  return catalogue;
}

}  // namespace bramah
