// The types of the library "signals".
#include <bramah/component.hpp>

#include "constant.hpp"
#include "table.hpp"

using namespace bramah::signals;

BRAMAH_LIBRARY("signals", "0.1.0", Constant, Table)
