// Redundant constraint rows as an engineer sees them: which joints repeat each other, what they could be clamped with,
// which one to relax.
//
// Each redundant row stands for one state of self-stress: multipliers with D^T lambda = 0, forces that joints can carry
// against each other without moving anything. The forces and moments in them tell the direction that is supported twice.
#pragma once

#include <string>
#include <vector>

#include "solve/partition.hpp"

namespace bramah {

/// Redundant rows that belong together, told in terms of joints. They agree with the rows that are kept: a state that
/// contradicts them does not get as far as a partition.
struct RedundantSet {
  std::vector<Index> rows;        // the redundant ones
  std::vector<Index> components;  // all that take part, in the order of declaration; bodies are left out
  std::string joints;             // "4 mechanics/revolute (O1, C, D, O2)"
  std::string geometry;           // "in one plane, normal to x"; "" where it has no name
  std::string undetermined;       // "a force along x and moments normal to x"; "" where no body takes part
  std::string remedy;             // "free O2 along x and about axes normal to x; as much in O1, C or D would do"
};
/// The sets in the order of declaration; `state`: where `partition` was chosen.
std::vector<RedundantSet> describe_redundancy(const System& system, const State& state, const Partition& partition);

/// Makes the multipliers of redundant sets unique: of all with the same D^T lambda, those of least norm, each in
/// the machine's energy over the size of its row.
void take_minimum_norm(const System& system, const Partition& partition, Vector& lambda);

}  // namespace bramah
