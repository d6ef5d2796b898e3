// Machines put together by chance, of which the zeros are known beforehand.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "system/scene.hpp"

namespace bramah::support {

struct RandomMachine {
  Scene scene;
  std::vector<int> zero_blocks;  // sizes of the Jordan blocks of the eigenvalue 0, largest first
};

/// One to three parts without connection, each of a family drawn by lot with numbers drawn by lot; at most 60
/// coordinates. All are passive, or roll and spin fast enough to be stable: no eigenvalue has a positive real part. The
/// same on every platform up to rounding of the mathematical functions.
///
/// The blocks follow from symmetric coefficients. With M > 0, C >= 0, K >= 0 of the motions that constraints leave,
///
///   M q'' + C q' + K q = 0:   dim null K blocks, of which dim (null K and null C) have size 2, the others size 1
///
/// and every set of volumes that is closed adds a block of size 1, whatever the mechanics, but holds one motion of
/// null K that changes its content. Rolling and skating are told where they are made.
RandomMachine random_machine(std::uint64_t seed);

}  // namespace bramah::support
