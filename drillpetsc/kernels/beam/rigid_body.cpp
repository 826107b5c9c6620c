#include "beam/rigid_body.hpp"
#include "core/formulations.hpp"

DP_ENTRY(body, dp::Body)
DP_ENTRY(load, dp::Load)
DP_ENTRY(drive, dp::Drive)
DP_OTHER_FORMULATIONS(body, dp::Body, 1)

// kinetic and potential energy of n bodies: out (n, 2) [J]
extern "C" void body_energy(int n, int, const int* idx, const double* par, const void*, const double* x, const double* y, double* out) {
    using namespace dp;
    for (int e = 0; e < n; ++e) {
        const double* p = par + e * Body::NP;
        double X[7], Y[7];
        for (int i = 0; i < 7; ++i) { X[i] = x[idx[7 * e + i]]; Y[i] = y[idx[7 * e + i]]; }
        const Vec<double> v = vec(X + 3), zero = {0, 0, 0};
        const Tangent<double> t(v, vec(Y + 3), zero);
        Vec<double> d2, d3;
        directors(vec(p + Body::REFERENCE), vec(p + Body::SECOND), t.t, X[6], d2, d3);
        const Vec<double> offset = t.t * p[Body::CENTER] + d2 * p[Body::OFFSET] + d3 * p[Body::OFFSET + 1];
        const Vec<double> turning = cross(t.t, t.t1) + t.t * Y[6], speed = vec(Y) + cross(turning, offset);
        out[2 * e] = 0.5 * (p[Body::MASS] * dot(speed, speed) + p[Body::TRANSVERSE] * dot(t.t1, t.t1) + p[Body::AXIAL] * Y[6] * Y[6]);
        out[2 * e + 1] = -p[Body::MASS] * dot(vec(p + Body::GRAVITY), vec(X) + offset);
    }
}
