// The types of the library "hydraulics".
#include <bramah/component.hpp>

#include "cylinder.hpp"
#include "directional_valve.hpp"
#include "hose.hpp"
#include "leakage.hpp"
#include "pressure_source.hpp"
#include "throttle.hpp"
#include "volume.hpp"

using namespace bramah::hydraulics;

BRAMAH_LIBRARY("hydraulics", "0.1.0", Volume, Hose, Cylinder, Throttle, Leakage, DirectionalValve, PressureSource)
