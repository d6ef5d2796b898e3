// What a component sees while it is evaluated: the local values of its variables, on the scalar T.
//
//   Positions<T>  t, x                     holonomic rows
//   Motion<T>     t, x, v                  nonholonomic rows
//   At<T>         t, x, v, a, z, u         balances, outputs, switching functions
#pragma once

#include "bramah/handles.hpp"
#include "bramah/math.hpp"
#include "bramah/vector.hpp"

namespace bramah {

template <class T>
class Positions {
 public:
  Positions(const T* x, T time, int side) : x_(x), time_(time), side_(side) {}

  [[nodiscard]] const T& operator()(Coordinate q) const { return x_[detail::tied<T>(q)]; }
  [[nodiscard]] const T& time() const { return time_; }

  [[nodiscard]] Vec3<T> position(Frame f) const {
    return {x_[detail::tied<T>(f)], x_[detail::tied<T>(f) + 1], x_[detail::tied<T>(f) + 2]};
  }
  [[nodiscard]] Quaternion<T> orientation(Frame f) const {
    return {x_[detail::tied<T>(f) + 3], x_[detail::tied<T>(f) + 4], x_[detail::tied<T>(f) + 5],
            x_[detail::tied<T>(f) + 6]};
  }
  /// The point r of the body (body axes, m) in the ground frame.
  template <class S = double>
  [[nodiscard]] Vec3<T> point(Frame f, const Vec3<S>& r) const {
    return position(f) + direction(f, r);
  }
  /// The direction d of the body in the ground frame.
  template <class S = double>
  [[nodiscard]] Vec3<T> direction(Frame f, const Vec3<S>& d) const {
    return rotate(orientation(f), d);
  }

  [[nodiscard]] const T& angle(PlanarFrame f) const { return x_[detail::tied<T>(f) + 2]; }
  [[nodiscard]] Vec2<T> position(PlanarFrame f) const { return {x_[detail::tied<T>(f)], x_[detail::tied<T>(f) + 1]}; }
  template <class S = double>
  [[nodiscard]] Vec2<T> point(PlanarFrame f, const Vec2<S>& r) const {
    return position(f) + direction(f, r);
  }
  template <class S = double>
  [[nodiscard]] Vec2<T> direction(PlanarFrame f, const Vec2<S>& d) const {
    const T c = cos(angle(f)), s = sin(angle(f));
    return {c * d[0] - s * d[1], s * d[0] + c * d[1]};
  }

  /// Whether a > 0, or a = 0 on the side that the analysis takes: for laws with a declared switching function.
  [[nodiscard]] bool above_zero(const T& a) const {
    const double v = value(a);
    return v > 0.0 || (v == 0.0 && side_ > 0);
  }

 protected:
  const T* x_;
  T time_;
  int side_;
};

template <class T>
class Motion : public Positions<T> {
 public:
  Motion(const T* x, const T* v, T time, int side) : Positions<T>(x, time, side), v_(v) {}

  [[nodiscard]] const T& rate(Coordinate q) const { return v_[detail::tied<T>(q)]; }
  [[nodiscard]] const T& rate_of_angle(PlanarFrame f) const { return v_[detail::tied<T>(f) + 2]; }
  [[nodiscard]] Vec2<T> velocity(PlanarFrame f) const { return {v_[detail::tied<T>(f)], v_[detail::tied<T>(f) + 1]}; }
  template <class S = double>
  [[nodiscard]] Vec2<T> velocity(PlanarFrame f, const Vec2<S>& r) const {
    const Vec2<T> d = this->direction(f, r);
    const T& w = rate_of_angle(f);
    return {v_[detail::tied<T>(f)] - w * d[1], v_[detail::tied<T>(f) + 1] + w * d[0]};
  }
  [[nodiscard]] Vec3<T> velocity(Frame f) const {
    return {v_[detail::tied<T>(f)], v_[detail::tied<T>(f) + 1], v_[detail::tied<T>(f) + 2]};
  }
  [[nodiscard]] Quaternion<T> orientation_rate(Frame f) const {
    return {v_[detail::tied<T>(f) + 3], v_[detail::tied<T>(f) + 4], v_[detail::tied<T>(f) + 5],
            v_[detail::tied<T>(f) + 6]};
  }
  /// Velocity of the point r of the body in the ground frame: rdot + d(A(e) r)/de edot.
  template <class S = double>
  [[nodiscard]] Vec3<T> velocity(Frame f, const Vec3<S>& r) const {
    // A(e) r is quadratic in e, so its rate is the difference of the form at e + edot and e - edot over two.
    const Quaternion<T> e = this->orientation(f), q = orientation_rate(f);
    const Vec3<T> forward = rotate(e + q, r), backward = rotate(e - q, r);
    return velocity(f) + 0.5 * (forward - backward);
  }
  /// Angular velocity in body axes, 2 L(e) edot.
  [[nodiscard]] Vec3<T> angular_velocity(Frame f) const {
    return 2.0 * body_rate(this->orientation(f), orientation_rate(f));
  }

 protected:
  const T* v_;
};

template <class T>
class At : public Motion<T> {
 public:
  At(const T* x, const T* v, const T* a, const T* z, const T* zdot, const T* u, const T* lambda, T time, int side)
      : Motion<T>(x, v, time, side), a_(a), z_(z), zdot_(zdot), u_(u), lambda_(lambda) {}

  using Positions<T>::operator();
  [[nodiscard]] const T& operator()(FirstOrder p) const { return z_[detail::tied<T>(p)]; }
  [[nodiscard]] const T& operator()(Input w) const { return u_[detail::tied<T>(w)]; }
  [[nodiscard]] Vec3<T> operator()(Gravity g) const {
    return {u_[detail::tied<T>(g)], u_[detail::tied<T>(g) + 1], u_[detail::tied<T>(g) + 2]};
  }

  [[nodiscard]] const T& acceleration(Coordinate q) const { return a_[detail::tied<T>(q)]; }
  [[nodiscard]] Vec3<T> acceleration(Frame f) const {
    return {a_[detail::tied<T>(f)], a_[detail::tied<T>(f) + 1], a_[detail::tied<T>(f) + 2]};
  }
  [[nodiscard]] Quaternion<T> orientation_acceleration(Frame f) const {
    return {a_[detail::tied<T>(f) + 3], a_[detail::tied<T>(f) + 4], a_[detail::tied<T>(f) + 5],
            a_[detail::tied<T>(f) + 6]};
  }
  [[nodiscard]] Vec2<T> acceleration(PlanarFrame f) const {
    return {a_[detail::tied<T>(f)], a_[detail::tied<T>(f) + 1]};
  }
  [[nodiscard]] const T& acceleration_of_angle(PlanarFrame f) const { return a_[detail::tied<T>(f) + 2]; }
  [[nodiscard]] const T& rate(FirstOrder p) const { return zdot_[detail::tied<T>(p)]; }
  using Motion<T>::rate;

  /// Multiplier of an own row; only in outputs.
  [[nodiscard]] const T& multiplier(HolonomicRow row) const { return lambda_[detail::tied<T>(row)]; }
  [[nodiscard]] const T& multiplier(NonholonomicRow row) const { return lambda_[detail::tied<T>(row)]; }

  [[nodiscard]] const T* x() const { return this->x_; }
  [[nodiscard]] const T* v() const { return this->v_; }
  [[nodiscard]] const T* a() const { return a_; }

 private:
  const T *a_, *z_, *zdot_, *u_, *lambda_;
};

}  // namespace bramah
