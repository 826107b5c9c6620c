// Closest point of the well's centreline, hole radius and friction there, with exact derivatives through Dual<N>.
//
// The well comes as one array of doubles made by drillpetsc.geometry.well.Well.packed():
//   WellHeader, then a WellNode row for each node, then a WellStep row for each transition
//       segment: c(u) = x + m t u + a2 u^2 + a3 u^3,  s(u) = s + u L + (m-L) u (1-u)(1-2u),  0 <= u <= 1  (last row: a node only)
// Straight lines go on beyond both ends.  No allocation; T is double or Dual<N>.
#pragma once
#include "core/ad.hpp"
#include "core/names.hpp"

namespace dp {

struct WellHeader {
    DP_ENUM(Column,
        NODES, TRANSITIONS,
        RADIUS, FRICTION,  // above the first transition
        STEEPEST,          // largest slope of the radius along the hole [-]
        COLUMNS)
};
struct WellNode {
    DP_ENUM(Column,
        DEPTH, LENGTH, HANDLE,  // measured depth s; length L and handle m of the segment below [m]
        POSITION, TANGENT = POSITION + 3, SECOND = TANGENT + 3, THIRD = SECOND + 3,  // 3 each: x, t, a2, a3
        UNUSED = THIRD + 3, COLUMNS)
};
struct WellStep {  // a smoothstep over a transition
    DP_ENUM(Column, START, WIDTH, RADIUS, RADIUS_CHANGE, FRICTION, FRICTION_CHANGE, COLUMNS)
};
constexpr double WELL_RHO0 = 1e-6;  // m, rounds off |e| at the axis
// Share of a centring spring's force k rho that is a force: k |e|.  The rest is the rounding of rho, on which there is no friction.
template <class T> inline T offset_share(const Vec<T>& e, const T& rho) { return sqrt(dot(e, e) + 1e-24) / rho; }

struct Well {
    int nodes, steps;
    double radius_top, friction_top, steepest;
    const double* node;
    const double* step;
    explicit Well(const double* p)
        : nodes(int(p[WellHeader::NODES])), steps(int(p[WellHeader::TRANSITIONS])), radius_top(p[WellHeader::RADIUS]),
          friction_top(p[WellHeader::FRICTION]), steepest(p[WellHeader::STEEPEST]), node(p + WellHeader::COLUMNS), step(node + long(nodes) * WellNode::COLUMNS) {}
    const double* row(int i) const { return node + long(i) * WellNode::COLUMNS; }
};

// Closest point: measured depth s, centre c, unit tangent t, offset e = x - c, rho = sqrt(|e|^2 + rho0^2), n = e / rho,
// hole radius and friction at s.  Gap to a circle of radius R_o about x: rho + R_o - radius.
template <class T> struct HolePoint {
    T s;
    Vec<T> c, t, e, n;
    T rho, radius, friction, radius_slope;
    T ds_dx;  // length of the gradient of s, 1/(1 - e.kappa)
};

// Radius, friction and their slopes along s.
template <class S> struct BoreOf { S radius, radius_slope, friction, friction_slope, radius_bend; };
typedef BoreOf<double> Bore;
inline Bore bore_at(const Well& w, double s) {
    int lo = 0, hi = w.steps;  // number of transitions that start at or above s
    while (lo < hi) {
        const int mid = (lo + hi) / 2;
        if (w.step[mid * WellStep::COLUMNS + WellStep::START] <= s) lo = mid + 1; else hi = mid;
    }
    if (lo == 0) return {w.radius_top, 0.0, w.friction_top, 0.0, 0.0};
    typedef WellStep P;
    const double* p = w.step + (lo - 1) * P::COLUMNS;
    const double u = (s - p[P::START]) / p[P::WIDTH];
    if (u >= 1.0) return {p[P::RADIUS] + p[P::RADIUS_CHANGE], 0.0, p[P::FRICTION] + p[P::FRICTION_CHANGE], 0.0, 0.0};
    const double h = u * u * (3.0 - 2.0 * u), dh = 6.0 * u * (1.0 - u) / p[P::WIDTH];
    return {p[P::RADIUS] + p[P::RADIUS_CHANGE] * h, p[P::RADIUS_CHANGE] * dh, p[P::FRICTION] + p[P::FRICTION_CHANGE] * h,
            p[P::FRICTION_CHANGE] * dh, p[P::RADIUS_CHANGE] * 6.0 * (1.0 - 2.0 * u) / (p[P::WIDTH] * p[P::WIDTH])};
}

inline BoreOf<Pack> bore_at(const Well& w, const Pack& s) {
    BoreOf<Pack> all;
    for (int l = 0; l < 4; ++l) {
        const Bore b = bore_at(w, s.v[l]);
        all.radius.v[l] = b.radius; all.radius_slope.v[l] = b.radius_slope; all.friction.v[l] = b.friction;
        all.friction_slope.v[l] = b.friction_slope; all.radius_bend.v[l] = b.radius_bend;
    }
    return all;
}

// How far x lies below the plane across the centreline at node i.
inline double below_node(const Well& w, const Vec<double>& x, int i) {
    const double *p = w.row(i), *at = p + WellNode::POSITION, *t = p + WellNode::TANGENT;
    return (x.x - at[0]) * t[0] + (x.y - at[1]) * t[1] + (x.z - at[2]) * t[2];
}

// Segment whose chord is nearest to x, found by a search of all segments: used without a warm start.
inline int nearest_segment(const Well& w, const Vec<double>& x) {
    int best = 0;
    double least = 1e300;
    for (int i = 0; i + 1 < w.nodes; ++i) {
        const Vec<double> a = vec(w.row(i) + WellNode::POSITION), chord = vec(w.row(i + 1) + WellNode::POSITION) - a, d = x - a;
        double u = dot(d, chord) / dot(chord, chord);
        if (u < 0.0 && i > 0) u = 0.0;  // first and last go on straight
        if (u > 1.0 && i + 2 < w.nodes) u = 1.0;
        const Vec<double> r = d - u * chord;
        const double q = dot(r, r);
        if (q < least) { least = q; best = i; }
    }
    return best;
}

// Segment between whose end planes x lies, walking from the given one.  (x - c).c' is the distance to the plane at a node, so this
// is exactly the segment that holds a root; the walk never turns back, so it ends.
inline int walk_to_segment(const Well& w, const Vec<double>& x, int i) {
    const int last = w.nodes - 2;
    if (i < last && below_node(w, x, i + 1) > 0.0) {
        do ++i; while (i < last && below_node(w, x, i + 1) > 0.0);
    } else {
        while (i > 0 && below_node(w, x, i) < 0.0) --i;
    }
    return i;
}

// A segment's cubic at u: centre, first and second derivative by u; g = (x - c).c' and slope = -dg/du.
template <class S>
struct FootOf {
    S u, s, ds, dds;
    Vec<S> c, d1, d2, d3;
    S g, slope, speed2;
};
typedef FootOf<double> Foot;
inline Foot foot_at(const double* p, const Vec<double>& x, double u) {
    Foot f;
    const Vec<double> a1 = p[WellNode::HANDLE] * vec(p + WellNode::TANGENT), a2 = vec(p + WellNode::SECOND), a3 = vec(p + WellNode::THIRD);
    f.u = u;
    f.c = vec(p + WellNode::POSITION) + u * (a1 + u * (a2 + u * a3));
    f.d1 = a1 + u * (2.0 * a2 + (3.0 * u) * a3);
    f.d2 = 2.0 * a2 + (6.0 * u) * a3;
    f.d3 = 6.0 * a3;
    const Vec<double> e = x - f.c;
    f.g = dot(e, f.d1);
    f.speed2 = dot(f.d1, f.d1);
    f.slope = f.speed2 - dot(e, f.d2);
    return f;
}

// Root of (x - c).c' on the segment of row p to |du| < 1e-6: Newton, kept inside a bracket.  One more step, left to the caller,
// brings it to rounding.
inline Foot find_foot(const double* p, const Vec<double>& x, double above, double below) {
    double lo = 0.0, hi = 1.0, u = above + below > 0.0 ? above / (above + below) : 0.5;
    u = u < 0.0 ? 0.0 : (u > 1.0 ? 1.0 : u);
    Foot f = foot_at(p, x, u);
    for (int it = 0; it < 60; ++it) {
        const double du = f.g / f.slope;
        const bool sound = f.slope > 0.05 * f.speed2;  // else x is near or beyond the centre of curvature
        if (sound && std::fabs(du) < 1e-6) break;
        if (f.g > 0.0) lo = u; else hi = u;
        if (hi - lo < 1e-12) break;
        double next = u + du;
        if (!sound || next < lo - 1e-9 || next > hi + 1e-9) next = 0.5 * (lo + hi);
        u = next;
        f = foot_at(p, x, u);
    }
    // measured depth, cubic with ds/du = m at both ends
    const double L = p[WellNode::LENGTH], k = p[WellNode::HANDLE] - L;
    f.s = p[WellNode::DEPTH] + u * L + k * u * (1.0 - u) * (1.0 - 2.0 * u);
    f.ds = L + k * (1.0 - 6.0 * u + 6.0 * u * u);
    f.dds = k * (12.0 * u - 6.0);
    return f;
}

// Foot on a straight line through node row p, the parameter being the distance along it.
inline Foot straight_foot(const double* p, const Vec<double>& x, double distance) {
    Foot f;
    f.u = distance;
    f.s = p[WellNode::DEPTH] + distance;
    f.ds = 1.0;
    f.dds = 0.0;
    f.d1 = vec(p + WellNode::TANGENT);
    f.d2 = f.d3 = {0.0, 0.0, 0.0};
    f.c = vec(p + WellNode::POSITION) + distance * f.d1;
    f.g = dot(x - f.c, f.d1);
    f.speed2 = f.slope = dot(f.d1, f.d1);
    return f;
}

inline Foot locate(const Well& w, const Vec<double>& x, int& segment) {
    const int last = w.nodes - 2;
    if (segment < 0 || segment > last) segment = nearest_segment(w, x);
    for (int attempt = 0;; ++attempt) {
        segment = walk_to_segment(w, x, segment);
        const double above = below_node(w, x, segment), below = -below_node(w, x, segment + 1);
        Foot f = segment == 0 && above < 0.0 ? straight_foot(w.row(0), x, above)
                 : segment == last && below < 0.0 ? straight_foot(w.row(last + 1), x, -below)
                                                  : find_foot(w.row(segment), x, above, below);
        const Vec<double> e = x - f.c;
        // further off than any hole is wide: the warm start may be stale, so all segments are searched once
        if (attempt || dot(e, e) < 25.0) return f;
        const int best = nearest_segment(w, x);
        if (best == segment) return f;
        segment = best;
    }
}

// Closest point of the centreline to x, whose foot is known.  One Newton step in T from the foot's root carries the derivatives:
// du = g(x)/slope  gives exactly  du/dx = c'^T/(c'.c' - e.c''), that is ds/dx = t^T/(1 - e.kappa), and the rest follows from
// first-order expansions about the root.
template <class T, class S> inline HolePoint<T> hole_point(const Well& w, const FootOf<S>& f, const Vec<T>& x) {
    const S floor = 0.05 * f.speed2, slope = choose(f.slope > floor, [&] { return f.slope; }, [&] { return floor; });
    const T du = dot(x - f.c, f.d1) * (1.0 / slope);
    const S speed = sqrt(f.speed2);
    const Vec<S> t = (1.0 / speed) * f.d1, turn = (1.0 / speed) * (f.d2 - dot(f.d2, t) * t);
    HolePoint<T> h;
    h.s = f.s + f.ds * du;
    h.c = f.c + du * f.d1;
    h.t = t + du * turn;
    h.e = x - h.c;
    h.rho = sqrt(dot(h.e, h.e) + WELL_RHO0 * WELL_RHO0);
    h.n = (1.0 / h.rho) * h.e;
    const S s = val(h.s);
    const BoreOf<S> b = bore_at(w, s);
    const T ds = h.s - s;
    h.radius = b.radius + b.radius_slope * ds;
    h.friction = b.friction + b.friction_slope * ds;
    h.radius_slope = b.radius_slope + b.radius_bend * ds;
    const Vec<T> d1 = f.d1 + du * f.d2, d2 = f.d2 + du * f.d3;
    const T speed2 = dot(d1, d1), fall = speed2 - dot(h.e, d2);
    h.ds_dx = (f.ds + f.dds * du) * sqrt(speed2) / choose(val(fall) > floor, [&] { return fall; }, [&] { return T(floor); });
    return h;
}

// Closest point of the centreline to x.  segment: in, where to begin (any value; < 0 for none), out, where the point was found.
template <class T> inline HolePoint<T> closest_point(const Well& w, const Vec<T>& x, int& segment) {
    const Vec<double> place{val(x.x), val(x.y), val(x.z)};
    return hole_point(w, locate(w, place, segment), x);
}

}  // namespace dp
