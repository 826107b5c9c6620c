// Mass centre beside the axis: what a pipe of mass m per length adds to its beam's inertia and weight by lying at r + c instead of r,
// c(s) = (1 - s) c1 + s c2, c_i = e2 d2_i + e3 d3_i with the directors of the nodes.  r is the element's cubic, so that together with the
// beam's consistent mass the kinetic energy is int m |r' + c'|^2/2 ds: never negative, however large the offset.
//   virtual work   m int dr.c'' + dc.(r'' - g + c'') ds,   ' the rate
#pragma once
#include "beam/beam_jacobian.hpp"
#include "core/pack_dual.hpp"
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

// What the entries of elements without rigid offset need of a node: its centre depends on slope and spin angle only, by which it is differentiated.
struct EccentricNode {
    typedef PackDual<4> D;
    Eccentric<false>::Centre<D> centre;
    PackVec arm, tangent;  // values of the offset and of the tangent
    Pack over;             // 1/length of the slope

    EccentricNode(const Pack* x, const Pack* y, const Pack* a, const double* c, const Pack* g, const Pack* reference, const Pack* second, const Pack* offset)
        : centre(seeded(x, c[0]), seeded(y, c[1]), seeded(a, c[2]), spin(x[6], c[0], nullptr), spin(y[6], c[1], g), spin(a[6], c[2], g), reference, second,
                 offset),
          arm(values(centre.c)), tangent(values(centre.t.t)), over(1.0 / centre.t.n.v) {}

    static Vec<D> seeded(const Pack* v, double weight) {
        Vec<D> u = {v[3], v[4], v[5]};
        u.x.set(0, weight); u.y.set(1, weight); u.z.set(2, weight);
        return u;
    }
    static D spin(const Pack& value, double weight, const Pack* g) {
        D u(value);
        for (int k = 0; g && k < 3; ++k) u.set(k, g[k] * weight);
        u.set(3, weight);
        return u;
    }
    // Derivative i of the offset's acceleration.
    PackVec by(int i) const { return {centre.c2.x.g[i], centre.c2.y.g[i], centre.c2.z.g[i]}; }
    // Rows of slope and spin angle by a derivative of the force at the mass centre.
    void load(const PackVec& push, Pack* rows) const {
        const PackVec moment = cross(arm, push), bend = cross(moment, tangent) * over;
        rows[0] += bend.x; rows[1] += bend.y; rows[2] += bend.z;
        rows[3] += dot(moment, tangent);
    }
};

// Entries of elements without rigid offset, side by side.  The offsets' accelerations and the forces at the mass centre are linear in those of both
// nodes, so that only the centres are differentiated.
inline void eccentric_entries(const Pack* X, const Pack* Y, const Pack* A, const Pack* p, const double* c, const Pack* g1, const Pack* g2, Pack (*out)[14]) {
    typedef Eccentric<false> E;
    const Pack L = p[E::LENGTH], m = p[E::MASS], zero = Pack(0.0), share = m * L * (1.0 / 20.0), square = m * L * L * (1.0 / 60.0), own = m * L * (1.0 / 6.0);
    const EccentricNode one(X, Y, A, c, g1, p + E::REFERENCE1, p + E::SECOND1, p + E::OFFSET);
    const EccentricNode two(X + 7, Y + 7, A + 7, c, g2, p + E::REFERENCE2, p + E::SECOND2, p + E::OFFSET);
    const EccentricNode* both[2] = {&one, &two};
    for (int row = 0; row < 2; ++row) {
        const EccentricNode &node = *both[row], &other = *both[1 - row];
        const double sign = row ? -1.0 : 1.0;  // of shapes that belong to slopes
        // the force at the mass centre, and what turns its arm
        const PackVec near = vec(A + 7 * row) * 7.0 + vec(A + 7 - 7 * row) * 3.0, bent = vec(A + 3 + 7 * row) * 3.0 - vec(A + 10 - 7 * row) * 2.0;
        const PackVec push = near * share + bent * (square * sign) + (values(node.centre.c2) * 2.0 + values(other.centre.c2)) * own -
                             vec(p + E::GRAVITY) * (L * m * 0.5);
        EccentricNode::D bend[3] = {0.0, 0.0, 0.0}, torque;
        node.centre.load(Vec<EccentricNode::D>{push.x, push.y, push.z}, bend, torque);
        for (int column = 0; column < 2; ++column) {
            const bool same = row == column;
            Pack(*to)[14] = out + 7 * row;
            for (int i = 0; i < 4; ++i) {
                const PackVec by = both[column]->by(i), force = by * (share * (same ? 7.0 : 3.0)), couple = by * (square * (sign * (same ? 3.0 : 2.0)));
                Pack rows[7] = {force.x, force.y, force.z, couple.x, couple.y, couple.z, zero};
                PackVec moved = by * (own * (same ? 2.0 : 1.0));
                const Pack slope = square * (sign * (same ? 3.0 : -2.0) * c[2]);  // of the slope's acceleration
                if (i == 0) moved.x += slope;
                if (i == 1) moved.y += slope;
                if (i == 2) moved.z += slope;
                node.load(moved, rows + 3);
                if (same) {
                    for (int k = 0; k < 3; ++k) rows[3 + k] += bend[k].g[i];
                    rows[6] += torque.g[i];
                }
                for (int k = 0; k < 7; ++k) to[k][7 * column + 3 + i] = rows[k];
            }
            const Pack s = share * ((same ? 7.0 : 3.0) * c[2]);
            for (int j = 0; j < 3; ++j) {  // positions act through their accelerations only
                Pack turned[4] = {zero, zero, zero, zero};
                node.load(PackVec{j == 0 ? s : zero, j == 1 ? s : zero, j == 2 ? s : zero}, turned);
                for (int k = 0; k < 3; ++k) to[k][7 * column + j] = zero;
                for (int k = 0; k < 4; ++k) to[3 + k][7 * column + j] = turned[k];
            }
        }
    }
}

inline void run_eccentric_jacobian(int n, const int* idx, const int* nodes, const double* par, void*, const double* c, const double* spin,
                                   const double* x, const double* y, const double* a, double* K) {
    for (int e = 0; e < n; e += 4) {
        Pack X[14], Y[14], A[14], P[Eccentric<false>::NP], g1[3], g2[3], out[14][14];
        const Lanes lanes(e, n);
        lanes.gather(14, idx, x, X);
        lanes.gather(14, idx, y, Y);
        lanes.gather(14, idx, a, A);
        lanes.rows(Eccentric<false>::NP, par, P);
        gather_spin(lanes, nodes, spin, g1, g2);
        eccentric_entries(X, Y, A, P, c, g1, g2, out);
        lanes.store_rows(14 * 14, out[0], K);
    }
}

}  // namespace dp
