// What the command line said.
#pragma once

#include <string>
#include <vector>

namespace bramah {

struct Arguments {
  std::string subject;                // a scene file; for describe a type; may be empty for list
  std::vector<std::string> settings;  // component.parameter=value, in the order given
  std::string out;                    // folder for results, empty: none was given
  bool json = false;                  // one JSON document on standard output
};

}  // namespace bramah
