// Writes tests/reference/benchmarks.json: published problems of multibody dynamics, solved without the engine.
//
//   g++ -std=c++20 -O2 benchmarks.cpp -o benchmarks && ./benchmarks > ../benchmarks.json
//
// Every problem is set up in coordinates of its own, as few as there are, with equations derived by hand, on numbers of
// 64 bits' mantissa. Where there is no closed form it is integrated by extrapolation of the midpoint rule at two step
// sizes and orders; `agreement` is their largest difference. Names of values are those of the scenes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace {

using real = long double;
const real pi = std::acos(-1.0L);

// ---- numbers with first and second derivative along a curve --------------------------------------------------------

struct Jet {
  real v = 0, d = 0, dd = 0;
  Jet(real value = 0, real first = 0, real second = 0) : v(value), d(first), dd(second) {}
};
Jet operator+(Jet a, Jet b) { return {a.v + b.v, a.d + b.d, a.dd + b.dd}; }
Jet operator-(Jet a, Jet b) { return {a.v - b.v, a.d - b.d, a.dd - b.dd}; }
Jet operator*(Jet a, Jet b) { return {a.v * b.v, a.d * b.v + a.v * b.d, a.dd * b.v + 2 * a.d * b.d + a.v * b.dd}; }
Jet chain(Jet a, real f, real f1, real f2) { return {f, f1 * a.d, f1 * a.dd + f2 * a.d * a.d}; }
Jet operator/(Jet a, Jet b) { return a * chain(b, 1 / b.v, -1 / (b.v * b.v), 2 / (b.v * b.v * b.v)); }
Jet sin(Jet a) { return chain(a, std::sin(a.v), std::cos(a.v), -std::sin(a.v)); }
Jet cos(Jet a) { return chain(a, std::cos(a.v), -std::sin(a.v), -std::cos(a.v)); }
Jet sqrt(Jet a) {
  const real root = std::sqrt(a.v);
  return chain(a, root, 1 / (2 * root), -1 / (4 * a.v * root));
}
/// The angle of (x, y).
Jet angle(Jet y, Jet x) {
  const real r2 = x.v * x.v + y.v * y.v, moment = x.v * y.d - y.v * x.d;
  return {std::atan2(y.v, x.v), moment / r2,
          ((x.v * y.dd - y.v * x.dd) * r2 - moment * 2 * (x.v * x.d + y.v * y.d)) / (r2 * r2)};
}

template <std::size_t D>
using Point = std::array<Jet, D>;

/// One degree of freedom q with T = M(q) q'^2 / 2: collects M, M'/2 and the generalized force.
struct OneDegree {
  real M = 0, half_slope = 0, Q = 0;
  void inertia(real m, Jet p) {
    M += m * p.d * p.d;
    half_slope += m * p.d * p.dd;
  }
  template <std::size_t D>
  void mass(real m, const Point<D>& p) {
    for (const Jet& c : p) inertia(m, c);
  }
  void force(real F, Jet along) { Q += F * along.d; }
  real acceleration(real rate) const { return (Q - half_slope * rate * rate) / M; }
};

// ---- integration ---------------------------------------------------------------------------------------------------

template <std::size_t N>
using State = std::array<real, N>;

/// One step of the midpoint rule, extrapolated from 2, 4, ..., 2 columns substeps: order 2 columns.
template <std::size_t N, class F>
State<N> step(const F& f, real t, const State<N>& y, real H, int columns) {
  std::vector<State<N>> row;  // of the table of Aitken and Neville
  for (int k = 1; k <= columns; ++k) {
    const real h = H / (2 * k);
    State<N> before = y, now, rate = f(t, y);
    for (std::size_t i = 0; i < N; ++i) now[i] = y[i] + h * rate[i];
    for (int s = 1; s < 2 * k; ++s) {
      rate = f(t + s * h, now);
      for (std::size_t i = 0; i < N; ++i) before[i] += 2 * h * rate[i];
      std::swap(before, now);
    }
    std::vector<State<N>> next = {now};
    for (int j = 1; j < k; ++j) {
      const real ratio = static_cast<real>(k) / (k - j), factor = 1 / (ratio * ratio - 1);
      State<N> entry = next.back();
      for (std::size_t i = 0; i < N; ++i) entry[i] += factor * (entry[i] - row[static_cast<std::size_t>(j - 1)][i]);
      next.push_back(entry);
    }
    row = std::move(next);
  }
  return row.back();
}

/// States at `times`, from y at 0, in steps of about H.
template <std::size_t N, class F>
std::vector<State<N>> integrate(const F& f, State<N> y, const std::vector<real>& times, real H, int columns) {
  std::vector<State<N>> result;
  real t = 0;
  for (const real end : times) {
    const long steps = static_cast<long>(std::ceil((end - t) / H - 1e-9L));
    const real start = t, h = (end - start) / steps;
    for (long k = 0; k < steps; ++k) y = step(f, start + k * h, y, h, columns);
    t = end;
    result.push_back(y);
  }
  return result;
}

// ---- writing -------------------------------------------------------------------------------------------------------

using Values = std::vector<std::pair<std::string, real>>;

struct Problem {
  std::string name, source, method;
  std::vector<real> times;
  std::vector<Values> rows = {};
  real agreement = 0;
  Values published = {};
  std::string published_source = {};
};

std::string text(real x, const char* format = "%.18Lg") {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, x);
  return buffer;
}
void write(const Values& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::printf("%s\"%s\": \"%s\"", i == 0 ? "" : ", ", values[i].first.c_str(), text(values[i].second).c_str());
  }
}
void write(const Problem& p, bool last) {
  std::printf(
      "  \"%s\": {\n   \"source\": \"%s\",\n   \"method\": \"%s\",\n   \"agreement\": \"%s\",\n   \"rows\": [\n",
      p.name.c_str(), p.source.c_str(), p.method.c_str(), text(p.agreement, "%.1Le").c_str());
  for (std::size_t k = 0; k < p.rows.size(); ++k) {
    std::printf("    { \"t\": \"%s\", ", text(p.times[k]).c_str());
    write(p.rows[k]);
    std::printf(" }%s\n", k + 1 < p.rows.size() ? "," : "");
  }
  std::printf("   ]");
  if (!p.published.empty()) {
    std::printf(",\n   \"published\": { \"source\": \"%s\", ", p.published_source.c_str());
    write(p.published);
    std::printf(" }");
  }
  std::printf("\n  }%s\n", last ? "" : ",");
}
real largest_difference(const std::vector<Values>& a, const std::vector<Values>& b) {
  real largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    for (std::size_t i = 0; i < a[k].size(); ++i) {
      largest = std::max(largest, std::abs(a[k][i].second - b[k][i].second) / std::max(1.0L, std::abs(a[k][i].second)));
    }
  }
  return largest;
}
/// Integrates twice and compares; `values` turns a time and a state into named values.
template <std::size_t N, class F, class V>
Problem integrated(Problem p, const F& f, const State<N>& start, real H, int columns, const V& values) {
  const auto run = [&](real h, int c) {
    std::vector<Values> rows;
    const std::vector<State<N>> states = integrate(f, start, p.times, h, c);
    for (std::size_t k = 0; k < states.size(); ++k) rows.push_back(values(p.times[k], states[k]));
    return rows;
  };
  p.rows = run(H / 2, columns + 1);
  p.agreement = largest_difference(p.rows, run(H, columns));
  return p;
}

// ---- elliptic functions --------------------------------------------------------------------------------------------

/// Arithmetic-geometric means a_i with c_i, of 1 and sqrt(1 - m).
struct Means {
  std::vector<real> a, c;
  explicit Means(real m) : a{1}, c{std::sqrt(m)} {
    real b = std::sqrt(1 - m);
    while (std::abs(c.back()) > 1e-20L && a.size() < 20) {
      const real mean = (a.back() + b) / 2;
      c.push_back((a.back() - b) / 2);
      b = std::sqrt(a.back() * b);
      a.push_back(mean);
    }
  }
  real K() const { return pi / (2 * a.back()); }
  /// Jacobi's amplitude, by descending Landen transformations.
  real amplitude(real u) const {
    const real turns = std::nearbyint(u / (2 * K()));  // am(u + 2 K) = am(u) + pi
    std::size_t i = a.size() - 1;
    real phi = std::ldexp(a[i] * (u - turns * 2 * K()), static_cast<int>(i));
    for (; i > 0; --i) phi = (phi + std::asin(c[i] / a[i] * std::sin(phi))) / 2;
    return phi + turns * pi;
  }
};

// ---- the problems --------------------------------------------------------------------------------------------------

const real g = 9.81L;

/// Released level: sin(psi / 2) = k cd(w t), k = sin(pi / 4), psi from the bottom.
Problem pendulum() {
  Problem p{"pendulum",
            "IFToMM benchmark A01 (Gonzalez, Dopico, Gonzalez, Cuadrado 2006), run on to 1000 s",
            "closed form by Jacobi's elliptic functions",
            {1, 10, 100, 1000}};
  const real m = 0.5L, k = std::sqrt(m), w = std::sqrt(g);
  const Means means(m);
  const auto at = [&](real t) {
    const real phi = means.amplitude(means.K() - w * t), sn = std::sin(phi), cn = std::cos(phi);
    const real psi = -2 * std::asin(k * sn);  // sn(K - u) = cd(u)
    return Values{{"bob.x", std::sin(psi)},
                  {"bob.y", -std::cos(psi)},
                  {"bob.angle", psi + 1.5L * pi},
                  {"bob.angle.rate", 2 * k * w * cn}};
  };
  for (const real t : p.times) p.rows.push_back(at(t));
  const auto f = [](real, const State<2>& y) { return State<2>{y[1], -g * std::sin(y[0])}; };
  const State<2> check = integrate(f, State<2>{-pi / 2, 0}, {10}, 0.05L, 9)[0];
  p.agreement =
      std::max(std::abs(check[0] + 1.5L * pi - p.rows[1][2].second), std::abs(check[1] - p.rows[1][3].second));
  return p;
}

/// Uprights turn alike, bars across stay level: ((N + 1) / 3 + N) phi'' = -g ((N + 1) / 2 + N) cos phi.
Problem ladder(int N) {
  Problem p{"four_bars_" + std::to_string(N),
            "IFToMM benchmark A02, N four-bars, N = " + std::to_string(N),
            "the motion of all parallelograms alike, closed form by Jacobi's amplitude",
            {0.5L, 1, 2, 5, 10}};
  const real w2 = g * ((N + 1) / 2.0L + N) / ((N + 1) / 3.0L + N), rate2 = 1 + 4 * w2, m = 4 * w2 / rate2;
  const Means means(m);
  const auto at = [&](real t) {
    const real half = means.amplitude(means.K() + std::sqrt(rate2) / 2 * t);  // from the bottom
    const real phi = 1.5L * pi - 2 * half, rate = -std::sqrt(rate2 * (1 - m * std::sin(half) * std::sin(half)));
    return Values{{"upright_0.angle", phi},
                  {"upright_0.angle.rate", rate},
                  {"upright_" + std::to_string(N) + ".angle", phi},
                  {"across_1.x", 0.5L + std::cos(phi)},
                  {"across_1.y", std::sin(phi)},
                  {"across_1.angle", 0}};
  };
  for (const real t : p.times) p.rows.push_back(at(t));
  const auto f = [&](real, const State<2>& y) { return State<2>{y[1], -w2 * std::cos(y[0])}; };
  const State<2> check = integrate(f, State<2>{pi / 2, -1}, {10}, 0.02L, 9)[0];
  p.agreement = std::max(std::abs(check[0] - p.rows.back()[0].second), std::abs(check[1] - p.rows.back()[1].second));
  return p;
}

/// Hairer and Wanner's seven bodies as one degree of freedom, the crank angle beta: where the loops close comes from
/// intersections of circles.
struct Andrews {
  using Vec = Point<2>;
  static Vec on(const Vec& p, real along, real across, Jet c, Jet s) {
    return {p[0] + along * c - across * s, p[1] + along * s + across * c};
  }
  /// The point at distances a of A and b of B, left (+1) or right (-1) of the way from A to B.
  static Vec meet(const Vec& A, real a, const Vec& B, real b, int side) {
    const Jet dx = B[0] - A[0], dy = B[1] - A[1], r2 = dx * dx + dy * dy;
    const Jet along = (r2 + Jet(a * a - b * b)) / (Jet(2) * r2);
    const Jet across = Jet(side) * sqrt(Jet(a * a) / r2 - along * along);
    return {A[0] + along * dx - across * dy, A[1] + along * dy + across * dx};
  }
  struct Places {
    Jet EF, DBE, EG, AG, EH, AH;  // angles of the rods and triangles
    Vec D, com_2, com_4, com_6;
  };
  const real d = 28e-3L, da = 115e-4L, e = 2e-2L, ea = 1421e-5L, rr = 7e-3L, ra = 92e-5L, ss = 35e-3L, sa = 1874e-5L,
             sb = 1043e-5L, sc = 18e-3L, sd = 2e-2L, ta = 2308e-5L, tb = 916e-5L, u = 4e-2L, ua = 1228e-5L,
             ub = 449e-5L, zf = 2e-2L, zt = 4e-2L, fa = 1421e-5L, l0 = 7785e-5L, c0 = 4530, mom = 33e-3L;
  const real m1 = .04325L, m2 = .00365L, m3 = .02373L, m4 = .00706L, m5 = .07050L, m6 = .00706L, m7 = .05498L;
  const real I1 = 2.194e-6L, I2 = 4.410e-7L, I3 = 5.255e-6L, I4 = 5.667e-7L, I5 = 1.169e-5L, I6 = 5.667e-7L,
             I7 = 1.912e-5L;
  const Vec A = {Jet(-.06934L), Jet(-.00227L)}, B = {Jet(-0.03635L), Jet(.03273L)}, C = {Jet(.014L), Jet(.072L)};
  Places places(real beta) const {
    const Jet b(beta, 1, 0);
    const Vec F = {rr * cos(b), rr * sin(b)};
    const Vec E = meet(B, ss, F, d, -1), G = meet(A, zt, E, e, 1), H = meet(A, u, E, zf, -1);
    Places p;
    p.EF = angle(F[1] - E[1], F[0] - E[0]);   // d (cos, sin) from E to F
    p.DBE = angle(E[0] - B[0], B[1] - E[1]);  // ss (sin, -cos) from B to E
    p.AG = angle(G[1] - A[1], G[0] - A[0]);   // zt (cos, sin) from A to G
    p.EG = angle(E[0] - G[0], G[1] - E[1]);   // e (sin, -cos) from G to E
    p.AH = angle(H[0] - A[0], A[1] - H[1]);   // u (sin, -cos) from A to H
    p.EH = angle(E[1] - H[1], E[0] - H[0]);   // zf (cos, sin) from H to E
    p.D = on(B, sd, -sc, cos(p.DBE), sin(p.DBE));
    p.com_2 = on(F, -da, 0, cos(p.EF), sin(p.EF));
    p.com_4 = on(G, 0, -(e - ea), cos(p.EG), sin(p.EG));
    p.com_6 = on(H, zf - fa, 0, cos(p.EH), sin(p.EH));
    return p;
  }
  State<2> operator()(real, const State<2>& y) const {
    const Places p = places(y[0]);
    OneDegree one;
    one.inertia(I1 + m1 * ra * ra, Jet(y[0], 1, 0));
    one.inertia(I2, p.EF);
    one.inertia(I3 + m3 * (sa * sa + sb * sb), p.DBE);
    one.inertia(I4, p.EG);
    one.inertia(I5 + m5 * (ta * ta + tb * tb), p.AG);
    one.inertia(I6, p.EH);
    one.inertia(I7 + m7 * (ua * ua + ub * ub), p.AH);
    one.mass(m2, p.com_2);
    one.mass(m4, p.com_4);
    one.mass(m6, p.com_6);
    const Jet dx = p.D[0] - C[0], dy = p.D[1] - C[1], length = sqrt(dx * dx + dy * dy);
    one.force(-c0 * (length.v - l0), length);
    one.force(mom, Jet(y[0], 1, 0));
    return {y[1], one.acceleration(y[1])};
  }
};
/// The same by all seven angles of Hairer and Wanner, their mass matrix and multipliers of the six loop equations,
/// accelerations from the 13 x 13 system: nothing in common with the above but the parameters.
struct AndrewsByMultipliers : Andrews {
  State<14> operator()(real, const State<14>& y) const {
    const real *q = y.data(), *v = q + 7;
    const real ce = e - ea, cf = zf - fa;  // from G and H to the centres of mass
    real K[13][14] = {};                   // [M G^T; G 0 | Q, -G' v]
    const auto M = [&](int i, int j, real m) { K[i][j] = K[j][i] = m; };
    M(0, 0, m1 * ra * ra + m2 * (rr * rr - 2 * da * rr * std::cos(q[1]) + da * da) + I1 + I2);
    M(1, 0, m2 * (da * da - da * rr * std::cos(q[1])) + I2);
    M(1, 1, m2 * da * da + I2);
    M(2, 2, m3 * (sa * sa + sb * sb) + I3);
    M(3, 3, m4 * ce * ce + I4);
    M(4, 3, m4 * (ce * ce + zt * ce * std::sin(q[3])) + I4);
    M(4, 4, m4 * (zt * zt + 2 * zt * ce * std::sin(q[3]) + ce * ce) + m5 * (ta * ta + tb * tb) + I4 + I5);
    M(5, 5, m6 * cf * cf + I6);
    M(6, 5, m6 * (cf * cf - u * cf * std::sin(q[5])) + I6);
    M(6, 6, m6 * (cf * cf - 2 * u * cf * std::sin(q[5]) + u * u) + m7 * (ua * ua + ub * ub) + I6 + I7);
    const real sg = std::sin(q[2]), cg = std::cos(q[2]);
    const real dx = sd * cg + sc * sg + B[0].v - C[0].v, dy = sd * sg - sc * cg + B[1].v - C[1].v;
    const real pull = -c0 * (1 - l0 / std::hypot(dx, dy));
    K[0][13] = mom - m2 * da * rr * v[1] * (v[1] + 2 * v[0]) * std::sin(q[1]);
    K[1][13] = m2 * da * rr * v[0] * v[0] * std::sin(q[1]);
    K[2][13] = pull * (dx * (sc * cg - sd * sg) + dy * (sd * cg + sc * sg));
    K[3][13] = m4 * zt * ce * v[4] * v[4] * std::cos(q[3]);
    K[4][13] = -m4 * zt * ce * v[3] * (v[3] + 2 * v[4]) * std::cos(q[3]);
    K[5][13] = -m6 * u * cf * v[6] * v[6] * std::cos(q[5]);
    K[6][13] = m6 * u * cf * v[5] * (v[5] + 2 * v[6]) * std::cos(q[5]);
    // Loop equations are sums of r (cos a, sin a), a = the sum of some angles + a right angle times `quarter`.
    const auto bar = [&](int loop, real r, std::initializer_list<int> angles, int quarter) {
      real a = quarter * pi / 2, w = 0;
      for (const int i : angles) a += q[i], w += v[i];
      const real x = r * std::cos(a), y = r * std::sin(a);
      for (const int i : angles) {
        K[7 + loop][i] -= y;
        K[8 + loop][i] += x;
      }
      K[7 + loop][13] += w * w * x;
      K[8 + loop][13] += w * w * y;
    };
    for (int loop = 0; loop < 6; loop += 2) {
      bar(loop, rr, {0}, 0);
      bar(loop, -d, {0, 1}, 0);
    }
    bar(0, -ss, {2}, -1);
    bar(2, -e, {3, 4}, -1);
    bar(2, -zt, {4}, 0);
    bar(4, -zf, {5, 6}, 0);
    bar(4, -u, {6}, -1);
    for (int i = 7; i < 13; ++i) {
      for (int j = 0; j < 7; ++j) K[j][i] = K[i][j];
    }
    for (int k = 0; k < 13; ++k) {  // Gauss, largest pivot of the column
      int pivot = k;
      for (int i = k; i < 13; ++i) pivot = std::abs(K[i][k]) > std::abs(K[pivot][k]) ? i : pivot;
      std::swap(K[pivot], K[k]);
      for (int i = 0; i < 13; ++i) {
        if (i == k) continue;
        const real factor = K[i][k] / K[k][k];
        for (int j = k; j < 14; ++j) K[i][j] -= factor * K[k][j];
      }
    }
    State<14> rate;
    for (std::size_t i = 0; i < 7; ++i) {
      rate[i] = v[i];
      rate[i + 7] = K[i][13] / K[i][i];
    }
    return rate;
  }
};
Problem andrews() {
  const Andrews mechanism;
  Problem p{"andrews",
            "Andrews' squeezing mechanism: Hairer and Wanner, Solving Ordinary Differential Equations II, Sect. VII.7; "
            "Test Set for IVP Solvers",
            "one degree of freedom, loops closed by intersection of circles; at the end also by seven angles and six "
            "multipliers",
            {0.005L, 0.01L, 0.02L, 0.03L}};
  p.published_source = "Test Set for IVP Solvers, andrews, t = 0.03 s, by PSIDE to 1e-14";
  p.published = {{"beta", 0.1581077119629904e2L},    {"theta", -0.1575637105984298e2L},
                 {"gamma", 0.4082224013073101e-1L},  {"phi", -0.5347301163226948e0L},
                 {"delta", 0.5244099658805304e0L},   {"omega", 0.5347301163226948e0L},
                 {"epsilon", 0.1048080741042263e1L}, {"beta.rate", 0.1139920302151208e4L}};
  const real beta = -0.0617138900142764496358948458001L;
  p = integrated(p, mechanism, State<2>{beta, 0}, 1e-4L, 8, [&](real, const State<2>& y) {
    const Andrews::Places at = mechanism.places(y[0]);
    return Values{{"crank.angle", y[0]}, {"crank.angle.rate", y[1]}, {"EF.angle", at.EF.v}, {"DBE.angle", at.DBE.v},
                  {"EG.angle", at.EG.v}, {"AG.angle", at.AG.v},      {"EH.angle", at.EH.v}, {"AH.angle", at.AH.v}};
  });
  const Andrews::Places at = mechanism.places(beta);
  const State<14> start = {beta, at.EF.v - beta, at.DBE.v, at.EG.v - at.AG.v, at.AG.v, at.EH.v - at.AH.v, at.AH.v};
  const State<14> end = integrate(AndrewsByMultipliers(), start, {p.times.back()}, 5e-5L, 8)[0];
  const Values other = {{"", end[0]},          {"", end[7]}, {"", end[0] + end[1]}, {"", end[2]},
                        {"", end[3] + end[4]}, {"", end[4]}, {"", end[5] + end[6]}, {"", end[6]}};
  p.agreement = std::max(p.agreement, largest_difference({p.rows.back()}, {other}));
  return p;
}

/// Shaft and slider turn alike and angular momentum is kept, which leaves beta of the rods and the height s of the
/// slider: J(beta) phi' = L.
Problem governor() {
  Problem p{"flyball_governor",
            "IFToMM benchmark A05, stiff flyball governor",
            "two degrees of freedom by symmetry and conserved angular momentum",
            {0.1L, 1, 2, 5, 10}};
  const real rod = 0.3L, ball = 5, slider = 3, offset = 0.05L, k = 8e5L, c = 4e4L, rest = 0.5L;
  const real along = rod * 2e-4L / 12, across = rod * 1.0001L / 12, shaft = 0.3L * 2e-4L / 12, cube = 3 * 0.01L / 6;
  const auto J = [=](Jet b) {
    const Jet x = cos(b), z = sin(b), middle = Jet(offset) + Jet(0.5L) * x, end = Jet(offset) + x;
    return Jet(shaft + cube) +
           Jet(2) * (Jet(across) * x * x + Jet(along) * z * z + Jet(rod) * middle * middle + Jet(ball) * end * end);
  };
  const real beta0 = pi / 6, L = J(Jet(beta0)).v * 2 * pi;
  const real I = 2 * (across + rod / 4 + ball);  // of both rods about their hinges
  const auto f = [=](real, const State<5>& y) {  // beta, beta', s, s', phi
    const real b = y[0], w = y[1], s = y[2], v = y[3];
    const real x = std::cos(b) / 2, z = 1 - std::sin(b) / 2 - s, length = std::hypot(x, z);
    const real to_b = (-x * std::sin(b) - z * std::cos(b)) / 2 / length, to_s = -z / length;
    const real pull = 2 * (k * (length - rest) + c * (to_b * w + to_s * v));
    const Jet turning = J(Jet(b, 1));
    const real rate = L / turning.v;
    return State<5>{w, (rate * rate * turning.d / 2 + 2 * g * (rod / 2 + ball) * std::cos(b) - pull * to_b) / I, v,
                    -g - pull * to_s / slider, rate};
  };
  const real com = (rod * 0.5L + ball) / (rod + ball);
  return integrated(p, f, State<5>{beta0, 0, 0.5L, 0, 0}, 4e-5L, 4, [&](real, const State<5>& y) {
    const real out = offset + com * std::cos(y[0]);
    return Values{{"slider.z", y[2]},
                  {"slider.z.rate", y[3]},
                  {"rod_1.x", out * std::cos(y[4])},
                  {"rod_1.y", out * std::sin(y[4])},
                  {"rod_1.z", 1 - com * std::sin(y[0])}};
  });
}

/// Three of Bricard's hinge angles are a and three are b, with F = cos a + cos b + cos a cos b = 0; along that
/// curve da/ds = F_b, db/ds = -F_a, and s is the degree of freedom. A rod is 1/6 kg at its ends and 2/3 kg between.
struct Bricard {
  static std::array<Point<3>, 7> hinges(Jet a, Jet b) {
    std::array<Point<3>, 7> P = {};  // from R_6 along the ground to R_1, then along the rods back to R_6
    P[0][2] = Jet(1);
    Point<3> u = {Jet(0), Jet(0), Jet(-1)}, n = {Jet(-1), Jet(0), Jet(0)};
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t k = 0; k < 3; ++k) P[i + 1][k] = P[i][k] + u[k];
      const Jet sign(i % 2 == 0 ? -1 : 1);
      Point<3> axis, side;
      for (std::size_t k = 0; k < 3; ++k) {
        axis[k] = sign * (u[(k + 1) % 3] * n[(k + 2) % 3] - u[(k + 2) % 3] * n[(k + 1) % 3]);
      }
      for (std::size_t k = 0; k < 3; ++k) {
        side[k] = axis[(k + 1) % 3] * u[(k + 2) % 3] - axis[(k + 2) % 3] * u[(k + 1) % 3];
      }
      const Jet turn = i % 2 == 0 ? a : b, c = cos(turn), s = sin(turn);
      for (std::size_t k = 0; k < 3; ++k) u[k] = c * u[k] + s * side[k];
      n = axis;
    }
    return P;
  }
  static std::pair<Jet, Jet> along(real a, real b) {
    const Jet A(a, -std::sin(b) * (1 + std::cos(a))), B(b, std::sin(a) * (1 + std::cos(b)));
    const Jet a1 = Jet(-1) * sin(B) * (Jet(1) + cos(A)), b1 = sin(A) * (Jet(1) + cos(B));
    return {Jet(a, a1.v, a1.d), Jet(b, b1.v, b1.d)};
  }
  State<3> operator()(real, const State<3>& y) const {
    const auto [a, b] = along(y[0], y[1]);
    const std::array<Point<3>, 7> P = hinges(a, b);
    OneDegree one;
    for (std::size_t i = 1; i < 6; ++i) {
      Point<3> middle;
      for (std::size_t k = 0; k < 3; ++k) middle[k] = Jet(0.5L) * (P[i][k] + P[i + 1][k]);
      one.mass(1.0L / 6, P[i]);
      one.mass(2.0L / 3, middle);
      one.mass(1.0L / 6, P[i + 1]);
      one.force(-g, middle[1]);
    }
    return {a.d * y[2], b.d * y[2], one.acceleration(y[2])};
  }
};
Problem bricard() {
  Problem p{"bricard",
            "IFToMM benchmark A04, Bricard's mechanism",
            "one degree of freedom along the curve of its two hinge angles, rods as three particles each",
            {1, 2, 5, 10}};
  const State<3> start = {pi / 2, pi / 2, 0};  // hinges along edges of a cube
  real open = 0;
  p = integrated(p, Bricard(), start, 0.01L, 8, [&](real, const State<3>& y) {
    const auto [a, b] = Bricard::along(y[0], y[1]);
    const auto P = Bricard::hinges(a, b);
    for (std::size_t k = 0; k < 3; ++k) open = std::max(open, std::abs(P[6][k].v - P[0][k].v));
    return Values{{"rod_3.x", (P[3][0].v + P[4][0].v) / 2},
                  {"rod_3.y", (P[3][1].v + P[4][1].v) / 2},
                  {"rod_3.z", (P[3][2].v + P[4][2].v) / 2}};
  });
  p.agreement = std::max(p.agreement, open);
  return p;
}

/// The left wheel's distance rho from the middle along the normal n of the axis, and the angle psi of the chassis.
Problem car_axis() {
  Problem p{"car_axis",
            "Test Set for IVP Solvers, car axis problem",
            "two degrees of freedom with the road as a given function of time",
            {0.5L, 1, 2, 3}};
  p.published_source = "Test Set for IVP Solvers, caraxis, t = 3 s, by GAMD in quadruple precision";
  p.published = {{"x_l", 0.493455784275402809122e-1L},       {"y_l", 0.496989460230171153861L},
                 {"x_r", 0.104174252488542151681e1L},        {"y_r", 0.373911027265361256927L},
                 {"x_l.rate", -0.770583684040972357970e-1L}, {"y_l.rate", 0.744686658723778553466e-2L},
                 {"x_r.rate", 0.175568157537232222276e-1L},  {"y_r.rate", 0.770341043779251976443L}};
  const real K = 10 * 1e-4L / 2, L0 = 0.5L;
  struct Road {
    real n[2], n1[2], n2[2];
  };
  const auto road = [](real t) {
    const real s = 0.1L * std::sin(10 * t), s1 = std::cos(10 * t), s2 = -10 * std::sin(10 * t),
               c = std::sqrt(1 - s * s);
    const real c1 = -s * s1 / c, c2 = -(s1 * s1 + s * s2 + c1 * c1) / c;
    return Road{{-s, c}, {-s1, c1}, {-s2, c2}};
  };
  const auto f = [=](real t, const State<4>& y) {  // rho, rho', psi, psi'
    const Road r = road(t);
    const real u[2] = {std::cos(y[2]), std::sin(y[2])}, v[2] = {-u[1], u[0]};
    const real left[2] = {y[0] * r.n[0], y[0] * r.n[1]};
    const real right[2] = {left[0] + u[0] - r.n[1], left[1] + u[1] + r.n[0]};  // from the end (n_y, -n_x) of the axis
    const real l = std::hypot(left[0], left[1]), q = std::hypot(right[0], right[1]);
    real sum[2], of_right[2];  // forces less those of the known accelerations
    for (int k = 0; k < 2; ++k) {
      const real weight = k == 1 ? K : 0, drift = 2 * y[1] * r.n1[k] + y[0] * r.n2[k];
      of_right[k] = (L0 - q) * right[k] / q - weight - K * (drift - y[3] * y[3] * u[k]);
      sum[k] = (L0 - l) * left[k] / l - weight - K * drift + of_right[k];
    }
    // K [2, n.v; n.v, 1] (rho'', psi'') = (n . sum, v . of_right)
    const real nv = r.n[0] * v[0] + r.n[1] * v[1];
    const real a = r.n[0] * sum[0] + r.n[1] * sum[1], b = v[0] * of_right[0] + v[1] * of_right[1];
    const real det = K * (2 - nv * nv);
    return State<4>{y[1], (a - nv * b) / det, y[3], (2 * b - nv * a) / det};
  };
  return integrated(p, f, State<4>{L0, 0, 0, 0}, 0.002L, 8, [&](real t, const State<4>& y) {
    const Road r = road(t);
    const real u[2] = {std::cos(y[2]), std::sin(y[2])};
    return Values{{"chassis.x", y[0] * r.n[0] + u[0] / 2},
                  {"chassis.y", y[0] * r.n[1] + u[1] / 2},
                  {"chassis.angle", y[2]},
                  {"chassis.x.rate", y[1] * r.n[0] + y[0] * r.n1[0] - y[3] * u[1] / 2},
                  {"chassis.y.rate", y[1] * r.n[1] + y[0] * r.n1[1] + y[3] * u[0] / 2},
                  {"chassis.angle.rate", y[3]}};
  });
}

/// About the tip, d along the axle: H = I d x d' + C w d, H' = -m g d x e_z, which gives d''.
Problem top() {
  Problem p{"heavy_top",
            "the heavy top of Bruels, Cardona and Arnold (2012)",
            "its axle as a point on the sphere, spin conserved",
            {0.5L, 1, 1.5L, 2}};
  const real m = 15, I = 0.234375L + m, C = 0.46875L, spin = 150;
  const auto f = [=](real, const State<6>& y) {
    const real speed2 = y[3] * y[3] + y[4] * y[4] + y[5] * y[5], n = C * spin / I, w = m * g / I;
    const real turn[3] = {y[1] * y[5] - y[2] * y[4], y[2] * y[3] - y[0] * y[5], y[0] * y[4] - y[1] * y[3]};
    State<6> rate;
    for (std::size_t k = 0; k < 3; ++k) {
      rate[k] = y[k + 3];
      rate[k + 3] = -speed2 * y[k] + n * turn[k] + w * (y[k] * y[2] - (k == 2 ? 1 : 0));
    }
    return rate;
  };
  return integrated(p, f, State<6>{0, 1, 0, 4.61538L, 0, 0}, 0.01L, 8, [](real, const State<6>& y) {
    return Values{{"top.x", y[0]},      {"top.y", y[1]},      {"top.z", y[2]},
                  {"top.x.rate", y[3]}, {"top.y.rate", y[4]}, {"top.z.rate", y[5]}};
  });
}

/// Frame e_1 level ahead, e_2 along the axle, e_3 from contact to centre; w in it, contact at rest.
Problem disc() {
  Problem p{"rolling_disc",
            "a thin disc that rolls in a wavy circle; no published digits",
            "three rates in the frame of the axle, the contact force eliminated by hand",
            {0.5L, 1, 2, 5}};
  const real m = 2, a = 0.3L, A = 0.045L, C = 0.09L;
  const auto f = [=](real, const State<8>& y) {  // w_1, w_2, w_3, lean, yaw, spin, x, y
    const real w1 = y[0], w2 = y[1], w3 = y[2], s = std::sin(y[3]), c = std::cos(y[3]), r2 = m * a * a;
    return State<8>{((C + r2) * w2 * w3 - A * w3 * w3 * s / c + m * g * a * s) / (A + r2),
                    -r2 * w1 * w3 / (C + r2),
                    (-C * w1 * w2 + A * w1 * w3 * s / c) / A,
                    w1,
                    w3 / c,
                    w2 - w3 * s / c,
                    a * (w2 * std::cos(y[4]) + w1 * c * std::sin(y[4])),
                    a * (w2 * std::sin(y[4]) - w1 * c * std::cos(y[4]))};
  };
  const real lean = 0.3L, yaw_rate = -2, lean_rate = 0.5L, spin_rate = 6;
  const State<8> start = {lean_rate, spin_rate + yaw_rate * std::sin(lean), yaw_rate * std::cos(lean), lean, 0, 0, 0,
                          0};
  return integrated(p, f, start, 0.02L, 8, [&](real, const State<8>& y) {
    return Values{{"wheel.x", y[6]},   {"wheel.y", y[7]},    {"wheel.z", a * std::cos(y[3])},
                  {"wheel.yaw", y[4]}, {"wheel.lean", y[3]}, {"wheel.spin", y[5]}};
  });
}

/// m u' = m a w^2, (I + m a^2) w' = -m a u w: u = c tanh(k tau), w = c sqrt(m / J) sech(k tau), k = a c m / J.
Problem sleigh() {
  Problem p{"chaplygin_sleigh",
            "Chaplygin's sleigh pushed backwards, so that it turns round; no published digits",
            "closed form for speeds and heading, the path by quadrature",
            {1, 2, 5, 10}};
  const real m = 2, a = 0.3L, J = 0.1L + m * a * a, u0 = -1, w0 = 0.05L;
  const real c = std::sqrt(u0 * u0 + J / m * w0 * w0), k = a * c * m / J, start = std::atanh(u0 / c) / k;
  const auto gd = [](real x) { return 2 * std::atan(std::tanh(x / 2)); };
  const auto heading = [=](real t) { return c * std::sqrt(m / J) / k * (gd(k * (start + t)) - gd(k * start)); };
  const auto f = [=](real t, const State<2>&) {
    const real u = c * std::tanh(k * (start + t)), psi = heading(t);
    return State<2>{u * std::cos(psi), u * std::sin(psi)};
  };
  return integrated(p, f, State<2>{-a, 0}, 0.02L, 8, [=](real t, const State<2>& y) {
    const real psi = heading(t);
    return Values{{"sleigh.x", y[0] + a * std::cos(psi)},
                  {"sleigh.y", y[1] + a * std::sin(psi)},
                  {"sleigh.angle", psi},
                  {"sleigh.angle.rate", c * std::sqrt(m / J) / std::cosh(k * (start + t))}};
  });
}

/// Pole angle th from the bottom: th'^2 = 2 g cos th / (sin^2 th + e cos^2 th), e the cart's share of the mass; time is
/// a quadrature and its inverse the motion.
Problem cart_pole() {
  Problem p{"light_cart_pole",
            "a pole released level from a cart of 1e-6 of its mass; no published digits",
            "energy and momentum integrals, time by quadrature",
            {0.4L, 0.5L, 1, 2, 5}};
  const real e = 1e-6L / (1 + 1e-6L), share = 1 / (1 + 1e-6L);
  const auto slowness = [=](real th) {
    const real s = std::sin(th), c = std::cos(th);
    return std::sqrt((s * s + e * c * c) / (2 * g * c));
  };
  // Tanh-sinh rule on (0, b): nodes crowd at 0, where the cart whips.
  const auto rule = [](const auto& f, real b, real h) {
    real sum = 0;
    for (int k = static_cast<int>(-4.5L / h); k <= static_cast<int>(4.5L / h); ++k) {
      const real x = k * h, outer = pi / 2 * std::sinh(x), share_below = 1 / (1 + std::exp(-2 * outer));
      sum += f(b * share_below) * h * pi * std::cosh(x) * share_below / (1 + std::exp(2 * outer));
    }
    return b * sum;
  };
  const auto run = [&](real h) {
    // Near level, cos th = w^2.
    const auto level = [=](real w) {
      const real w4 = w * w * w * w;
      return std::sqrt((1 - (1 - e) * w4) / (1 - w4)) * 2 / std::sqrt(2 * g);
    };
    const real bend = pi / 4;
    const real below = rule(slowness, bend, h);
    const auto from_bottom = [&](real th) {
      return th <= bend ? rule(slowness, th, h)
                        : below + rule(level, std::sqrt(std::cos(bend)), h) - rule(level, std::sqrt(std::cos(th)), h);
    };
    const real quarter = below + rule(level, std::sqrt(std::cos(bend)), h);
    std::vector<Values> rows;
    for (const real t : p.times) {
      const real phase = std::remainder(t - quarter, 4 * quarter);  // 0: through the bottom to the left
      const real tau = std::abs(phase) <= quarter ? std::abs(phase) : 2 * quarter - std::abs(phase);
      const bool left = phase > 0;
      real th = pi / 4;
      for (int k = 0; k < 60; ++k) th = std::clamp(th - (from_bottom(th) - tau) / slowness(th), th / 4, (th + pi) / 3);
      const real signed_th = left ? -th : th;
      rows.push_back({{"pole.angle", signed_th - pi / 2}, {"cart.x", share * (1 - std::sin(signed_th))}});
    }
    return rows;
  };
  p.rows = run(1.0L / 64);
  p.agreement = largest_difference(p.rows, run(1.0L / 48));
  return p;
}

}  // namespace

int main() {
  const std::vector<Problem> problems = {pendulum(), ladder(2), ladder(40), andrews(), governor(), bricard(),
                                         car_axis(), top(),     disc(),     sleigh(),  cart_pole()};
  std::printf(
      "{\n \"about\": \"Values of published problems at a few times, by names of the scenes, in SI units; how each was "
      "found, and agreement, the largest difference of two computations. Written by generators/benchmarks.cpp.\",\n");
  std::printf(" \"problems\": {\n");
  for (std::size_t i = 0; i < problems.size(); ++i) write(problems[i], i + 1 == problems.size());
  std::printf(" }\n}\n");
}
