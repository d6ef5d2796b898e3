// Small motions of hanging chains of rods and the fall of a ladder of four-bars, made independently of the engine.
#pragma once

#include <vector>

namespace bramah::support {

/// Lengths of the rigid pieces (m), from the top, that the links of a hanging chain swing as in one plane.
std::vector<double> planar_pieces(int links);
/// Of a spatial chain with axes in turn: about y links 1 and 2, 3 and 4, ... are one piece; about x link 1 stands still, and
/// links 2 and 3, 4 and 5, ... are one.
std::vector<double> spatial_pieces_about_y(int links);
std::vector<double> spatial_pieces_about_x(int links);

/// The `count` lowest circular frequencies (rad/s) of slender rods of 1 kg/m that hang from each other in a plane, by
/// Sturm's count in the displacements u_j of their lower ends:
///
///   T = sum m_j / 6 (u_(j-1)'^2 + u_(j-1)' u_j' + u_j'^2),  V = sum (W_j + m_j g / 2) (u_j - u_(j-1))^2 / (2 l_j)
///
/// with W_j the weight below rod j.
std::vector<double> lowest_frequencies(const std::vector<double>& pieces, int count);

/// The angle (rad) from upright of the uprights of four_bar_ladder(loops) at time t, by Taylor series in steps so short that
/// rounding is left: one degree of freedom, ((N + 1) / 3 + N) L phi'' = ((N + 1) / 2 + N) g sin(phi).
double ladder_angle(int loops, double t);

}  // namespace bramah::support
