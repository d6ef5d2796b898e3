// A library that loads, of components that no scene can use: what `compile` must find out.
#include <bramah/component.hpp>

namespace bramah::loose {

/// A coordinate that neither mass nor constraint acts on.
struct Slide {
  Coordinate q;
  void describe(Description& is) {
    is.called("loose/slide", "a coordinate without an equation");
    is.own("q", q, "m", "where it is");
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.apply(q, -1.0 * at(q));
  }
};

/// A spool that is read and never stored.
struct Spring {
  Spool U;
  void describe(Description& is) {
    is.called("loose/spool", "a spool without a storage balance");
    is.own("U", U, "1", "where it is");
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.inflow(U, -1.0 * at(U));
  }
};

/// Reads any signal; every kind of parameter with every kind of limit.
struct Limits {
  Input read;
  Output echo;
  double low = 0.0, high = 0.0, between = 0.0;
  std::vector<double> many;
  std::string note;
  void describe(Description& is) {
    is.called("loose/limits", "one parameter for each kind of limit");
    is.port("signal", read, "what it reads", "N").optional({0.0});
    is.parameter("low", low, "m").by_default(1.0).at_least(0.0).doc("not below zero");
    is.parameter("high", high, "Pa").by_default(-1.0).below(0.0).doc("under pressure");
    is.parameter("between", between, "1").by_default(0.5).above(0.0).at_most(1.0).doc("a share");
    is.parameter("many", many, "s").by_default({1.0}).at_least(0.0).doc("some times");
    is.parameter("note", note).by_default("").doc("what comes to mind");
    is.output("echo", echo, "N", "what it reads");
  }
  template <class T>
  void output(const At<T>& at, Values<T>& y) const {
    y(echo) = at(read);
  }
};

}  // namespace bramah::loose

using namespace bramah::loose;

BRAMAH_LIBRARY("loose", "1.0.0", Slide, Spring, Limits)
