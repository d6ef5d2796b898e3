#include <memory>

#include "fuzz/targets.hpp"
#include "io/checkpoint.hpp"
#include "io/read_scene.hpp"
#include "system/compile.hpp"

namespace bramah::fuzz {

void checkpoint(const std::uint8_t* data, std::size_t size) {
  static const Compiled compiled =
      compile(read_scene(BRAMAH_SOURCE_DIR "/scenes/four_bar/overdamped.json"), std::make_shared<Registry>());
  const Source source{"checkpoint.json", std::string(reinterpret_cast<const char*>(data), size)};
  try {
    const Checkpoint read = read_checkpoint(compiled.system, source);
    checkpoint_text(compiled.system, read);
  } catch (const SceneError& error) {
    render(source, error);
  }
}

}  // namespace bramah::fuzz
