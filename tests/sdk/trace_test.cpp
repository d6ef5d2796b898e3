#include "bramah/trace.hpp"

#include <gtest/gtest.h>

#include "bramah/math.hpp"

namespace bramah {
namespace {

/// Seeds 0, 1, 2 in letters: "ab" depends on the first two; capitals where nonlinearly.
std::string seen(const Trace& t) {
  std::string text;
  for (std::size_t k = 0; k < 3; ++k) {
    if (t.nonlinear().test(k)) {
      text += static_cast<char>('A' + k);
    } else if (t.depends().test(k)) {
      text += static_cast<char>('a' + k);
    }
  }
  return text;
}
const Trace a = Trace::seed(0.3, 0), b = Trace::seed(0.5, 1), c = Trace::seed(0.7, 2);

TEST(TraceTest, LinearOperations) {
  EXPECT_EQ(seen(a), "a");
  EXPECT_EQ(seen(Trace(4.0)), "");
  EXPECT_EQ(seen(a + b), "ab");
  EXPECT_EQ(seen(a - c), "ac");
  EXPECT_EQ(seen(-b), "b");
  EXPECT_EQ(seen(2.0 * a + 1.0), "a");
  EXPECT_EQ(seen(1.0 - a / 2.0), "a");
  EXPECT_EQ(seen(1.0 + a * 2.0 - 3.0), "a");
  EXPECT_EQ(seen(a * Trace(2.0) + Trace(2.0) * b), "ab") << "a constant in disguise";
  EXPECT_EQ(seen(a / Trace(2.0)), "a");
}

TEST(TraceTest, NonlinearOperations) {
  EXPECT_EQ(seen(a * b), "AB");
  EXPECT_EQ(seen(a * b + c), "ABc");
  EXPECT_EQ(seen(a / b), "AB");
  EXPECT_EQ(seen(1.0 / a), "A");
  EXPECT_EQ(seen(sin(a) + b), "Ab");
  EXPECT_EQ(seen(pow(a, 1.5)), "A");
  EXPECT_EQ(seen(square(a) - b), "Ab");
}

TEST(TraceTest, KeepsNumbersAndInPlace) {
  Trace t = a;
  t += b;
  t *= c;
  t -= a;
  EXPECT_DOUBLE_EQ(t.number(), 0.8 * 0.7 - 0.3);
  EXPECT_EQ(seen(t), "ABC");
}

TEST(TraceTest, NotesComparisons) {
  Trace::compared() = false;
  (void)(sin(a) * b / c + sqrt(a) + pow(b, 2.0));
  EXPECT_FALSE(Trace::compared());
  (void)max(a, b);
  EXPECT_TRUE(Trace::compared());
  Trace::compared() = false;
  (void)abs(a);
  EXPECT_TRUE(Trace::compared());
  Trace::compared() = false;
}

}  // namespace
}  // namespace bramah
