// Handles: how a component names its ports, variables and rows. `describe` ties them; they hold a local position only.
#pragma once

#include <stdexcept>
#include <type_traits>

namespace bramah {

struct Handle {
  int slot = -1;
};

class Trace;
namespace detail {

/// A law uses a handle that `describe` has not tied.
struct Untied : std::logic_error {
  using std::logic_error::logic_error;
};

/// The handle's position, counted from `first`. The one evaluation on Trace, when a library is loaded, finds handles that
/// describe never tied; on other scalars this is the number itself.
template <class T>
constexpr int tied(Handle handle, int first = 0) {
  if constexpr (std::is_same_v<T, Trace>) {
    if (handle.slot < first) throw Untied("a law uses a port, variable or row that describe does not declare");
  }
  return handle.slot - first;
}

}  // namespace detail

/// Position and orientation of a body: r (3), Euler parameters e (4). Ground is a frame without variables.
struct Frame : Handle {
  static constexpr const char* kind = "frame";
  static constexpr int slots = 7;
};
/// Position (x, y) and angle of a body that moves in a plane.
struct PlanarFrame : Handle {
  static constexpr const char* kind = "planar_frame";
  static constexpr int slots = 3;
};
/// One second-order variable: a length or an angle.
struct Coordinate : Handle {
  static constexpr const char* kind = "coordinate";
  static constexpr int slots = 1;
};
/// First-order variables: one storage balance each.
struct FirstOrder : Handle {
  static constexpr int slots = 1;
};
struct Pressure : FirstOrder {
  static constexpr const char* kind = "pressure";
};
struct Spool : FirstOrder {
  static constexpr const char* kind = "spool";
};
/// A value that a signal gives: no row, no derivative in time.
struct Input : Handle {
  static constexpr const char* kind = "input";
  static constexpr int slots = 1;
};
/// The acceleration of free fall (3).
struct Gravity : Handle {
  static constexpr const char* kind = "gravity";
  static constexpr int slots = 3;
};

struct HolonomicRow : Handle {};
struct NonholonomicRow : Handle {};
struct Output : Handle {};
struct Switch : Handle {};
struct Limit : Handle {};

}  // namespace bramah
