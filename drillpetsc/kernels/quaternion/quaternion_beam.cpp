// Entry points of the quaternion element, its energies and section forces, the power lost in the material.
#include "beam/beam_results.hpp"
#include "quaternion/quaternion_beam.hpp"

typedef dp::QuaternionBeam<false> QuaternionPlain;
typedef dp::QuaternionBeam<true> QuaternionDamped;
DP_ENTRY(quaternion_beam, QuaternionPlain)
DP_ENTRY(quaternion_beam_damped, QuaternionDamped)
typedef dp::QuaternionBelowItem<false> QuaternionBelow;
typedef dp::QuaternionBelowItem<true> QuaternionBelowDamped;
DP_ENTRY(quaternion_beam_junction, QuaternionBelow)
DP_ENTRY(quaternion_beam_junction_damped, QuaternionBelowDamped)

namespace {

using namespace dp;
typedef double R;
typedef QuaternionParameters P;
struct Element {  // motion of the element's own ends
    double X[17], Y[17];
    Element(const int* idx, const double* x, const double* y) {
        for (int i = 0; i < 16; ++i) { X[i] = x[idx[i]]; Y[i] = y[idx[i]]; }
    }
    // width: unknowns of the element, 17 below a rigid item of length l
    Element(const int* idx, int width, double l, const double* x, const double* y) : Element(idx, x, y) {
        if (width == 16) return;
        double A[17] = {};
        X[16] = x[idx[16]]; Y[16] = y[idx[16]];
        below_item(l, X, Y, A);
    }
};

Strains<R> at(double xi, double L, const Element& e, const Node<R>& n1, const Node<R>& n2) {
    const Shape<R, R> N(xi, 1 / L);
    return Interpolated<R, R>(N, xi, 1 / L, vec(e.X + 8) - vec(e.X), n1.v, n2.v, n1.unit, n2.unit).strains();
}

// q M q of the consistent mass matrix over the mass, and of the spin inertia over jp L
R mass_form(R L, const Vec<R>& a1, const Vec<R>& a2, const Vec<R>& b1, const Vec<R>& b2) {
    return (156 * (dot(a1, a1) + dot(b1, b1)) + 4 * L * L * (dot(a2, a2) + dot(b2, b2)) + 108 * dot(a1, b1) + 44 * L * (dot(a1, a2) - dot(b1, b2)) +
            26 * L * (dot(b1, a2) - dot(a1, b2)) - 6 * L * L * dot(a2, b2)) / 420;
}
R spin_form(R o1, R o2) { return (5 * o1 * o1 + 2 * o1 * o2 + 5 * o2 * o2) / 12; }

R bending(const double* p, const Strains<R>& s) { return p[P::EI] * std::hypot(s.k2 - p[P::CURVATURE], s.k3 - p[P::CURVATURE + 1]); }

}  // namespace

// width: unknowns of an element; out: (n, BEAM_RESULTS)
extern "C" void quaternion_beam_results(int n, int width, const int* idx, const double* par, void*, const double* x, const double* y, double* out) {
    for (int k = 0; k < n; ++k) {
        const double *p = par + k * P::NP, L = p[P::LENGTH];
        const Element e(idx + width * k, width, p[P::RIGID], x, y);
        const Node<R> n1(e.X, e.Y, e.Y), n2(e.X + 8, e.Y + 8, e.Y + 8);
        double* q = out + k * BEAM_RESULTS;
        const double m = p[P::MASS] * L;
        q[KINETIC] = 0.5 * (m * mass_form(L, vec(e.Y), n1.w, vec(e.Y + 8), n2.w) + p[P::POLAR] * L * spin_form(n1.spin, n2.spin));
        q[POTENTIAL] = -m * dot(vec(p + P::GRAVITY), (vec(e.X) + vec(e.X + 8)) * 0.5 + (n1.v - n2.v) * (L / 12));
        q[STRAIN] = q[TORQUE] = 0;
        for (int g = 0; g < 3; ++g) {
            const Strains<R> s = at(XI3[g], L, e, n1, n2);
            const double eps = s.stretch - 1, k2 = s.k2 - p[P::CURVATURE], k3 = s.k3 - p[P::CURVATURE + 1];
            q[STRAIN] += 0.5 * L * W3[g] * (p[P::EA] * eps * eps + p[P::GJ] * s.k1 * s.k1 + p[P::EI] * (k2 * k2 + k3 * k3));
            q[TORQUE] += W3[g] * p[P::GJ] * s.k1;
        }
        q[AXIAL_UPPER] = p[P::EA] * e.X[3];
        q[AXIAL_MIDDLE] = p[P::EA] * (at(0.5, L, e, n1, n2).stretch - 1);
        q[AXIAL_LOWER] = p[P::EA] * e.X[11];
        q[BENDING_UPPER] = bending(p, at(0.0, L, e, n1, n2));
        q[BENDING_LOWER] = bending(p, at(1.0, L, e, n1, n2));
    }
}

// power turned into heat by material and mass damping: out (n,) [W]
extern "C" void quaternion_beam_dissipation(int n, int width, const int* idx, const double* par, void*, const double* x, const double* y, double* out) {
    for (int k = 0; k < n; ++k) {
        const double *p = par + k * P::NP, L = p[P::LENGTH];
        const Element e(idx + width * k, width, p[P::RIGID], x, y);
        const Node<R> n1(e.X, e.Y, e.Y), n2(e.X + 8, e.Y + 8, e.Y + 8);
        out[k] = p[P::ALPHA] * L * (p[P::MASS] * mass_form(L, vec(e.Y), n1.w, vec(e.Y + 8), n2.w) + p[P::POLAR] * spin_form(n1.spin, n2.spin));
        for (int g = 0; g < 3; ++g) {
            const Shape<R, R> N(XI3[g], 1 / L);
            const Interpolated<R, R> u(N, XI3[g], 1 / L, vec(e.X + 8) - vec(e.X), n1.v, n2.v, n1.unit, n2.unit);
            const Interpolated<R, R> w(N, XI3[g], 1 / L, vec(e.Y + 8) - vec(e.Y), n1.w, n2.w, n1.unit_rate(), n2.unit_rate());
            const Strains<Rated<R>> q = rates_of(u.r1, u.r2, u.p, u.s, w.r1, w.r2, w.p, w.s);
            out[k] += p[P::BETA] * L * W3[g] * (p[P::EA] * q.stretch.d * q.stretch.d + p[P::GJ] * q.k1.d * q.k1.d +
                                             p[P::EI] * (q.k2.d * q.k2.d + q.k3.d * q.k3.d));
        }
    }
}

// (n, 8) motion of n nodes: slope r' (3), tangent (3), spin rate [rad/s], angle about the tangent from the smallest rotation of the frame
// of `frame` (n, 4) [rad]; at: (n, 8) places of r, eps, q
extern "C" void quaternion_motion(int n, const int* at, const double* frame, const double* x, const double* y, double* out) {
    for (int k = 0; k < n; ++k) {
        const Element e = [&] { int idx[16]; for (int i = 0; i < 16; ++i) idx[i] = at[8 * k + i % 8]; return Element(idx, x, y); }();
        const Node<R> node(e.X, e.Y, e.Y);
        const Quat<R> f = quat(frame + 4 * k);
        double* o = out + 8 * k;
        o[0] = node.v.x; o[1] = node.v.y; o[2] = node.v.z; o[3] = node.t.x; o[4] = node.t.y; o[5] = node.t.z;
        o[6] = node.spin / (node.length * node.length);
        // f* q = (smallest rotation)(rotation about e1): their angle is that of the first two components
        o[7] = 2 * std::atan2(dot(times_e1(f), node.q), dot(f, node.q));
    }
}

// (n, 8) input of the ANCF kernels at n nodes: slope (3), angle about the tangent [rad], rates of both; at, frame as above
extern "C" void quaternion_view(int n, const int* at, const double* frame, const double* x, const double* y, double* out) {
    for (int k = 0; k < n; ++k) {
        const Element e = [&] { int idx[16]; for (int i = 0; i < 16; ++i) idx[i] = at[8 * k + i % 8]; return Element(idx, x, y); }();
        const Node<R> node(e.X, e.Y, e.Y);
        const Quat<R> f = quat(frame + 4 * k);
        const double angle = 2 * std::atan2(dot(times_e1(f), node.q), dot(f, node.q));
        const double row[8] = {node.v.x, node.v.y, node.v.z, angle, node.w.x, node.w.y, node.w.z, node.spin / (node.length * node.length)};
        for (int i = 0; i < 8; ++i) out[8 * k + i] = row[i];
    }
}
