// The types of the library "friction".
#include <bramah/component.hpp>

#include "brown_mcphee.hpp"
#include "stick_slip.hpp"

using namespace bramah::friction;

BRAMAH_LIBRARY("friction", "0.1.0", BrownMcPhee, StickSlip)
