// A direction that derivatives are taken along: the state moves by eps times a direction of its own, and with it the
// parameters that one number of the scene drives.
#pragma once

#include <utility>
#include <vector>

#include "system/scene_number.hpp"
#include "system/system.hpp"

namespace bramah {

class Direction {
 public:
  /// Nothing moves; parameters stand still whatever `state` becomes.
  explicit Direction(const System& system);
  /// Parameters move with the number: their instances are made anew, with tangents. The direction of the state is zero but
  /// for the fixed numbers that these give to others (ground, gravity).
  Direction(const System& system, const SceneNumber& number);

  /// d(state)/deps in the layout of State: variables, then inputs and constants. Time and side are not used.
  State state;

  /// Sets the inputs in `state` to their derivatives at time at.t and side at.side.
  void apply_inputs(const System& system, const State& at);
  /// Adds d(initial_state)/d(number) to x, v and z of `state`.
  void add_start(const System& system);

  /// The instances of a group from `first` on that lie together in memory: the first of them, and how many, at most `most`.
  [[nodiscard]] std::pair<const void*, Index> instances(const Group& group, Index first, Index most) const;

 private:
  struct Moving {
    const Component* component;  // of the system, which outlives this
    const bramah_tangent* tangent;
    Instances instance;
  };
  void move_component(const System& system, const SceneNumber& number, Index index);
  std::vector<Moving> moving_;
  std::vector<StartRef> starts_;
};

}  // namespace bramah
