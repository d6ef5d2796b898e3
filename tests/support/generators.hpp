// Scenes made in code: families with a size, shared by tests and benchmarks.
//
// Rods are slender, 1 m and 1 kg, bodies at their centres of mass, gravity 9.81 m/s^2. Bodies are called link_1,
// link_2, ..., joints joint_1, ..., joint i holding link i. Every scene starts assembled.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "system/compile.hpp"
#include "system/scene.hpp"

namespace bramah::support {

inline constexpr double rod_length = 1.0, rod_mass = 1.0, gravity = 9.81;
inline constexpr double rod_inertia = rod_mass * rod_length * rod_length / 12.0;

/// Angle of joint 1, 2, ...: rotation of a link against the one before it, 0 for a chain that hangs.
using Shape = std::function<double(int joint)>;
double hanging(int joint);
/// A chain bent by up to `amplitude` at every joint, without regularity.
Shape bent(double amplitude);

/// scenes/four_bar/overdamped.json.
Scene four_bar_scene();

/// Links that hang from the ground by planar revolutes; n = 3 links, m = 2 links.
Scene planar_chain(int links, const Shape& shape = hanging);

/// Which way the axes of a spatial chain point: all along y, so that it moves in a plane, or along y and x in turn.
enum class Axes { parallel, alternating };
/// The same of rigid bodies with Euler parameters, hanging along -z; n = 7 links, m = 6 links.
Scene spatial_chain(int links, Axes axes = Axes::alternating, const Shape& shape = hanging);

/// A planar chain with a cylinder, its two volumes and a throttle between them across joints 1, 1 + every, ...
/// The rod-side pressures are held.
Scene hydraulic_chain(int links, int every, const Shape& shape = hanging);

/// `loops` four-bars side by side: loops + 1 upright rods on the ground, a rod across each neighbouring pair, 1 m/s at
/// the upper end of every upright; one degree of freedom, singular where the uprights lie down.
Scene four_bar_ladder(int loops);

/// The same at rest, of rigid bodies with hinges along y in the plane x-z: three rows of every loop are redundant.
Scene spatial_ladder(int loops);

/// Masses on cylinders side by side, their piston sides fed from one rail through a throttle each, the rail from a pump;
/// rail and its throttle grow with their number. What the cylinders do against each other leaves the rail alone, what they
/// do together is what one of them does: 3 eigenvalues `cylinders` - 1 times, and the 4 of one cylinder.
Scene cylinder_manifold(int cylinders);

/// Trailers behind a tractor, straight ahead at trailer_speed: bodies on knife edges, hinged at the axle before them;
/// seen from above, n = 3 trailers + 3, m = 2 trailers, l = trailers + 1. Nonzero eigenvalues -trailer_speed / length of
/// each trailer's drawbar; five zeros.
Scene trailers(int count);
inline constexpr double trailer_speed = 5.0;
/// Of trailer 1 ... count, all different.
double drawbar(int trailer, int count);

/// side x side masses that move across their plane, each held by springs to four neighbours or to the frame around them:
/// w^2 = 4 (k / m) (sin^2(i p) + sin^2(j p)), p = pi / (2 side + 2), i, j = 1 ... side.
Scene spring_lattice(int side);
inline constexpr double lattice_stiffness = 2000.0, lattice_mass = 0.5;

/// A family of scenes with a size.
struct Family {
  const char* name;
  Scene (*make)(int size);
  int bodies_per_size = 1;  // for costs per body, where the sizes are large
};
/// All families: "planar_chain", "spatial_chain", "four_bar_ladder", "spatial_ladder", "hydraulic_chain",
/// "cylinder_manifold", "trailers", "spring_lattice" (size: its side).
const std::vector<Family>& families();

/// The scene as a file would hold it.
std::string scene_text(const Scene& scene);

/// A registry that the scenes of this process share.
std::shared_ptr<Registry> shared_registry();
/// Compiles with the shared registry.
Compiled compiled(const Scene& scene);

}  // namespace bramah::support
