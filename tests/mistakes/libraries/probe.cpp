// A spring with a damper and a signal, right with M = 0. Every other M is one mistake that authors of plugins make.
#include <bramah/component.hpp>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>
#ifndef M
#define M 0
#endif
#ifndef LIBRARY
#define LIBRARY "probe"
#endif

struct Spring {
  bramah::Coordinate along, other;
  bramah::HolonomicRow tie;
  bramah::Switch edge;
  bramah::Output force_out, spare;
  bramah::Parameter k = 0.0, c = 0.0;
#if M == 12
  mutable double drift = 0.0;
#endif

  void describe(bramah::Description& is) {
#if M == 16
    for (volatile int i = 0; i == 0;) {
    }
#endif
#if M == 21
    static int times = 0;
    if (++times > 1) is.output("spare", spare, "N", "appears the second time");
#endif
#if M == 22
    throw std::runtime_error("the table of materials is missing");
#endif
    is.called(LIBRARY "/spring", "a linear spring with a damper along a length");
    is.port("along", along, "the length it acts on", "m");
#if M == 7
    is.port("other", other, "declared and never read", "m");
#endif
#if M == 3
    is.parameter("k", k, "N/furlong").at_least(0.0).doc("stiffness");
#else
    is.parameter("k", k, "N/m").at_least(0.0).doc("stiffness");
#endif
    is.parameter("c", c, "N.s/m").by_default(0.0).at_least(0.0).doc("damping");
    is.output("force", force_out, "N", "force, positive where it lengthens");
#if M == 6
    is.switching("edge", edge, "m", 1e-3, "where the law has a kink");
#endif
#if M == 13
    is.holonomic("tie", tie, "m", "declared and never written");
#endif
  }
  template <class T>
  T force(const bramah::At<T>& at) const {
#if M == 8
    return k * at(along) - c * at.rate(along);
#elif M == 10
    return -k * at(along) - c * at.rate(along) + (value(at(along)) > 0.5 ? 5.0 : 0.0);
#elif M == 11
    return T(-k * value(at(along))) - c * at.rate(along);
#elif M == 12
    drift += 1e-6;
    return -k * at(along) - c * at.rate(along) + drift;
#elif M == 24
    const double s = at(along);
    return -k * s - c * at.rate(along);
#elif M == 25
    return -k * std::fabs(at(along)) - c * at.rate(along);
#elif M == 4
    return -k * (at(along) - at(other)) - c * at.rate(along);
#else
    return -k * at(along) - c * at.rate(along);
#endif
  }
#if M == 1
  template <class T>
  void balanc(const bramah::At<T>& at, bramah::Rows<T>& rows) const {
    rows.apply(along, force(at));
  }
#elif M == 2
  template <class T>
  void balance(const bramah::At<T>& at, bramah::Rows<T>& rows) {
    rows.apply(along, force(at));
  }
#else
  template <class T>
  void balance(const bramah::At<T>& at, bramah::Rows<T>& rows) const {
#if M == 14
    std::abort();
#endif
#if M == 15
    std::raise(SIGSEGV);
#endif
    rows.apply(along, force(at));
  }
#endif
#if M == 13
  template <class T>
  void holonomic(const bramah::Positions<T>&, bramah::Values<T>&) const {}
#endif
  template <class T>
  T energy(const bramah::At<T>& at) const {
#if M == 9
    return 5.0 * k * square(at(along));
#else
    return 0.5 * k * square(at(along));
#endif
  }
  template <class T>
  void output(const bramah::At<T>& at, bramah::Values<T>& y) const {
#if M != 5
    y(force_out) = force(at);
#endif
#if M == 20 || M == 21
    y(spare) = force(at);
#endif
  }
};

struct Pulse {
  bramah::Input value_out;
  bramah::Parameter height = 1.0;
  void describe(bramah::Description& is) {
    is.called(LIBRARY "/pulse", "a force that is on from 0.2 s to 0.4 s");
    is.parameter("height", height, "N").by_default(1.0).doc("height");
    is.provide_signal<bramah::Input>("value", "N", "the force");
  }
  bramah::Parameter signal(double t, int side) const {
#if M == 18
    if (t > 0.1) throw std::runtime_error("no value beyond 0.1 s");
#endif
#if M == 23
    if (t > 0.1) return std::nan("");
#endif
    const bool on = side < 0 ? t > 0.2 && t <= 0.4 : t >= 0.2 && t < 0.4;
    return on ? height : bramah::Parameter(0.0);
  }
#if M == 26
  bramah::Parameter next_breakpoint(double t) const {
#else
  double next_breakpoint(double t) const {
#endif
#if M == 17
      return t;
#endif
#if M == 19
  throw std::runtime_error("no breakpoints here");
#endif
  return t < 0.2 ? 0.2 : t < 0.4 ? 0.4 : HUGE_VAL;
}
}
;

BRAMAH_LIBRARY(LIBRARY, "1.0.0", Spring, Pulse)
