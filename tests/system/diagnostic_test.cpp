#include "system/diagnostic.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace bramah {
namespace {

using Words = std::vector<std::string>;

TEST(Closest, FindsSlipsOfTheFinger) {
  const Words words = {"volume", "V_h", "B_h", "B_oil"};
  EXPECT_EQ(closest("volum", words), "volume");    // one left out
  EXPECT_EQ(closest("volumee", words), "volume");  // one too many
  EXPECT_EQ(closest("vokume", words), "volume");   // one wrong
  EXPECT_EQ(closest("voluem", words), "volume");   // two swapped
  EXPECT_EQ(closest("volume", words), "volume");
  EXPECT_EQ(closest("B_iol", words), "B_oil");
}

TEST(Closest, SwapCountsOnce) {
  EXPECT_EQ(closest("tpy", {"typ"}), "typ");  // two substitutions would be too many for three letters
}

TEST(Closest, GivesUpBeyondAThird) {
  EXPECT_EQ(closest("xyz", {"volume", "abc"}), "");
  EXPECT_EQ(closest("vulome", {"volume"}), "volume");  // two of six
  EXPECT_EQ(closest("vulima", {"volume"}), "");        // three of six
  EXPECT_EQ(closest("p", {"q"}), "");
  EXPECT_EQ(closest("", {"a", ""}), "");
  EXPECT_EQ(closest("a", {}), "");
  EXPECT_EQ(closest(std::string(100000, 'a'), {std::string(100000, 'b')}), "");
}

TEST(Closest, ForgivesCase) {
  EXPECT_EQ(closest("d_2", {"D_3", "D_2"}), "D_2");
  EXPECT_EQ(closest("VOLUME", {"value", "volume"}), "volume");
  EXPECT_EQ(closest("b_h", {"B_H", "B_h"}), "B_h");  // the fewer capitals differ the better
}

TEST(Closest, TakesTheNearestThenTheFirst) {
  EXPECT_EQ(closest("mases", {"masses", "massed", "mass"}), "masses");
  EXPECT_EQ(closest("abcd", {"abcx", "abcy"}), "abcx");
}

TEST(Suggestion, AsksOrFallsBack) {
  EXPECT_EQ(suggestion("volum", {"volume"}, "look it up"), "did you mean \"volume\"?");
  EXPECT_EQ(suggestion("xyz", {"volume"}, "look it up"), "look it up");
}

TEST(QuotedList, StopsAtMost) {
  EXPECT_EQ(quoted_list({}), "");
  EXPECT_EQ(quoted_list({"a"}), "\"a\"");
  EXPECT_EQ(quoted_list({"a", "b", "c"}), "\"a\", \"b\", \"c\"");
  EXPECT_EQ(quoted_list({"a", "b", "c"}, 3), "\"a\", \"b\", \"c\"");
  EXPECT_EQ(quoted_list({"a", "b", "c"}, 2), "\"a\", \"b\", ... (3 in all)");
  EXPECT_EQ(quoted_list({"a", "b"}, 0), "... (2 in all)");
}

TEST(SceneErrorTest, WhatJoinsEverything) {
  Diagnostic first;
  first.code = "unknown-key";
  first.pointer = "/components/V2/volum";
  first.found = "unknown key \"volum\"";
  first.expected = "one of: volume";
  first.remedy = "did you mean \"volume\"?";
  Diagnostic second;
  second.found = "nothing to do";
  second.severity = Diagnostic::Severity::warning;
  const SceneError error({first, second});
  EXPECT_STREQ(error.what(),
               "/components/V2/volum: unknown key \"volum\"; expected one of: volume; did you mean \"volume\"?\n"
               "warning: nothing to do");
  ASSERT_EQ(error.diagnostics().size(), 2U);
  EXPECT_EQ(error.diagnostics()[0].code, "unknown-key");
}

TEST(SceneErrorTest, TakesOneDiagnostic) {
  Diagnostic only;
  only.found = "x";
  const SceneError error(only);
  EXPECT_STREQ(error.what(), "x");
  EXPECT_EQ(error.diagnostics().size(), 1U);
}

}  // namespace
}  // namespace bramah
