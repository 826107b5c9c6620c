// Two-node spatial Euler-Bernoulli element (ANCF: absolute nodal coordinates): position r, slope v = r', spin angle phi at each node.
//
// Strains: quadratic axial strain with the true mean, three-point bending, torsion against parallel transport with two points.
// Rows are virtual work on (dr, dv, dtheta), dtheta = dphi + c.dv, so no term of the reference direction appears in a force.
#pragma once
#include "core/element.hpp"
#include "core/frame.hpp"

namespace dp {

DP_ENUM(BeamParameter,  // per element
    LENGTH,           // reference length [m]
    EA, EI, GJ,       // [N], [N m2], [N m2]
    MASS, POLAR,      // per length [kg/m], [kg m]
    BETA, ALPHA,      // Kelvin-Voigt time [s], mass-proportional rate [1/s]
    TWIST0,           // delta_e minus the stress-free twist [rad]
    GRAVITY,          // 3: [m/s2]
    REFERENCE1 = GRAVITY + 3, REFERENCE2 = REFERENCE1 + 3,  // 3 each: reference directions of both nodes
    RIGID = REFERENCE2 + 3,   // length of the rigid item above the element's upper end [m]
    BEAM_PARAMETERS)

constexpr double XI3[3] = {0.11270166537925831, 0.5, 0.8872983346207417}, W3[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
constexpr double XI2[2] = {0.21132486540518712, 0.7886751345948129}, W2[2] = {0.5, 0.5};

template <class T, class S>
struct Shape {  // r' = B0 d + B1 v1 + B2 v2,  r'' = C0 d + C1 v1 + C2 v2
    S B0, C0, C1, C2;
    double B1, B2;
    Shape(double xi, const S& il) {
        B0 = 6 * xi * (1 - xi) * il; B1 = 1 - 4 * xi + 3 * xi * xi; B2 = 3 * xi * xi - 2 * xi;
        C0 = (6 - 12 * xi) * il * il; C1 = (6 * xi - 4) * il; C2 = (6 * xi - 2) * il;
    }
    Vec<T> slope(const Vec<T>& d, const Vec<T>& v1, const Vec<T>& v2) const { return d * B0 + v1 * B1 + v2 * B2; }
    Vec<T> second(const Vec<T>& d, const Vec<T>& v1, const Vec<T>& v2) const { return d * C0 + v1 * C1 + v2 * C2; }
};

template <class T>
struct Work {  // generalised forces of one element
    Vec<T> d, v1, v2;
    T theta1, theta2;
};

// 1/(|p|(|p||d| + p.d)) d x p: the connection of the parallel transport along the chord as reference direction
template <class T>
inline Vec<T> chord_connection(const Vec<T>& d, const T& m, const Vec<T>& p, const T& n) {
    return cross(d, p) / (n * (n * m + dot(d, p)));
}

template <class T>
struct Twist {  // twist and its independent of the reference direction, gradient: dTwist = theta2 - theta1 + d.dd + v1.dv1 + v2.dv2
    T value;
    Vec<T> d, v1, v2;
};

// Twist of an element against parallel transport along its centre line.
template <class T, class S>
inline Twist<T> twist(const Vec<T>& d, const Vec<T>& v1, const Vec<T>& v2, const T& n1, const T& n2, const T& phi1, const T& phi2, const S* p) {
    const Vec<S> a1 = {p[REFERENCE1], p[REFERENCE1 + 1], p[REFERENCE1 + 2]}, a2 = {p[REFERENCE2], p[REFERENCE2 + 1], p[REFERENCE2 + 2]};
    const S il = S(1.0) / p[LENGTH];
    const T m = norm(d);
    const Vec<T> h1 = chord_connection(d, m, v1, n1), h2 = chord_connection(d, m, v2, n2);
    const Vec<T> lifted = {T(0.0) + a1.x, T(0.0) + a1.y, T(0.0) + a1.z};
    Twist<T> q;
    q.value = phi2 - phi1 + p[TWIST0] + reference_change(a2, lifted, v2) + reference_change(a1, d, v2) - reference_change(a1, d, v1);
    q.v1 = -h1;
    q.v2 = h2;
    q.d = (h2 * n2 - h1 * n1) / m;
    for (int g = 0; g < 2; ++g) {
        const Shape<T, S> N(XI2[g], il);
        const Vec<T> r1 = N.slope(d, v1, v2), r2 = N.second(d, v1, v2);
        const T n = norm(r1), dr = dot(d, r1);
        const T scale = 1.0 / (n * n * m + n * dr);
        const Vec<T> by_r2 = cross(d, r1) * scale;
        const T f = dot(by_r2, r2);
        const Vec<T> by_r1 = cross(r2, d) * scale - (f * scale) * (r1 * (2.0 * m + dr / n) + d * n);
        const Vec<T> by_d = cross(r1, r2) * scale - (f * scale) * (d * (n * n / m) + r1 * n);
        const S w = p[LENGTH] * W2[g];
        q.value -= f * w;
        q.d -= (by_r1 * N.B0 + by_r2 * N.C0 + by_d) * w;
        q.v1 -= (by_r1 * N.B1 + by_r2 * N.C1) * w;
        q.v2 -= (by_r1 * N.B2 + by_r2 * N.C2) * w;
    }
    return q;
}

// Curvature vector k = (r'' - t (t.r''))/n of a point, t = r'/n, n = |r'|, |k| = |kappa|; side = t x k.
template <class T>
struct Bend {
    T along;  // t.r''
    Vec<T> k, side;
    Bend(const Vec<T>& t, const T& in, const Vec<T>& r2) : along(dot(t, r2)), k((r2 - t * along) * in), side(cross(t, k)) {}
    // Rate of k across t in the frame that turns with the pipe: [P(q2 - (t.r''/n) q1) - (t.q1) k]/n - spin t x k, P = I - t t^T,
    // q1, q2 the rates of r', r''.
    Vec<T> rate(const Vec<T>& t, const T& in, const Vec<T>& q1, const Vec<T>& q2, const T& spin) const {
        const Vec<T> bend = q2 - q1 * (along * in);
        return (bend - t * dot(t, bend) - k * dot(t, q1)) * in - side * spin;
    }
};

// Bending forces of one point, conjugate to r' and r''; damped: moment beta EI times the rate in the axes of the turning pipe.  The power of
// the moment m = EI (k + beta rate) is m.rate, so forces and torque are its factors of q1, q2, spin.  stiffness: EI times the length
// of the point [N m3].
template <class T, class S, bool DAMPED>
inline void bending(const Vec<T>& t, const T& in, const Vec<T>& r2, const Vec<T>& q1, const Vec<T>& q2, const T& spin, const S& stiffness,
                    const S& beta, Vec<T>& f1, Vec<T>& f2, T& torque) {
    const Bend<T> b(t, in, r2);
    Vec<T> m = b.k * stiffness;
    if constexpr (DAMPED) {
        m += b.rate(t, in, q1, q2, spin) * (stiffness * beta);
        torque = -dot(m, b.side);
    }
    f2 = m * in;
    f1 = -(f2 * b.along + t * dot(m, b.k)) * in;
}

// Elastic and Kelvin-Voigt forces of an element; w are the rates of d, v1, v2 and o1, o2 the spin rates (used when DAMPED).
template <class T, class S, bool DAMPED>
inline Work<T> stiffness_forces(const Vec<T>& d, const Vec<T>& v1, const Vec<T>& v2, const T& phi1, const T& phi2, const Vec<T>& d_rate,
                                const Vec<T>& w1, const Vec<T>& w2, const T& o1, const T& o2, const S* p) {
    const S il = S(1.0) / p[LENGTH], beta = p[BETA];
    const T n1 = norm(v1), n2 = norm(v2);
    const Vec<T> t1 = v1 / n1, t2 = v2 / n2;
    T e1 = n1 - 1.0, e2 = n2 - 1.0, em = T(-1.0);
    if constexpr (DAMPED) {
        e1 += dot(t1, w1) * beta;
        e2 += dot(t2, w2) * beta;
    }
    Vec<T> tg[3], f1[3], f2[3];
    T theta[3];
    for (int g = 0; g < 3; ++g) {
        const Shape<T, S> N(XI3[g], il);
        const Vec<T> r1 = N.slope(d, v1, v2), r2 = N.second(d, v1, v2);
        const T n = norm(r1), in = 1.0 / n;
        tg[g] = r1 * in;
        em += n * W3[g];
        Vec<T> q1, q2;
        T spin;
        if constexpr (DAMPED) {
            q1 = N.slope(d_rate, w1, w2);
            q2 = N.second(d_rate, w1, w2);
            em += dot(tg[g], q1) * (beta * W3[g]);
            spin = o1 * (1 - XI3[g]) + o2 * XI3[g];
        }
        bending<T, S, DAMPED>(tg[g], in, r2, q1, q2, spin, p[EI] * p[LENGTH] * W3[g], beta, f1[g], f2[g], theta[g]);
    }
    // conjugates of the end strains and the mean strain, U = EA L/2 [2/15 (e1^2+e2^2) - e1 e2/15 - (e1+e2) em/5 + 6/5 em^2]
    const S k = p[EA] * p[LENGTH] * 0.5;
    const T N1 = k * (4.0 / 15 * e1 - 1.0 / 15 * e2 - 0.2 * em), N2 = k * (4.0 / 15 * e2 - 1.0 / 15 * e1 - 0.2 * em);
    const T Nm = k * (2.4 * em - 0.2 * (e1 + e2));
    Work<T> Q;
    Q.v1 = t1 * N1;
    Q.v2 = t2 * N2;
    Q.d = {T(0.0), T(0.0), T(0.0)};
    const Twist<T> q = twist(d, v1, v2, n1, n2, phi1, phi2, p);
    T angle = q.value;
    if constexpr (DAMPED) angle += (o2 - o1 + dot(q.d, d_rate) + dot(q.v1, w1) + dot(q.v2, w2)) * beta;
    const T torque = angle * (p[GJ] * il);
    Q.theta1 = -torque;
    Q.theta2 = torque;
    for (int g = 0; g < 3; ++g) {
        const Shape<T, S> N(XI3[g], il);
        const Vec<T> f = f1[g] + tg[g] * (Nm * W3[g]);
        Q.d += f * N.B0 + f2[g] * N.C0;
        Q.v1 += f * N.B1 + f2[g] * N.C1;
        Q.v2 += f * N.B2 + f2[g] * N.C2;
        if constexpr (DAMPED) {
            Q.theta1 += theta[g] * (1 - XI3[g]);
            Q.theta2 += theta[g] * XI3[g];
        }
    }
    Q.d += q.d * torque;
    Q.v1 += q.v1 * torque;
    Q.v2 += q.v2 * torque;
    return Q;
}

// JUNCTION: the upper node carries a stretch ratio m (unknown 14): the element's upper end has the slope m v1 at r1 + RIGID v1/|v1|.
template <bool DAMPED, bool JUNCTION>
struct Beam {
    static constexpr int D = JUNCTION ? 15 : 14, NP = BEAM_PARAMETERS, NSPIN = 2;
    static constexpr const char* ParameterText = BeamParameterText;
    static constexpr bool PACKED = true;
    static constexpr int SPINS[2][2] = {{6, 3}, {13, 10}};

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void*, T* r) {
        Vec<T> r1 = vec(x), v1 = vec(x + 3), u1 = vec(y), w1 = vec(y + 3), b1 = vec(a), z1 = vec(a + 3);
        const Vec<T> v0 = v1, r2 = vec(x + 7), v2 = vec(x + 10), u2 = vec(y + 7), w2 = vec(y + 10);
        Vec<T> b2 = vec(a + 7), z2 = vec(a + 10);
        T o1 = a[6], o2 = a[13];
        if constexpr (JUNCTION) {
            const Tangent<T> t(v1, w1, z1);
            r1 += t.t * p[RIGID]; u1 += t.t1 * p[RIGID]; b1 += t.t2 * p[RIGID];
            z1 = v1 * a[14] + w1 * (2.0 * y[14]) + z1 * x[14];
            w1 = v1 * y[14] + w1 * x[14];
            v1 = v1 * x[14];
        }
        if constexpr (DAMPED) {
            b1 += u1 * p[ALPHA]; z1 += w1 * p[ALPHA]; o1 += y[6] * p[ALPHA];
            b2 += u2 * p[ALPHA]; z2 += w2 * p[ALPHA]; o2 += y[13] * p[ALPHA];
        }
        const Work<T> Q = stiffness_forces<T, S, DAMPED>(r2 - r1, v1, v2, x[6], x[13], u2 - u1, w1, w2, y[6], y[13], p);
        const Vec<S> g = {p[GRAVITY], p[GRAVITY + 1], p[GRAVITY + 2]};
        const S L = p[LENGTH], m = p[MASS] * L * (1.0 / 420), j = p[POLAR] * L * (1.0 / 12);
        b1 = b1 - g;  // a uniform acceleration field acts through the same consistent matrix
        b2 = b2 - g;
        const Vec<T> F1 = (b1 * 156.0 + z1 * (L * 22.0) + b2 * 54.0 - z2 * (L * 13.0)) * m - Q.d;
        const Vec<T> F2 = (b1 * 54.0 + z1 * (L * 13.0) + b2 * 156.0 - z2 * (L * 22.0)) * m + Q.d;
        const T h1 = (y[6] * 5.0 + y[13]) * j, h2 = (y[13] * 5.0 + y[6]) * j;  // spin momentum at the nodes [kg m2/s]
        const T n1 = norm(v1), n2 = norm(v2);
        Vec<T> G1 = (b1 * (L * 22.0) + z1 * (L * L * 4.0) + b2 * (L * 13.0) - z2 * (L * L * 3.0)) * m + Q.v1 + cross(w1, v1) * (h1 / (n1 * n1 * n1));
        const Vec<T> G2 = (b1 * (L * -13.0) - z1 * (L * L * 3.0) - b2 * (L * 22.0) + z2 * (L * L * 4.0)) * m + Q.v2 + cross(w2, v2) * (h2 / (n2 * n2 * n2));
        if constexpr (JUNCTION) {
            const T n0 = norm(v0);
            const Vec<T> t = v0 / n0;
            r[14] = dot(v0, G1);
            G1 = G1 * x[14] + (F1 - t * dot(t, F1)) * (p[RIGID] / n0);
        }
        r[0] = F1.x; r[1] = F1.y; r[2] = F1.z; r[3] = G1.x; r[4] = G1.y; r[5] = G1.z;
        r[6] = (o1 * 5.0 + o2) * j + Q.theta1;
        r[7] = F2.x; r[8] = F2.y; r[9] = F2.z; r[10] = G2.x; r[11] = G2.y; r[12] = G2.z;
        r[13] = (o2 * 5.0 + o1) * j + Q.theta2;
    }
};

}  // namespace dp
