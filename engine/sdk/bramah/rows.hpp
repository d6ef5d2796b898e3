// Where a component adds its share of the balances. The verbs carry the signs.
#pragma once

#include "bramah/at.hpp"

namespace bramah {

/// Inertia of a rigid body in its frame at the centre of mass: (xx, yy, zz, xy, xz, yz), kg.m^2, with I_xy = -int x y dm
/// written as the element of the matrix.
using Inertia = std::array<Parameter, 6>;

/// I w, N.m.s or N.m.
template <class S>
Vec3<S> times(const Inertia& I, const Vec3<S>& w) {
  return {w[0] * I[0] + w[1] * I[3] + w[2] * I[4], w[0] * I[3] + w[1] * I[1] + w[2] * I[5],
          w[0] * I[4] + w[1] * I[5] + w[2] * I[2]};
}

template <class T>
class Rows {
 public:
  Rows(const At<T>& at, T* f, T* g) : at_(at), f_(f), g_(g) {}

  /// Adds mass (kg or kg.m^2) times the coordinate's acceleration.
  template <class S>
  void inertia(Coordinate q, const S& mass) {
    f_[detail::tied<T>(q)] += at_.acceleration(q) * mass;
  }
  /// A rigid body whose frame sits at its centre of mass: Newton and Euler, f_e = 2 L^T (I 2 L eddot + w x I w).
  void inertia(Frame frame, const Parameter& mass, const Inertia& inertia) {
    const Vec3<T> a = at_.acceleration(frame);
    for (std::size_t k = 0; k < 3; ++k) f_[slot(frame, k)] += a[k] * mass;
    const Quaternion<T> e = at_.orientation(frame);
    const Vec3<T> w = at_.angular_velocity(frame);
    const Vec3<T> alpha = 2.0 * body_rate(e, at_.orientation_acceleration(frame));
    const Vec3<T> torque = times(inertia, alpha) + cross(w, times(inertia, w));
    const Quaternion<T> q = body_rate_transposed(e, torque);
    for (std::size_t k = 0; k < 4; ++k) f_[slot(frame, 3 + k)] += q[k] * 2.0;
  }
  /// A planar body whose frame sits at its centre of mass; inertia about that point, kg.m^2.
  void inertia(PlanarFrame frame, const Parameter& mass, const Parameter& inertia) {
    const Vec2<T> a = at_.acceleration(frame);
    f_[slot(frame, 0)] += a[0] * mass;
    f_[slot(frame, 1)] += a[1] * mass;
    f_[slot(frame, 2)] += at_.acceleration_of_angle(frame) * inertia;
  }

  /// Adds the generalized force Q (N or N.m) to a coordinate.
  void apply(Coordinate q, const T& force) { f_[detail::tied<T>(q)] -= force; }
  /// A force (N, ground axes) at the point r of the body.
  template <class S = double>
  void apply(Frame frame, const Vec3<S>& r, const Vec3<T>& force) {
    for (std::size_t k = 0; k < 3; ++k) f_[slot(frame, k)] -= force[k];
    const Quaternion<T> q = point_force(at_.orientation(frame), r, force);
    for (std::size_t k = 0; k < 4; ++k) f_[slot(frame, 3 + k)] -= q[k];
  }
  /// A force (N, ground axes) at the origin of the frame.
  void apply(Frame frame, const Vec3<T>& force) {
    for (std::size_t k = 0; k < 3; ++k) f_[slot(frame, k)] -= force[k];
  }
  /// A torque (N.m) in body axes.
  void apply_torque(Frame frame, const Vec3<T>& torque) {
    const Quaternion<T> q = body_rate_transposed(at_.orientation(frame), torque);
    for (std::size_t k = 0; k < 4; ++k) f_[slot(frame, 3 + k)] -= q[k] * 2.0;
  }
  template <class S = double>
  void apply(PlanarFrame frame, const Vec2<S>& r, const Vec2<T>& force) {
    apply(frame, force);
    const Vec2<T> d = at_.direction(frame, r);
    f_[slot(frame, 2)] -= d[0] * force[1] - d[1] * force[0];
  }
  void apply(PlanarFrame frame, const Vec2<T>& force) {
    f_[slot(frame, 0)] -= force[0];
    f_[slot(frame, 1)] -= force[1];
  }
  void apply_torque(PlanarFrame frame, const T& torque) { f_[slot(frame, 2)] -= torque; }

  /// Adds K zdot + rate to the balance of a first-order variable: for a volume, K = V / B_e (m^3/Pa) and rate = dV/dt.
  template <class S>
  void store(FirstOrder p, const S& K, const T& rate) {
    g_[detail::tied<T>(p)] += at_.rate(p) * K + rate;
  }
  template <class S>
  void store(FirstOrder p, const S& K) {
    g_[detail::tied<T>(p)] += at_.rate(p) * K;
  }
  /// Flow into a volume (m^3/s); for other first-order variables the right-hand side h of K zdot = h.
  void inflow(FirstOrder p, const T& flow) { g_[detail::tied<T>(p)] -= flow; }

 private:
  static std::size_t slot(Handle h, std::size_t k) { return static_cast<std::size_t>(detail::tied<T>(h)) + k; }
  const At<T>& at_;
  T *f_, *g_;
};

/// Constraint rows and outputs: `rows(handle) = value`.
template <class T>
class Values {
 public:
  /// `first`: slot of the handle that values[0] belongs to.
  explicit Values(T* values, int first = 0) : values_(values), first_(first) {}
  T& operator()(Handle row) { return values_[detail::tied<T>(row, first_)]; }

 private:
  T* values_;
  int first_;
};

}  // namespace bramah
