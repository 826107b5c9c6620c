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
    static constexpr bool PACKED = false;
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
        Centre(const Vec<T>& v, const Vec<T>& w, const Vec<T>& w1, const T& phi, const T& spin, const T& spin_rate, const double* reference,
               const double* second, const double* offset)
            : t(v, w, w1) {
            Vec<T> d2, d3;
            directors(vec(reference), vec(second), t.t, phi, d2, d3);
            c = d2 * offset[0] + d3 * offset[1];
            const Vec<T> turning = cross(t.t, t.t1) + t.t * spin, turning_rate = cross(t.t, t.t2) + t.t * spin_rate + t.t1 * spin;
            c1 = cross(turning, c);
            c2 = cross(turning_rate, c) + cross(turning, c1);
        }
        void load(const Vec<T>& push, T* bend, T& torque) const {  // a force at the mass centre on slope and spin
            const Vec<T> moment = cross(c, push), b = cross(moment, t.t) / t.n;
            bend[0] += b.x; bend[1] += b.y; bend[2] += b.z;
            torque = dot(moment, t.t);
        }
    };

    // int N c ds of the cubic shapes N, c linear
    template <class T>
    static Four<T> shared(const Vec<T>& c1, const Vec<T>& c2, double L) {
        return {(c1 * 7.0 + c2 * 3.0) * (L / 20), (c1 * 3.0 + c2 * 2.0) * (L * L / 60), (c1 * 3.0 + c2 * 7.0) * (L / 20),
                (c1 * 2.0 + c2 * 3.0) * (-L * L / 60)};
    }
    // int r (1 - s) ds and int r s ds of the cubic r
    template <class T>
    static Vec<T> upper(const Four<T>& r, double L) { return (r.r1 * 7.0 + r.r2 * 3.0) * (L / 20) + (r.v1 * 3.0 - r.v2 * 2.0) * (L * L / 60); }
    template <class T>
    static Vec<T> lower(const Four<T>& r, double L) { return (r.r1 * 3.0 + r.r2 * 7.0) * (L / 20) + (r.v1 * 2.0 - r.v2 * 3.0) * (L * L / 60); }

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void*, T* r) {
        const double L = p[LENGTH], m = p[MASS];
        const Ride<T, JUNCTION> on(x, y, a, p[RIGID]);
        const Centre<T> one(vec(x + 3), vec(y + 3), vec(a + 3), x[6], y[6], a[6], p + REFERENCE1, p + SECOND1, p + OFFSET);
        const Centre<T> two(vec(x + 10), vec(y + 10), vec(a + 10), x[13], y[13], a[13], p + REFERENCE2, p + SECOND2, p + OFFSET);
        on.store(shared(one.c2 * m, two.c2 * m, L), p[RIGID], r);
        const Vec<double> weight = vec(p + GRAVITY) * (0.5 * L);
        one.load((upper(on.a, L) + (one.c2 * 2.0 + two.c2) * (L / 6) - weight) * m, r + 3, r[6]);
        two.load((lower(on.a, L) + (two.c2 * 2.0 + one.c2) * (L / 6) - weight) * m, r + 10, r[13]);
    }

    // kinetic and potential energy [J]
    static void energy(const double* x, const double* y, const double* p, double* out) {
        const double L = p[LENGTH], m = p[MASS], a[15] = {0.0};
        const Ride<double, JUNCTION> on(x, y, a, p[RIGID]);
        const Centre<double> one(vec(x + 3), vec(y + 3), vec(a), x[6], y[6], 0.0, p + REFERENCE1, p + SECOND1, p + OFFSET);
        const Centre<double> two(vec(x + 10), vec(y + 10), vec(a), x[13], y[13], 0.0, p + REFERENCE2, p + SECOND2, p + OFFSET);
        const double own = (dot(one.c1, one.c1) + dot(one.c1, two.c1) + dot(two.c1, two.c1)) * (L / 6);
        out[0] = m * (dot(upper(on.y, L), one.c1) + dot(lower(on.y, L), two.c1) + own);
        out[1] = -m * 0.5 * L * dot(vec(p + GRAVITY), one.c + two.c);
    }
};

}  // namespace dp
