// Everything a component author includes.
//
// A component is a struct with `void describe(bramah::Description&)` and any of
//   template <class T> void balance(const bramah::At<T>&, bramah::Rows<T>&) const;             forces and storage
//   template <class T> void holonomic(const bramah::Positions<T>&, bramah::Values<T>&) const;  c(t, x) = 0
//   template <class T> void nonholonomic(const bramah::Motion<T>&, bramah::Values<T>&) const;  b(t, x, v) = 0, affine in v
//   template <class T> void output(const bramah::At<T>&, bramah::Values<T>&) const;            measurements
//   template <class T> T energy(const bramah::At<T>&) const;                                   what it stores, J
//   template <class T> void switches(const bramah::At<T>&, bramah::Values<T>&) const;          kinks of the law
//   template <class T> void validity(const bramah::At<T>&, bramah::Values<T>&) const;          where the law holds
//   void check(bramah::Faults&) const;                                                         limits across parameters
//   void start(bramah::Start&) const;                                                          start values
//   void constants(Parameter*) const;  Parameter signal(double t, int side) const;  double next_breakpoint(double) const;
// and a library is BRAMAH_LIBRARY("name", "1.0.0", Component, Component, ...).
#pragma once

#if !defined(__cplusplus) || __cplusplus < 202002L
#error "Bramah components need C++20: compile with -std=c++20"
#else

#include "bramah/at.hpp"
#include "bramah/describe.hpp"
#include "bramah/energy.hpp"
#include "bramah/export.hpp"
#include "bramah/math.hpp"
#include "bramah/measure.hpp"
#include "bramah/rows.hpp"
#include "bramah/vector.hpp"

#endif
