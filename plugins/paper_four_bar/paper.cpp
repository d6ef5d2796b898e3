// The four-bar mechanism of Agundez et al. (2023), Sect. 4.1, in the paper's own ten coordinates:
//
//   x = (x_G2 y_G2 z_G2 psi2 theta2 phi2 phi32 phi43 s alpha)^T                    m, rad   Eq. (65)
//   M(x) xddot + C_x^T Lambda = Q,  C(x) = 0                                                Eqs. (67), (76)
//
//   L_1 ... L_4   m    ground link, input link, coupler, output link
//   d_1           m    from O_c, where the cylinder stands, to O_1
//   m_2 ... m_4   kg   slender rods
// Every link lies along the Y axis of its body; the motion takes place in the plane Y1-Z1. The cylinder without mass is
// here the length s and the angle alpha alone: a hydraulics/cylinder on "machine.s" gives the force.
#include <bramah/component.hpp>

namespace {

using bramah::Coordinate, bramah::HolonomicRow, bramah::Parameter, bramah::Positions, bramah::Vec3;

// Elemental rotations of a vector.
template <class T>
Vec3<T> R_x(const T& angle, const Vec3<T>& u) {
  const T c = cos(angle), s = sin(angle);
  return {u[0], c * u[1] - s * u[2], s * u[1] + c * u[2]};
}
template <class T>
Vec3<T> R_y(const T& angle, const Vec3<T>& u) {
  const T c = cos(angle), s = sin(angle);
  return {c * u[0] + s * u[2], u[1], c * u[2] - s * u[0]};
}
template <class T>
Vec3<T> R_z(const T& angle, const Vec3<T>& u) {
  const T c = cos(angle), s = sin(angle);
  return {c * u[0] - s * u[1], s * u[0] + c * u[1], u[2]};
}
template <class T>
Vec3<T> along_Y(const T& eta) {
  return {T(0.0), eta, T(0.0)};
}

struct FourBar {
  bramah::Gravity gravity;
  Coordinate x_G2, y_G2, z_G2, psi2, theta2, phi2, phi32, phi43, s, alpha;
  HolonomicRow O1_X, O1_Y, O1_Z, v_Y, v_Z, O2_Y, O2_Z, cylinder_Y, cylinder_Z;
  Parameter L_1 = 10.0, L_2 = 2.0, L_3 = 8.0, L_4 = 5.0, d_1 = 1.0, m_2 = 2.0, m_3 = 8.0, m_4 = 5.0;

  void describe(bramah::Description& is) {
    is.called("paper/four_bar", "the four-bar mechanism of Agundez et al. (2023), Sect. 4.1");
    is.port("gravity", gravity, "the field it falls in");
    is.parameter("L_1", L_1, "m").by_default(L_1.value()).above(0.0).doc("ground link, from O_1 to O_2");
    is.parameter("L_2", L_2, "m").by_default(L_2.value()).above(0.0).doc("input link, from O_1 to C");
    is.parameter("L_3", L_3, "m").by_default(L_3.value()).above(0.0).doc("coupler, from C to D");
    is.parameter("L_4", L_4, "m").by_default(L_4.value()).above(0.0).doc("output link, from D to O_2");
    is.parameter("d_1", d_1, "m").by_default(d_1.value()).above(0.0).doc("from O_c to O_1");
    is.parameter("m_2", m_2, "kg").by_default(m_2.value()).above(0.0).doc("mass of the input link");
    is.parameter("m_3", m_3, "kg").by_default(m_3.value()).above(0.0).doc("mass of the coupler");
    is.parameter("m_4", m_4, "kg").by_default(m_4.value()).above(0.0).doc("mass of the output link");

    is.own("x_G2", x_G2, "m", "centre of mass of the input link");
    is.own("y_G2", y_G2, "m", "centre of mass of the input link");
    is.own("z_G2", z_G2, "m", "centre of mass of the input link");
    is.own("psi2", psi2, "rad", "first angle of the input link, about Z");
    is.own("theta2", theta2, "rad", "second angle of the input link, about Y");
    is.own("phi2", phi2, "rad", "third angle of the input link, about X: its rotation in the plane of motion");
    is.own("phi32", phi32, "rad", "rotation of the coupler against the input link");
    is.own("phi43", phi43, "rad", "rotation of the output link against the coupler");
    is.own("s", s, "m", "length of the cylinder, from O_c to G_2").start(1.0);
    is.own("alpha", alpha, "rad", "angle of the cylinder");

    is.holonomic("O1_X", O1_X, "m", "O_1 of the input link is the origin, along X");
    is.holonomic("O1_Y", O1_Y, "m", "O_1 of the input link is the origin, along Y");
    is.holonomic("O1_Z", O1_Z, "m", "O_1 of the input link is the origin, along Z");
    is.holonomic("v_Y", v_Y, "1", "the X axis of the input link has no part along Y");
    is.holonomic("v_Z", v_Z, "1", "the X axis of the input link has no part along Z");
    is.holonomic("O2_Y", O2_Y, "m", "O_2 of the output link is that of the ground, along Y");
    is.holonomic("O2_Z", O2_Z, "m", "O_2 of the output link is that of the ground, along Z");
    is.holonomic("cylinder_Y", cylinder_Y, "m", "the cylinder ends at G_2, along Y");
    is.holonomic("cylinder_Z", cylinder_Z, "m", "the cylinder ends at G_2, along Z");
  }

  // R2 = R_psi2 R_theta2 R_phi2, R3 = R2 R_phi32, R4 = R3 R_phi43, Rc = R_psi2 R_theta2 R_alpha, each times u. Eq. (66)
  template <class T>
  Vec3<T> R2(const Positions<T>& at, const Vec3<T>& u) const {
    return R_z(at(psi2), R_y(at(theta2), R_x(at(phi2), u)));
  }
  template <class T>
  Vec3<T> R3(const Positions<T>& at, const Vec3<T>& u) const {
    return R2(at, R_x(at(phi32), u));
  }
  template <class T>
  Vec3<T> R4(const Positions<T>& at, const Vec3<T>& u) const {
    return R3(at, R_x(at(phi43), u));
  }
  template <class T>
  Vec3<T> Rc(const Positions<T>& at, const Vec3<T>& u) const {
    return R_z(at(psi2), R_y(at(theta2), R_x(at(alpha), u)));
  }

  // The point eta (m) of each link, counted from G_2, C and D. Eqs. (68)-(70)
  template <class T>
  Vec3<T> r2(const Positions<T>& at, const Parameter& eta) const {
    return Vec3<T>{at(x_G2), at(y_G2), at(z_G2)} + R2(at, along_Y(T(eta)));
  }
  template <class T>
  Vec3<T> r3(const Positions<T>& at, const Parameter& eta) const {
    return r2(at, 0.5 * L_2) + R3(at, along_Y(T(eta)));
  }
  template <class T>
  Vec3<T> r4(const Positions<T>& at, const Parameter& eta) const {
    return r3(at, L_3) + R4(at, along_Y(T(eta)));
  }

  // Eq. (67), with the sign of d_1 in row 8 and the component in row 9 put right (docs/theory.md).
  template <class T>
  void holonomic(const Positions<T>& at, bramah::Values<T>& C) const {
    const Vec3<T> r_O1 = r2(at, -0.5 * L_2);
    const Vec3<T> v = {cos(at(psi2)) * cos(at(theta2)), sin(at(psi2)) * cos(at(theta2)), -sin(at(theta2))};  // Eq. (68)
    const Vec3<T> r_O2 = r4(at, L_4);                                                                        // Eq. (69)
    const Vec3<T> r_OcG2 = Rc(at, along_Y(at(s))), r_O1G2 = R2(at, along_Y(T(0.5 * L_2)));                   // Eq. (71)
    C(O1_X) = r_O1[0];
    C(O1_Y) = r_O1[1];
    C(O1_Z) = r_O1[2];
    C(v_Y) = v[1];
    C(v_Z) = v[2];
    C(O2_Y) = r_O2[1] - L_1;
    C(O2_Z) = r_O2[2];
    C(cylinder_Y) = r_OcG2[1] - r_O1G2[1] - d_1;
    C(cylinder_Z) = r_OcG2[2] - r_O1G2[2];
  }

  // Calls add(mass, point) for particles that have the mass, centre and inertia of the three slender rods. Simpson's rule:
  // m/6, 4m/6, m/6 at the ends and the middle give m, its centre, and 2 (m/6) (L/2)^2 = m L^2 / 12 about both normals,
  // and nothing about the axis. Nothing is approximated.
  template <class Add>
  void for_particles(const Add& add) const {
    const auto rod = [&](const Parameter& mass, const Parameter& first, const Parameter& length, const auto& point) {
      for (int k = 0; k < 3; ++k) {
        const Parameter eta = first + 0.5 * k * length, share = k == 1 ? mass * 4.0 / 6.0 : mass / 6.0;
        add(share, [&](const auto& there) { return point(there, eta); });
      }
    };
    rod(m_2, -0.5 * L_2, L_2, [&](const auto& there, const Parameter& eta) { return r2(there, eta); });
    rod(m_3, 0.0, L_3, [&](const auto& there, const Parameter& eta) { return r3(there, eta); });
    rod(m_4, 0.0, L_4, [&](const auto& there, const Parameter& eta) { return r4(there, eta); });
  }
  // M(x) xddot - Q of three rods that fall freely.
  template <class T>
  void balance(const bramah::At<T>& at, bramah::Rows<T>& rows) const {
    for_particles([&](const Parameter& mass, const auto& point) {
      bramah::add_particle<10>(at, rows, mass, at(gravity), point);
    });
  }
  template <class T>
  T energy(const bramah::At<T>& at) const {
    T sum = T(0.0);
    for_particles([&](const Parameter& mass, const auto& point) {
      sum += bramah::particle_energy<10>(at, mass, at(gravity), point);
    });
    return sum;
  }
};

}  // namespace

BRAMAH_LIBRARY("paper", "1.0.0", FourBar)
