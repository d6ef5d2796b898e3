#include "app/equilibrium_report.hpp"

#include <algorithm>
#include <numbers>

#include "app/results.hpp"

namespace bramah {
namespace {

// Nominals that a variable has moved by and is worth a line: coordinates are given, pressures mostly guessed.
constexpr double notable_coordinate = 0.01, notable_other = 1.0;
constexpr std::size_t most_named = 6;

std::string quantity(double value, const std::string& unit) {
  if (unit == "rad") return short_number(value * 180.0 / std::numbers::pi, 4) + " deg";
  if (unit == "Pa") return short_number(value * 1e-5, 4) + " bar";
  return with_unit(short_number(value, 4), unit);
}

const char* word_for(Stability::Verdict verdict) {
  switch (verdict) {
    case Stability::Verdict::stable: return "stable";
    case Stability::Verdict::unstable: return "unstable";
    case Stability::Verdict::undecided: break;
  }
  return "undecided";
}

std::string states_text(const Stability& stability, const Eigen::VectorXd& shares) {
  LinearModel names;
  names.states = stability.states;
  return involved_states(names, shares);
}

}  // namespace

std::string stability_text(const Stability& stability) {
  std::string text = word_for(stability.verdict);
  if (stability.verdict == Stability::Verdict::undecided)
    return text + ": " + stability.why + (stability.states.empty() ? "" : "; no direction is unstable");
  if (stability.verdict == Stability::Verdict::stable) return text;
  text += " in " + counted(static_cast<std::size_t>(stability.directions), "direction") + ": ";
  for (std::size_t k = 0; k < stability.modes.size() && k < most_named; ++k) {
    const UnstableMode& mode = stability.modes[k];
    text += (k == 0 ? "" : "; ") + complex_text(mode.eigenvalue, 4) + " 1/s of " + states_text(stability, mode.shares);
  }
  return text + (stability.modes.size() > most_named ? "; ..." : "");
}

std::string moved_text(const Equilibrium& equilibrium) {
  std::vector<const Moved*> list;
  for (const Moved& one : equilibrium.moved) {
    if (one.nominals >= (one.coordinate ? notable_coordinate : notable_other)) list.push_back(&one);
  }
  // What the scene gives comes first, then angles, which say more of a body than its place.
  const auto rank = [](const Moved& one) { return one.given ? 0 : one.unit == "rad" ? 1 : one.coordinate ? 2 : 3; };
  std::stable_sort(list.begin(), list.end(), [&](const Moved* a, const Moved* b) { return rank(*a) < rank(*b); });
  std::string text;
  for (std::size_t k = 0; k < list.size() && k < most_named; ++k) {
    const Moved& one = *list[k];
    text += (k == 0 ? "" : ", ") + one.name + " moved from " + quantity(one.from, one.unit) + " to " +
            quantity(one.to, one.unit);
  }
  return text + (list.size() > most_named ? ", and " + std::to_string(list.size() - most_named) + " others" : "");
}

void tell_equilibrium(const Context& context, const Equilibrium& equilibrium) {
  if (context.arguments.quiet) return;
  if (const std::string moved = moved_text(equilibrium); !moved.empty())
    say("note: the equilibrium is away from the start values: " + moved + '\n');
  for (const std::string& beyond : equilibrium.beyond_limits) say("warning: at the equilibrium " + beyond + '\n');
  if (equilibrium.passed_unstable)
    say("note: the equilibrium nearest by Newton's method is unstable; this one is a minimum of the potential\n");
  if (equilibrium.free_directions.empty()) return;
  std::string list;
  for (std::size_t k = 0; k < equilibrium.free_directions.size() && k < most_named; ++k)
    list += (k == 0 ? "" : ", ") + equilibrium.free_directions[k].variables.front().first;
  const std::size_t count = equilibrium.free_directions.size();
  say("note: " + counted(count, "free direction") + " that nobody holds: " + list +
      (count > most_named ? ", ..." : "") + " stayed where the search left " + (count == 1 ? "it" : "them") + '\n');
}

void tell_stability(const Context& context, const Stability& stability) {
  if (!context.arguments.quiet && stability.verdict == Stability::Verdict::unstable)
    say("warning: the equilibrium is " + stability_text(stability) + '\n');
}

void judge(const Context& context, Linearization& linear) {
  if (!linear.equilibrium) return;
  if (linear.model.A.rows() > most_judged) {
    linear.stability.emplace();
    linear.stability->why =
        std::to_string(linear.model.A.rows()) + " states, not computed above " + std::to_string(most_judged);
    return;
  }
  linear.stability = judge_stability(linear.model, find_spectrum(linear.model));
  tell_stability(context, *linear.stability);
}

Rest find_rest(const Context& context, double t) {
  Rest rest{find_equilibrium(context.system(), context.options().equilibrium, t), {}};
  tell_equilibrium(context, rest.equilibrium);
  rest.stability = judge_stability(context.system(), rest.equilibrium.state, most_judged);
  tell_stability(context, rest.stability);
  return rest;
}

void write_free_directions(JsonWriter& json, const std::vector<FreeDirection>& directions) {
  json.key("free_directions").begin_list();
  for (const FreeDirection& direction : directions) {
    json.begin_flat_object();
    for (const auto& [name, share] : direction.variables) json.member(name, share);
    json.end_object();
  }
  json.end_list();
}

void write_stability(JsonWriter& json, const Equilibrium& equilibrium, const Stability& stability) {
  json.key("stability").begin_object().member("verdict", word_for(stability.verdict));
  json.member("directions", stability.directions).key("unstable").begin_list();
  for (const UnstableMode& mode : stability.modes) {
    json.begin_flat_object()
        .member("re", mode.eigenvalue.real())
        .member("im", mode.eigenvalue.imag())
        .member("states", states_text(stability, mode.shares))
        .end_object();
  }
  json.end_list().member("zeros", stability.zeros).member("undamped", stability.undamped);
  json.member("why", stability.why).member("passed_unstable", equilibrium.passed_unstable).end_object();
}

void write_moved(JsonWriter& json, const Equilibrium& equilibrium) {
  json.key("moved").begin_object();
  for (const Moved& one : equilibrium.moved) {
    json.key(one.name).begin_flat_object().member("from", one.from).member("to", one.to);
    json.member("nominals", one.nominals).end_object();
  }
  json.end_object();
}

void write_beyond_limits(JsonWriter& json, const Equilibrium& equilibrium) {
  json.key("beyond_limits").begin_list();
  for (const std::string& text : equilibrium.beyond_limits) json.value(text);
  json.end_list();
}

void write_equilibrium(JsonWriter& json, const Equilibrium* equilibrium, const Stability* stability) {
  json.key("equilibrium");
  if (equilibrium == nullptr) {
    json.null();
    return;
  }
  json.begin_object();
  write_stability(json, *equilibrium, stability != nullptr ? *stability : Stability{});
  write_moved(json, *equilibrium);
  write_free_directions(json, equilibrium->free_directions);
  write_beyond_limits(json, *equilibrium);
  json.end_object();
}

void write_equilibrium(JsonWriter& json, const Linearization& linear) {
  write_equilibrium(json, linear.equilibrium ? &*linear.equilibrium : nullptr,
                    linear.stability ? &*linear.stability : nullptr);
}

}  // namespace bramah
