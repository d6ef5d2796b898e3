#include "support/reference.hpp"

#include <fstream>
#include <stdexcept>

namespace bramah::testing {

nlohmann::json reference(const std::string& file) {
  std::ifstream in(std::string(BRAMAH_SOURCE_DIR) + "/tests/reference/" + file);
  if (!in) throw std::runtime_error("cannot read reference " + file);
  return nlohmann::json::parse(in);
}

}  // namespace bramah::testing
