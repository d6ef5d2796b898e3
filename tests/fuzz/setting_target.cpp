#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "fuzz/targets.hpp"
#include "io/read_scene.hpp"
#include "system/compile.hpp"

namespace bramah::fuzz {

void setting(const std::uint8_t* data, std::size_t size) {
  static const auto registry = std::make_shared<Registry>();
  static const Scene original = read_scene(BRAMAH_SOURCE_DIR "/scenes/four_bar/overdamped.json");
  std::istringstream lines(std::string(reinterpret_cast<const char*>(data), size));
  Scene scene = original;
  std::vector<std::string> over;
  try {
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("over ")) {
        over.push_back(line.substr(5));
      } else {
        apply_setting(scene, line);
      }
    }
    apply_sweep(scene, over);
    compile(scene, registry);
  } catch (const SceneError& error) {
    render(scene.source, error);
  }
}

}  // namespace bramah::fuzz
