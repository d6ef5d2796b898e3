// The types of the library "mechanics".
#include <bramah/component.hpp>

#include "coordinate_force.hpp"
#include "cylindrical.hpp"
#include "end_stop.hpp"
#include "force.hpp"
#include "gravity.hpp"
#include "ground.hpp"
#include "knife_edge.hpp"
#include "mass.hpp"
#include "planar_body.hpp"
#include "planar_bushing.hpp"
#include "planar_force.hpp"
#include "planar_revolute.hpp"
#include "planar_shaker.hpp"
#include "planar_slot.hpp"
#include "planar_stroke.hpp"
#include "planar_torque.hpp"
#include "planar_traction.hpp"
#include "prismatic.hpp"
#include "revolute.hpp"
#include "rigid_body.hpp"
#include "rolling_disc.hpp"
#include "rolling_wheel.hpp"
#include "spherical.hpp"
#include "spring_damper.hpp"
#include "stroke.hpp"
#include "torque.hpp"
#include "torsion_spring.hpp"
#include "universal.hpp"
#include "wheel.hpp"

using namespace bramah::mechanics;

BRAMAH_LIBRARY("mechanics", "0.1.0", Ground, UniformGravity, RigidBody, PlanarBody, Mass, Wheel, RollingDisc, Revolute,
               Universal, Spherical, Cylindrical, Prismatic, PlanarRevolute, PlanarSlot, PlanarShaker, Stroke,
               PlanarStroke, RollingWheel, KnifeEdge, CoordinateForce, Force, Torque, PlanarForce, PlanarTorque,
               PlanarTraction, SpringDamper, TorsionSpring, PlanarBushing, EndStop)
