#include "io/read_scene.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

namespace bramah {
namespace {

namespace fs = std::filesystem;

Scene read(std::string_view text) { return read_scene_text(text, "test.json"); }

// Every fault of the text, none where it is accepted.
std::vector<Diagnostic> faults(std::string_view text) {
  try {
    read(text);
  } catch (const SceneError& error) {
    for (const Diagnostic& diagnostic : error.diagnostics()) {
      EXPECT_FALSE(diagnostic.code.empty());
      EXPECT_FALSE(diagnostic.found.empty());
      EXPECT_FALSE(diagnostic.expected.empty()) << diagnostic.found;
      EXPECT_FALSE(diagnostic.remedy.empty()) << diagnostic.found;
    }
    return error.diagnostics();
  }
  return {};
}

Diagnostic only_fault(std::string_view text) {
  const std::vector<Diagnostic> all = faults(text);
  EXPECT_EQ(all.size(), 1U) << text.substr(0, 200);
  return all.empty() ? Diagnostic{} : all.front();
}

std::vector<std::string> codes(std::string_view text) {
  std::vector<std::string> result;
  for (const Diagnostic& diagnostic : faults(text)) result.push_back(diagnostic.code);
  return result;
}

// "line:column" of a diagnostic.
std::string place(std::string_view text, const Diagnostic& diagnostic) {
  const Place at = locate({"test.json", std::string(text)}, diagnostic);
  return std::to_string(at.line) + ':' + std::to_string(at.column);
}

std::string place_of(std::string_view text, std::string pointer, bool at_key = false) {
  Diagnostic diagnostic;
  diagnostic.pointer = std::move(pointer);
  diagnostic.at_key = at_key;
  return place(text, diagnostic);
}

// A scene with `members` beside the version.
std::string scene_with(std::string_view members) { return R"({"bramah": 1, )" + std::string(members) + "}"; }

using Codes = std::vector<std::string>;

// ---- what is read ----

TEST(ReadScene, BuildsTheValue) {
  const Scene scene = read(R"(// a comment
    { "bramah": 1, /* another */ "libraries": ["mechanics"],
      "components": { "V2": { "type": "hydraulics/volume", "p": -1.5e5, "on": true, "off": false, "none": null,
                              "list": [1, [2, "x"], {}] } } })");
  EXPECT_EQ(scene.source.name, "test.json");
  ASSERT_NE(scene.root.object(), nullptr);
  ASSERT_EQ(scene.root.object()->size(), 3U);
  EXPECT_EQ((*scene.root.object())[1].key, "libraries");
  const Value& volume = *scene.root.find("components")->find("V2");
  EXPECT_EQ(*volume.find("type")->text(), "hydraulics/volume");
  EXPECT_EQ(*volume.find("p")->number(), -1.5e5);
  EXPECT_TRUE(*volume.find("on")->boolean());
  EXPECT_FALSE(*volume.find("off")->boolean());
  EXPECT_TRUE(std::holds_alternative<std::monostate>(volume.find("none")->data));
  const Value::List& list = *volume.find("list")->list();
  ASSERT_EQ(list.size(), 3U);
  EXPECT_EQ(*list[0].number(), 1.0);
  EXPECT_EQ(*(*list[1].list())[1].text(), "x");
  EXPECT_TRUE(list[2].object()->empty());
}

TEST(ReadScene, ReadsNumbersOfEveryForm) {
  const Scene scene = read(scene_with(
      R"("simulate": {"a": 0, "b": -0.0, "c": 18446744073709551615, "d": -9223372036854775808, "e": 1e-999,
          "f": 123456789012345678901234567890, "g": 1.7976931348623157e308, "h": 0.1})"));
  const Value& s = *scene.root.find("simulate");
  EXPECT_EQ(*s.find("a")->number(), 0.0);
  EXPECT_TRUE(std::signbit(*s.find("b")->number()));
  EXPECT_EQ(*s.find("c")->number(), 18446744073709551616.0);
  EXPECT_EQ(*s.find("d")->number(), -9223372036854775808.0);
  EXPECT_EQ(*s.find("e")->number(), 0.0);
  EXPECT_EQ(*s.find("f")->number(), 123456789012345678901234567890.0);
  EXPECT_EQ(*s.find("g")->number(), std::numeric_limits<double>::max());
  EXPECT_EQ(*s.find("h")->number(), 0.1);
}

TEST(ReadScene, AcceptsEveryTopLevelMember) {
  EXPECT_EQ(codes(scene_with(R"("title": "t", "description": "d", "libraries": ["a"], "constants": {}, "components": {},
      "start": {}, "hold": ["a.b"], "outputs": [], "equilibrium": {}, "simulate": {}, "linearize": {}, "study": {},
      "compare": {}, "sweep": {}, "vary": {})")),
            Codes{});
}

TEST(ReadScene, AcceptsAByteOrderMarkAndWindowsLines) {
  const std::string text = "\xEF\xBB\xBF{\r\n\"bramah\": 1,\r\n\"titel\": 2}";
  const Diagnostic fault = only_fault(text);
  EXPECT_EQ(place(text, fault), "3:1");
  EXPECT_EQ(place_of(text, ""), "1:1");
  EXPECT_EQ(codes("\xEF\xBB\xBF{\"bramah\": 1}"), Codes{});
}

// ---- syntax ----

TEST(ReadScene, ReportsSyntax) {
  const auto expect = [](std::string_view text, std::string_view where, std::string_view found,
                         std::string_view remedy) {
    const Diagnostic fault = only_fault(text);
    EXPECT_EQ(fault.code, "syntax") << text;
    EXPECT_GE(fault.byte, 0) << text;
    EXPECT_EQ(place(text, fault), where) << text;
    EXPECT_EQ(fault.found, found) << text;
    EXPECT_EQ(fault.remedy, remedy) << text;
  };
  expect("{\"bramah\": 1,\n \"hold\": [1, 2, ] }", "2:17", "unexpected ']'", "remove the comma before it");
  expect("{\"bramah\": 1,\n}", "2:1", "unexpected '}'", "remove the comma before it");
  expect("{\"bramah\": }", "1:12", "unexpected '}'", "complete what stands before it, or remove it");
  expect("{\"bramah\": 1\n  \"title\": 2}", "2:3", "unexpected string literal", "put a comma before it");
  expect(R"({"hold": ["one" "two"]})", "1:17", "unexpected string literal", "put a comma before it");
  expect("{\"bramah\" 1}", "1:11", "unexpected number literal", "write \"key\": value");
  expect("{1: 2}", "1:2", "unexpected number literal", "put the key in double quotes");
  expect("{bramah: 1}", "1:2", "invalid literal", "put the key in double quotes");
  expect("{\"bramah\": one}", "1:12", "invalid literal",
         "put texts in double quotes; the only bare words are true, false and null");
  expect("{\"bramah\": NaN}", "1:12", "invalid literal",
         "put texts in double quotes; the only bare words are true, false and null");
  expect("{\"bramah\": -}", "1:13", "invalid number; expected digit after '-'", "write numbers like 0.5 or -1.5e3");
  expect("{\"bramah\": \"one\n}", "1:16",
         "invalid string: control character U+000A (LF) must be escaped to \\u000A or \\n",
         "close the text with a double quote on its line");
  expect(R"({"bramah": "C:\dir"})", "1:16", "invalid string: forbidden character after backslash",
         "write a backslash as \\\\");
  expect("{\"bramah\": 1", "1:13", "unexpected end of input in the object that begins in line 1",
         "close what is still open; the end of the file may be lost");
  expect("{\n\"hold\":\n[", "3:2", "unexpected end of input in the list that begins in line 3",
         "close what is still open; the end of the file may be lost");
  expect("{\"bramah\": 1} }", "1:15", "unexpected '}'", "complete what stands before it, or remove it");
  expect("{\"bramah\": 1} /* open", "1:22", "invalid comment; missing closing '*/'",
         "comments are // to the end of the line, or /* ... */");
}

TEST(ReadScene, NamesWhatIsExpected) {
  EXPECT_EQ(only_fault("{\"a\": 1 2}").expected, "a comma or \"}\"");
  EXPECT_EQ(only_fault("[1 2]").expected, "a comma or \"]\"");
  EXPECT_EQ(only_fault("{\"a\" 1}").expected, "a colon after the key");
  EXPECT_EQ(only_fault("{a: 1}").expected, "a key in double quotes");
  EXPECT_EQ(only_fault("{} {}").expected, "nothing after the end of the scene");
  EXPECT_EQ(only_fault("{\"a\": x}").expected,
            "a value: text in double quotes, number, true, false, null, list or object");
}

TEST(ReadScene, ReportsOneEmptyFile) {
  for (const char* text : {"", " \n\t ", "\xEF\xBB\xBF", "// nothing", "/* nothing */\n"}) {
    EXPECT_EQ(only_fault(text).code, "empty-file") << text;
  }
}

TEST(ReadScene, ReportsBytesThatAreNotUtf8) {
  for (const char* bytes : {"\xFF", "\xC3(", "\xED\xA0\x80", "\xC0\xAF", "\xF8\x88\x80\x80\x80"}) {
    const std::string text = "{\"bramah\": 1,\n \"title\": \"" + std::string(bytes) + "\"}";
    const Diagnostic fault = only_fault(text);
    EXPECT_EQ(fault.code, "not-utf8");
    EXPECT_EQ(fault.found, "a byte that is not UTF-8");
    EXPECT_EQ(place(text, fault).substr(0, 2), "2:");
  }
}

TEST(ReadScene, ReportsZeroBytes) {
  const std::string behind = std::string("{\"bramah\": 1}\0 garbage", 22);
  EXPECT_EQ(only_fault(behind).found, "a zero byte");
  EXPECT_EQ(only_fault(behind).byte, 13);
  EXPECT_EQ(only_fault(std::string("{\0\"\0", 4)).byte, 1);  // UTF-16
}

TEST(ReadScene, ReportsNumbersOutOfRange) {
  const std::string text =
      "{\"bramah\": 1,\n \"simulate\": {\"a\": 1e999,\n  \"b\": [-1e999], \"a\": 2}, \"hodl\": []}";
  const std::vector<Diagnostic> all = faults(text);
  ASSERT_EQ(codes(text), (Codes{"number-out-of-range", "number-out-of-range", "duplicate-key", "unknown-key"}));
  EXPECT_EQ(all[0].found, "number 1e999 is out of range");
  EXPECT_EQ(place(text, all[0]), "2:20");
  EXPECT_EQ(all[1].found, "number -1e999 is out of range");
  EXPECT_EQ(place(text, all[1]), "3:9");
  EXPECT_EQ(all[0].byte, static_cast<long long>(text.find("1e999")));
  EXPECT_EQ(only_fault(scene_with("\"study\": {\"a\": 9" + std::string(5000, '0') + "}")).code, "number-out-of-range");
}

TEST(ReadScene, StopsAfterManyNumbersOutOfRange) {
  std::string list = "1e999";
  for (int i = 0; i < 1000; ++i) list += ",1e999";
  const std::size_t count = faults(scene_with(R"("study": {"a": [)" + list + "]}")).size();
  EXPECT_GE(count, 10U);
  EXPECT_LE(count, 100U);
}

TEST(ReadScene, RefusesDeepNesting) {
  const auto nested = [](std::size_t depth) {  // the scene and its member count, too
    return R"({"bramah": 1, "study": {"a": )" + std::string(depth - 2, '[') + std::string(depth - 2, ']') + "}}";
  };
  EXPECT_EQ(codes(nested(64)), Codes{});
  const Diagnostic fault = only_fault(nested(65));
  EXPECT_EQ(fault.code, "too-deep");
  EXPECT_EQ(fault.expected, "at most 64 levels");
  EXPECT_EQ(fault.byte, 29 + 62);
  EXPECT_EQ(only_fault(nested(200000)).byte, 29 + 62);
  EXPECT_EQ(only_fault(std::string(200000, '[')).byte, 64);
  std::string objects;
  for (int i = 0; i < 200000; ++i) objects += "{\"a\":";
  EXPECT_EQ(only_fault(objects).code, "too-deep");
}

TEST(ReadScene, ReportsEveryRepeatedKey) {
  const std::string text =
      "{\"bramah\": 1,\n"
      " \"start\": {\"a\": 1, \"b\": 2, \"a\": 3},\n"
      " \"constants\": {\"a\": 1, \"\\u0061\": 2, \"a\": 3},\n"
      " \"start\": {\"a\": 1}}";
  const std::vector<Diagnostic> all = faults(text);
  ASSERT_EQ(codes(text), (Codes{"duplicate-key", "duplicate-key", "duplicate-key", "duplicate-key"}));
  EXPECT_EQ(place(text, all[0]), "2:28");
  EXPECT_EQ(all[0].found, "key \"a\" written twice");
  EXPECT_EQ(all[0].remedy, "rename or remove one; the first is in line 2");
  EXPECT_EQ(place(text, all[1]), "3:24");
  EXPECT_EQ(place(text, all[2]), "3:37");
  EXPECT_EQ(place(text, all[3]), "4:2");
  EXPECT_EQ(all[3].found, "key \"start\" written twice");
}

TEST(ReadScene, FindsRepeatedKeysInLargeObjects) {
  std::string members = "\"k0\": 0";
  for (int i = 1; i < 1000; ++i) members += ", \"k" + std::to_string(i) + "\": 0";
  EXPECT_EQ(codes(scene_with("\"start\": {" + members + "}")), Codes{});
  EXPECT_EQ(codes(scene_with("\"start\": {" + members + ", \"k500\": 1}")), Codes{"duplicate-key"});
}

TEST(ReadScene, SameKeyInDifferentObjectsIsFine) {
  EXPECT_EQ(codes(scene_with(R"("start": {"a": 1, "b": {"a": 1}}, "constants": {"a": [{"a": 1}, {"a": 1}]})")),
            Codes{});
}

TEST(ReadScene, ReportsRepeatedKeysBeforeASyntaxError) {
  EXPECT_EQ(codes("{\"a\": 1, \"a\": 2, \"b\" 3, \"b\": 4}"), (Codes{"syntax", "duplicate-key"}));
  EXPECT_EQ(codes("{\"ab\": 1, \"ab"), Codes{"syntax"});  // not a key yet
  const std::string deep = R"({"a": 1, "a": )" + std::string(70, '[');
  EXPECT_EQ(codes(deep), (Codes{"too-deep", "duplicate-key"}));
}

// ---- shape ----

TEST(ReadScene, WantsAnObject) {
  EXPECT_EQ(only_fault("[1, 2]").found, "the scene is list of 2");
  EXPECT_EQ(only_fault("3.5").found, "the scene is number 3.5");
  EXPECT_EQ(only_fault("null").code, "not-an-object");
}

TEST(ReadScene, WantsTheVersion) {
  const Diagnostic missing = only_fault("{}");
  EXPECT_EQ(missing.code, "missing-version");
  EXPECT_EQ(missing.remedy, "write \"bramah\": 1 as its first member");
  const std::string text = "{\n  \"bramah\": 2}";
  const Diagnostic wrong = only_fault(text);
  EXPECT_EQ(wrong.code, "wrong-version");
  EXPECT_EQ(wrong.found, "\"bramah\" is number 2");
  EXPECT_EQ(place(text, wrong), "2:13");
  EXPECT_EQ(only_fault("{\"bramah\": \"1\"}").found, "\"bramah\" is text \"1\"");
  EXPECT_EQ(only_fault("{\"bramah\": true}").code, "wrong-version");
}

TEST(ReadScene, ReportsUnknownTopLevelKeys) {
  const std::string text = scene_with("\n  \"component\": {}");
  const Diagnostic fault = only_fault(text);
  EXPECT_EQ(fault.code, "unknown-key");
  EXPECT_EQ(fault.found, "unknown key \"component\" of the scene");
  EXPECT_EQ(fault.remedy, "did you mean \"components\"?");
  EXPECT_EQ(fault.pointer, "/component");
  EXPECT_EQ(place(text, fault), "2:3");
  for (const char* key : {"\"bramah\"", "\"study\"", "\"compare\"", "\"outputs\""}) {
    EXPECT_NE(fault.expected.find(key), std::string::npos) << key;
  }
  EXPECT_EQ(only_fault(scene_with("\"zzzzzzz\": 1")).remedy, "remove it, or write it as a comment");
}

TEST(ReadScene, ReportsWrongKinds) {
  const auto expect = [](std::string_view member, std::string_view pointer, std::string_view found,
                         std::string_view expected) {
    const Diagnostic fault = only_fault(scene_with(member));
    EXPECT_EQ(fault.code, "wrong-kind") << member;
    EXPECT_EQ(fault.pointer, pointer);
    EXPECT_EQ(fault.found, found);
    EXPECT_EQ(fault.expected, expected);
  };
  expect(R"("title": 3)", "/title", "\"title\" is number 3", "text");
  expect(R"("description": [])", "/description", "\"description\" is list of 0", "text");
  expect(R"("libraries": "mechanics")", "/libraries", R"("libraries" is text "mechanics")", "a list of texts");
  expect(R"("hold": ["a", 3])", "/hold/1", "an element of \"hold\" is number 3", "text");
  expect(R"("outputs": {})", "/outputs", "\"outputs\" is object", "a list of texts");
  for (const char* key : {"constants", "components", "start", "equilibrium", "simulate", "linearize", "study",
                          "compare", "sweep", "vary"}) {
    const std::string name(key);
    expect('"' + name + "\": []", '/' + name, '"' + name + "\" is list of 0", "an object");
  }
}

TEST(ReadScene, WantsTypedComponents) {
  const std::string text = scene_with("\"components\": {\n \"a\": 3,\n \"b\": {},\n \"c\": {\"type\": 4}}");
  const std::vector<Diagnostic> all = faults(text);
  ASSERT_EQ(codes(text), (Codes{"wrong-kind", "missing-type", "wrong-kind"}));
  EXPECT_EQ(all[0].found, "component \"a\" is number 3");
  EXPECT_EQ(place(text, all[0]), "2:7");
  EXPECT_EQ(all[1].found, "component \"b\" has no \"type\"");
  EXPECT_EQ(place(text, all[1]), "3:2");
  EXPECT_EQ(all[2].found, "\"type\" of component \"c\" is number 4");
  EXPECT_EQ(all[2].pointer, "/components/c/type");
  EXPECT_EQ(place(text, all[2]), "4:16");
}

TEST(ReadScene, RefusesBadNames) {
  const auto fault_of = [](std::string_view name) {
    return only_fault(scene_with(R"("components": {")" + std::string(name) + R"(": {"type": "a/b"}})"));
  };
  EXPECT_EQ(fault_of("").found, "component name \"\" is empty");
  EXPECT_EQ(fault_of("a.b").found, "component name \"a.b\" contains a dot");
  EXPECT_EQ(fault_of("a/b").found, "component name \"a/b\" contains a slash");
  EXPECT_EQ(fault_of("a/b").pointer, "/components/a~1b");
  EXPECT_EQ(fault_of("a b").found, "component name \"a b\" contains a space");
  EXPECT_EQ(fault_of("a=b").found, "component name \"a=b\" contains an equals sign");
  EXPECT_EQ(fault_of("a\\tb").code, "bad-name");
  EXPECT_EQ(fault_of("a\\u0000b").code, "bad-name");
  EXPECT_EQ(fault_of("a\x7F").code, "bad-name");
  EXPECT_EQ(fault_of("a.b c").remedy, "call it for instance \"a_b_c\"");
  EXPECT_TRUE(fault_of("a.b").at_key);
  EXPECT_EQ(codes(scene_with(R"("components": {"Bär_2-b": {"type": "a/b"}})")), Codes{});
}

TEST(ReadScene, ReportsAllFaultsAtOnce) {
  EXPECT_EQ(codes(R"({"title": 1, "titel": 2, "hold": "x", "hold": [], "components": {"a.b": 1, "c": {}}})"),
            (Codes{"duplicate-key", "missing-version", "wrong-kind", "unknown-key", "wrong-kind", "bad-name",
                   "wrong-kind", "missing-type"}));
}

// ---- files ----

class Files : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("read_scene_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  static Diagnostic fault_of(const fs::path& file) {
    try {
      read_scene(file);
    } catch (const SceneError& error) {
      EXPECT_EQ(error.diagnostics().size(), 1U);
      return error.diagnostics().front();
    }
    ADD_FAILURE() << file << " was accepted";
    return {};
  }

  fs::path folder_;
};

TEST_F(Files, AreRead) {
  const std::string text = "{\"bramah\": 1,\n\"title\": \"" + std::string(3 << 20, 'x') + "\"}";
  const fs::path file = write("scene.json", text);
  const Scene scene = read_scene(file);
  EXPECT_EQ(scene.source.name, file.string());
  EXPECT_EQ(scene.source.text, text);
  EXPECT_EQ(scene.root.find("title")->text()->size(), std::size_t{3} << 20U);
  EXPECT_EQ(read_source(file).text, text);
}

TEST_F(Files, MayBeMissing) {
  ASSERT_TRUE(fs::exists(write("four_bar.json", "{}")));
  const Diagnostic fault = fault_of(folder_ / "four_bra.json");
  EXPECT_EQ(fault.code, "no-file");
  EXPECT_EQ(fault.remedy, "did you mean \"four_bar.json\"?");
  EXPECT_EQ(fault_of(folder_ / "nowhere" / "x.json").remedy, "check the path");
  EXPECT_EQ(fault_of("").code, "no-file");
}

TEST_F(Files, MayBeDirectories) {
  EXPECT_EQ(fault_of(folder_).found, "this is a directory");
  EXPECT_EQ(fault_of(folder_).code, "unreadable-file");
}

TEST_F(Files, MayBeUnreadable) {
  const fs::path file = write("secret.json", "{}");
  fs::permissions(file, fs::perms::none);
  // Root reads everything: step down for the attempt.
  const bool root = geteuid() == 0;
  if (root) {
    ASSERT_EQ(seteuid(65534), 0);
  }
  const std::string code = fault_of(file).code;
  if (root) {
    ASSERT_EQ(seteuid(0), 0);
  }
  EXPECT_EQ(code, "unreadable-file");
}

TEST_F(Files, MayFailWhileBeingRead) {
  const fs::path file = "/proc/self/mem";  // opens, but has nothing at address 0
  EXPECT_EQ(fault_of(file).code, "unreadable-file");
}

TEST_F(Files, MayBeTooBig) {
  const fs::path file = write("big.json", "");
  fs::resize_file(file, (std::uintmax_t{1} << 30U) + 1);  // a hole: takes no space
  EXPECT_EQ(fault_of(file).code, "too-big");
}

TEST_F(Files, MayBeEmpty) { EXPECT_EQ(fault_of(write("empty.json", "")).code, "empty-file"); }

// ---- places ----

constexpr std::string_view kPlaced = R"({ // a comment with "quotes": { [
  "bramah": 1, /* and
  "another": 2 */ "components": {
    "µ\"x": { "type": "a/b", "list": [10, {"k": [ ] }, "s" ] },
    "a/b~c": 3, "": 4 ,
    "esc\u0061\ud83d\ude00": -1e3
  },
  "components": { "again": 5 }
})";

TEST(Locate, FindsValuesAndKeys) {
  EXPECT_EQ(place_of(kPlaced, ""), "1:1");
  EXPECT_EQ(place_of(kPlaced, "/bramah"), "2:13");
  EXPECT_EQ(place_of(kPlaced, "/bramah", true), "2:3");
  EXPECT_EQ(place_of(kPlaced, "/components"), "3:33");
  EXPECT_EQ(place_of(kPlaced, "/components", true), "3:19");
  EXPECT_EQ(place_of(kPlaced, "/components/µ\"x/type"), "4:23");  // characters, not bytes
  EXPECT_EQ(place_of(kPlaced, "/components/µ\"x/type", true), "4:15");
  EXPECT_EQ(place_of(kPlaced, "/components/µ\"x/list"), "4:38");
}

TEST(Locate, FindsElementsOfLists) {
  EXPECT_EQ(place_of(kPlaced, "/components/µ\"x/list/0"), "4:39");
  EXPECT_EQ(place_of(kPlaced, "/components/µ\"x/list/1"), "4:43");
  EXPECT_EQ(place_of(kPlaced, "/components/µ\"x/list/1/k"), "4:49");
  EXPECT_EQ(place_of(kPlaced, "/components/µ\"x/list/2"), "4:56");
  EXPECT_EQ(place_of(kPlaced, "/components/µ\"x/list/2", true), "4:56");
}

TEST(Locate, DecodesEscapes) {
  EXPECT_EQ(place_of(kPlaced, "/components/a~1b~0c"), "5:14");
  EXPECT_EQ(place_of(kPlaced, "/components/"), "5:21");  // the empty key
  EXPECT_EQ(place_of(kPlaced, "/components/esca😀"), "6:30");
  EXPECT_EQ(place_of("{\"\\n\\t\\/\\\\\\b\\f\\r\": 1}", "/\n\t~1\\\b\f\r"), "1:20");
}

TEST(Locate, FallsBackToTheClosestParent) {
  EXPECT_EQ(place_of(kPlaced, "/components/nothing/here"), "3:33");
  EXPECT_EQ(place_of(kPlaced, "/components/nothing", true), "3:33");
  EXPECT_EQ(place_of(kPlaced, "/nothing"), "1:1");
  EXPECT_EQ(place_of(kPlaced, "/bramah/deeper"), "2:13");
  EXPECT_EQ(place_of(kPlaced, "/components/µ\"x/list/3"), "4:38");
  EXPECT_EQ(place_of(kPlaced, "/components/µ\"x/list/01"), "4:38");
  EXPECT_EQ(place_of(kPlaced, "no pointer"), "1:1");
}

TEST(Locate, TakesTheFirstOfEqualKeys) {
  EXPECT_EQ(place_of(kPlaced, "/components/again"), "3:33");
  EXPECT_EQ(place_of(R"({"a": {"b": 1}, "a": {"b": 2}})", "/a/b"), "1:13");
}

TEST(Locate, TakesBytes) {
  Diagnostic diagnostic;
  diagnostic.byte = static_cast<long long>(kPlaced.find("\"type\""));
  EXPECT_EQ(place(kPlaced, diagnostic), "4:15");
  diagnostic.byte = 1000000;
  EXPECT_EQ(place("{}\n{", diagnostic), "2:2");
  EXPECT_EQ(place("", diagnostic), "1:1");
}

TEST(Locate, EndsCommentsLikeTheParser) {
  const std::string_view text = "// c\r{\"bramah\": 1, /**/ \"title\": /* // */ \"/*\" /***/}";
  EXPECT_NO_THROW(read(text));
  EXPECT_EQ(place_of(text, "/bramah"), "1:17");
  EXPECT_EQ(place_of(text, "/title"), "1:43");
}

TEST(Locate, WorksOnBrokenText) {
  EXPECT_EQ(place_of("{\"a\": {\"b\": 1, \"c\": ", "/a/b"), "1:13");
  EXPECT_EQ(place_of("{\"a\": {\"b\": 1, \"c\": ", "/a/c"), "1:16");  // its value is missing
  EXPECT_EQ(place_of("{\"a\": \"never closed\n, \"b\": 2}", "/b"), "2:8");
  EXPECT_EQ(place_of("}]}]{{[[:::,,,\"\\", "/a"), "1:5");
  EXPECT_EQ(place_of(std::string(200000, '['), "/0/0/0"), "1:4");
  EXPECT_EQ(place_of("{\"\\u12\": 1, \"\\ud800x\": 2, \"b\\", "/b"), "1:27");
}

// ---- the message ----

TEST(Render, ShowsOneBlockForEachFault) {
  const std::string text = "{ \"bramah\": 1,\n  \"componets\": {},\n  \"hold\": 3\n}";
  try {
    read_scene_text(text, "scenes/bad.json");
    FAIL() << "accepted";
  } catch (const SceneError& error) {
    EXPECT_EQ(
        render({"scenes/bad.json", text}, error),
        "scenes/bad.json:2:3: error: unknown key \"componets\" of the scene   [unknown-key]\n"
        "  at        /componets\n"
        "  expected  one of: \"bramah\", \"title\", \"description\", \"libraries\", \"constants\", \"components\", "
        "\"start\", \"hold\", \"outputs\", \"assembly\", \"equilibrium\", \"simulate\", \"linearize\", \"modes\", \"study\", \"compare\", \"sweep\", \"vary\"\n"
        "  to do     did you mean \"components\"?\n"
        "scenes/bad.json:3:11: error: \"hold\" is number 3   [wrong-kind]\n"
        "  at        /hold\n"
        "  expected  a list of texts\n"
        "  to do     write it as [\"...\", \"...\"]\n");
  }
}

TEST(Render, LeavesOutWhatIsNotKnown) {
  Diagnostic bare;
  bare.found = "nothing to do";
  bare.severity = Diagnostic::Severity::warning;
  EXPECT_EQ(render({}, SceneError(bare)), "scene: warning: nothing to do\n");
  EXPECT_EQ(render({"a.json", "{}"}, SceneError(bare)), "a.json: warning: nothing to do\n");
  bare.pointer = "/x";
  EXPECT_EQ(render({"made in code", ""}, SceneError(bare)), "made in code: warning: nothing to do\n  at        /x\n");
  bare.pointer.clear();
  bare.byte = 1;
  EXPECT_EQ(render({"a.json", "{}"}, SceneError(bare)), "a.json:1:2: warning: nothing to do\n");
}

TEST(Render, KeepsControlCharactersFromTheTerminal) {
  Diagnostic diagnostic;
  diagnostic.found = "text \"\x1b[31m\n\x7f µ\"";
  EXPECT_EQ(render({"s", ""}, SceneError(diagnostic)), "s: error: text \"\\u001b[31m\\n\\u007f µ\"\n");
}

}  // namespace
}  // namespace bramah
