// Forward derivatives of elements side by side: value and N derivatives of each lane.
#pragma once
#include "core/pack_math.hpp"

namespace dp {

template <int N>
struct PackDual {
    Pack v, g[N];
    PackDual() = default;
    PackDual(const Pack& s) : v(s) { for (Pack& d : g) d = Pack(0.0); }
    PackDual(double s) : PackDual(Pack(s)) {}
    const Pack& d(int i) const { return g[i]; }
    void set(int i, const Pack& s) { g[i] = s; }
    PackDual& operator+=(const PackDual& b) { v += b.v; for (int i = 0; i < N; ++i) g[i] += b.g[i]; return *this; }
    PackDual& operator-=(const PackDual& b) { v -= b.v; for (int i = 0; i < N; ++i) g[i] -= b.g[i]; return *this; }
};
#define DP_D template <int N> inline PackDual<N>
// value f and the derivatives fa, fb by the operands
DP_D chain(const Pack& f, const Pack& fa, const PackDual<N>& a) {
    PackDual<N> r; r.v = f;
    for (int i = 0; i < N; ++i) r.g[i] = fa * a.g[i];
    return r;
}
DP_D chain(const Pack& f, const Pack& fa, const PackDual<N>& a, const Pack& fb, const PackDual<N>& b) {
    PackDual<N> r; r.v = f;
    for (int i = 0; i < N; ++i) r.g[i] = fa * a.g[i] + fb * b.g[i];
    return r;
}
DP_D operator+(const PackDual<N>& a, const PackDual<N>& b) { PackDual<N> r = a; r += b; return r; }
DP_D operator-(const PackDual<N>& a, const PackDual<N>& b) { PackDual<N> r = a; r -= b; return r; }
DP_D operator*(const PackDual<N>& a, const PackDual<N>& b) { return chain(a.v * b.v, b.v, a, a.v, b); }
DP_D operator/(const PackDual<N>& a, const PackDual<N>& b) {
    const Pack q = 1.0 / b.v, f = a.v * q;
    return chain(f, q, a, -f * q, b);
}
DP_D operator-(const PackDual<N>& a) { return chain(-a.v, -1.0, a); }
DP_D operator+(const PackDual<N>& a, const Pack& s) { PackDual<N> r = a; r.v += s; return r; }
DP_D operator+(const Pack& s, const PackDual<N>& a) { return a + s; }
DP_D operator-(const PackDual<N>& a, const Pack& s) { return a + (-s); }
DP_D operator-(const Pack& s, const PackDual<N>& a) { return chain(s - a.v, -1.0, a); }
DP_D operator*(const PackDual<N>& a, const Pack& s) { return chain(a.v * s, s, a); }
DP_D operator*(const Pack& s, const PackDual<N>& a) { return a * s; }
DP_D operator/(const PackDual<N>& a, const Pack& s) { return a * (1.0 / s); }
DP_D operator/(const Pack& s, const PackDual<N>& b) { const Pack f = s / b.v; return chain(f, -f / b.v, b); }
DP_D sqrt(const PackDual<N>& a) { const Pack f = sqrt(a.v); return chain(f, 0.5 / f, a); }
DP_D exp(const PackDual<N>& a) { const Pack f = exp(a.v); return chain(f, f, a); }
DP_D sin(const PackDual<N>& a) { return chain(sin(a.v), cos(a.v), a); }
DP_D cos(const PackDual<N>& a) { return chain(cos(a.v), -sin(a.v), a); }
DP_D blend(const I4& which, const PackDual<N>& a, const PackDual<N>& b) {
    PackDual<N> r; r.v = blend(which, a.v, b.v);
    for (int i = 0; i < N; ++i) r.g[i] = blend(which, a.g[i], b.g[i]);
    return r;
}
#undef DP_D

template <int N> inline Pack val(const PackDual<N>& a) { return a.v; }

}  // namespace dp
