// Jacobian of an element that hangs below a junction (JUNCTION in beam/beam.hpp, contact/contact.hpp), from that of the element itself.
//
// The element's upper end has r = r1 + l t, v = m v1, t = v1/|v1|, with the rates and accelerations that follow (unknowns 0-13 and m in
// place 14).  Columns: chain rule through the end's motion.  Rows: with the element's own rows F on r and G on v, the rows of the
// junction are F on r1, m G + l/n P F on v1 (P = I - t t^T), v1.G on m; these factors move with v1 and m too.
#pragma once
#include "core/element.hpp"
#include "core/frame.hpp"
#include "core/matrix.hpp"

namespace dp {

// Motion of the element's own upper end in place of that of the junction.
template <class T>
inline void below_junction(const T& offset, T* x, T* y, T* a) {
    const Vec<T> v = vec(x + 3), w = vec(y + 3), z = vec(a + 3);
    const Tangent<T> t(v, w, z);
    const auto put = [](const Vec<T>& q, T* to) { to[0] = q.x; to[1] = q.y; to[2] = q.z; };
    put(vec(x) + t.t * offset, x); put(vec(y) + t.t1 * offset, y); put(vec(a) + t.t2 * offset, a);
    put(v * x[14], x + 3);
    put(v * y[14] + w * x[14], y + 3);
    put(v * a[14] + w * (2.0 * y[14]) + z * x[14], a + 3);
}

// Change of the end's (r, v), of their rates and of their accelerations with the unknowns v1 (3) and m, seeds c.
template <class T>
struct JunctionSeeds { T by[3][6][4]; };

inline JunctionSeeds<double> junction_seeds(const double* x, const double* y, const double* a, double offset, const double* c) {
    typedef Dual<4> D;
    const auto seeded = [](const double* p, double s) {
        Vec<D> v = {D(p[0]), D(p[1]), D(p[2])};
        v.x.set(0, s); v.y.set(1, s); v.z.set(2, s);
        return v;
    };
    D m(x[14]), m1(y[14]), m2(a[14]);
    m.set(3, c[0]); m1.set(3, c[1]); m2.set(3, c[2]);
    const Vec<D> v = seeded(x + 3, c[0]), w = seeded(y + 3, c[1]), z = seeded(a + 3, c[2]);
    const Tangent<D> t(v, w, z);
    const Vec<D> end[3][2] = {{t.t * offset, v * m}, {t.t1 * offset, v * m1 + w * m}, {t.t2 * offset, v * m2 + w * (2.0 * m1) + z * m}};
    JunctionSeeds<double> s;
    for (int order = 0; order < 3; ++order)
        for (int j = 0; j < 4; ++j)
            for (int k = 0; k < 2; ++k) {
                const Vec<D>& q = end[order][k];
                s.by[order][3 * k][j] = q.x.d(j); s.by[order][3 * k + 1][j] = q.y.d(j); s.by[order][3 * k + 2][j] = q.z.d(j);
            }
    return s;
}

// J: derivatives of the element's rows by positions, rates, accelerations (14 x 14 each, a spin's rate in its column of the second);
// F, G: its rows on r and v of the upper end; g1, g2: d(omega)/dv of both nodes (core/element.hpp).  A change of position of the end is
// that of r1 besides the seeds.
template <class T, int N>
inline void junction_columns(const T (*J)[14][N], const JunctionSeeds<T>& seeds, const double* c, const T* g1, const T* g2, T (*K)[15]) {
    for (int i = 0; i < 14; ++i) {
        for (int j = 0; j < 14; ++j) K[i][j] = J[0][i][j] * c[0] + J[1][i][j] * c[1] + J[2][i][j] * c[2];
        for (int j = 0; j < 4; ++j) {
            T sum = T(0.0);
            for (int order = 0; order < 3; ++order)
                for (int k = 0; k < 6; ++k) sum += J[order][i][k] * seeds.by[order][k][j];
            K[i][j < 3 ? 3 + j : 14] = sum;
        }
        const T spin1 = J[1][i][6] * c[1] + J[2][i][6] * c[2], spin2 = J[1][i][13] * c[1] + J[2][i][13] * c[2];
        for (int k = 0; k < 3; ++k) { K[i][3 + k] += spin1 * g1[k]; K[i][10 + k] += spin2 * g2[k]; }
    }
}

template <class T>
inline void junction_rows(const Vec<T>& v, const T& m, const T& offset, const Vec<T>& F, const Vec<T>& G, double c0, T (*K)[15]) {
    const T n = norm(v), arm = offset / n;
    const Vec<T> t = v / n;
    for (int j = 0; j < 15; ++j) {
        const Vec<T> f = {K[0][j], K[1][j], K[2][j]}, g = {K[3][j], K[4][j], K[5][j]}, row = g * m + (f - t * dot(t, f)) * arm;
        K[14][j] = dot(v, g);
        K[3][j] = row.x; K[4][j] = row.y; K[5][j] = row.z;
    }
    const T along = dot(t, F);
    const Vec<T> across = F - t * along, push = G * c0;
    // d(P F/n)/dv = -(P F t^T + t (P F)^T + (t.F) P)/n^2
    const Matrix<T> turn = (outer(across, t) + outer(t, across) + (scalar_matrix(T(1.0)) - outer(t, t)) * along) * (arm / n * -c0);
    add(K, 3, 3, turn);
    K[3][14] += push.x; K[4][14] += push.y; K[5][14] += push.z;
    K[14][3] += push.x; K[14][4] += push.y; K[14][5] += push.z;
}

}  // namespace dp
