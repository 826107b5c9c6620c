// Entry points of the closest-point search for Python: output, probes and tests.
#include "contact/well.hpp"

using namespace dp;
DP_EXPORT(well_header, WellHeader::ColumnText)
DP_EXPORT(well_node, WellNode::ColumnText)
DP_EXPORT(well_step, WellStep::ColumnText)

static constexpr double NEAR_AXIS = 0.2;
static void put(double* p, const Vec<double>& a) { p[0] = a.x; p[1] = a.y; p[2] = a.z; }

// Closest points of n positions x (n, 3).  segment (n): warm start in, found segment out.
// Out: s (n), c, t, e (n, 3), radius (n), friction (n).
extern "C" void well_project(const double* packed, int n, const double* x, int* segment, double* s, double* c, double* t, double* e,
                             double* radius, double* friction) {
    const Well w(packed);
    for (int i = 0; i < n; ++i) {
        const HolePoint<double> h = closest_point(w, vec(x + 3L * i), segment[i]);
        s[i] = h.s;
        put(c + 3L * i, h.c);
        put(t + 3L * i, h.t);
        put(e + 3L * i, h.e);
        radius[i] = h.radius;
        friction[i] = h.friction;
    }
}

// Whether any of n positions at the places `at` (n, 3) of x has moved from `from` (n, 6), a position and a direction, by more than `along`
// in that direction, or by more than `apart` in all.
extern "C" int moved_along(int n, const int* at, const double* x, const double* from, double along, double apart) {
    for (int i = 0; i < n; ++i) {
        const int* k = at + 3L * i;
        const Vec<double> way = Vec<double>{x[k[0]], x[k[1]], x[k[2]]} - vec(from + 6L * i);
        if (!(std::fabs(dot(way, vec(from + 6L * i + 3))) <= along && dot(way, way) <= apart * apart)) return 1;
    }
    return 0;
}

// For tests: the 16 numbers s, c, t, e, n, rho, radius, friction of each point in value (n, 16) and their derivatives by x in
// slope (n, 16, 3).
extern "C" void well_project_derivatives(const double* packed, int n, const double* x, int* segment, double* value, double* slope) {
    typedef Dual<4> D;
    const Well w(packed);
    for (int i = 0; i < n; ++i) {
        Vec<D> p{D(x[3L * i]), D(x[3L * i + 1]), D(x[3L * i + 2])};
        p.x.set(0, 1.0);
        p.y.set(1, 1.0);
        p.z.set(2, 1.0);
        const HolePoint<D> h = closest_point(w, p, segment[i]);
        const D all[16] = {h.s,   h.c.x, h.c.y, h.c.z, h.t.x, h.t.y, h.t.z, h.e.x,
                           h.e.y, h.e.z, h.n.x, h.n.y, h.n.z, h.rho, h.radius, h.friction};
        for (int j = 0; j < 16; ++j) {
            value[16L * i + j] = all[j].v;
            for (int k = 0; k < 3; ++k) slope[48L * i + 3 * j + k] = all[j].d(k);
        }
    }
}

// Steps of n nodes in the hole's own coordinates (manual: eq-statics-retraction).  at (n, 2): places of position and slope in x, p and
// out; clearance (n): a node further from the axis than NEAR_AXIS of it also steps about the axis, 0: never; segment (n): warm start in, found segment out.
// out = x + p to first order; a node that slides along the wall stays on it to second order.
extern "C" void hole_advance(const double* packed, int n, const int* at, const double* clearance, const double* x, const double* p,
                             double factor, int* segment, double* out) {
    const Well w(packed);
    for (int i = 0; i < n; ++i) {
        const int r = at[2 * i], v = at[2 * i + 1];
        const Vec<double> place = vec(x + r), step = factor * vec(p + r), turn = factor * vec(p + v);
        const Foot f = locate(w, place, segment[i]);
        const HolePoint<double> h = hole_point(w, f, place);
        const Vec<double> d1 = f.d1, kappa = (1.0 / f.speed2) * (f.d2 - (dot(f.d2, d1) / f.speed2) * d1);
        const double along = dot(step, h.t), fall = 1.0 - dot(h.e, kappa), ds = along / (fall > 0.2 ? fall : 0.2);
        Vec<double> across = step - along * h.t;
        double angle = 0.0;
        if (clearance[i] > 0.0 && h.rho > NEAR_AXIS * clearance[i]) {
            const Vec<double> b = cross(h.t, h.n);
            const double sideways = dot(across, b);
            angle = sideways / h.rho;
            across = across - sideways * b;
        }
        int next = segment[i];
        const Vec<double> ahead = h.c + ds * h.t;
        const Foot g = locate(w, ahead, next);
        const HolePoint<double> k = hole_point(w, g, ahead);
        // rotation about t by the angle, then the smallest rotation from t to the tangent there
        const double c = std::cos(angle), sn = std::sin(angle), both = 1.0 + dot(h.t, k.t);
        const Vec<double> axis = cross(h.t, k.t), spin = angle * h.t + ds * cross(h.t, kappa);
        const auto rotated = [&](const Vec<double>& a) {
            const Vec<double> q = c * a + sn * cross(h.t, a) + ((1.0 - c) * dot(h.t, a)) * h.t;
            return dot(h.t, k.t) * q + cross(axis, q) + (dot(axis, q) / both) * axis;
        };
        put(out + r, k.c + rotated(h.e + across));
        const Vec<double> slope = vec(x + v);
        put(out + v, rotated(slope + turn - cross(spin, slope)));
    }
}
