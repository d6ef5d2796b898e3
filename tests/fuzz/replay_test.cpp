// Every input of the corpus, and every shipped scene, through its target: what fuzzing has found stays found.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "fuzz/targets.hpp"

namespace bramah {
namespace {

namespace fs = std::filesystem;

std::size_t replay(const fs::path& folder, void (*target)(const std::uint8_t*, std::size_t)) {
  std::size_t count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ostringstream text;
    text << std::ifstream(entry.path(), std::ios::binary).rdbuf();
    const std::string bytes = text.str();
    SCOPED_TRACE(entry.path().string());
    EXPECT_NO_THROW(target(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()));
    ++count;
  }
  return count;
}

const fs::path corpus = BRAMAH_SOURCE_DIR "/tests/fuzz/corpus";

TEST(Corpus, OfScenes) {
  EXPECT_GT(replay(corpus / "scene", fuzz::scene), 0U);
  EXPECT_GT(replay(BRAMAH_SOURCE_DIR "/scenes", fuzz::scene), 20U);
  EXPECT_GT(replay(BRAMAH_SOURCE_DIR "/tests/errors", fuzz::scene), 20U);
}
TEST(Corpus, OfCheckpoints) { EXPECT_GT(replay(corpus / "checkpoint", fuzz::checkpoint), 0U); }
TEST(Corpus, OfSettings) { EXPECT_GT(replay(corpus / "setting", fuzz::setting), 0U); }
TEST(Corpus, OfTables) { EXPECT_GT(replay(corpus / "tables", fuzz::tables), 0U); }

}  // namespace
}  // namespace bramah
