// Two-node spatial Euler-Bernoulli element with eight unknowns per node: position (3), normal strain, Euler parameters (4), after Zhao
// and Ren (2012); strains by three-point integration, EA eps^2 + GJ k1^2 + EI (k2^2 + k3^2).
//
// Inertia: consistent for the centre line, for the spin the mean of consistent and lumped (as the ANCF element); rotation of the section
// across the axis carries none.
#pragma once
#include "beam/beam.hpp"
#include "quaternion/quaternion_node.hpp"
#include "quaternion/quaternion_strain.hpp"

namespace dp {

struct QuaternionParameters {  // units as in beam/beam.hpp
    DP_ENUM(Parameter,
        LENGTH, EA, EI, GJ, MASS, POLAR, BETA, ALPHA,
        CURVATURE,                // 2: stress-free curvature in the section's axes 2, 3 [1/m]
        GRAVITY = CURVATURE + 2,  // 3
        RIGID = GRAVITY + 3,      // length of the rigid item above the element's upper end [m]
        NP)
};

template <class T, class S>
struct Interpolated {  // r', r'', p, p' at a place of the element
    Vec<T> r1, r2;
    Quat<T> p, s;
    Interpolated(const Shape<T, S>& N, double xi, const S& il, const Vec<T>& d, const Vec<T>& v1, const Vec<T>& v2, const Quat<T>& q1, const Quat<T>& q2)
        : r1(N.slope(d, v1, v2)), r2(N.second(d, v1, v2)), p(q1 * (1 - xi) + q2 * xi), s((q2 - q1) * il) {}
    Strains<T> strains() const { return Strains<T>(r1, r2, p, s); }
};

template <class T>
inline Strains<Rated<T>> rates_of(const Vec<T>& r1, const Vec<T>& r2, const Quat<T>& p, const Quat<T>& s, const Vec<T>& q1, const Vec<T>& q2,
                                  const Quat<T>& pr, const Quat<T>& sr) {
    return Strains<Rated<T>>(rated(r1, q1), rated(r2, q2), rated(p, pr), rated(s, sr));
}

template <bool DAMPED>
struct QuaternionBeam : QuaternionParameters {
    static constexpr int D = 16, NSPIN = 0;
    static constexpr bool PACKED = true;
    static constexpr int SPINS[1][2] = {{0, 0}};

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void*, T* r) {
        const Node<T> n1(x, y, a), n2(x + 8, y + 8, a + 8);
        const Vec<T> zero = {T(0.0), T(0.0), T(0.0)};
        Vec<T> Qd = zero, Q1 = zero, Q2 = zero;
        Quat<T> P1 = {T(0.0), T(0.0), T(0.0), T(0.0)}, P2 = P1;
        stresses(x, y, n1, n2, p, Qd, Q1, Q2, P1, P2);
        Vec<T> b1 = vec(a), b2 = vec(a + 8), z1 = n1.z, z2 = n2.z;
        const S L = p[LENGTH], m = p[MASS] * L * (1.0 / 420), j = p[POLAR] * L * (1.0 / 12);
        const T h1 = (n1.spin * 5.0 + n2.spin) * j, h2 = (n2.spin * 5.0 + n1.spin) * j;
        T k1 = (n1.spin_rate * 5.0 + n2.spin_rate) * j, k2 = (n2.spin_rate * 5.0 + n1.spin_rate) * j;
        if constexpr (DAMPED) {
            const S alpha = p[ALPHA];
            b1 += vec(y) * alpha; b2 += vec(y + 8) * alpha;
            z1 += n1.w * alpha; z2 += n2.w * alpha;
            k1 += h1 * alpha; k2 += h2 * alpha;
        }
        const Vec<S> g = {p[GRAVITY], p[GRAVITY + 1], p[GRAVITY + 2]};
        b1 = b1 - g;
        b2 = b2 - g;
        const Vec<T> F1 = (b1 * 156.0 + z1 * (L * 22.0) + b2 * 54.0 - z2 * (L * 13.0)) * m - Qd;
        const Vec<T> F2 = (b1 * 54.0 + z1 * (L * 13.0) + b2 * 156.0 - z2 * (L * 22.0)) * m + Qd;
        const Vec<T> G1 = (b1 * (L * 22.0) + z1 * (L * L * 4.0) + b2 * (L * 13.0) - z2 * (L * L * 3.0)) * m + Q1;
        const Vec<T> G2 = (b1 * (L * -13.0) - z1 * (L * L * 3.0) - b2 * (L * 22.0) + z2 * (L * L * 4.0)) * m + Q2;
        n1.rows(F1, G1, zero, P1, r);
        n2.rows(F2, G2, zero, P2, r + 8);
        n1.add_spin(h1, k1, r);
        n2.add_spin(h2, k2, r + 8);
    }

    // elastic and Kelvin-Voigt forces, conjugate to d, v1, v2 and the unit quaternions
    template <class T, class S>
    static void stresses(const T* x, const T* y, const Node<T>& n1, const Node<T>& n2, const S* p, Vec<T>& Qd, Vec<T>& Q1, Vec<T>& Q2, Quat<T>& P1,
                         Quat<T>& P2) {
        const S L = p[LENGTH], il = S(1.0) / L;
        const Vec<T> d = vec(x + 8) - vec(x);
        for (int g = 0; g < 3; ++g) {
            const double xi = XI3[g];
            const Shape<T, S> N(xi, il);
            const Interpolated<T, S> at(N, xi, il, d, n1.v, n2.v, n1.unit, n2.unit);
            const Strains<T> e = at.strains();
            T axial = e.stretch - 1.0, k1 = e.k1, k2 = e.k2 - p[CURVATURE], k3 = e.k3 - p[CURVATURE + 1];
            if constexpr (DAMPED) {
                const Interpolated<T, S> rate(N, xi, il, vec(y + 8) - vec(y), n1.w, n2.w, n1.unit_rate(), n2.unit_rate());
                const Strains<Rated<T>> q = rates_of(at.r1, at.r2, at.p, at.s, rate.r1, rate.r2, rate.p, rate.s);
                const S beta = p[BETA];
                axial += q.stretch.d * beta; k1 += q.k1.d * beta; k2 += q.k2.d * beta; k3 += q.k3.d * beta;
            }
            const S w = L * W3[g];
            Vec<T> f1 = {T(0.0), T(0.0), T(0.0)}, f2 = f1;
            Quat<T> fp = {T(0.0), T(0.0), T(0.0), T(0.0)}, fs = fp;
            e.conjugate(axial * (p[EA] * w), k1 * (p[GJ] * w), k2 * (p[EI] * w), k3 * (p[EI] * w), f1, f2, fp, fs);
            Qd += f1 * N.B0 + f2 * N.C0;
            Q1 += f1 * N.B1 + f2 * N.C1;
            Q2 += f1 * N.B2 + f2 * N.C2;
            P1 += fp * (1 - xi) + fs * (-il);
            P2 += fp * xi + fs * il;
        }
    }
};

// Motion of the element's own upper end below a rigid item at its upper node, in place of that of the node (unknowns 0-7, stretch ratio m
// in place 16): r + l t, 1 + eps = m (1 + eps of the node), the section of the node.
template <class T, class S>
inline void below_item(const S& l, T* x, T* y, T* a) {
    const Node<T> n(x, y, a);
    const auto put = [](const Vec<T>& q, T* to) { to[0] = q.x; to[1] = q.y; to[2] = q.z; };
    put(vec(x) + n.t * l, x); put(vec(y) + n.t1 * l, y); put(vec(a) + n.t2 * l, a);
    a[3] = a[16] * n.stretch + y[16] * y[3] * 2.0 + x[16] * a[3];
    y[3] = y[16] * n.stretch + x[16] * y[3];
    x[3] = x[16] * n.stretch - 1.0;
}

// The element below a rigid item: the strains above and below the item differ by the stretch ratio (manual: eq-junction-kinematics).
template <bool DAMPED>
struct QuaternionBelowItem : QuaternionParameters {
    static constexpr int D = 17, NSPIN = 0;
    static constexpr bool PACKED = true;
    static constexpr int SPINS[1][2] = {{0, 0}};

    template <class T, class S>
    static void force(int e, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        T X[D], Y[D], A[D];
        for (int i = 0; i < D; ++i) { X[i] = x[i]; Y[i] = y[i]; A[i] = a[i]; }
        below_item(p[RIGID], X, Y, A);
        QuaternionBeam<DAMPED>::template force<T, S>(e, X, Y, A, p, context, r);
        const Node<T> n(x, y, a);
        const Vec<T> F = vec(r), zero = {T(0.0), T(0.0), T(0.0)};
        T lever[8];
        n.rows(zero, zero, cross(n.t, F) * p[RIGID], Quat<T>{T(0.0), T(0.0), T(0.0), T(0.0)}, lever);
        for (int i = 4; i < 8; ++i) r[i] += lever[i];
        r[16] = r[3] * n.stretch;
        r[3] = r[3] * x[16];
    }
};

}  // namespace dp
