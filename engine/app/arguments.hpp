// What the command line said.
#pragma once

#include <string>
#include <vector>

namespace bramah {

struct Arguments {
  std::string subject;                // a scene file; for describe a type; may be empty for list
  std::vector<std::string> settings;  // component.parameter=value, in the order given
  std::string out;                    // folder for results, empty: none was given
  std::vector<std::string> over;      // PARAMETER=FROM:TO:COUNT or PARAMETER=A,B,C: instead of the scene's "sweep"
  std::vector<std::string> by;        // of sensitivity: these numbers alone; empty: all
  int threads = 0;                    // 0: as many as there are cores
  std::vector<std::string> inputs;    // of respond: these alone; empty: all
  std::vector<std::string> outputs;   // instead of the scene's "outputs"
  std::string step, impulse;          // TO or TO:COUNT, empty: not asked for
  std::string resume;                 // of simulate: a checkpoint to go on from
  double save_every = 0.0;            // of simulate: s between checkpoints; 0: at the end alone
  bool binary = false;                // of simulate: time_series.npy instead of .csv
  bool strict = false;                // warnings about the scene are errors
  bool quiet = false;                 // no progress bars, no word about files written
  bool json = false;                  // one JSON document on standard output
};

}  // namespace bramah
