#include <memory>
#include <string_view>

#include "fuzz/targets.hpp"
#include "io/read_scene.hpp"
#include "system/analysis_error.hpp"
#include "system/compile.hpp"

namespace bramah::fuzz {

void scene(const std::uint8_t* data, std::size_t size) {
  static const auto registry = std::make_shared<Registry>();  // libraries are opened once
  const Source source{"fuzz.json", std::string(reinterpret_cast<const char*>(data), size)};
  try {
    std::vector<Diagnostic> of_shape;
    const Scene read = read_scene_text(source.text, source.name, &of_shape);
    const Compiled compiled = compile(read, registry, std::move(of_shape));
    initial_state(compiled.system, compiled.options.simulate.from_time);
  } catch (const SceneError& error) {
    render(source, error);
  } catch (const AnalysisError& error) {
    render(source, error);
  }
}

}  // namespace bramah::fuzz
