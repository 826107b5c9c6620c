// Entry points of the closest-point search for Python: output, probes and tests.
#include "contact/well.hpp"

using namespace dp;
DP_EXPORT(well_header, WellHeader::ColumnText)
DP_EXPORT(well_node, WellNode::ColumnText)
DP_EXPORT(well_step, WellStep::ColumnText)

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
