// Flow in a channel by its volume (Zhao and Ren 2012): volume that has passed, as a cubic between the nodes (formulation: hermite).
//
// V(s,t) [m3, at zero pressure] has passed the place s of the string beyond what a reference flow Q(t), the same everywhere, has brought:
// q = V_t + Q.  Mass is then conserved identically: the content per reference length is mu = mu0 - V' (mu0: at rest, at zero pressure), and
// the pressure follows from it, mu = c theta(p), with the channel's section c [m2] and theta = exp(beta p)(1 + wall p).  Unknowns at a
// node: V and p; the end slopes of the cubic are V' = mu0 - c theta(p) with the element's own c, so that p, and not the slope, is common
// to elements of different section.
//   momentum, Galerkin   int N_k [rho0/c q_t + ... + rho0/rho 4 tau/d] ds - int N_k' h ds + [N_k h] = 0,   N_k = dV/d(unknown), h = int dp rho0/rho
// p is pressure plus the heads rho0^2/rho q^2 (1/A^2 - 1/A_0^2)/2 that speed costs since the channel's uppermost element (areas A, A_0):
// continuous where the section jumps.  In what the pipe's and the hole's walls and the string feel, the pressure itself enters.
#pragma once
#include "fluid/bit_flow.hpp"
#include "fluid/flow.hpp"

namespace dp {

using std::expm1; using std::log1p;
inline Pack expm1(const Pack& a) { return Pack(V4{std::expm1(a.v[0]), std::expm1(a.v[1]), std::expm1(a.v[2]), std::expm1(a.v[3])}); }
inline Pack log1p(const Pack& a) { return Pack(V4{std::log1p(a.v[0]), std::log1p(a.v[1]), std::log1p(a.v[2]), std::log1p(a.v[3])}); }
template <int N> inline Dual<N> expm1(const Dual<N>& a) { const double e = std::expm1(a.v); return chain(e, e + 1.0, a); }
template <int N> inline Dual<N> log1p(const Dual<N>& a) { return chain(std::log1p(a.v), 1.0 / (1.0 + a.v), a); }

// four Gauss points on (0, 1)
constexpr double XI4[4] = {0.069431844202973712, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629};
constexpr double W4[4] = {0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693};

// value, rate, acceleration
template <class T>
struct Jet {
    T x, y, a;
    friend Jet operator+(const Jet& u, const Jet& v) { return {u.x + v.x, u.y + v.y, u.a + v.a}; }
    friend Jet operator-(const Jet& u, const Jet& v) { return {u.x - v.x, u.y - v.y, u.a - v.a}; }
    friend Jet operator*(const Jet& u, const Jet& v) { return {u.x * v.x, u.x * v.y + u.y * v.x, u.x * v.a + u.y * v.y * 2.0 + u.a * v.x}; }
    template <class S> Jet times(const S& s) const { return {x * s, y * s, a * s}; }
};

// What a channel of a section S [m2] holds under the pressure p beyond S: e S + e c p - S with e = exp(beta p) and the give c of its walls [m2/Pa].
// Stretch changes S and not the give, so that the stored energy changes with S by -p at a given content: pressure loads the string by itself.
template <class T>
struct Filled {
    Jet<T> excess;
    T by_p, full;  // d(excess)/dp; e
    template <class S>
    Filled(const Fluid& f, const Jet<T>& p, const Jet<T>& section, const S& give) {
        const double b = f.compressibility;
        const T e1 = expm1(p.x * b);
        full = e1 + 1.0;
        const Jet<T> swell = {e1, full * b * p.y, full * (p.a * b + p.y * p.y * (b * b))};
        excess = section * swell + (p * Jet<T>{full, swell.y, swell.a}).times(give);
        by_p = full * (section.x * b + (1.0 + p.x * b) * give);
    }
};
// the pressure at which a channel holds `excess`, by two Newton steps from the logarithm, whose error is (c p/S)^2/2
template <class T, class S>
inline T pressure_of(const Fluid& f, const T& excess, const T& section, const S& give) {
    const double b = f.compressibility;
    T p = log1p(excess / section) / (give / section + b);
    for (int k = 0; k < 2; ++k) {
        const T e1 = expm1(p * b);
        p -= (section * e1 + p * (e1 + 1.0) * give - excess) / ((e1 + 1.0) * (section * b + (1.0 + p * b) * give));
    }
    return p;
}

// Whether the string moves and the unknowns of the flow do not, as in statics where they are found in turn: 1 in all elements or in none.  Pressure is then
// straight between the nodes, as it is in mud at rest; the contents wait for the string and say nothing.
inline bool is_waiting(double waits) { return waits > 0.0; }
inline bool is_waiting(const Pack& waits) { return waits.v[0] > 0.0; }

// flow work of a pressure per volume at zero pressure [J/m3]: int dp rho0/rho
template <class T>
inline T flow_work(const Fluid& f, const T& p) { return expm1(p * -f.compressibility) * (-1.0 / f.compressibility); }
inline double pressure_of_work(const Fluid& f, double h) { return -std::log1p(-f.compressibility * h) / f.compressibility; }

// heads that the flow q has spent at (near) the pressure p; the density there to first order in p/K
template <class T, class S>
inline T heads(const Fluid& f, const T& q, const T& p, const S& steps) { return q * q * (1.0 - p * f.compressibility) * (steps * f.density); }

struct CubicShape {  // times the element's length where SLOPE is odd; derivatives: over it where SLOPE is even
    double N[4], B[4];
    explicit CubicShape(double s)
        : N{1 - s * s * (3 - 2 * s), s * (1 - s) * (1 - s), s * s * (3 - 2 * s), s * s * (s - 1)},
          B{-6 * s * (1 - s), 1 - 4 * s + 3 * s * s, 6 * s * (1 - s), 3 * s * s - 2 * s} {}
};

template <class T, class S>
inline Vec<T> value(const CubicShape& c, const Four<T>& u, const S& L) { return u.r1 * c.N[0] + u.v1 * (L * c.N[1]) + u.r2 * c.N[2] + u.v2 * (L * c.N[3]); }
template <class T, class S>
inline Vec<T> slope(const CubicShape& c, const Four<T>& u, const S& il) { return (u.r2 - u.r1) * (il * c.B[2]) + u.v1 * c.B[1] + u.v2 * c.B[3]; }

// The cubic of one element, and its rows [J/m3]: virtual work per volume at zero pressure.  A rigid item above the element holds `item`; its flow is that of
// the node, and the pressure rises by `drop` along it as in mud at rest, so that the element begins with p1 and the node has p1 - drop.
template <class T, class S>
struct VolumeLine {
    Jet<T> V1, V2, g1, g2, p1, p2, middle;  // g: slopes at the ends [m2]; middle: pressure half way along the item
    T by1, by2, by_item, full1, full2;      // -dg/dp at the ends, d(content of the item)/dp; exp(beta p) at the ends
    T row[4], over, at_node, item_more;     // over: work of the item's content; at_node: row of the item's flow; item_more: what it holds beyond `item` [m3]
    S L;
    // c1, c2: section at the ends, less1, less2: the same less that at rest; give: of the walls [m2/Pa]; item: volume of the item above the element [m3]
    VolumeLine(const T* x, const T* y, const T* a, const Fluid& f, const S& length, const S& give, const S& item, const S& item_give, const Jet<T>& drop,
               const Jet<T>& c1, const Jet<T>& less1, const Jet<T>& c2, const Jet<T>& less2) : L(length) {
        const Jet<T> node = {x[2], y[2], a[2]}, zero = {T(0.0), T(0.0), T(0.0)};
        p1 = node + drop; p2 = {x[3], y[3], a[3]}; middle = node + drop.times(0.5);
        const Filled<T> h1(f, p1, c1, give), h2(f, p2, c2, give), held(f, middle, Jet<T>{T(0.0) + item, T(0.0), T(0.0)}, item_give);
        V1 = Jet<T>{x[0], y[0], a[0]} - held.excess;
        V2 = {x[1], y[1], a[1]};
        g1 = zero - (less1 + h1.excess);
        g2 = zero - (less2 + h2.excess);
        by1 = h1.by_p; by2 = h2.by_p; by_item = held.by_p; item_more = held.excess.x; full1 = h1.full; full2 = h2.full;
        over = flow_work(f, middle.x) + drop.x * 0.5; at_node = T(0.0);
        for (int k = 0; k < 4; ++k) row[k] = T(0.0);
    }
    T straight(double xi) const { return p1.x * (1 - xi) + p2.x * xi; }
    T slope(const CubicShape& c, const S& il) const { return (V2.x - V1.x) * (il * c.B[2]) + g1.x * c.B[1] + g2.x * c.B[3]; }
    T slope_rate(const CubicShape& c, const S& il) const { return (V2.y - V1.y) * (il * c.B[2]) + g1.y * c.B[1] + g2.y * c.B[3]; }
    T flow(const CubicShape& c) const { return V1.y * c.N[0] + g1.y * (L * c.N[1]) + V2.y * c.N[2] + g2.y * (L * c.N[3]); }
    T surge(const CubicShape& c) const { return V1.a * c.N[0] + g1.a * (L * c.N[1]) + V2.a * c.N[2] + g2.a * (L * c.N[3]); }
    // push: momentum per reference length [J/m4], h: flow work of the pressure, at a point of weight w
    void add(const CubicShape& c, double w, const T& push, const T& h) {
        row[0] += (push * (L * c.N[0]) - h * c.B[0]) * w;
        row[1] += (push * (L * c.N[1]) - h * c.B[1]) * (L * w);
        row[2] += (push * (L * c.N[2]) - h * c.B[2]) * w;
        row[3] += (push * (L * c.N[3]) - h * c.B[3]) * (L * w);
    }
    // friction [J/m3] in the rigid item above, spread over the element, as no jump of p fits in between
    void spread(const T& friction) {
        const T part = friction * (S(1.0) / L);
        for (int k = 0; k < 4; ++k) add(CubicShape(XI4[k]), W4[k], part, T(0.0));
    }
    // work of a change of `drop`
    T by_drop() const { return (row[1] * by1 + (row[0] - over) * by_item * 0.5) * -1.0; }
    // rows of V1, V2, p1, p2; those of the pressures by dV/dp, times the bulk modulus
    void store(const Fluid& f, T* r) const {
        const double scale = MOMENTUM_ROW / f.compressibility;
        r[0] = (row[0] + at_node) * MOMENTUM_ROW;
        r[1] = row[2] * MOMENTUM_ROW;
        r[2] = (row[1] * by1 + (row[0] - over) * by_item) * scale;
        r[3] = row[3] * by2 * scale;
    }
};

// Mud at a point of a channel, for the energies, per reference length: content mu [m2] and its rate mu1, mass m [kg/m] as the rows have it (without the
// give of the walls) and its rate m1.  along, along1: speed of the string that adds to that of the mud, and its derivative by length.
struct Point {
    double q, w, head, section, mu, mu1, m, m1, along, along1;
};

// What a point of weight `part` [m] adds to the results of both channels.  The rows leave out the flow's own convection, less what the heads have of
// it (manual: eq-mud-left-out-flow).  give: of the walls [m2/Pa].
inline void count(const Fluid& f, const Point& at, double gradient, double give, double steps, double part, double length, FlowResults* results) {
    const double filling = at.mu1 * f.density, thinning = at.q * f.density * at.w * f.compressibility * gradient, passing = at.w + at.along;
    const double spent = 2.0 * steps * at.section * at.section;  // heads over density w^2/2
    const double convection = 0.5 * (at.m1 * (at.along * at.along - at.w * at.w) - filling * passing * passing) +
                              passing * (at.q * f.density * at.along1 - at.w * filling - thinning) + spent * at.w * (1.5 * at.w * filling + thinning);
    results->left_out += part * convection;
    results->stored += stored_energy(f, at.head, give / at.section, at.section * part);
    results->speed += part / length * at.w;
    results->density += part / length * at.m / at.section;
}

// The stretch along an element: a parabola through its values at the ends with the true mean, as the beam has it.  Point by point a bent
// cubic also holds the square of its slope, which the content would answer with pressure.  What works on it loads the string by its derivatives.
template <class T>
struct Stretch {
    T end1, end2, mean, work1, work2, work_mean;
    template <class S>
    Stretch(const Four<T>& x, const S& il) : end1(norm(x.v1)), end2(norm(x.v2)), mean(T(0.0)), work1(T(0.0)), work2(T(0.0)), work_mean(T(0.0)) {
        for (int k = 0; k < 4; ++k) mean += norm(dp::slope(CubicShape(XI4[k]), x, il)) * W4[k];
    }
    T at(const CubicShape& c) const { return end1 * c.B[1] + mean * c.B[2] + end2 * c.B[3]; }
    void add_to_ends(const T& first, const T& second) { work1 += first; work2 += second; }
    void add(const CubicShape& c, const T& work) { work1 += work * c.B[1]; work_mean += work * c.B[2]; work2 += work * c.B[3]; }
    template <class S>
    void store(const Four<T>& x, const S& il, Four<T>& rows) const {
        rows.v1 += x.v1 * (work1 / end1);
        rows.v2 += x.v2 * (work2 / end2);
        for (int k = 0; k < 4; ++k) {
            const CubicShape at(XI4[k]);
            const Vec<T> rs = dp::slope(at, x, il), push = rs * (work_mean * W4[k] / norm(rs));
            rows.r1 += push * (il * at.B[0]); rows.v1 += push * at.B[1]; rows.r2 += push * (il * at.B[2]); rows.v2 += push * at.B[3];
        }
    }
};

// derivative by the stretch n of the section of a tube of area 1, n (1 - 2 nu (n - 1))
template <class T, class S>
inline T bulge(const T& n, const S& nu) { return 1.0 - (n * 2.0 - 1.0) * (nu * 2.0); }

// section of a tube of area 1 under the stretch n: n (1 - 2 nu (n - 1)), and less 1
template <class T>
struct Tube {
    Jet<T> section, less;
    template <class S>
    Tube(const Vec<T>& v, const Vec<T>& w, const Vec<T>& z, const S& nu) {
        const T n = norm(v), n1 = dot(v, w) / n, n2 = (dot(w, w) + dot(v, z) - n1 * n1) / n;
        const Jet<T> over = {n - 1.0, n1, n2};
        less = over * Jet<T>{1.0 - n * (nu * 2.0), n1 * (nu * -2.0), n2 * (nu * -2.0)};
        section = {less.x + 1.0, less.y, less.a};
    }
};

// The same of a string that is held, whose mud lies straight between the nodes of the element.
template <class At, class S>
inline void count_held(const Fluid& f, const VolumeLine<double, double>& line, const CubicShape& at, double xi, double weight, double area, double q, double w,
                       double head, double thick, const S* p, FlowResults* results) {
    const double L = p[At::LENGTH], il = 1.0 / L, part = weight * L, mu = area - line.slope(at, il), m = thick * f.density * area;
    const double m1 = m * f.compressibility * (line.p1.y * (1 - xi) + line.p2.y * xi);
    results->kinetic += part * 0.5 * f.density / area * q * q / thick;
    results->potential -= part * mu * f.density * (p[At::HEAD] + p[At::DROP] * (xi - 0.5));
    count(f, {q, w, head, area, mu, -line.slope_rate(at, il), m, m1, 0.0, 0.0}, (line.p2.x - line.p1.x) * il, p[At::WALL] * area, p[At::HEADS], part, L, results);
}

}  // namespace dp
