// A scene's file and the shape of its document.
#include "io/read_scene.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include "io/parse_json.hpp"

namespace bramah {

namespace {

constexpr std::uintmax_t kLargest = std::uintmax_t{1} << 30;  // bytes

Diagnostic at_value(std::string place, Diagnostic diagnostic) {
  diagnostic.pointer = std::move(place);
  return diagnostic;
}

Diagnostic at_key(std::string place, Diagnostic diagnostic) {
  diagnostic.at_key = true;
  return at_value(std::move(place), std::move(diagnostic));
}

// ---- shape of the document ----

enum class Shape { version, text, texts, object };

struct TopLevel {
  std::string_view key;
  Shape shape;
};

constexpr auto kTopLevel = std::to_array<TopLevel>({
    {"bramah", Shape::version},
    {"title", Shape::text},
    {"description", Shape::text},
    {"libraries", Shape::texts},
    {"constants", Shape::object},
    {"components", Shape::object},
    {"start", Shape::object},
    {"hold", Shape::texts},
    {"outputs", Shape::texts},
    {"assembly", Shape::object},
    {"equilibrium", Shape::object},
    {"simulate", Shape::object},
    {"linearize", Shape::object},
    {"modes", Shape::object},
    {"study", Shape::object},
    {"compare", Shape::object},
    {"sweep", Shape::object},
    {"vary", Shape::object},
});

void check_texts(const std::string& place, const std::string& key, const Value& value, Faults& faults) {
  const Value::List* list = value.list();
  if (list == nullptr) {
    const std::string remedy =
        value.text() != nullptr ? "put it in brackets: [ ... ]" : R"(write it as ["...", "..."])";
    faults.push_back(
        at_value(place, fault("wrong-kind", in_quotes(key) + " is " + description(value), "a list of texts", remedy)));
    return;
  }
  for (std::size_t i = 0; i < list->size(); ++i) {
    const Value& element = (*list)[i];
    if (element.text() != nullptr) continue;
    faults.push_back(at_value(pointer(place, i),
                              fault("wrong-kind", "an element of " + in_quotes(key) + " is " + description(element),
                                    "text", "put it in double quotes")));
  }
}

void check_member(const Member& member, Faults& faults) {
  const std::string place = pointer("", member.key);
  const auto* const known =
      std::find_if(kTopLevel.begin(), kTopLevel.end(), [&](const TopLevel& t) { return t.key == member.key; });
  if (known == kTopLevel.end()) {
    std::vector<std::string> keys;
    keys.reserve(kTopLevel.size());
    for (const TopLevel& top : kTopLevel) keys.emplace_back(top.key);
    faults.push_back(at_key(place, fault("unknown-key", "unknown key " + in_quotes(member.key) + " of the scene",
                                         "one of: " + quoted_list(keys, keys.size()),
                                         suggestion(member.key, keys, "remove it, or write it as a comment"))));
    return;
  }
  const Value& value = member.value;
  const std::string found = in_quotes(member.key) + " is " + description(value);
  switch (known->shape) {
    case Shape::version:
      if (value.number() != nullptr && *value.number() == 1.0) return;
      faults.push_back(at_value(place, fault("wrong-version", found, "\"bramah\": 1, the only version of scenes so far",
                                             "write \"bramah\": 1, or use a newer bramah")));
      return;
    case Shape::text:
      if (value.text() != nullptr) return;
      faults.push_back(at_value(place, fault("wrong-kind", found, "text", "put it in double quotes")));
      return;
    case Shape::texts: return check_texts(place, member.key, value, faults);
    case Shape::object:
      if (value.object() != nullptr) return;
      faults.push_back(at_value(place, fault("wrong-kind", found, "an object", "write it as { \"name\": ... }")));
      return;
  }
}

// What is wrong with a component's name, or nothing. Paths like piston.s and --set piston.mass=3 must stay readable.
std::string_view flaw_of_name(std::string_view name) {
  if (name.empty()) return "is empty";
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '.') return "contains a dot";
    if (c == '/') return "contains a slash";
    if (c == ' ') return "contains a space";
    if (c == '=') return "contains an equals sign";
    if (byte < 0x20 || byte == 0x7F) return "contains a control character";
  }
  return {};
}

std::string mended_name(std::string name) {
  if (name.empty()) return "body_1";
  for (char& c : name) {
    if (!flaw_of_name({&c, 1}).empty()) c = '_';
  }
  return name;
}

void check_component(const Member& component, Faults& faults) {
  const std::string place = pointer("/components", component.key);
  const std::string_view flaw = flaw_of_name(component.key);
  if (!flaw.empty()) {
    faults.push_back(
        at_key(place, fault("bad-name", "component name " + in_quotes(component.key) + ' ' + std::string(flaw),
                            "a name without dots, slashes, spaces, equals signs and control characters",
                            "call it for instance " + in_quotes(mended_name(component.key)))));
  }
  const std::string subject = "component " + in_quotes(component.key);
  const std::string example = R"(write for instance "type": "hydraulics/volume")";
  if (component.value.object() == nullptr) {
    faults.push_back(at_value(place, fault("wrong-kind", subject + " is " + description(component.value),
                                           "an object with a \"type\"", example)));
    return;
  }
  const Value* type = component.value.find("type");
  if (type == nullptr) {
    faults.push_back(at_key(place, fault("missing-type", subject + " has no \"type\"", "\"type\": text", example)));
  } else if (type->text() == nullptr) {
    faults.push_back(
        at_value(pointer(place, "type"),
                 fault("wrong-kind", "\"type\" of " + subject + " is " + description(*type), "text", example)));
  }
}

void check_shape(const Value& root, Faults& faults) {
  if (root.object() == nullptr) {
    faults.push_back(fault("not-an-object", "the scene is " + description(root), "an object",
                           "begin with { \"bramah\": 1 and end with }"));
    return;
  }
  if (root.find("bramah") == nullptr) {
    faults.push_back(at_value("/bramah", fault("missing-version", "the scene has no \"bramah\"", "\"bramah\": 1",
                                               "write \"bramah\": 1 as its first member")));
  }
  for (const Member& member : *root.object()) check_member(member, faults);
  const Value* components = root.find("components");
  if (components == nullptr || components->object() == nullptr) return;
  for (const Member& component : *components->object()) check_component(component, faults);
}

Scene scene_from(Source source, Faults* of_shape) {
  Scene scene{Value{}, std::move(source)};
  Faults faults;
  const bool is_whole = parse_json(scene.source.text, scene.root, faults);
  const bool is_readable = is_whole && faults.empty() && scene.root.object() != nullptr;
  if (is_whole) check_shape(scene.root, faults);
  if (faults.empty()) return scene;
  if (of_shape == nullptr || !is_readable) throw SceneError(std::move(faults));
  of_shape->insert(of_shape->end(), faults.begin(), faults.end());
  return scene;
}

// ---- files ----

std::vector<std::string> scenes_beside(const std::filesystem::path& file) {
  std::vector<std::string> names;
  std::error_code error;
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  for (std::filesystem::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
    if (i->path().extension() == ".json") names.push_back(i->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

[[noreturn]] void refuse_size(std::uintmax_t least) {
  throw SceneError(fault("too-big", "a file of " + std::to_string(least >> 20U) + " MiB or more",
                         "a scene of at most 1 GiB", "split the scene"));
}

// Reads on to the end: the size of a pipe is not known beforehand.
std::string contents(const std::filesystem::path& file, std::uintmax_t likely_size) {
  const Diagnostic unreadable =
      fault("unreadable-file", "the file cannot be read", "a readable scene file", "check its permissions");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw SceneError(unreadable);
  constexpr std::size_t chunk = std::size_t{1} << 20U;
  std::size_t wanted = std::max(chunk, static_cast<std::size_t>(likely_size) + 1);  // one more meets the end at once
  std::size_t read = 0;
  std::string text;
  while (in) {
    text.resize(read + wanted);
    in.read(text.data() + read, static_cast<std::streamsize>(wanted));
    read += static_cast<std::size_t>(in.gcount());
    if (read > kLargest) refuse_size(read);
    wanted = chunk;
  }
  if (in.bad()) throw SceneError(unreadable);
  text.resize(read);
  return text;
}

}  // namespace

Source read_source(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw SceneError(fault("no-file", "there is no such file", "a scene file",
                           suggestion(file.filename().string(), scenes_beside(file), "check the path")));
  }
  if (std::filesystem::is_directory(status)) {
    throw SceneError(fault("unreadable-file", "this is a directory", "a scene file", "name a file in it"));
  }
  const bool is_regular = std::filesystem::is_regular_file(status);
  const std::uintmax_t size = is_regular ? std::filesystem::file_size(file, error) : 0;
  if (error) {
    throw SceneError(fault("unreadable-file", "the file cannot be read", "a readable scene file", error.message()));
  }
  if (size > kLargest) refuse_size(size);
  return {file.string(), contents(file, size)};
}

Scene read_scene(const std::filesystem::path& file) { return scene_from(read_source(file), nullptr); }

Scene read_scene_text(std::string_view text, std::string_view name, std::vector<Diagnostic>* of_shape) {
  if (text.size() > kLargest) refuse_size(text.size());
  return scene_from({std::string(name), std::string(text)}, of_shape);
}

}  // namespace bramah
