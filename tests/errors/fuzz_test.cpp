// Two thousand damaged copies of a real scene: whatever was done to it, reading and compiling it end, and end either
// well or in a SceneError whose faults are complete. The same damage on every machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/read_scene.hpp"
#include "support/machine.hpp"

namespace bramah {
namespace {

/// xorshift64*: the distributions of the standard library differ between implementations.
class Dice {
 public:
  std::size_t below(std::size_t count) {
    state_ ^= state_ >> 12U;
    state_ ^= state_ << 25U;
    state_ ^= state_ >> 27U;
    return static_cast<std::size_t>((state_ * 0x2545F4914F6CDD1DULL) >> 33U) % count;
  }

 private:
  std::uint64_t state_ = 0x9E3779B97F4A7C15ULL;
};

/// Begin and length of every text, number, word and mark.
std::vector<std::pair<std::size_t, std::size_t>> tokens(std::string_view text) {
  std::vector<std::pair<std::size_t, std::size_t>> list;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i + 1;
    if (text[i] == '"') {
      end = std::min(text.find('"', i + 1), text.size() - 1) + 1;
    } else if (std::string_view("{}[],: \n").find(text[i]) == std::string_view::npos) {
      end = std::min(text.find_first_of("{}[],: \n\"", i), text.size());
    }
    if (text[i] != ' ' && text[i] != '\n') list.emplace_back(i, end - i);
    i = end;
  }
  return list;
}

std::string damaged(std::string text, Dice& dice) {
  for (std::size_t wounds = 1 + dice.below(3); wounds > 0; --wounds) {
    const auto all = tokens(text);
    const auto [begin, length] = all[dice.below(all.size())];
    const auto [other, other_length] = all[dice.below(all.size())];
    const std::string one = text.substr(begin, length), two = text.substr(other, other_length);
    const std::size_t at = dice.below(text.size());
    switch (dice.below(7)) {
      case 0: text[at] = static_cast<char>(static_cast<unsigned char>(text[at]) ^ (1U << dice.below(8))); break;
      case 1: text.erase(at, 1 + dice.below(40)); break;
      case 2: text.insert(at, 1, static_cast<char>(dice.below(256))); break;
      case 3: text.erase(begin, length); break;
      case 4: text.insert(begin, two); break;
      case 5: text.replace(begin, length, two); break;
      default:  // swap
        if (begin >= other + other_length) {
          text.replace(begin, length, two).replace(other, other_length, one);
        } else if (other >= begin + length) {
          text.replace(other, other_length, one).replace(begin, length, two);
        }
    }
  }
  return text;
}

TEST(Fuzz, DamagedScenesEndInSceneErrors) {
  std::ifstream in(std::string(BRAMAH_SOURCE_DIR) + "/scenes/four_bar/overdamped.json");
  const std::string sound{std::istreambuf_iterator<char>(in), {}};
  ASSERT_FALSE(sound.empty());
  const auto registry = testing::registry();
  const auto begin = std::chrono::steady_clock::now();
  Dice dice;
  int accepted = 0, refused = 0, compiled = 0;
  for (int k = 0; k < 2000; ++k) {
    const std::string text = damaged(sound, dice);
    bool is_read = false;
    try {
      std::vector<Diagnostic> of_shape;
      const Scene scene = read_scene_text(text, "damaged.json", &of_shape);
      is_read = true;
      compile(scene, registry, of_shape);
      ++accepted;
    } catch (const SceneError& error) {
      ++refused;
      if (is_read) ++compiled;
      ASSERT_FALSE(error.diagnostics().empty()) << text;
      for (const Diagnostic& fault : error.diagnostics()) {
        ASSERT_FALSE(fault.code.empty() || fault.found.empty() || fault.expected.empty() || fault.remedy.empty())
            << render({"damaged.json", text}, error);
      }
      ASSERT_FALSE(render({"damaged.json", text}, error).empty());
    }
  }
  // Damage of every depth: to the syntax, to the meaning, and none that matters.
  EXPECT_GT(accepted, 20);
  EXPECT_GT(compiled, 50);
  EXPECT_GT(refused - compiled, 200);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::minutes(2));
}

}  // namespace
}  // namespace bramah
