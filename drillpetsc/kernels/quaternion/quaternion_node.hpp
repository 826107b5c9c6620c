// Kinematics of a node of the quaternion element: position r, strain eps, Euler parameters q; slope r' = (1 + eps) A(q) e1.
//
// The direction t = q e1 q*/|q|^2 does not depend on the length of q, so that a Newton step that turns q by a finite angle does not
// stretch the string; the spin rate is the plain one of Euler parameters, 2 (q* q')_1.  Both are those of Zhao and Ren
// (2012) where |q| = 1.
#pragma once
#include "core/element.hpp"
#include "quaternion/quaternion.hpp"

namespace dp {

template <class T>
struct Node {
    Quat<T> q, unit, q1;   // parameters, the same over their length, their rate
    T length, stretch;     // |q|; 1 + eps
    Vec<T> t, t1, t2, v, w, z; // direction with two rates; slope r' with two rates
    T spin, spin_rate;     // [rad/s], [rad/s2]

    // x, y, a: eight unknowns with rate and acceleration
    Node(const T* x, const T* y, const T* a) : q(quat(x + 4)), q1(quat(y + 4)) {
        const Quat<T> q2 = quat(a + 4), e1 = times_e1(q);
        length = sqrt(dot(q, q));
        const T il = 1.0 / length, il2 = il * il;
        unit = q * il;
        stretch = 1.0 + x[3];
        t = vector_of(times_e1(unit), unit);
        const Vec<T> turn = vector_of(q1, q) * (2.0 * il2);
        const Vec<T> turn_rate = vector_of(q2, q) * (2.0 * il2) - turn * (2.0 * dot(q, q1) * il2);
        t1 = cross(turn, t);
        t2 = cross(turn_rate, t) + cross(turn, t1);
        v = t * stretch;
        w = t * y[3] + t1 * stretch;
        z = t * a[3] + t1 * (2.0 * y[3]) + t2 * stretch;
        spin = 2.0 * dot(q1, e1);
        spin_rate = 2.0 * dot(q2, e1);
    }
    Quat<T> unit_rate() const { return (q1 - unit * dot(unit, q1)) * (1.0 / length); }
    // rows (8) of a force F on r, G on the slope, a moment M in space, and f on the components of the unit quaternion
    void rows(const Vec<T>& F, const Vec<T>& G, const Vec<T>& M, const Quat<T>& f, T* r) const {
        const Quat<T> turned = times((cross(t, G) * stretch + M) * 2.0, unit) + f;
        const Quat<T> row = (turned - unit * dot(unit, turned)) * (1.0 / length);
        r[0] = F.x; r[1] = F.y; r[2] = F.z; r[3] = dot(t, G);
        r[4] = row.w; r[5] = row.x; r[6] = row.y; r[7] = row.z;
    }
    // rows of the spin momentum h and its rate: Lagrange's d/dt dT/dq' - dT/dq = 2 h' q e1 + 4 h q' e1 of T = h.spin/2, with q.q' = 0
    // in the second term (with it BDF1 would falsify the spin twice as much)
    void add_spin(const T& h, const T& h_rate, T* r) const {
        const Quat<T> across = q1 - unit * dot(unit, q1);
        const Quat<T> row = times_e1(q) * (2.0 * h_rate) + times_e1(across) * (4.0 * h);
        r[4] += row.w; r[5] += row.x; r[6] += row.y; r[7] += row.z;
    }
};

}  // namespace dp
