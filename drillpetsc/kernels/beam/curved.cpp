// Stress-free curvature carried by the pipe: cross term -EI int kappa.kappa0 ds with kappa0 = sum_i N_i (k2 d2_i + k3 d3_i).
// Directors are those of the two nodes, interpolated linearly: objective, second order.
#include "beam/beam.hpp"

namespace dp {

template <bool JUNCTION>
struct Curved {
    static constexpr int D = JUNCTION ? 15 : 14, NSPIN = 2;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[2][2] = {{6, 3}, {13, 10}};
    DP_ENUM(Parameter,
        LENGTH, EI,   // of the element [m], [N m2]
        CURVATURE,    // 2: stress-free curvature along the two directors [1/m]
        RIGID = CURVATURE + 2,  // length of the rigid item above [m]
        REFERENCE1, SECOND1 = REFERENCE1 + 3, REFERENCE2 = SECOND1 + 3, SECOND2 = REFERENCE2 + 3,  // 3 each: frames of both nodes
        NP = SECOND2 + 3)

    template <class T, class S>
    static void force(int, const T* x, const T*, const T*, const S* p, void*, T* r) {
        Vec<T> r1 = vec(x), v1 = vec(x + 3);
        const Vec<T> v0 = v1, v2 = vec(x + 10);
        const T n0 = norm(v0), n2 = norm(v2);
        const Vec<T> t1 = v0 / n0, t2 = v2 / n2;
        if constexpr (JUNCTION) { r1 += t1 * p[RIGID]; v1 = v1 * x[14]; }
        const Vec<T> d = vec(x + 7) - r1;
        Vec<T> a2, a3, b2, b3;
        directors(vec(p + REFERENCE1), vec(p + SECOND1), t1, x[6], a2, a3);
        directors(vec(p + REFERENCE2), vec(p + SECOND2), t2, x[13], b2, b3);
        const Vec<T> k1 = a2 * p[CURVATURE] + a3 * p[CURVATURE + 1], k2 = b2 * p[CURVATURE] + b3 * p[CURVATURE + 1];
        const Vec<T> k1_turn = cross(t1, k1), k2_turn = cross(t2, k2);
        const Vec<T> zero = {T(0.0), T(0.0), T(0.0)};
        Vec<T> Qd = zero, Q1 = zero, Q2 = zero;  // Q1: conjugate to the element's own slope v1
        Vec<T> G1 = zero, G2 = zero;             // by the directors, conjugate to the node's slope
        T theta1 = T(0.0), theta2 = T(0.0);
        for (int g = 0; g < 3; ++g) {
            const Shape<T, double> N(XI3[g], 1.0 / p[LENGTH]);
            const Vec<T> q1 = N.slope(d, v1, v2), q2 = N.second(d, v1, v2);
            const T iA = 1.0 / dot(q1, q1);
            const Vec<T> kappa = cross(q1, q2) * iA;
            const double w = -p[EI] * p[LENGTH] * W3[g], a = 1 - XI3[g], b = XI3[g];
            const Vec<T> m = (k1 * a + k2 * b) * w;
            const Vec<T> f1 = cross(q2, m) * iA - q1 * (2.0 * dot(m, kappa) * iA), f2 = cross(m, q1) * iA;
            Qd += f1 * N.B0 + f2 * N.C0;
            Q1 += f1 * N.B1 + f2 * N.C1;
            Q2 += f1 * N.B2 + f2 * N.C2;
            G1 -= k1 * (dot(kappa, t1) * (w * a) / n0);
            G2 -= k2 * (dot(kappa, t2) * (w * b) / n2);
            theta1 += dot(kappa, k1_turn) * (w * a);
            theta2 += dot(kappa, k2_turn) * (w * b);
        }
        if constexpr (JUNCTION) {
            r[14] = dot(v0, Q1);
            Q1 = Q1 * x[14] - (Qd - t1 * dot(t1, Qd)) * (p[RIGID] / n0);
        }
        Q1 += G1;
        Q2 += G2;
        r[0] = -Qd.x; r[1] = -Qd.y; r[2] = -Qd.z; r[3] = Q1.x; r[4] = Q1.y; r[5] = Q1.z; r[6] = theta1;
        r[7] = Qd.x; r[8] = Qd.y; r[9] = Qd.z; r[10] = Q2.x; r[11] = Q2.y; r[12] = Q2.z; r[13] = theta2;
    }
};

}  // namespace dp

typedef dp::Curved<false> CurvedPlain;
typedef dp::Curved<true> CurvedJunction;
DP_ENTRY(curved, CurvedPlain)
DP_ENTRY(curved_junction, CurvedJunction)

// energy -EI int kappa.kappa0 of n elements (D unknowns each) into out (n,) [J]
extern "C" void curved_energy(int n, int D, const int* idx, const double* par, const void*, const double* x, const double*, double* out) {
    using namespace dp;
    for (int e = 0; e < n; ++e) {
        const double* p = par + e * CurvedPlain::NP;
        double X[15];
        for (int i = 0; i < D; ++i) X[i] = x[idx[e * D + i]];
        Vec<double> r1 = vec(X), v1 = vec(X + 3);
        const Vec<double> v2 = vec(X + 10), t1 = v1 / norm(v1), t2 = v2 / norm(v2);
        if (D == 15) { r1 += t1 * p[CurvedPlain::RIGID]; v1 = v1 * X[14]; }
        const Vec<double> d = vec(X + 7) - r1;
        Vec<double> a2, a3, b2, b3;
        directors(vec(p + CurvedPlain::REFERENCE1), vec(p + CurvedPlain::SECOND1), t1, X[6], a2, a3);
        directors(vec(p + CurvedPlain::REFERENCE2), vec(p + CurvedPlain::SECOND2), t2, X[13], b2, b3);
        const Vec<double> k1 = a2 * p[CurvedPlain::CURVATURE] + a3 * p[CurvedPlain::CURVATURE + 1], k2 = b2 * p[CurvedPlain::CURVATURE] + b3 * p[CurvedPlain::CURVATURE + 1];
        out[e] = 0;
        for (int g = 0; g < 3; ++g) {
            const Shape<double, double> N(XI3[g], 1.0 / p[CurvedPlain::LENGTH]);
            const Vec<double> q1 = N.slope(d, v1, v2), q2 = N.second(d, v1, v2);
            out[e] -= p[CurvedPlain::EI] * p[CurvedPlain::LENGTH] * W3[g] * dot(cross(q1, q2), k1 * (1 - XI3[g]) + k2 * XI3[g]) / dot(q1, q1);
        }
    }
}
