// What the Jacobians c0 dR/dx + c1 dR/dy + c2 dR/da of both channels share (elements that hang below no junction), four elements side
// by side: how the pipe's walls move, and the assembly of the rows on the string.
//
// Everything not linear in the motion of the string depends on its shape D = (d, v1, v2), d = r2 - r1, through a few integrals over the
// element.  Their gradients by D carry the seeds c0 of a position and c1 of its rate together.  The rows on the string are then
//   (4 x 4 shape integrals) kron (I or P)  +  sum of (rows per unit of an integral) x (its gradient)  +  stiffness of the pressure.
#pragma once
#include "beam/beam_jacobian.hpp"
#include "fluid/flow.hpp"

namespace dp {

typedef Four<Pack> PackFour;
constexpr int FLOW_WIDTH = 17, AT_P1 = 14, AT_P2 = 15, AT_Q = 16, ROWS_AT[4] = {0, 3, 7, 10};

inline PackFour nodal(const Pack* x) { return {vec(x), vec(x + 3), vec(x + 7), vec(x + 10)}; }
inline PackFour operator*(const PackFour& a, const Pack& s) { return {a.r1 * s, a.v1 * s, a.r2 * s, a.v2 * s}; }
inline PackFour operator+(const PackFour& a, const PackFour& b) { return {a.r1 + b.r1, a.v1 + b.v1, a.r2 + b.r2, a.v2 + b.v2}; }
inline PackFour operator-(const PackFour& a, const PackFour& b) { return {a.r1 - b.r1, a.v1 - b.v1, a.r2 - b.r2, a.v2 - b.v2}; }
inline PackFour at_ends(const PackFour& x) { const PackVec zero = {0.0, 0.0, 0.0}; return {x.r1, zero, -x.r2, zero}; }  // -[N x] from end to end

struct Gradient { PackVec d, v1, v2; };  // by the shape of the element
inline Gradient operator*(const Gradient& a, const Pack& s) { return {a.d * s, a.v1 * s, a.v2 * s}; }
inline Gradient operator+(const Gradient& a, const Gradient& b) { return {a.d + b.d, a.v1 + b.v1, a.v2 + b.v2}; }
inline PackFour on_nodes(const Gradient& a) { return {-a.d, a.v1, a.d, a.v2}; }
inline void project(Gradient& to, const PackVec& a, const Shape<Pack, Pack>& N) { to.d += a * N.B0; to.v1 += a * N.B1; to.v2 += a * N.B2; }

// Integrals over the element, per its length, at lam = |r'|: lam, f(lam) = lam (1 - 2 nu (lam - 1)), lam', f(lam)' psi_1 and psi_2, and the
// change of each with the seeds; push1, push2: int psi f' t.dr' ds, the force of a unit of pressure at an end; stiffness: c0 times the
// change of p1 push1 + p2 push2.
struct Walls {
    Pack stretch, inner, rate, squeeze1, squeeze2;
    Gradient by_stretch, by_inner, by_rate, by_squeeze1, by_squeeze2, push1, push2;
    PackMatrix stiffness[3][3];
};

DP_APART void move_walls(const PackFour& x, const PackFour& y, const Pack& L, const Pack& poisson, const Pack& p1, const Pack& p2, double c0,
                         double c1, Walls& w) {
    const PackVec zero = {0.0, 0.0, 0.0}, d = x.r2 - x.r1, d_rate = y.r2 - y.r1;
    const Gradient none = {zero, zero, zero};
    const Pack il = 1.0 / L, narrowing = poisson * 2.0;
    w.stretch = w.inner = w.rate = w.squeeze1 = w.squeeze2 = Pack(0.0);
    Gradient tangents = none, turning = none, moving1 = none, moving2 = none;
    w.push1 = w.push2 = none;
    for (int a = 0; a < 3; ++a) for (int b = a; b < 3; ++b) w.stiffness[a][b] = {zero, zero, zero};
    for (int k = 0; k < 3; ++k) {
        const Shape<Pack, Pack> N(XI3[k], il);
        const double at1 = (1 - XI3[k]) * W3[k], at2 = XI3[k] * W3[k];
        const PackVec slope = N.slope(d, x.v1, x.v2), slope_rate = N.slope(d_rate, y.v1, y.v2);
        const Pack n = norm(slope), in = 1.0 / n, bulge = 1.0 - (n * 2.0 - 1.0) * narrowing, bent = narrowing * -2.0;  // f', f''
        const PackVec t = slope * in, wide = t * bulge;
        const Pack n_rate = dot(t, slope_rate);
        const PackVec turn = (slope_rate - t * n_rate) * in;  // rate of t
        w.stretch += n * W3[k];
        w.inner += n * (1.0 - (n - 1.0) * narrowing) * W3[k];
        w.rate += n_rate * W3[k];
        w.squeeze1 += bulge * n_rate * at1;
        w.squeeze2 += bulge * n_rate * at2;
        project(tangents, t * W3[k], N);
        project(turning, turn * W3[k], N);
        project(w.push1, wide * at1, N);
        project(w.push2, wide * at2, N);
        const PackVec wide_rate = t * (bent * n_rate) + turn * bulge;
        project(moving1, wide_rate * at1, N);
        project(moving2, wide_rate * at2, N);
        // d(f' t)/dr' = f'/n I + (f'' - f'/n) t t^T
        const Pack pressure = (p1 * at1 + p2 * at2) * c0, round = bulge * in;
        const PackMatrix H = outer(t, t * ((bent - round) * pressure)) + scalar_matrix(round * pressure);
        const Pack B[3] = {N.B0, N.B1, N.B2};
        for (int a = 0; a < 3; ++a) for (int b = a; b < 3; ++b) w.stiffness[a][b] += H * (B[a] * B[b]);
    }
    for (int a = 0; a < 3; ++a) for (int b = 0; b < a; ++b) w.stiffness[a][b] = w.stiffness[b][a];
    w.by_stretch = tangents * c0;
    w.by_inner = (w.push1 + w.push2) * c0;
    w.by_rate = turning * c0 + tangents * c1;
    w.by_squeeze1 = moving1 * c0 + w.push1 * c1;
    w.by_squeeze2 = moving2 * c0 + w.push2 * c1;
}

// Integrals of the cubic shapes without their powers of L: 60 int N_i N_j' ds, 30 int N_i' N_j' ds; MASS_FORM: 420 int N_i N_j ds
constexpr double SLOPE_FORM[4][4] = {{-30, 6, 30, -6}, {-6, 0, 6, -1}, {-30, -6, 30, 6}, {6, 1, -6, 0}};
constexpr double STIFF_FORM[4][4] = {{36, 3, -36, 3}, {3, 4, -3, -1}, {-36, -3, 36, -3}, {3, -1, -3, 4}};

// (rows on the string per unit of an integral) x (its change with the shape)
struct Product { PackFour rows; Gradient change; };

// K = [mass int N N + slope int N N' + curve int N' N' + ends (1, 0, -1, 0)] kron P + products + push * stiffness of the walls, P = I or
// the given matrix.
template <int COUNT>
DP_APART void assemble_string(const Pack& L, const Pack& mass, const Pack& slope, const Pack& curve, const Pack& ends, const PackMatrix* P,
                              const Product (&products)[COUNT], const Walls& w, const Pack& push, Pack (*K)[FLOW_WIDTH]) {
    const Pack power[3] = {Pack(1.0), L, L * L}, m = mass * L * (1.0 / 420), s = slope * (1.0 / 60), c = curve * (1.0 / 30) / L;
    constexpr int shape[4] = {0, 1, 0, 2};  // r1 and r2 move d
    for (int a = 0; a < 4; ++a) {
        PackMatrix by_shape[3];
        for (int b = 0; b < 3; ++b) by_shape[b] = w.stiffness[shape[a]][b] * (a == 0 ? -push : push);
        for (const Product& one : products) {
            const PackVec rows = a == 0 ? one.rows.r1 : a == 1 ? one.rows.v1 : a == 2 ? one.rows.r2 : one.rows.v2;
            by_shape[0] += outer(rows, one.change.d);
            by_shape[1] += outer(rows, one.change.v1);
            by_shape[2] += outer(rows, one.change.v2);
        }
        for (int b = 0; b < 4; ++b) {
            Pack form = power[a % 2 + b % 2] * (m * MASS_FORM[a][b] + s * SLOPE_FORM[a][b] + c * STIFF_FORM[a][b]);
            if (a == b && a % 2 == 0) form += a == 0 ? ends : -ends;
            const PackMatrix plain = P ? *P * form : scalar_matrix(form), block = b == 0 ? plain - by_shape[0] : plain + by_shape[shape[b]];
            Pack(*to)[FLOW_WIDTH] = K + ROWS_AT[a];
            const int at = ROWS_AT[b];
            to[0][at] = block.x.x; to[0][at + 1] = block.x.y; to[0][at + 2] = block.x.z;
            to[1][at] = block.y.x; to[1][at + 1] = block.y.y; to[1][at + 2] = block.y.z;
            to[2][at] = block.z.x; to[2][at + 1] = block.z.y; to[2][at + 2] = block.z.z;
        }
    }
}

inline void put(const PackVec& a, Pack* to) { to[0] = a.x; to[1] = a.y; to[2] = a.z; }
// a row of K by the string's unknowns; a column of the string's rows
inline void put_row(const PackFour& a, Pack* row) {
    put(a.r1, row); put(a.v1, row + 3); put(a.r2, row + 7); put(a.v2, row + 10);
    row[6] = row[13] = Pack(0.0);
}
inline void put_column(const PackFour& a, int j, Pack (*K)[FLOW_WIDTH]) {
    const PackVec* at[4] = {&a.r1, &a.v1, &a.r2, &a.v2};
    for (int i = 0; i < 4; ++i) { K[ROWS_AT[i]][j] = at[i]->x; K[ROWS_AT[i] + 1][j] = at[i]->y; K[ROWS_AT[i] + 2][j] = at[i]->z; }
}
inline void clear_spins(Pack (*K)[FLOW_WIDTH]) {
    for (int at : SPIN_AT)
        for (int j = 0; j < FLOW_WIDTH; ++j) K[at][j] = K[j][at] = Pack(0.0);
}

// K += [mass int N N + slope int N N' + ends (1, 0, -1, 0)] kron J
DP_APART void add_turned(const Pack& L, const Pack& mass, const Pack& slope, const Pack& ends, const PackMatrix& J, Pack (*K)[FLOW_WIDTH]) {
    const Pack power[3] = {Pack(1.0), L, L * L}, m = mass * L * (1.0 / 420), s = slope * (1.0 / 60);
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
            Pack form = power[a % 2 + b % 2] * (m * MASS_FORM[a][b] + s * SLOPE_FORM[a][b]);
            if (a == b && a % 2 == 0) form += a == 0 ? ends : -ends;
            add(K, ROWS_AT[a], ROWS_AT[b], J * form);
        }
}

// Change of the density and of the content of a channel with its mean pressure.
struct Compression { Pack density, theta, by_p; };
inline Compression compression(const Fluid& f, const Compressed<Pack>& c, const Pack& wall) {
    return {c.density * f.compressibility, c.by_p, (c.by_p + c.density * (1.0 / f.density) * wall) * f.compressibility};
}

// Rows of mass of both nodes: content L theta (volume per length `content`), given way by swept1, swept2, with their changes by the shape
// and, for what is not of the shape, by the nodes.  At a node with a given pressure the row prescribes it instead.
struct Storage { Pack content, swept1, swept2; PackFour by_content, by_swept1, by_swept2; };
inline void put_mass_rows(const Storage& s, const Compressed<Pack>& c, const Compression& by, const Pack& L, const Pack& y1, const Pack& y2,
                          const Pack& control, double c0, double c1, Pack (*K)[FLOW_WIDTH]) {
    const Pack free = (1.0 - control) * MASS_ROW, twelfth = L * (1.0 / 12), stored = c.by_p * s.content * twelfth * c1, moved = c.theta * L;
    const Pack rate1 = y1 * 5.0 + y2, rate2 = y2 * 5.0 + y1, half = Pack(0.5 * c0);
    const Pack common1 = half * (by.by_p * s.content * twelfth * rate1 + by.theta * L * s.swept1);
    const Pack common2 = half * (by.by_p * s.content * twelfth * rate2 + by.theta * L * s.swept2), held = c.by_p * twelfth;
    put_row(s.by_content * (held * rate1 * free) + s.by_swept1 * (moved * free), K[AT_P1]);
    put_row(s.by_content * (held * rate2 * MASS_ROW) + s.by_swept2 * (moved * MASS_ROW), K[AT_P2]);
    K[AT_P1][AT_P1] = (common1 + stored * 5.0) * free + control * (GIVEN_PRESSURE * MASS_ROW * c0);
    K[AT_P1][AT_P2] = (common1 + stored) * free;
    K[AT_P1][AT_Q] = free * c0;
    K[AT_P2][AT_P1] = (common2 + stored) * MASS_ROW;
    K[AT_P2][AT_P2] = (common2 + stored * 5.0) * MASS_ROW;
    K[AT_P2][AT_Q] = Pack(-MASS_ROW * c0);
}

// Row of momentum by the pressures and the flow: its changes by the density, by q and by dq/dt, minor losses `heads` included here.
inline void put_momentum(const Pack& q, const Pack& step, const Pack& loss, const Fluid& f, const Pack& density, const Compression& by, Pack by_density,
                         Pack by_q, const Pack& by_flow, double c0, double c1, Pack* row) {
    const Pack size = sqrt(q * q + 1e-20), head = f.density * f.density / density;
    by_density -= q * (q * step + size * loss) * head / density;
    by_q += (2.0 * q * step + loss * (size + q * q / size)) * head;
    const Pack common = by_density * by.density * 0.5;
    row[AT_P1] = (common - 1.0) * (c0 * MOMENTUM_ROW);
    row[AT_P2] = (common + 1.0) * (c0 * MOMENTUM_ROW);
    row[AT_Q] = (by_q * c0 + by_flow * c1) * MOMENTUM_ROW;
}

// Four elements at a time: one(x, y, a, p, fluid, c, g1, g2, K), g1 and g2 the change of the nodes' spin rates with v (core/element.hpp).
template <int NP, bool SPINS, class One>
inline void run_flow_jacobian(int n, const int* idx, const int* nodes, const double* par, void* fluid, const double* c, const double* spin,
                              const double* x, const double* y, const double* a, double* K, One one) {
    constexpr int SIZE = FLOW_WIDTH * FLOW_WIDTH, WHOLE = SIZE / 4 * 4;
    for (int e = 0; e < n; e += 4) {
        Pack X[FLOW_WIDTH], Y[FLOW_WIDTH], A[FLOW_WIDTH], P[NP], g1[3], g2[3], out[SIZE];
        const Lanes lanes(e, n);
        lanes.gather(FLOW_WIDTH, idx, x, X);
        lanes.gather(FLOW_WIDTH, idx, y, Y);
        lanes.gather(FLOW_WIDTH, idx, a, A);
        lanes.rows(NP, par, P);
        if constexpr (SPINS) gather_spin(lanes, nodes, spin, g1, g2);
        one(X, Y, A, P, *static_cast<const Fluid*>(fluid), c, g1, g2, reinterpret_cast<Pack(*)[FLOW_WIDTH]>(out));
        for (int i = 0; i < WHOLE; i += 4) {
            V4 row[4] = {out[i].v, out[i + 1].v, out[i + 2].v, out[i + 3].v};
            transpose(row);
            for (int l = 3; l >= 0; --l) *reinterpret_cast<Unaligned*>(K + (long)lanes.at[l] * SIZE + i) = row[l];  // as Lanes::store_rows
        }
        for (int i = WHOLE; i < SIZE; ++i) for (int l = 0; l < lanes.count; ++l) K[(long)(e + l) * SIZE + i] = out[i].v[l];
    }
}

}  // namespace dp
