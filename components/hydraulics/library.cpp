// The types of the library "hydraulics".
#include <bramah/component.hpp>

#include "centre_path.hpp"
#include "check_valve.hpp"
#include "cylinder.hpp"
#include "directional_valve.hpp"
#include "hose.hpp"
#include "leakage.hpp"
#include "pipe.hpp"
#include "pressure_source.hpp"
#include "pump.hpp"
#include "relief_valve.hpp"
#include "throttle.hpp"
#include "volume.hpp"

using namespace bramah::hydraulics;

BRAMAH_LIBRARY("hydraulics", "0.1.0", Volume, Hose, Cylinder, Pipe, Throttle, Leakage, DirectionalValve, CentrePath,
               CheckValve, ReliefValve, Pump, PressureSource)
