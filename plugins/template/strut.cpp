// A spring with a damper along a length: adds to Q of Eq. (9)
//
//   F = -k (s - s_0) - c sdot    N, positive where it lengthens
//
//   s     along   m       the length
//   s_0           m       the length without force
//   k             N/m     stiffness
//   c             N.s/m   damping
#include <bramah/component.hpp>

struct SpringDamper {
  bramah::Coordinate along;
  bramah::Output force_out;
  bramah::Parameter k = 0.0, c = 0.0, s_0 = 0.0;

  void describe(bramah::Description& is) {
    is.called("strut/spring_damper", "a linear spring with a damper along a length");
    is.port("along", along, "the length it acts on", "m");
    is.parameter("k", k, "N/m").at_least(0.0).doc("stiffness");
    is.parameter("c", c, "N.s/m").by_default(0.0).at_least(0.0).doc("damping");
    is.parameter("s_0", s_0, "m").doc("the length without force");
    is.output("force", force_out, "N", "force, positive where it lengthens");
  }
  template <class T>
  T force(const bramah::At<T>& at) const {
    return -k * (at(along) - s_0) - c * at.rate(along);
  }
  template <class T>
  void balance(const bramah::At<T>& at, bramah::Rows<T>& rows) const {
    rows.apply(along, force(at));
  }
  template <class T>
  T energy(const bramah::At<T>& at) const {
    return 0.5 * k * square(at(along) - s_0);
  }
  template <class T>
  void output(const bramah::At<T>& at, bramah::Values<T>& y) const {
    y(force_out) = force(at);
  }
};

BRAMAH_LIBRARY("strut", "1.0.0", SpringDamper)
