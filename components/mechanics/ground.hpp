// Ground: the inertial frame (body 1 of the paper), fixed numbers that joints connect to as to any body.
//
//   frame    r = (0, 0, 0) m, e = (1, 0, 0, 0)
//   planar   r = (0, 0) m, angle = 0 rad
#pragma once

#include <algorithm>
#include <bramah/component.hpp>

namespace bramah::mechanics {

struct Ground {
  void describe(Description& is) {
    is.called("mechanics/ground", "the inertial frame, which never moves");
    is.provide_constants<Frame>("frame", "origin and axes of the inertial frame");
    is.provide_constants<PlanarFrame>("planar", "the same for planar bodies: its x-y plane");
  }
  void constants(Parameter* values) const {
    std::fill_n(values, Frame::slots + PlanarFrame::slots, 0.0);
    values[3] = 1.0;  // e0: not rotated
  }
};

}  // namespace bramah::mechanics
