// What a run knows of an event on its way: part of a checkpoint.
#pragma once

#include <string>

namespace bramah {

struct EventMemory {
  std::string name;              // "relief.crack", or as the scene calls it
  std::string of;                // what a condition of the scene watches; "" of a switching function
  double level = 0.0;            // of the condition, SI
  int side = 0;                  // of the zero: +1 or -1; 0: on it since the start
  bool fresh = false;            // has just happened, and the new side has not been reached beyond doubt
  double slack = 0.0;            // how far on the old side a fresh event may be found
  double low = 0.0, high = 0.0;  // range of the quantity so far, less the level, which it includes
};

}  // namespace bramah
