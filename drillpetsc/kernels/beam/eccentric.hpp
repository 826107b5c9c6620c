// Mass centre beside the axis: what a pipe of mass m per length adds to its beam's inertia and weight by lying at r + c instead of r,
// c(s) = (1 - s) c1 + s c2, c_i = e2 d2_i + e3 d3_i with the directors of the nodes.  r is the element's cubic, so that together with the
// beam's consistent mass the kinetic energy is int m |r' + c'|^2/2 ds: never negative, however large the offset.
//   virtual work   m int dr.c'' + dc.(r'' - g + c'') ds,   ' the rate
#pragma once
#include "fluid/flow.hpp"

namespace dp {

template <bool JUNCTION>
struct Eccentric {
    static constexpr int D = JUNCTION ? 15 : 14, NSPIN = 2;
    static constexpr bool PACKED = !JUNCTION;
    static constexpr int SPINS[2][2] = {{6, 3}, {13, 10}};
    DP_ENUM(Parameter,
        LENGTH, MASS,  // of the element [m]; per length [kg/m]
        OFFSET,        // 2: mass centre along the two directors [m]
        RIGID = OFFSET + 2,  // length of the rigid item above [m]
        GRAVITY,       // 3: [m/s2]
        REFERENCE1 = GRAVITY + 3, SECOND1 = REFERENCE1 + 3, REFERENCE2 = SECOND1 + 3, SECOND2 = REFERENCE2 + 3,  // 3 each: frames of both nodes
        NP = SECOND2 + 3)

    template <class T>
    struct Centre {  // the offset at a node, its rates, the tangent there
        Tangent<T> t;
        Vec<T> c, c1, c2;
        template <class S>
        Centre(const Vec<T>& v, const Vec<T>& w, const Vec<T>& w1, const T& phi, const T& spin, const T& spin_rate, const S* reference,
               const S* second, const S* offset)
            : t(v, w, w1) {
            Vec<T> d2, d3;
            directors(vec(reference), vec(second), t.t, phi, d2, d3);
            c = d2 * offset[0] + d3 * offset[1];
            const Vec<T> turning = cross(t.t, t.t1) + t.t * spin, turning_rate = cross(t.t, t.t2) + t.t * spin_rate + t.t1 * spin;
            c1 = cross(turning, c);
            c2 = cross(turning_rate, c) + cross(turning, c1);
        }
        template <class R>
        void load(const Vec<R>& push, R* bend, R& torque) const {  // a force at the mass centre on slope and spin
            const Vec<R> moment = cross(c, push), b = cross(moment, t.t) / t.n;
            bend[0] += b.x; bend[1] += b.y; bend[2] += b.z;
            torque = dot(moment, t.t);
        }
    };

    // int N c ds of the cubic shapes N, c linear
    template <class T, class S>
    static Four<T> shared(const Vec<T>& c1, const Vec<T>& c2, const S& L) {
        return {(c1 * 7.0 + c2 * 3.0) * (L / 20.0), (c1 * 3.0 + c2 * 2.0) * (L * L / 60.0), (c1 * 3.0 + c2 * 7.0) * (L / 20.0),
                (c1 * 2.0 + c2 * 3.0) * (-L * L / 60.0)};
    }
    // int r (1 - s) ds and int r s ds of the cubic r
    template <class T, class S>
    static Vec<T> upper(const Four<T>& r, const S& L) { return (r.r1 * 7.0 + r.r2 * 3.0) * (L / 20.0) + (r.v1 * 3.0 - r.v2 * 2.0) * (L * L / 60.0); }
    template <class T, class S>
    static Vec<T> lower(const Four<T>& r, const S& L) { return (r.r1 * 3.0 + r.r2 * 7.0) * (L / 20.0) + (r.v1 * 2.0 - r.v2 * 3.0) * (L * L / 60.0); }

    // The rows of an element without rigid offset; each node's unknowns, rates and accelerations may have a number type of their own, R is
    // that of their sums.
    template <class T, class U, class S, class R>
    static void rows(const T* x1, const T* y1, const T* a1, const U* x2, const U* y2, const U* a2, const S* p, R* r) {
        const S L = p[LENGTH], m = p[MASS], square = L * L / 60.0;
        const Centre<T> one(vec(x1 + 3), vec(y1 + 3), vec(a1 + 3), x1[6], y1[6], a1[6], p + REFERENCE1, p + SECOND1, p + OFFSET);
        const Centre<U> two(vec(x2 + 3), vec(y2 + 3), vec(a2 + 3), x2[6], y2[6], a2[6], p + REFERENCE2, p + SECOND2, p + OFFSET);
        const Vec<T> r1 = vec(a1), v1 = vec(a1 + 3), c1 = one.c2 * m;
        const Vec<U> r2 = vec(a2), v2 = vec(a2 + 3), c2 = two.c2 * m;
        const Vec<R> F1 = (c1 * 7.0 + c2 * 3.0) * (L / 20.0), G1 = (c1 * 3.0 + c2 * 2.0) * square;
        const Vec<R> F2 = (c1 * 3.0 + c2 * 7.0) * (L / 20.0), G2 = (c1 * 2.0 + c2 * 3.0) * -square;
        const Vec<S> weight = vec(p + GRAVITY) * (0.5 * L);
        const Vec<R> above = (r1 * 7.0 + r2 * 3.0) * (L / 20.0) + (v1 * 3.0 - v2 * 2.0) * square;
        const Vec<R> below = (r1 * 3.0 + r2 * 7.0) * (L / 20.0) + (v1 * 2.0 - v2 * 3.0) * square;
        r[0] = F1.x; r[1] = F1.y; r[2] = F1.z; r[3] = G1.x; r[4] = G1.y; r[5] = G1.z;
        r[7] = F2.x; r[8] = F2.y; r[9] = F2.z; r[10] = G2.x; r[11] = G2.y; r[12] = G2.z;
        one.load((above + (one.c2 * 2.0 + two.c2) * (L / 6.0) - weight) * m, r + 3, r[6]);
        two.load((below + (two.c2 * 2.0 + one.c2) * (L / 6.0) - weight) * m, r + 10, r[13]);
    }

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void*, T* r) {
        if constexpr (!JUNCTION) {
            rows(x, y, a, x + 7, y + 7, a + 7, p, r);
        } else {
            const S L = p[LENGTH], m = p[MASS];
            const Ride<T, JUNCTION> on(x, y, a, p[RIGID]);
            const Centre<T> one(vec(x + 3), vec(y + 3), vec(a + 3), x[6], y[6], a[6], p + REFERENCE1, p + SECOND1, p + OFFSET);
            const Centre<T> two(vec(x + 10), vec(y + 10), vec(a + 10), x[13], y[13], a[13], p + REFERENCE2, p + SECOND2, p + OFFSET);
            on.store(shared(one.c2 * m, two.c2 * m, L), p[RIGID], r);
            const Vec<S> weight = vec(p + GRAVITY) * (0.5 * L);
            one.load((upper(on.a, L) + (one.c2 * 2.0 + two.c2) * (L / 6.0) - weight) * m, r + 3, r[6]);
            two.load((lower(on.a, L) + (two.c2 * 2.0 + one.c2) * (L / 6.0) - weight) * m, r + 10, r[13]);
        }
    }

    // kinetic and potential energy [J]
    template <class T>
    static void energy(const T* x, const T* y, const T* p, T* out) {
        const T L = p[LENGTH], m = p[MASS], none = T(0.0);
        T a[15];
        for (T& one : a) one = none;
        const Ride<T, JUNCTION> on(x, y, a, p[RIGID]);
        const Centre<T> one(vec(x + 3), vec(y + 3), vec(a), x[6], y[6], none, p + REFERENCE1, p + SECOND1, p + OFFSET);
        const Centre<T> two(vec(x + 10), vec(y + 10), vec(a), x[13], y[13], none, p + REFERENCE2, p + SECOND2, p + OFFSET);
        const T own = (dot(one.c1, one.c1) + dot(one.c1, two.c1) + dot(two.c1, two.c1)) * (L / 6.0);
        out[0] = m * (dot(upper(on.y, L), one.c1) + dot(lower(on.y, L), two.c1) + own);
        out[1] = -m * 0.5 * L * dot(vec(p + GRAVITY), one.c + two.c);
    }
};

// Derivatives by the slope and the spin angle of a node, side by side.
typedef Vec<Pack> BySlopeAndSpin;
inline BySlopeAndSpin derivatives(const Vec<Dual<4>>& u) { return {Pack(u.x.g[0]), Pack(u.y.g[0]), Pack(u.z.g[0])}; }

// What the entries of an element without rigid offset need of a node: its centre depends on slope and spin angle only.
struct EccentricNode {
    Eccentric<false>::Centre<Dual<4>> centre;
    Vec<double> arm, tangent;  // values of the offset and of the tangent over the slope's length
    double slope;
    BySlopeAndSpin by_centre, by_acceleration;  // of the offset's acceleration; of the slope's

    EccentricNode(const double* x, const double* y, const double* a, const double* c, const double* g, const double* reference, const double* second,
                  const double* offset)
        : centre(seeded(x, c[0]), seeded(y, c[1]), seeded(a, c[2]), spin(x[6], c[0], nullptr), spin(y[6], c[1], g), spin(a[6], c[2], g), reference, second,
                 offset),
          arm(values(centre.c)), tangent(values(centre.t.t)), slope(centre.t.n.v), by_centre(derivatives(centre.c2)),
          by_acceleration{Pack(V4{c[2], 0, 0, 0}), Pack(V4{0, c[2], 0, 0}), Pack(V4{0, 0, c[2], 0})} {}

    static Vec<Dual<4>> seeded(const double* v, double weight) {
        Vec<Dual<4>> u = {v[3], v[4], v[5]};
        u.x.set(0, weight); u.y.set(1, weight); u.z.set(2, weight);
        return u;
    }
    static Dual<4> spin(double value, double weight, const double* g) {
        Dual<4> u(value);
        u.g[0] = g ? V4{weight * g[0], weight * g[1], weight * g[2], weight} : V4{0, 0, 0, weight};
        return u;
    }
    // Rows of slope and spin angle by the derivatives of a force at the mass centre.
    template <class R> void load(const Vec<R>& push, R* rows) const {
        const Vec<R> moment = cross(arm, push), bend = cross(moment, tangent) * (1.0 / slope);
        rows[0] += bend.x; rows[1] += bend.y; rows[2] += bend.z;
        rows[3] += dot(moment, tangent);
    }
};

// Entries of elements without rigid offset.  The offsets' accelerations and the forces at the mass centre are linear in those of both nodes, so
// that only the centres are differentiated.
inline void run_eccentric_jacobian(int n, const int* idx, const int* nodes, const double* par, void*, const double* c, const double* spin,
                                   const double* x, const double* y, const double* a, double* K) {
    typedef Eccentric<false> E;
    for (int e = 0; e < n; ++e) {
        const double *p = par + (long)e * E::NP, L = p[E::LENGTH], m = p[E::MASS], long_share = m * L / 20.0, square = m * L * L / 60.0, own = m * L / 6.0;
        double X[14], Y[14], A[14], *out = K + 196L * e;
        for (int i = 0; i < 14; ++i) { const int k = idx[14L * e + i]; X[i] = x[k]; Y[i] = y[k]; A[i] = a[k]; }
        const EccentricNode one(X, Y, A, c, spin + 3 * nodes[2 * e], p + E::REFERENCE1, p + E::SECOND1, p + E::OFFSET);
        const EccentricNode two(X + 7, Y + 7, A + 7, c, spin + 3 * nodes[2 * e + 1], p + E::REFERENCE2, p + E::SECOND2, p + E::OFFSET);
        const EccentricNode* both[2] = {&one, &two};
        for (int i = 0; i < 14; ++i)  // positions act through their accelerations only
            for (int j = 0; j < 3; ++j) out[14 * i + j] = out[14 * i + 7 + j] = 0.0;
        for (int row = 0; row < 2; ++row) {
            const EccentricNode &node = *both[row], &other = *both[1 - row];
            const double sign = row ? -1.0 : 1.0;  // of shapes that belong to slopes
            // the force at the mass centre
            const Vec<double> near = vec(A + 7 * row) * 7.0 + vec(A + 7 - 7 * row) * 3.0, bent = vec(A + 3 + 7 * row) * 3.0 - vec(A + 10 - 7 * row) * 2.0;
            const Vec<double> push = near * long_share + bent * (sign * square) + (values(node.centre.c2) * 2.0 + values(other.centre.c2)) * own -
                                     vec(p + E::GRAVITY) * (0.5 * L * m);
            for (int column = 0; column < 2; ++column) {
                const bool same = row == column;
                const BySlopeAndSpin &by = both[column]->by_centre, &slope = both[column]->by_acceleration;
                const BySlopeAndSpin force = by * (long_share * (same ? 7.0 : 3.0)), couple = by * (sign * square * (same ? 3.0 : 2.0));
                Pack rows[7] = {force.x, force.y, force.z, couple.x, couple.y, couple.z, Pack(0.0)};
                node.load(slope * (same ? sign * square * 3.0 : -sign * square * 2.0) + by * (own * (same ? 2.0 : 1.0)), rows + 3);
                if (same) {  // its arm turns
                    Dual<4> bend[3] = {0.0, 0.0, 0.0}, torque;
                    const Vec<Dual<4>> fixed = {push.x, push.y, push.z};
                    node.centre.load(fixed, bend, torque);
                    for (int k = 0; k < 3; ++k) rows[3 + k] += Pack(bend[k].g[0]);
                    rows[6] += Pack(torque.g[0]);
                }
                for (int i = 0; i < 7; ++i)
                    for (int l = 0; l < 4; ++l) out[14 * (7 * row + i) + 7 * column + 3 + l] = rows[i].v[l];
                const double share = c[2] * long_share * (same ? 7.0 : 3.0);
                for (int j = 0; j < 3; ++j) {
                    double turned[4] = {0.0, 0.0, 0.0, 0.0};
                    node.load(Vec<double>{j == 0 ? share : 0.0, j == 1 ? share : 0.0, j == 2 ? share : 0.0}, turned);
                    for (int i = 0; i < 4; ++i) out[14 * (7 * row + 3 + i) + 7 * column + j] = turned[i];
                }
            }
        }
    }
}

}  // namespace dp
