// What an analysis that begins at an equilibrium says of it: how far it is from the start values, what nobody held, whether
// the machine stays there.
#pragma once

#include <string>

#include "app/context.hpp"
#include "io/json_writer.hpp"
#include "linear/stability.hpp"
#include "solve/equilibrium.hpp"

namespace bramah {

/// States up to which the verdict is computed where no spectrum is asked for.
inline constexpr Index most_judged = 400;

/// "stable", "unstable in 3 directions: ...", "undecided: 1 zero".
std::string stability_text(const Stability& stability);
/// "boom.angle moved from 40 deg to 13.7 deg, ..."; empty where nothing moved notably.
std::string moved_text(const Equilibrium& equilibrium);

/// Notes on standard error, unless --quiet: moves that are notable, free directions.
void tell_equilibrium(const Context& context, const Equilibrium& equilibrium);
/// A warning there where the machine does not stay.
void tell_stability(const Context& context, const Stability& stability);
/// Judges `linear` where it is at an equilibrium and has no more than most_judged states, and warns.
void judge(const Context& context, Linearization& linear);

/// The equilibrium that an analysis begins with, found, told and judged.
struct Rest {
  Equilibrium equilibrium;
  Stability stability;
};
Rest find_rest(const Context& context, double t);

/// Members of an open object.
void write_free_directions(JsonWriter& json, const std::vector<FreeDirection>& directions);
void write_stability(JsonWriter& json, const Equilibrium& equilibrium, const Stability& stability);
void write_moved(JsonWriter& json, const Equilibrium& equilibrium);
/// All of it as "equilibrium"; null where there is none.
void write_equilibrium(JsonWriter& json, const Equilibrium* equilibrium, const Stability* stability);
void write_equilibrium(JsonWriter& json, const Linearization& linear);

}  // namespace bramah
