// Strains of one point of the quaternion element and their conjugate forces.
//
// The section's frame is that of p (the nodes' quaternions interpolated linearly), turned by the smallest rotation that takes its first
// axis b1 on the direction t = r'/|r'| of the centre line.  With frame vectors b_k = p e_k p*/|p|^2, D = 1 + t.b1:
//   eps = |r'| - 1,   kappa = t x r''/|r'|,   k_j = kappa.d_j,   d_j = b_j - (t.b_j)(t + b1)/D   (j = 2, 3),
//   k_1 = 2 (p* p')_1/|p|^2 + (t x b1).(t' + b1')/D,
// the axial vector of A^T A': the twist of the base frame, and what the smallest rotation adds (spin of minrot(b1 -> t) about t: the
// potential of core/frame.hpp for a moving t, and by reversal of the rotation for a moving b1).
#pragma once
#include "quaternion/quaternion.hpp"

namespace dp {

// A number with its rate: carries the strain rates through the formulas of the strains.
template <class T>
struct Rated {
    T v, d;
    Rated() = default;
    Rated(double s) : v(s), d(0.0) {}
    Rated(const T& a, const T& b) : v(a), d(b) {}
    Rated& operator+=(const Rated& b) { v += b.v; d += b.d; return *this; }
    Rated& operator-=(const Rated& b) { v -= b.v; d -= b.d; return *this; }
    friend Rated operator+(const Rated& a, const Rated& b) { return {a.v + b.v, a.d + b.d}; }
    friend Rated operator-(const Rated& a, const Rated& b) { return {a.v - b.v, a.d - b.d}; }
    friend Rated operator-(const Rated& a) { return {-a.v, -a.d}; }
    friend Rated operator*(const Rated& a, const Rated& b) { return {a.v * b.v, a.v * b.d + a.d * b.v}; }
    friend Rated operator/(const Rated& a, const Rated& b) { const T f = a.v / b.v; return {f, (a.d - f * b.d) / b.v}; }
    friend Rated sqrt(const Rated& a) { const T f = sqrt(a.v); return {f, a.d / (2.0 * f)}; }
};
template <class T> inline Vec<Rated<T>> rated(const Vec<T>& a, const Vec<T>& b) { return {{a.x, b.x}, {a.y, b.y}, {a.z, b.z}}; }
template <class T> inline Quat<Rated<T>> rated(const Quat<T>& a, const Quat<T>& b) { return {{a.w, b.w}, {a.x, b.x}, {a.y, b.y}, {a.z, b.z}}; }

// gradient by p of f.(p e_k p*) is -2 f p e_k, of 2 f.(p e_k s*) (symmetric in p and s for a vector f) the same with s for p
template <class T> inline Quat<T> pull_e1(const Vec<T>& f, const Quat<T>& p) { return times(f, times_e1(p)) * -2.0; }
template <class T> inline Quat<T> pull_e2(const Vec<T>& f, const Quat<T>& p) { return times(f, times_e2(p)) * -2.0; }
template <class T> inline Quat<T> pull_e3(const Vec<T>& f, const Quat<T>& p) { return times(f, times_e3(p)) * -2.0; }

template <class T>
struct Strains {
    Vec<T> r2;            // r''
    Quat<T> p, s;         // interpolated quaternion and its derivative
    T in, iP, iD;         // 1/|r'|, 1/|p|^2, 1/D
    Vec<T> t, b1, b2, b3, kappa, b1_change, c, swing;  // b1_change = (p e1 p*)'/|p|^2, c = t x b1, swing = r''/|r'| + b1_change
    T stretch, k1, k2, k3, base, extra;   // |r'|; curvatures; the two parts of k1

    Strains(const Vec<T>& r1, const Vec<T>& second, const Quat<T>& p_, const Quat<T>& s_) : r2(second), p(p_), s(s_) {
        stretch = sqrt(dot(r1, r1));
        in = 1.0 / stretch;
        iP = 1.0 / dot(p, p);
        t = r1 * in;
        b1 = vector_of(times_e1(p), p) * iP;
        b2 = vector_of(times_e2(p), p) * iP;
        b3 = vector_of(times_e3(p), p) * iP;
        b1_change = vector_of(times_e1(p), s) * (2.0 * iP);
        iD = 1.0 / (1.0 + dot(t, b1));
        c = cross(t, b1);
        swing = r2 * in + b1_change;
        base = 2.0 * dot(times_e1(p), s) * iP;
        extra = dot(c, swing) * iD;
        k1 = base + extra;
        kappa = cross(t, r2) * in;
        const T u = dot(kappa, b1) * iD;
        k2 = dot(kappa, b2) - dot(t, b2) * u;
        k3 = dot(kappa, b3) - dot(t, b3) * u;
    }

    // adds the conjugates of r', r'', p, p' of the stresses N, M1, M2, M3: f = N deps/d. + sum_k M_k dk_k/d.
    void conjugate(const T& N, const T& M1, const T& M2, const T& M3, Vec<T>& f1, Vec<T>& f2, Quat<T>& fp, Quat<T>& fs) const {
        const Vec<T> B = b2 * M2 + b3 * M3;
        const T Q = dot(t, B) * iD, u = dot(kappa, b1) * iD;
        const Vec<T> K = B - b1 * Q;                                    // by kappa
        const Vec<T> side = kappa - t * u;                              // by B
        const T bent = dot(swing, c) * iD;
        const T both = (Q * u - M1 * bent * iD);                        // by D, which is t.b1
        const Vec<T> ft = b1 * both - B * u + cross(r2, K) * in + cross(b1, swing) * (M1 * iD);
        const Vec<T> fb1 = t * both - kappa * Q + cross(swing, t) * (M1 * iD);
        const Vec<T> fswing = c * (M1 * iD);
        f2 += cross(K, t) * in + fswing * in;
        const T fn = dot(K, kappa) + dot(fswing, r2) * in;              // by |r'|, times -|r'|
        f1 += t * (N - fn * in) + (ft - t * dot(t, ft)) * in;
        const Vec<T> g1 = fb1 * iP, g2 = side * (M2 * iP), g3 = side * (M3 * iP), gs = fswing * iP;
        const T fP = dot(g1, b1) + dot(g2, b2) + dot(g3, b3) + dot(gs, b1_change) + M1 * base * iP;  // by |p|^2, with minus
        fp += pull_e1(g1, p) + pull_e2(g2, p) + pull_e3(g3, p) + pull_e1(gs, s) + p * (-2.0 * fP) + times_e1(s) * (-2.0 * M1 * iP);
        fs += pull_e1(gs, p) + times_e1(p) * (2.0 * M1 * iP);
    }
};

}  // namespace dp
