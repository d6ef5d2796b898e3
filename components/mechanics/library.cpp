// The types of the library "mechanics".
#include <bramah/component.hpp>

#include "coordinate_force.hpp"
#include "force.hpp"
#include "gravity.hpp"
#include "ground.hpp"
#include "planar_body.hpp"
#include "planar_force.hpp"
#include "planar_revolute.hpp"
#include "planar_stroke.hpp"
#include "planar_torque.hpp"
#include "revolute.hpp"
#include "rigid_body.hpp"
#include "stroke.hpp"
#include "torque.hpp"

using namespace bramah::mechanics;

BRAMAH_LIBRARY("mechanics", "0.1.0", Ground, UniformGravity, RigidBody, PlanarBody, Revolute, PlanarRevolute, Stroke,
               PlanarStroke, CoordinateForce, Force, Torque, PlanarForce, PlanarTorque)
