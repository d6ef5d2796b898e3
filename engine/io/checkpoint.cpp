#include "io/checkpoint.hpp"

#include <algorithm>
#include <functional>
#include <unordered_map>

#include "io/json_writer.hpp"
#include "io/parse_json.hpp"

namespace bramah {
namespace {

constexpr double version = 1.0;

Diagnostic at(std::string pointer, Diagnostic diagnostic, bool at_key = false) {
  diagnostic.pointer = std::move(pointer);
  diagnostic.at_key = at_key;
  return diagnostic;
}

const char* const remedy = "take the checkpoint of this scene, or the scene of this checkpoint";

/// Reads numbers by name, and notes every fault.
class Reader {
 public:
  explicit Reader(const Value& root) : root_(root) {}

  double number(const char* key) {
    const Value* value = root_.find(key);
    if (value != nullptr && value->number() != nullptr) return *value->number();
    faults_.push_back(
        fault("not-a-checkpoint", "no number " + in_quotes(key), "a checkpoint of bramah simulate", remedy));
    return 0.0;
  }

  /// Numbers per name, `width` of each: take(index, numbers).
  void named(const char* key, const std::vector<std::string>& names, std::size_t width,
             const std::function<void(std::size_t, const std::vector<double>&)>& take) {
    const std::string place = pointer("", key);
    const Value* section = root_.find(key);
    if (section == nullptr || section->object() == nullptr) {
      faults_.push_back(
          fault("not-a-checkpoint", "no object " + in_quotes(key), "a checkpoint of bramah simulate", remedy));
      return;
    }
    std::unordered_map<std::string, const Value*> found;
    for (const Member& member : *section->object()) found[member.key] = &member.value;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto member = found.find(names[i]);
      std::vector<double> numbers;
      if (member != found.end() && read_numbers(*member->second, numbers) && numbers.size() == width) {
        take(i, numbers);
      } else {
        faults_.push_back(at(place, fault("unknown-variable", "no numbers for " + in_quotes(names[i]),
                                          std::to_string(width) + " numbers for every variable of the scene", remedy)));
      }
      if (member != found.end()) found.erase(member);
    }
    for (const Member& member : *section->object()) {
      if (found.contains(member.key)) {
        faults_.push_back(
            at(pointer(place, member.key),
               fault("unknown-variable", "the scene has no " + in_quotes(member.key), "variables of the scene", remedy),
               true));
      }
    }
  }

  /// Older checkpoints have none.
  void events(std::vector<EventMemory>& events) {
    const Value* section = root_.find("events");
    if (section == nullptr) return;
    if (section->object() == nullptr) {
      faults_.push_back(at("/events", fault("not-a-checkpoint", "\"events\" that is no object",
                                            "a checkpoint of bramah simulate", remedy)));
      return;
    }
    for (const auto& [name, value] : *section->object()) {
      EventMemory& event = events.emplace_back();
      event.name = name;
      double side = 0.0;
      const auto number = [&value = value](const char* key, double& to) {
        const Value* found = value.find(key);
        if (found == nullptr || found->number() == nullptr) return false;
        to = *found->number();
        return true;
      };
      const Value *of = value.find("of"), *fresh = value.find("fresh");
      if (of != nullptr && of->text() != nullptr && fresh != nullptr && fresh->boolean() != nullptr &&
          number("level", event.level) && number("side", side) && number("slack", event.slack) &&
          number("low", event.low) && number("high", event.high)) {
        event.of = *of->text();
        event.fresh = *fresh->boolean();
        event.side = side > 0.0 ? 1 : side < 0.0 ? -1 : 0;
      } else {
        faults_.push_back(
            at(pointer("/events", name), fault("not-a-checkpoint", "no state of the event " + in_quotes(name),
                                               "a checkpoint of bramah simulate", remedy)));
      }
    }
  }

  Faults& faults() { return faults_; }

 private:
  const Value& root_;
  Faults faults_;
};

template <class List>
std::vector<std::string> names_of(const List& list) {
  std::vector<std::string> names;
  for (const auto& one : list) names.push_back(one.name);
  return names;
}

std::vector<std::string> multipliers(const System& system) {
  std::vector<std::string> names;
  for (Index i = 0; i < system.m() + system.l(); ++i) names.push_back(system.multiplier_name(i));
  return names;
}

/// Members "x" and "z" of an open object; with a and zdot where `rates`.
void write_variables(JsonWriter& json, const System& system, const State& state, bool rates) {
  std::vector<double> numbers;
  json.key("x").begin_object();
  for (std::size_t i = 0; i < system.x.size(); ++i) {
    numbers = {state.x[i], state.v[i]};
    if (rates) numbers.push_back(state.a[i]);
    json.key(system.x[i].name).values(numbers);
  }
  json.end_object().key("z").begin_object();
  for (std::size_t i = 0; i < system.z.size(); ++i) {
    numbers = {state.z[i]};
    if (rates) numbers.push_back(state.zdot[i]);
    json.key(system.z[i].name).values(numbers);
  }
  json.end_object();
}

/// Time, side and what `write_variables` writes.
void read_variables(Reader& reader, const System& system, bool rates, State& state) {
  state.t = reader.number("time");
  state.side = reader.number("side") < 0.0 ? -1 : 1;
  reader.named("x", names_of(system.x), rates ? 3 : 2, [&](std::size_t i, const std::vector<double>& numbers) {
    state.x[i] = numbers[0];
    state.v[i] = numbers[1];
    if (rates) state.a[i] = numbers[2];
  });
  reader.named("z", names_of(system.z), rates ? 2 : 1, [&](std::size_t i, const std::vector<double>& numbers) {
    state.z[i] = numbers[0];
    if (rates) state.zdot[i] = numbers[1];
  });
}

/// Where the rows were chosen; older checkpoints do not have this place.
void read_chosen_at(const System& system, const Value& from, State& state, Faults& faults) {
  Reader reader(from);
  read_variables(reader, system, false, state);
  for (Diagnostic& fault : reader.faults()) {
    fault.pointer = "/chosen_at" + fault.pointer;
    faults.push_back(std::move(fault));
  }
  apply_inputs(system, state);
}

}  // namespace

std::string checkpoint_text(const System& system, const Checkpoint& checkpoint) {
  const State& state = checkpoint.state;
  JsonWriter json;
  json.begin_object().member("bramah_checkpoint", version).member("time", state.t).member("side", state.side);
  json.member("integrator", checkpoint.integrator).member("outputs", checkpoint.outputs);
  write_variables(json, system, state, true);
  json.key("lambda").begin_object();
  const std::vector<std::string> names = multipliers(system);
  for (std::size_t i = 0; i < names.size(); ++i) json.key(names[i]).values(std::vector<double>{state.lambda[i]});
  json.end_object().key("held").begin_object();
  for (const auto& [input, value] : state.held) json.member(system.inputs[static_cast<std::size_t>(input)].name, value);
  json.end_object().key("memory").values(checkpoint.memory);
  json.key("events").begin_object();
  for (const EventMemory& event : checkpoint.events) {
    json.key(event.name).begin_flat_object().member("of", event.of).member("level", event.level);
    json.member("side", event.side).member("fresh", event.fresh).member("slack", event.slack);
    json.member("low", event.low).member("high", event.high).end_object();
  }
  json.end_object();
  const State& chosen = checkpoint.chosen_at;
  json.key("chosen_at").begin_object().member("time", chosen.t).member("side", chosen.side);
  write_variables(json, system, chosen, false);
  json.end_object().end_object();
  return json.take();
}

Checkpoint read_checkpoint(const System& system, const Source& source) {
  Value root;
  Faults syntax;
  if (!parse_json(source.text, root, syntax) || !syntax.empty()) throw SceneError(std::move(syntax));
  Reader reader(root);
  Checkpoint result;
  State& state = result.state = initial_state(system);
  if (reader.number("bramah_checkpoint") != version && reader.faults().empty()) {
    reader.faults().push_back(at("/bramah_checkpoint", fault("wrong-version", "a checkpoint of another version",
                                                             "\"bramah_checkpoint\": 1", "run the simulation anew")));
  }
  if (!reader.faults().empty()) throw SceneError(std::move(reader.faults()));
  read_variables(reader, system, true, state);
  const Value* integrator = root.find("integrator");
  if (integrator != nullptr && integrator->text() != nullptr) result.integrator = *integrator->text();
  if (const Value* outputs = root.find("outputs"); outputs != nullptr && outputs->number() != nullptr)
    result.outputs = static_cast<long>(std::clamp(*outputs->number(), 0.0, 9e15));
  reader.named("lambda", multipliers(system), 1,
               [&](std::size_t i, const std::vector<double>& numbers) { state.lambda[i] = numbers[0]; });
  const Value* held = root.find("held");
  for (std::size_t k = 0; held != nullptr && held->object() != nullptr && k < held->object()->size(); ++k) {
    const Member& member = (*held->object())[k];
    const auto input = std::find_if(system.inputs.begin(), system.inputs.end(),
                                    [&](const InputSignal& one) { return one.name == member.key; });
    if (input != system.inputs.end() && member.value.number() != nullptr) {
      state.held.emplace_back(input - system.inputs.begin(), *member.value.number());
    } else {
      reader.faults().push_back(
          at(pointer("/held", member.key),
             fault("unknown-variable", "no input " + in_quotes(member.key) + " that can hold this value",
                   "inputs of the scene, and numbers", remedy),
             true));
    }
  }
  const Value* memory = root.find("memory");
  if (memory == nullptr || !read_numbers(*memory, result.memory)) {
    reader.faults().push_back(
        fault("not-a-checkpoint", "no list \"memory\" of numbers", "a checkpoint of bramah simulate", remedy));
  }
  reader.events(result.events);
  apply_inputs(system, state);
  result.chosen_at = state;
  if (const Value* chosen = root.find("chosen_at")) read_chosen_at(system, *chosen, result.chosen_at, reader.faults());
  if (!reader.faults().empty()) throw SceneError(std::move(reader.faults()));
  return result;
}

}  // namespace bramah
