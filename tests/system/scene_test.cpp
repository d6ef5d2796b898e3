#include "system/scene.hpp"

#include <gtest/gtest.h>

#include <string>

#include "system/diagnostic.hpp"

namespace bramah {
namespace {

Scene sample() {
  Scene scene;
  Value volume;
  volume.set("type", "hydraulics/volume");
  volume.set("p", 1e5);
  Value components;
  components.set("V2", volume);
  components.set("broken", 3.0);
  scene.root.set("bramah", 1);
  scene.root.set("components", components);
  scene.root.set("hold", Value::List{Value("V2.p")});
  scene.root.set("compare", Value::Object{});
  return scene;
}

const Value& at(const Scene& scene, std::string_view section, std::string_view key) {
  const Value* parent = scene.root.find(section);
  const Value* value = parent == nullptr ? nullptr : parent->find(key);
  static const Value nothing;
  EXPECT_NE(value, nullptr) << section << " has no " << key;
  return value == nullptr ? nothing : *value;
}

const Value& parameter(const Scene& scene, std::string_view component, std::string_view key) {
  static const Value nothing;
  const Value* value = at(scene, "components", component).find(key);
  EXPECT_NE(value, nullptr);
  return value == nullptr ? nothing : *value;
}

// The only fault that the setting is refused for.
Diagnostic refusal(Scene scene, std::string_view setting) {
  try {
    apply_setting(scene, setting);
  } catch (const SceneError& error) {
    EXPECT_EQ(error.diagnostics().size(), 1U);
    EXPECT_FALSE(error.diagnostics()[0].remedy.empty()) << setting;
    EXPECT_FALSE(error.diagnostics()[0].expected.empty()) << setting;
    return error.diagnostics()[0];
  }
  ADD_FAILURE() << setting << " was accepted";
  return {};
}

TEST(ValueTest, FindsAndSets) {
  Value value;
  EXPECT_EQ(value.find("a"), nullptr);
  value.set("a", 1);
  value.set("b", true);
  value.set("a", "two");
  ASSERT_NE(value.object(), nullptr);
  ASSERT_EQ(value.object()->size(), 2U);
  EXPECT_EQ((*value.object())[0].key, "a");  // in the order written
  EXPECT_EQ(*value.find("a")->text(), "two");
  EXPECT_TRUE(*value.find("b")->boolean());
  EXPECT_EQ(value.find("c"), nullptr);
  EXPECT_EQ(Value(3.0).find("a"), nullptr);
}

TEST(ValueTest, SetTurnsAnythingIntoAnObject) {
  Value value(3.0);
  value.set("a", 1);
  EXPECT_EQ(value.number(), nullptr);
  EXPECT_EQ(*value.find("a")->number(), 1.0);
}

TEST(ValueTest, DescribesItself) {
  EXPECT_EQ(description(Value{}), "null");
  EXPECT_EQ(description(true), "true");
  EXPECT_EQ(description(false), "false");
  EXPECT_EQ(description(3.5), "number 3.5");
  EXPECT_EQ(description(0.1), "number 0.1");
  EXPECT_EQ(description("80 mm"), "text \"80 mm\"");
  EXPECT_EQ(description(Value::List{1, 2, 3}), "list of 3");
  EXPECT_EQ(description(Value::Object{}), "object");
}

TEST(ValueTest, DescriptionShortensTextBetweenCharacters) {
  EXPECT_EQ(description(std::string(61, 'x')), "text \"" + std::string(60, 'x') + "...\"");
  EXPECT_EQ(description(std::string(60, 'x')), "text \"" + std::string(60, 'x') + "\"");
  EXPECT_EQ(description(std::string(59, 'x') + "µm"), "text \"" + std::string(59, 'x') + "...\"");
}

TEST(Pointer, EscapesKeys) {
  EXPECT_EQ(pointer("", "components"), "/components");
  EXPECT_EQ(pointer("/a", "b/c~d"), "/a/b~1c~0d");
  EXPECT_EQ(pointer("/a", ""), "/a/");
  EXPECT_EQ(pointer("/a", std::size_t{12}), "/a/12");
}

TEST(Setting, SetsParameters) {
  Scene scene = sample();
  apply_setting(scene, "V2.p=2.5e5");
  apply_setting(scene, "V2.V_0=80 mm");
  apply_setting(scene, "V2.on=true");
  apply_setting(scene, "V2.off=false");
  apply_setting(scene, " V2.formula = =a=b ");
  EXPECT_EQ(*parameter(scene, "V2", "p").number(), 2.5e5);
  EXPECT_EQ(*parameter(scene, "V2", "V_0").text(), "80 mm");
  EXPECT_TRUE(*parameter(scene, "V2", "on").boolean());
  EXPECT_FALSE(*parameter(scene, "V2", "off").boolean());
  EXPECT_EQ(*parameter(scene, "V2", "formula").text(), "=a=b");
  EXPECT_EQ(*parameter(scene, "V2", "type").text(), "hydraulics/volume");
}

TEST(Setting, BracketsAreLists) {
  Scene scene = sample();
  apply_setting(scene, "V2.point=[-1.2, 80 mm ,\"3 m\"]");
  apply_setting(scene, "V2.none=[ ]");
  apply_setting(scene, "V2.half=[1, 2");
  apply_setting(scene, "V2.deep=" + std::string(100000, '[') + std::string(100000, ']'));
  const Value::List* point = parameter(scene, "V2", "point").list();
  ASSERT_NE(point, nullptr);
  ASSERT_EQ(point->size(), 3U);
  EXPECT_EQ(*(*point)[0].number(), -1.2);
  EXPECT_EQ(*(*point)[1].text(), "80 mm");
  EXPECT_EQ(*(*point)[2].text(), "3 m");
  ASSERT_NE(parameter(scene, "V2", "none").list(), nullptr);
  EXPECT_TRUE(parameter(scene, "V2", "none").list()->empty());
  EXPECT_EQ(*parameter(scene, "V2", "half").text(), "[1, 2");
  EXPECT_EQ(parameter(scene, "V2", "deep").list()->size(), 1U);
}

TEST(Setting, NumbersAreWholeAndFinite) {
  Scene scene = sample();
  for (const char* text : {"1e999", "nan", "inf", "0x10", "1 2", "--1", "1e", "TRUE", "null", ""}) {
    apply_setting(scene, std::string("V2.x=") + text);
    ASSERT_NE(parameter(scene, "V2", "x").text(), nullptr) << text;
    EXPECT_EQ(*parameter(scene, "V2", "x").text(), text);
  }
  apply_setting(scene, "V2.x=-0.5");
  EXPECT_EQ(*parameter(scene, "V2", "x").number(), -0.5);
}

TEST(Setting, SetsSections) {
  Scene scene = sample();
  apply_setting(scene, "start.crank.angle=60 deg");
  apply_setting(scene, "simulate.until=10");
  apply_setting(scene, "compare.what=J");
  EXPECT_EQ(*at(scene, "start", "crank.angle").text(), "60 deg");
  EXPECT_EQ(*at(scene, "simulate", "until").number(), 10.0);
  EXPECT_EQ(*at(scene, "compare", "what").text(), "J");
}

TEST(Setting, WorksOnAnEmptyScene) {
  Scene scene;
  apply_setting(scene, "constants.g=9.81");
  EXPECT_EQ(*at(scene, "constants", "g").number(), 9.81);
  const Diagnostic fault = refusal(Scene{}, "V2.p=3");
  EXPECT_EQ(
      fault.expected,
      "a section (\"constants\", \"start\", \"assembly\", \"simulate\", \"linearize\", \"equilibrium\", \"study\", \"sweep\", \"vary\", \"modes\", \"compare\")");
}

TEST(Setting, LeavesUnknownParametersToCompile) {
  Scene scene = sample();
  apply_setting(scene, "V2.nonsense=3");
  EXPECT_EQ(*parameter(scene, "V2", "nonsense").number(), 3.0);
}

TEST(Setting, RefusesUnknownWords) {
  const Diagnostic fault = refusal(sample(), "V3.p=3");
  EXPECT_EQ(fault.code, "unknown-setting");
  EXPECT_EQ(fault.found, "setting \"V3.p=3\": the scene has no component or section \"V3\"");
  EXPECT_NE(fault.expected.find("a component (\"V2\", \"broken\") or a section (\"constants\""), std::string::npos)
      << fault.expected;
  EXPECT_EQ(refusal(sample(), "simulat.until=3").remedy, "did you mean \"simulate\"?");
  EXPECT_EQ(refusal(sample(), "borken.x=3").remedy, "did you mean \"broken\"?");
}

TEST(Setting, RefusesIncompletePaths) {
  EXPECT_EQ(refusal(sample(), "V2.p").found, "setting \"V2.p\" has no equals sign");
  EXPECT_EQ(refusal(sample(), "").found, "setting \"\" has no equals sign");
  EXPECT_EQ(refusal(sample(), "V2=3.5").found, "setting \"V2=3.5\" has no dot before its equals sign");
  EXPECT_EQ(refusal(sample(), ".p=3").found, "setting \".p=3\" has nothing before its dot");
  EXPECT_EQ(refusal(sample(), "V2.=3").found, "setting \"V2.=3\" has nothing after its dot");
  EXPECT_EQ(refusal(sample(), "V2.p").expected, "component.parameter=value or section.key=value");
}

TEST(Setting, RefusesWhatHasNoMembers) {
  EXPECT_EQ(refusal(sample(), "hold.x=3").found, "setting \"hold.x=3\": \"hold\" is list of 1");
  EXPECT_EQ(refusal(sample(), "bramah.x=3").found, "setting \"bramah.x=3\": \"bramah\" is number 1");
  EXPECT_EQ(refusal(sample(), "broken.x=3").code, "wrong-kind");
}

TEST(Setting, RefusesTheWordComponents) {
  const Diagnostic fault = refusal(sample(), "components.V2.p=3");
  EXPECT_EQ(fault.found, "setting \"components.V2.p=3\" begins with \"components\"");
  EXPECT_EQ(fault.remedy, "write \"V2.p=...\"");
}

TEST(Setting, RefusesAmbiguity) {
  Scene scene = sample();
  Value component;
  component.set("type", "mechanics/body");
  scene.root.find("components")->set("start", component);
  EXPECT_EQ(refusal(scene, "start.x=3").code, "ambiguous-setting");
}

TEST(Setting, ChangesNothingWhenRefused) {
  Scene scene = sample();
  EXPECT_THROW(apply_setting(scene, "V3.p=3"), SceneError);
  EXPECT_EQ(scene.root.object()->size(), sample().root.object()->size());
}

}  // namespace
}  // namespace bramah
