// Number types of the kernels: double, Pack (four elements side by side) and Dual<N> (forward derivatives).
//
// A kernel is one template over its number type T.  T = Pack evaluates four elements at once; T = Dual<N> carries N directional
// derivatives, so a Jacobian is exact to rounding and never out of step with the residual.
#pragma once
#include <cmath>

namespace dp {

using std::atan2; using std::cos; using std::exp; using std::log; using std::pow; using std::sin; using std::sqrt;

typedef double V4 __attribute__((vector_size(32)));
typedef long long I4 __attribute__((vector_size(32)));

inline V4 splat(double s) { return V4{s, s, s, s}; }

// ---------------------------------------------------------------- four elements side by side
struct Pack {
    V4 v;
    Pack() = default;
    Pack(double s) : v(splat(s)) {}
    explicit Pack(V4 w) : v(w) {}
    Pack& operator+=(const Pack& b) { v += b.v; return *this; }
    Pack& operator-=(const Pack& b) { v -= b.v; return *this; }
};
inline Pack operator+(const Pack& a, const Pack& b) { return Pack(a.v + b.v); }
inline Pack operator-(const Pack& a, const Pack& b) { return Pack(a.v - b.v); }
inline Pack operator*(const Pack& a, const Pack& b) { return Pack(a.v * b.v); }
inline Pack operator/(const Pack& a, const Pack& b) { return Pack(a.v / b.v); }
inline Pack operator-(const Pack& a) { return Pack(-a.v); }
inline I4 operator>(const Pack& a, const Pack& b) { return a.v > b.v; }
inline I4 operator<=(const Pack& a, const Pack& b) { return a.v <= b.v; }
inline Pack sqrt(const Pack& a) { return Pack(V4{std::sqrt(a.v[0]), std::sqrt(a.v[1]), std::sqrt(a.v[2]), std::sqrt(a.v[3])}); }

// Sine and cosine without branches: the multiple of pi/2 next to the angle is taken away in three parts, and the polynomials of the Cephes
// library (S. L. Moshier, sin.c) are valid within pi/4 (relative error 2e-16 up to 5e8 rad).
struct Quadrant {
    I4 odd, second, third;  // of the quadrant's number: whether it is odd, and its second bit, also of the next quadrant, as masks
    V4 sine, cosine;        // of the angle in it
    explicit Quadrant(const V4& a) {
        constexpr double SHIFT = 6755399441055744.0;  // 1.5 * 2^52: the sum's last bits are the integer
        const V4 shifted = a * 0.63661977236758134308 + SHIFT, n = shifted - SHIFT;
        const I4 number = reinterpret_cast<const I4&>(shifted);
        odd = (number & 1) != 0, second = (number & 2) != 0, third = ((number + 1) & 2) != 0;
        const V4 r = ((a - n * 1.57079625129699707031) - n * 7.54978941586159635335e-8) - n * 5.39030285815811905290e-15, z = r * r;
        const V4 P = ((((1.58962301576546568060e-10 * z - 2.50507477628578072866e-8) * z + 2.75573136213857245213e-6) * z - 1.98412698295895385996e-4) * z +
                      8.33333333332211858878e-3) * z - 1.66666666666666307295e-1;
        const V4 Q = ((((-1.13585365213876817300e-11 * z + 2.08757008419747316778e-9) * z - 2.75573141792967388112e-7) * z + 2.48015872888517045348e-5) * z -
                      1.38888888888730564116e-3) * z + 4.16666666666665929218e-2;
        sine = r + r * (z * P);
        cosine = (1.0 - 0.5 * z) + z * z * Q;
    }
};
inline Pack sin(const Pack& a) {
    const Quadrant q(a.v);
    const V4 s = q.odd ? q.cosine : q.sine;
    return Pack(q.second ? -s : s);
}
inline Pack cos(const Pack& a) {
    const Quadrant q(a.v);
    const V4 c = q.odd ? q.sine : q.cosine;
    return Pack(q.third ? -c : c);
}

inline void transpose(V4 (&a)[4]) {
    const V4 p = __builtin_shufflevector(a[0], a[1], 0, 4, 2, 6), q = __builtin_shufflevector(a[0], a[1], 1, 5, 3, 7);
    const V4 r = __builtin_shufflevector(a[2], a[3], 0, 4, 2, 6), s = __builtin_shufflevector(a[2], a[3], 1, 5, 3, 7);
    a[0] = __builtin_shufflevector(p, r, 0, 1, 4, 5); a[1] = __builtin_shufflevector(q, s, 0, 1, 4, 5);
    a[2] = __builtin_shufflevector(p, r, 2, 3, 6, 7); a[3] = __builtin_shufflevector(q, s, 2, 3, 6, 7);
}

// atan2 without branches: angle of the smaller over the larger side, shifted by pi/4 if beyond pi/8, by the rational approximation of
// the Cephes library (S. L. Moshier, atan.c, relative error 2e-16), then unfolded.
inline Pack atan2(const Pack& y, const Pack& x) {
    const V4 zero = splat(0.0), ay = y.v < zero ? -y.v : y.v, ax = x.v < zero ? -x.v : x.v;
    const I4 steep = ay > ax;
    const V4 low = steep ? ax : ay, high = steep ? ay : ax;
    const I4 upper = low > high * 0.41421356237309503;  // beyond pi/8: tan(a - pi/4) = (tan a - 1)/(tan a + 1)
    const V4 top = upper ? low - high : low, under = upper ? low + high : high;
    const V4 t = top / (under > zero ? under : splat(1.0)), z = t * t;
    const V4 P = (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z - 7.500855792314704667340e1) * z -
                  1.228866684490136173410e2) * z - 6.485021904942025371773e1;
    const V4 Q = ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z + 4.328810604912902668951e2) * z +
                  4.853903996359136964868e2) * z + 1.945506571482613964425e2;
    V4 a = t + t * (z * P / Q);
    a = upper ? a + 0.78539816339744831 : a;
    a = steep ? 1.5707963267948966 - a : a;
    a = x.v < zero ? 3.1415926535897931 - a : a;
    return Pack(y.v < zero ? -a : a);
}

// ---------------------------------------------------------------- forward derivatives
template <int N>
struct Dual {
    static_assert(N % 4 == 0, "the derivative part is stored in groups of four");
    static constexpr int G = N / 4;
    double v;
    V4 g[G];
    Dual() = default;
    Dual(double s) : v(s) { for (int i = 0; i < G; ++i) g[i] = splat(0.0); }
    double d(int i) const { return g[i / 4][i % 4]; }
    void set(int i, double s) { g[i / 4][i % 4] = s; }
    Dual& operator+=(const Dual& b) { v += b.v; for (int i = 0; i < G; ++i) g[i] += b.g[i]; return *this; }
    Dual& operator-=(const Dual& b) { v -= b.v; for (int i = 0; i < G; ++i) g[i] -= b.g[i]; return *this; }
    Dual& operator+=(double b) { v += b; return *this; }
    Dual& operator-=(double b) { v -= b; return *this; }
};
#define DP_D template <int N> inline Dual<N>
// value f and the derivatives fa, fb by the operands
template <int N> inline Dual<N> chain(double f, double fa, const Dual<N>& a) {
    Dual<N> r; r.v = f; const V4 s = splat(fa);
    for (int i = 0; i < Dual<N>::G; ++i) r.g[i] = s * a.g[i];
    return r;
}
template <int N> inline Dual<N> chain(double f, double fa, const Dual<N>& a, double fb, const Dual<N>& b) {
    Dual<N> r; r.v = f; const V4 s = splat(fa), t = splat(fb);
    for (int i = 0; i < Dual<N>::G; ++i) r.g[i] = s * a.g[i] + t * b.g[i];
    return r;
}
DP_D operator+(const Dual<N>& a, const Dual<N>& b) { Dual<N> r = a; r += b; return r; }
DP_D operator-(const Dual<N>& a, const Dual<N>& b) { Dual<N> r = a; r -= b; return r; }
DP_D operator*(const Dual<N>& a, const Dual<N>& b) { return chain(a.v * b.v, b.v, a, a.v, b); }
DP_D operator/(const Dual<N>& a, const Dual<N>& b) {
    const double q = 1.0 / b.v, f = a.v * q;
    return chain(f, q, a, -f * q, b);
}
DP_D operator-(const Dual<N>& a) { return chain(-a.v, -1.0, a); }
DP_D operator+(const Dual<N>& a, double s) { Dual<N> r = a; r.v += s; return r; }
DP_D operator+(double s, const Dual<N>& a) { return a + s; }
DP_D operator-(const Dual<N>& a, double s) { return a + (-s); }
DP_D operator-(double s, const Dual<N>& a) { return chain(s - a.v, -1.0, a); }
DP_D operator*(const Dual<N>& a, double s) { return chain(a.v * s, s, a); }
DP_D operator*(double s, const Dual<N>& a) { return a * s; }
DP_D operator/(const Dual<N>& a, double s) { return a * (1.0 / s); }
DP_D operator/(double s, const Dual<N>& b) { const double f = s / b.v; return chain(f, -f / b.v, b); }
DP_D sqrt(const Dual<N>& a) { const double f = std::sqrt(a.v); return chain(f, f > 0 ? 0.5 / f : 0.0, a); }
DP_D exp(const Dual<N>& a) { const double f = std::exp(a.v); return chain(f, f, a); }
DP_D log(const Dual<N>& a) { return chain(std::log(a.v), 1.0 / a.v, a); }
DP_D sin(const Dual<N>& a) { return chain(std::sin(a.v), std::cos(a.v), a); }
DP_D cos(const Dual<N>& a) { return chain(std::cos(a.v), -std::sin(a.v), a); }
DP_D pow(const Dual<N>& a, double p) { const double f = std::pow(a.v, p); return chain(f, p * std::pow(a.v, p - 1), a); }
DP_D atan2(const Dual<N>& y, const Dual<N>& x) {
    const double q = 1.0 / (x.v * x.v + y.v * y.v);
    return chain(std::atan2(y.v, x.v), x.v * q, y, -y.v * q, x);
}
#undef DP_D

inline double val(double a) { return a; }
inline Pack val(const Pack& a) { return a; }
template <int N> inline double val(const Dual<N>& a) { return a.v; }

#define DP_CMP(op)                                                                               \
    template <int N> inline bool operator op(const Dual<N>& a, const Dual<N>& b) { return a.v op b.v; } \
    template <int N> inline bool operator op(const Dual<N>& a, double b) { return a.v op b; }    \
    template <int N> inline bool operator op(double a, const Dual<N>& b) { return a op b.v; }
DP_CMP(<) DP_CMP(>) DP_CMP(<=) DP_CMP(>=)
#undef DP_CMP

// ---------------------------------------------------------------- vectors in space
template <class T>
struct Vec {
    T x, y, z;
    Vec& operator+=(const Vec& b) { x += b.x; y += b.y; z += b.z; return *this; }
    Vec& operator-=(const Vec& b) { x -= b.x; y -= b.y; z -= b.z; return *this; }
};
template <class T, class U> __attribute__((always_inline)) inline auto operator+(const Vec<T>& a, const Vec<U>& b) -> Vec<decltype(a.x + b.x)> { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
template <class T, class U> __attribute__((always_inline)) inline auto operator-(const Vec<T>& a, const Vec<U>& b) -> Vec<decltype(a.x - b.x)> { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
template <class T> inline Vec<T> operator-(const Vec<T>& a) { return {-a.x, -a.y, -a.z}; }
template <class T, class S> __attribute__((always_inline)) inline auto operator*(const S& s, const Vec<T>& a) -> Vec<decltype(s * a.x)> { return {s * a.x, s * a.y, s * a.z}; }
template <class T, class S> __attribute__((always_inline)) inline auto operator*(const Vec<T>& a, const S& s) -> Vec<decltype(s * a.x)> { return s * a; }
template <class T, class S> __attribute__((always_inline)) inline auto operator/(const Vec<T>& a, const S& s) -> Vec<decltype(a.x / s)> { return {a.x / s, a.y / s, a.z / s}; }
template <class T, class U> __attribute__((always_inline)) inline auto dot(const Vec<T>& a, const Vec<U>& b) -> decltype(a.x * b.x) { return a.x * b.x + a.y * b.y + a.z * b.z; }
template <class T, class U> __attribute__((always_inline)) inline auto cross(const Vec<T>& a, const Vec<U>& b) -> Vec<decltype(a.x * b.x)> {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T> inline T norm(const Vec<T>& a) { return sqrt(dot(a, a)); }
template <class T> inline Vec<T> vec(const T* p) { return {p[0], p[1], p[2]}; }
template <class T> inline auto values(const Vec<T>& a) -> Vec<decltype(val(a.x))> { return {val(a.x), val(a.y), val(a.z)}; }
inline Vec<double> lane(const Vec<Pack>& a, int l) { return {a.x.v[l], a.y.v[l], a.z.v[l]}; }

// ---------------------------------------------------------------- one of two numbers, in each lane of a pack
inline bool no(bool which) { return !which; }
inline I4 no(const I4& which) { return ~which; }
inline bool any(bool which) { return which; }
inline bool any(const I4& which) { return which[0] | which[1] | which[2] | which[3]; }
inline Pack blend(const I4& which, const Pack& a, const Pack& b) { return Pack(which ? a.v : b.v); }
template <class T> inline Vec<T> blend(const I4& which, const Vec<T>& a, const Vec<T>& b) {
    return {blend(which, a.x, b.x), blend(which, a.y, b.y), blend(which, a.z, b.z)};
}
// a() where `which` holds, else b(); neither is evaluated where no number needs it
template <class A, class B> inline auto choose(bool which, const A& a, const B& b) -> decltype(a()) { return which ? a() : b(); }
template <class A, class B> inline auto choose(const I4& which, const A& a, const B& b) -> decltype(a()) {
    if (!any(no(which))) return a();
    return any(which) ? blend(which, a(), b()) : b();
}

}  // namespace dp
