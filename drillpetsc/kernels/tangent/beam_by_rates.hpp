// Derivatives of the beam without rigid offset by rates and accelerations, times directions: four elements side by side, all directions at once.
//
// Inertia and damping are linear in the directions, and the gyroscopic force is quadratic in the rates, so no derivative is formed.
#pragma once
#include "beam/beam.hpp"

namespace dp {

// Kelvin-Voigt damping of an element at its place: linear in the rates (the terms of stiffness_forces and bending, beam/beam.hpp).
struct Damping {
    struct Point { Shape<Pack, Pack> N; Vec<Pack> t, k, side; Pack in, along, stiffness; };
    const Pack* p;
    Point points[3];
    Vec<Pack> t1, t2;
    Twist<Pack> q;

    static Point point(int g, const Vec<Pack>& d, const Vec<Pack>& v1, const Vec<Pack>& v2, const Pack* p) {
        const Shape<Pack, Pack> N(XI3[g], 1.0 / p[LENGTH]);
        const Vec<Pack> r1 = N.slope(d, v1, v2);
        const Pack in = 1.0 / norm(r1);
        const Vec<Pack> t = r1 * in;
        const Bend<Pack> b(t, in, N.second(d, v1, v2));
        return {N, t, b.k, b.side, in, b.along, p[EI] * p[LENGTH] * p[BETA] * W3[g]};
    }

    Damping(const Vec<Pack>& d, const Vec<Pack>& v1, const Vec<Pack>& v2, const Pack& n1, const Pack& n2, const Pack& phi1, const Pack& phi2, const Pack* params)
        : p(params), points{point(0, d, v1, v2, params), point(1, d, v1, v2, params), point(2, d, v1, v2, params)}, t1(v1 / n1), t2(v2 / n2),
          q(twist(d, v1, v2, n1, n2, phi1, phi2, params)) {}

    Work<Pack> forces(const Vec<Pack>& d, const Vec<Pack>& w1, const Vec<Pack>& w2, const Pack& o1, const Pack& o2) const {
        Pack em = Pack(0.0), theta[3];
        Vec<Pack> f1[3], f2[3];
        for (int g = 0; g < 3; ++g) {
            const Point& c = points[g];
            const Vec<Pack> q1 = c.N.slope(d, w1, w2), bend = c.N.second(d, w1, w2) - q1 * (c.along * c.in);
            const Pack stretch = dot(c.t, q1), spin = o1 * (1 - XI3[g]) + o2 * XI3[g];
            em += stretch * W3[g];
            const Vec<Pack> m = ((bend - c.t * dot(c.t, bend) - c.k * stretch) * c.in - c.side * spin) * c.stiffness;
            theta[g] = -dot(m, c.side);
            f2[g] = m * c.in;
            f1[g] = -(f2[g] * c.along + c.t * dot(m, c.k)) * c.in;
        }
        const Pack k = p[EA] * p[LENGTH] * p[BETA] * 0.5, e1 = dot(t1, w1), e2 = dot(t2, w2), Nm = k * (2.4 * em - 0.2 * (e1 + e2));
        const Pack torque = (o2 - o1 + dot(q.d, d) + dot(q.v1, w1) + dot(q.v2, w2)) * (p[BETA] * p[GJ] / p[LENGTH]);
        Work<Pack> Q = {q.d * torque, t1 * (k * (4.0 / 15 * e1 - 1.0 / 15 * e2 - 0.2 * em)) + q.v1 * torque,
                        t2 * (k * (4.0 / 15 * e2 - 1.0 / 15 * e1 - 0.2 * em)) + q.v2 * torque, -torque, torque};
        for (int g = 0; g < 3; ++g) {
            const Point& c = points[g];
            const Vec<Pack> f = f1[g] + c.t * (Nm * W3[g]);
            Q.d += f * c.N.B0 + f2[g] * c.N.C0;
            Q.v1 += f * c.N.B1 + f2[g] * c.N.C1;
            Q.v2 += f * c.N.B2 + f2[g] * c.N.C2;
            Q.theta1 += theta[g] * (1 - XI3[g]);
            Q.theta2 += theta[g] * XI3[g];
        }
        return Q;
    }
};

// Adds to each of `count` rows (length) of r; dy, da: the directions, in rows as long.
template <bool DAMPED>
void run_beam_by_rates(int n, const int* idx, const double* par, const double* x, const double* y, int count, long length, const double* dy, const double* da,
                   double* r) {
    for (int e = 0; e < n; e += 4) {
        const Lanes lanes(e, n);
        Pack X[14], Y[14], P[BEAM_PARAMETERS], U[14], A[14], R[14];
        lanes.gather(14, idx, x, X);
        lanes.gather(14, idx, y, Y);
        lanes.rows(BEAM_PARAMETERS, par, P);
        bool damped = false;
        for (int l = 0; l < 4; ++l) damped |= P[BETA].v[l] != 0.0;
        const Vec<Pack> v1 = vec(X + 3), v2 = vec(X + 10), w1 = vec(Y + 3), w2 = vec(Y + 10), d = vec(X + 7) - vec(X);
        const Pack L = P[LENGTH], m = P[MASS] * L * (1.0 / 420), j = P[POLAR] * L * (1.0 / 12), n1 = norm(v1), n2 = norm(v2);
        const Pack in1 = 1.0 / (n1 * n1 * n1), in2 = 1.0 / (n2 * n2 * n2);
        const Vec<Pack> turn1 = cross(w1, v1) * in1, turn2 = cross(w2, v2) * in2;
        const Pack h1 = (Y[6] * 5.0 + Y[13]) * j, h2 = (Y[13] * 5.0 + Y[6]) * j;
        const Vec<Pack> zero = {Pack(0.0), Pack(0.0), Pack(0.0)};
        const auto directions = [&](const Damping* damping) {
        for (int k = 0; k < count; ++k) {
            lanes.gather(14, idx, dy + k * length, U);
            lanes.gather(14, idx, da + k * length, A);
            const Vec<Pack> q1 = vec(U + 3), q2 = vec(U + 10);
            Vec<Pack> b1 = vec(A), z1 = vec(A + 3), b2 = vec(A + 7), z2 = vec(A + 10);
            Pack o1 = A[6], o2 = A[13];
            Work<Pack> Q = {zero, zero, zero, Pack(0.0), Pack(0.0)};
            if constexpr (DAMPED) {
                b1 += vec(U) * P[ALPHA]; z1 += q1 * P[ALPHA]; o1 += U[6] * P[ALPHA];
                b2 += vec(U + 7) * P[ALPHA]; z2 += q2 * P[ALPHA]; o2 += U[13] * P[ALPHA];
                if (damping) Q = damping->forces(vec(U + 7) - vec(U), q1, q2, U[6], U[13]);
            }
            const Vec<Pack> F1 = (b1 * 156.0 + z1 * (L * 22.0) + b2 * 54.0 - z2 * (L * 13.0)) * m - Q.d;
            const Vec<Pack> F2 = (b1 * 54.0 + z1 * (L * 13.0) + b2 * 156.0 - z2 * (L * 22.0)) * m + Q.d;
            const Pack dh1 = (U[6] * 5.0 + U[13]) * j, dh2 = (U[13] * 5.0 + U[6]) * j;
            const Vec<Pack> G1 = (b1 * (L * 22.0) + z1 * (L * L * 4.0) + b2 * (L * 13.0) - z2 * (L * L * 3.0)) * m + Q.v1 + cross(q1, v1) * (h1 * in1) + turn1 * dh1;
            const Vec<Pack> G2 = (b1 * (L * -13.0) - z1 * (L * L * 3.0) - b2 * (L * 22.0) + z2 * (L * L * 4.0)) * m + Q.v2 + cross(q2, v2) * (h2 * in2) + turn2 * dh2;
            R[0] = F1.x; R[1] = F1.y; R[2] = F1.z; R[3] = G1.x; R[4] = G1.y; R[5] = G1.z;
            R[6] = (o1 * 5.0 + o2) * j + Q.theta1;
            R[7] = F2.x; R[8] = F2.y; R[9] = F2.z; R[10] = G2.x; R[11] = G2.y; R[12] = G2.z;
            R[13] = (o2 * 5.0 + o1) * j + Q.theta2;
            double* rows = r + k * length;
            for (int l = 0; l < lanes.count; ++l)
                for (int i = 0; i < 14; ++i) rows[idx[(e + l) * 14 + i]] += R[i].v[l];
        }
        };
        if (DAMPED && damped) {
            const Damping damping(d, v1, v2, n1, n2, X[6], X[13], P);
            directions(&damping);
        } else
            directions(nullptr);
    }
}

}  // namespace dp
