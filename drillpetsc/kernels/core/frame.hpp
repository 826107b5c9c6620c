// Kinematics of a node: tangent, its rates, spin potential, directors.
#pragma once
#include "core/ad.hpp"

namespace dp {

// Tangent t = v/|v| with first and second rate.
template <class T>
struct Tangent {
    T n;               // |v| [-]
    Vec<T> t, t1, t2;  // [-], [1/s], [1/s2]
    Tangent(const Vec<T>& v, const Vec<T>& w, const Vec<T>& w1) {
        n = norm(v);
        t = v / n;
        const T tw = dot(t, w);
        t1 = (w - tw * t) / n;
        t2 = (w1 - dot(t, w1) * t) / n - dot(t1, t1) * t - (2.0 * tw / n) * t1;
    }
};

// c_a(v): omega = phi' + c_a(v).v' (potential of a Dirac monopole; a is the reference direction).
template <class T, class S>
inline Vec<T> spin_potential(const Vec<S>& a, const Vec<T>& v) {
    const T n = norm(v);
    return cross(v, a) / (n * (n + dot(v, a)));
}

// Change of the spin angle from reference a to reference d/|d| at the tangent v: minus the solid angle of the triangle (a, d, v).
template <class T, class S>
inline T reference_change(const Vec<S>& a, const Vec<T>& d, const Vec<T>& v) {
    const T n = norm(v), m = norm(d);
    const T top = dot(v, cross(a, d));
    const T low = n * (m + dot(d, a)) + dot(d, v) + m * dot(v, a);
    return -2.0 * atan2(top, low);
}

// Directors 2 and 3 of the node frame minrot(a -> t) D0 Rot1(phi); D0 = (a, b2, b3).
template <class T, class S>
inline void directors(const Vec<S>& a, const Vec<S>& b2, const Vec<T>& t, const T& phi, Vec<T>& d2, Vec<T>& d3) {
    const Vec<S> b3 = cross(a, b2);
    const T c = cos(phi), s = sin(phi);
    const Vec<T> e2 = c * b2 + s * b3, e3 = c * b3 - s * b2;
    // smallest rotation a -> t applied to a vector normal to a:  e - (t.e)/(1 + a.t) (a + t)
    const T q = 1.0 + dot(t, a);
    d2 = e2 - (dot(t, e2) / q) * (t + a);
    d3 = e3 - (dot(t, e3) / q) * (t + a);
}

}  // namespace dp
