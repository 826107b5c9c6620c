// Jacobian c0 dR/dx + c1 dR/dy + c2 dR/da of the beam without rigid offset, four elements side by side.
//
// The same derivative as run_jacobian<Beam>, which differentiates the rows by all 14 unknowns, but each term is differentiated by the
// few numbers it depends on and carried to the unknowns by the scalar shape coefficients (a congruence):
//   bending    forces of a point by its r', r'' and spin rate, in closed form
//   axial      N_k = D_kl e_l: rank-three product of the gradients of e_1, e_2, e_m plus N_k times their second derivatives
//   torsion    gradient of the twist times gradient of the torque plus torque times the second derivatives of the twist (closed form)
//   inertia    constant;  gyroscopic force: local to a node.
// Positions and rates are the same sums of the unknowns, so one local direction carries the seed c0 for a position and c1 for its
// rate; nothing is divided by c0.
#pragma once
#include "beam/beam.hpp"
#include "beam/junction.hpp"
#include "core/matrix.hpp"

namespace dp {

#define DP_APART inline __attribute__((noinline))  // one function of all this is slower: registers run out

typedef Vec<Pack> PackVec;
typedef Matrix<Pack> PackMatrix;

// Local unknowns of the stiffness: d, v1, v2 (three each) and the two spins.
enum { AT_D = 0, AT_V1 = 3, AT_V2 = 6, AT_SPIN1 = 9, AT_SPIN2 = 10, LOCAL = 11 };

struct ElementMotion {  // of four elements: chord, slopes and their rates
    PackVec d, v1, v2, d_rate, w1, w2;
    Pack phi1, phi2, o1, o2;
};

// H: derivatives of what belongs to r' and r'' of a point by r' and r'', to d, v1, v2.
DP_APART void add_point(const Shape<Pack, Pack>& N, const PackMatrix& H11, const PackMatrix& H12, const PackMatrix& H21, const PackMatrix& H22,
                      Pack (*K)[LOCAL]) {
    const Pack B[3] = {N.B0, N.B1, N.B2}, C[3] = {N.C0, N.C1, N.C2};
    for (int b = 0; b < 3; ++b) {
        const PackMatrix by_slope = H11 * B[b] + H12 * C[b], by_second = H21 * B[b] + H22 * C[b];
        for (int a = 0; a < 3; ++a) add(K, 3 * a, 3 * b, by_slope * B[a] + by_second * C[a]);
    }
}

// The same for the columns (forces f1, f2) and rows (torque) of the spin rate, of which the ends have the given shares.
DP_APART void add_spin_point(const Shape<Pack, Pack>& N, const Pack* share, const PackVec& f1, const PackVec& f2, const PackVec& torque_r1,
                           const PackVec& torque_r2, const Pack& torque_spin, Pack (*K)[LOCAL]) {
    const Pack B[3] = {N.B0, N.B1, N.B2}, C[3] = {N.C0, N.C1, N.C2};
    for (int end = 0; end < 2; ++end) {
        const int at = AT_SPIN1 + end;
        for (int a = 0; a < 3; ++a) {
            const PackVec column = (f1 * B[a] + f2 * C[a]) * share[end], row = (torque_r1 * B[a] + torque_r2 * C[a]) * share[end];
            K[3 * a][at] += column.x; K[3 * a + 1][at] += column.y; K[3 * a + 2][at] += column.z;
            K[at][3 * a] += row.x; K[at][3 * a + 1] += row.y; K[at][3 * a + 2] += row.z;
        }
        for (int other = 0; other < 2; ++other) K[at][AT_SPIN1 + other] += torque_spin * share[end] * share[other];
    }
}

// ---------------------------------------------------------------- torsion
// S(d, v) = n^2 m + n d.v, n = |v|, m = |d|: gradient.  It is the denominator of the connection h = d x v / S of the chord as reference direction.
struct ChordScale {
    Pack inverse;
    PackVec by_d, by_v;
    ChordScale(const PackVec& d, const Pack& m, const PackVec& v, const Pack& n) {
        const Pack dv = dot(d, v);
        inverse = 1.0 / (n * n * m + n * dv);
        by_d = d * (n * n / m) + v * n;
        by_v = v * (2.0 * m + dv / n) + d * n;
    }
};

// Second derivatives of the twist by h(d, v) = d x v / S at one end: rows v are sign h, rows d are sign h n / m.
inline void add_end(double sign, int at, const PackVec& d, const Pack& m, const PackVec& v, const Pack& n, Pack (*H)[LOCAL]) {
    const ChordScale S(d, m, v, n);
    const PackVec h = cross(d, v) * S.inverse;
    const Pack s = sign * S.inverse;
    const PackMatrix by_v = (skew(d) - outer(h, S.by_v)) * s, by_d = (skew(v) + outer(h, S.by_d)) * -s;
    add(H, at, at, by_v);
    add(H, at, AT_D, by_d);
    add(H, AT_D, at, transpose(by_d));
    add(H, AT_D, AT_D, by_d * (n / m) - outer(h, d) * (sign * n / (m * m * m)));
}

// weight times the second derivatives of F = T/S, T = [d, p, q], at p = r', q = r'':  F_xy = (T_xy - F S_xy - S_x F_y^T - F_x S_y^T)/S.
DP_APART void add_twist_point(const Shape<Pack, Pack>& N, const Pack& weight, const PackVec& d, const Pack& m, const PackVec& p,
                            const PackVec& q, Pack (*H)[LOCAL]) {
    const Pack n = norm(p), in = 1.0 / n, im = 1.0 / m, dp = dot(d, p);
    const ChordScale S(d, m, p, n);
    const Pack F = dot(d, cross(p, q)) * S.inverse, s = weight * S.inverse;
    const PackVec F_d = (cross(p, q) - S.by_d * F) * S.inverse, F_p = (cross(q, d) - S.by_v * F) * S.inverse, F_q = cross(d, p) * S.inverse;
    const PackMatrix S_dd = scalar_matrix(n * n * im) - outer(d, d * (n * n * im * im * im));
    const PackMatrix S_dp = scalar_matrix(n) + outer(d * (2.0 * im) + p * in, p);
    const PackMatrix S_pp = scalar_matrix(2.0 * m + dp * in) - outer(p, p * (dp * in * in * in)) + (outer(p, d) + outer(d, p)) * in;
    const PackMatrix dd = (S_dd * F + outer(S.by_d, F_d) + outer(F_d, S.by_d)) * -s;
    const PackMatrix pp = (S_pp * F + outer(S.by_v, F_p) + outer(F_p, S.by_v)) * -s;
    const PackMatrix dp_ = (skew(q) + S_dp * F + outer(S.by_d, F_p) + outer(F_d, S.by_v)) * -s;
    const PackMatrix dq = (skew(p) - outer(S.by_d, F_q)) * s, pq = -(skew(d) + outer(S.by_v, F_q)) * s;
    const Pack B[3] = {N.B0, N.B1, N.B2}, C[3] = {N.C0, N.C1, N.C2};
    add(H, AT_D, AT_D, dd);
    for (int b = 0; b < 3; ++b) {
        const PackMatrix block = dp_ * B[b] + dq * C[b];
        add(H, AT_D, 3 * b, block);
        add(H, 3 * b, AT_D, transpose(block));
    }
    add_point(N, pp, pq, transpose(pq), scalar_matrix(Pack(0.0)), H);
}

template <bool DAMPED>
DP_APART void add_torsion(const ElementMotion& e, const Pack& n1, const Pack& n2, const Pack* p, double c0, double c1, Pack (*K)[LOCAL],
                        Pack* by_angle) {
    const Pack il = 1.0 / p[LENGTH], stiffness = p[GJ] * il, m = norm(e.d);
    const Twist<Pack> q = twist(e.d, e.v1, e.v2, n1, n2, e.phi1, e.phi2, p);
    Pack angle = q.value, rate_seed = Pack(c0);
    if constexpr (DAMPED) {
        angle += (e.o2 - e.o1 + dot(q.d, e.d_rate) + dot(q.v1, e.w1) + dot(q.v2, e.w2)) * p[BETA];
        rate_seed += p[BETA] * c1;
    }
    // gradient of the twist by the virtual displacements, and change of the torque; d(twist)/dv at constant phi has the potential too
    const PackVec a1 = spin_potential(vec(p + REFERENCE1), e.v1), a2 = spin_potential(vec(p + REFERENCE2), e.v2);
    const Pack by[LOCAL] = {q.d.x, q.d.y, q.d.z, q.v1.x, q.v1.y, q.v1.z, q.v2.x, q.v2.y, q.v2.z, Pack(-1.0), Pack(1.0)};
    const Pack reference_part[9] = {Pack(0.0), Pack(0.0), Pack(0.0), -a1.x, -a1.y, -a1.z, a2.x, a2.y, a2.z};
    Pack H[9][LOCAL];
    for (int i = 0; i < 9; ++i) for (int j = 0; j < LOCAL; ++j) H[i][j] = Pack(0.0);
    add_end(-1.0, AT_V1, e.d, m, e.v1, n1, H);
    add_end(1.0, AT_V2, e.d, m, e.v2, n2, H);
    for (int g = 0; g < 2; ++g) {
        const Shape<Pack, Pack> N(XI2[g], il);
        add_twist_point(N, p[LENGTH] * -W2[g], e.d, m, N.slope(e.d, e.v1, e.v2), N.second(e.d, e.v1, e.v2), H);
    }
    Pack change[LOCAL];
    for (int j = 0; j < 9; ++j) change[j] = by[j] * rate_seed + reference_part[j] * c0;
    if constexpr (DAMPED) {
        const Pack rates[9] = {e.d_rate.x, e.d_rate.y, e.d_rate.z, e.w1.x, e.w1.y, e.w1.z, e.w2.x, e.w2.y, e.w2.z};
        const Pack s = p[BETA] * c0;
        for (int j = 0; j < 9; ++j)
            for (int i = 0; i < 9; ++i) change[j] += s * rates[i] * H[i][j];
    }
    change[AT_SPIN1] = DAMPED ? p[BETA] * -c1 : Pack(0.0);
    change[AT_SPIN2] = DAMPED ? p[BETA] * c1 : Pack(0.0);
    const Pack torque = angle * stiffness * c0;
    for (int i = 0; i < LOCAL; ++i) {
        const Pack f = by[i] * stiffness;
        for (int j = 0; j < LOCAL; ++j) K[i][j] += f * change[j];
        if (i < 9) for (int j = 0; j < 9; ++j) K[i][j] += torque * H[i][j];
        by_angle[i] = f * c0;
    }
}

// ---------------------------------------------------------------- axial force and bending
struct AxialPoint {  // of the centre line
    PackVec r1, r2, q1, q2, t;  // r', r'', their rates, tangent
    Pack in;                    // 1/|r'|
};

// Change of a strain |x| - 1 (damped: + beta t.rate) by x, with seeds c0, c1.
template <bool DAMPED>
inline PackVec strain_change(const PackVec& t, const Pack& in, const PackVec& rate, const Pack& beta, double c0, double c1) {
    if constexpr (DAMPED) return t * (c0 + beta * c1) + (rate - t * dot(t, rate)) * (in * beta * c0);
    else return t * c0;
}

// Change of the forces of bending() (beam/beam.hpp, same names) and of the axial force, whose derivative by r' is axial P/n.
// With i = 1/n, a = t.r'': dt = i P dr', da = k.dr' + t.dr'', dk = i P dr'' - i (k t^T + t k^T + a i P) dr',
// d(t x k) = i skew(t) dr'' - i (skew(k) + 2 (t x k) t^T + a i skew(t)) dr'.
template <bool DAMPED>
DP_APART void add_bending(const AxialPoint& point, const Pack& spin, const Pack& stiffness, const Pack& beta, const Pack& axial, double c0,
                        double c1, const Shape<Pack, Pack>& shape, double xi, Pack (*K)[LOCAL]) {
    const PackVec &t = point.t, &q1 = point.q1, &q2 = point.q2;
    const Pack i = point.in, along = dot(t, point.r2), ai = along * i, c = i * c0;
    const PackVec k = (point.r2 - t * along) * i, side = cross(t, k);
    const PackMatrix P = scalar_matrix(Pack(1.0)) - outer(t, t), kt = outer(k, t), k_r1 = -(kt + transpose(kt) + P * ai) * i;
    PackVec m = k * stiffness;
    PackMatrix m_r1 = k_r1 * (stiffness * c0), m_r2 = P * (stiffness * c);
    PackVec m_spin, side_m;  // side_m = m^T d(t x k)/dr'
    if constexpr (DAMPED) {
        const Pack damping = stiffness * beta, b = dot(t, q1);
        const PackVec bend = q2 - q1 * ai, across = q1 - t * b, bend_across = bend - t * dot(t, bend), rate = bend_across - k * b;
        m += (rate * i - side * spin) * damping;
        // rate = P (q2 - a i q1) - b k
        const PackMatrix rate_r1 = outer(across, t * (ai * i) - k * i) - (P * dot(t, bend) + outer(t, bend_across) + outer(k, across)) * i - k_r1 * b;
        const PackMatrix rate_r2 = (outer(across, t) + P * b) * -i;
        const PackMatrix side_r1 = (skew(k) + outer(side, t) * 2.0 + skew(t) * ai) * -i, side_r2 = skew(t) * i;
        m_r1 += ((rate_r1 - outer(rate, t) * i) * i - side_r1 * spin) * (damping * c0) - (P * ai + kt) * (damping * i * c1);
        m_r2 += (rate_r2 * i - side_r2 * spin) * (damping * c0) + P * (damping * i * c1);
        m_spin = side * (damping * -c1);
        side_m = m * side_r1;
    }
    const PackVec f2 = m * i, f1 = -(f2 * along + t * dot(m, k)) * i;
    const PackMatrix f2_r1 = (m_r1 - outer(f2, t) * c0) * i, f2_r2 = m_r2 * i;
    const PackMatrix f1_r1 = P * (axial * c) - (outer(f1, t) * c0 + outer(f2, k) * c0 + f2_r1 * along + outer(t, k * m_r1 + (m * k_r1) * c0) + P * (dot(m, k) * c)) * i;
    const PackMatrix f1_r2 = (outer(f2, t) * c0 + f2_r2 * along + outer(t, k * m_r2 + m * c)) * -i;
    add_point(shape, f1_r1, f1_r2, f2_r1, f2_r2, K);
    if constexpr (DAMPED) {  // torque = -m.side, and the forces by the spin rate
        const PackVec torque_r1 = -(side * m_r1 + side_m * c0), torque_r2 = -(side * m_r2 + cross(m, t) * c), f2_spin = m_spin * i, f1_spin = f2_spin * -ai;
        const Pack share[2] = {Pack(1 - xi), Pack(xi)}, torque_spin = -dot(side, m_spin);
        add_spin_point(shape, share, f1_spin, f2_spin, torque_r1, torque_r2, torque_spin, K);
    }
}

// Points of the centre line, and the mean strain there: value, gradient by d, v1, v2, and its change with the seeds.
struct CentreLine { AxialPoint points[3]; Pack mean; PackVec by[3], change[3]; };

template <bool DAMPED>
inline void centre_line(const ElementMotion& e, const Pack& il, const Pack& beta, double c0, double c1, CentreLine& line) {
    line.mean = Pack(-1.0);
    for (int b = 0; b < 3; ++b) line.by[b] = line.change[b] = {Pack(0.0), Pack(0.0), Pack(0.0)};
    for (int g = 0; g < 3; ++g) {
        const Shape<Pack, Pack> N(XI3[g], il);
        AxialPoint& a = line.points[g];
        a.r1 = N.slope(e.d, e.v1, e.v2);
        a.r2 = N.second(e.d, e.v1, e.v2);
        const Pack n = norm(a.r1);
        a.in = 1.0 / n;
        a.t = a.r1 * a.in;
        line.mean += n * W3[g];
        if constexpr (DAMPED) {
            a.q1 = N.slope(e.d_rate, e.w1, e.w2);
            a.q2 = N.second(e.d_rate, e.w1, e.w2);
            line.mean += dot(a.t, a.q1) * (beta * W3[g]);
        }
        const PackVec t = a.t * W3[g], change = strain_change<DAMPED>(a.t, a.in, a.q1, beta, c0, c1) * W3[g];
        const Pack B[3] = {N.B0, N.B1, N.B2};
        for (int b = 0; b < 3; ++b) { line.by[b] += t * B[b]; line.change[b] += change * B[b]; }
    }
}

template <bool DAMPED>
DP_APART void add_axial_and_bending(const ElementMotion& e, const Pack& n1, const Pack& n2, const Pack* p, double c0, double c1,
                                    Pack (*K)[LOCAL]) {
    const Pack il = 1.0 / p[LENGTH], beta = p[BETA], in1 = 1.0 / n1, in2 = 1.0 / n2;
    const PackVec t1 = e.v1 * in1, t2 = e.v2 * in2;
    CentreLine line;
    centre_line<DAMPED>(e, il, beta, c0, c1, line);
    Pack strain[3] = {n1 - 1.0, n2 - 1.0, line.mean};
    if constexpr (DAMPED) {
        strain[0] += dot(t1, e.w1) * beta;
        strain[1] += dot(t2, e.w2) * beta;
    }
    // forces N = D (e1, e2, em), conjugate to the strains
    const Pack k = p[EA] * p[LENGTH] * 0.5;
    const double D[3][3] = {{4.0 / 15, -1.0 / 15, -0.2}, {-1.0 / 15, 4.0 / 15, -0.2}, {-0.2, -0.2, 2.4}};
    Pack force[3];
    for (int i = 0; i < 3; ++i) force[i] = k * (D[i][0] * strain[0] + D[i][1] * strain[1] + D[i][2] * strain[2]);
    const PackVec change1 = strain_change<DAMPED>(t1, in1, e.w1, beta, c0, c1), change2 = strain_change<DAMPED>(t2, in2, e.w2, beta, c0, c1);
    for (int b = 0; b < 3; ++b) {
        PackVec row[3];  // change of N1, N2, Nm by d, v1 or v2
        for (int i = 0; i < 3; ++i) {
            row[i] = line.change[b] * (k * D[i][2]);
            if (b == 1) row[i] += change1 * (k * D[i][0]);
            if (b == 2) row[i] += change2 * (k * D[i][1]);
        }
        for (int a = 0; a < 3; ++a) {
            PackMatrix block = outer(line.by[a], row[2]);
            if (a == 1) block += outer(t1, row[0]);
            if (a == 2) block += outer(t2, row[1]);
            add(K, 3 * a, 3 * b, block);
        }
    }
    add(K, AT_V1, AT_V1, (scalar_matrix(Pack(1.0)) - outer(t1, t1)) * (force[0] * in1 * c0));
    add(K, AT_V2, AT_V2, (scalar_matrix(Pack(1.0)) - outer(t2, t2)) * (force[1] * in2 * c0));
    for (int g = 0; g < 3; ++g) {
        const Pack spin = e.o1 * (1 - XI3[g]) + e.o2 * XI3[g];
        add_bending<DAMPED>(line.points[g], spin, p[EI] * p[LENGTH] * W3[g], beta, force[2] * W3[g], c0, c1,
                            Shape<Pack, Pack>(XI3[g], il), XI3[g], K);
    }
}

// ---------------------------------------------------------------- inertia and assembly
// Consistent mass on (r1, v1, r2, v2) times 420/(mu L), without its powers of L, and spin inertia times 12/(jp L).
constexpr double MASS_FORM[4][4] = {{156, 22, 54, -13}, {22, 4, 13, -3}, {54, 13, 156, -22}, {-13, -3, -22, 4}};
constexpr int MASS_AT[4] = {0, 3, 7, 10}, SPIN_AT[2] = {6, 13};

// Gyroscopic force h (w x v)/|v|^3 of one node, h = j (5 omega + omega of the other node).
DP_APART void add_gyroscopic(int at, int own, int other, const PackVec& v, const PackVec& w, const Pack& n, const Pack& h, const Pack& j,
                           double c0, double c1, Pack (*K)[14]) {
    const Pack in = 1.0 / n, in3 = in * in * in;
    const PackVec wv = cross(w, v) * in3;
    add(K, at, at, (skew(w) * c0 - skew(v) * c1) * (h * in3) - outer(wv, v) * (3.0 * h * in * in * c0));
    const Pack s = j * c1;
    const Pack rows[3] = {wv.x * s, wv.y * s, wv.z * s};
    for (int i = 0; i < 3; ++i) { K[at + i][own] += rows[i] * 5.0; K[at + i][other] += rows[i]; }
}

inline void add_inertia(const ElementMotion& e, const Pack& n1, const Pack& n2, const Pack* p, const Pack& c2, double c0, double c1,
                        Pack (*K)[14]) {
    const Pack L = p[LENGTH], power[3] = {Pack(1.0), L, L * L}, mass = p[MASS] * L * (1.0 / 420) * c2, j = p[POLAR] * L * (1.0 / 12);
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
            const Pack m = mass * power[a % 2 + b % 2] * MASS_FORM[a][b];
            for (int k = 0; k < 3; ++k) K[MASS_AT[a] + k][MASS_AT[b] + k] += m;
        }
    for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b) K[SPIN_AT[a]][SPIN_AT[b]] += j * c2 * (a == b ? 5.0 : 1.0);
    add_gyroscopic(3, 6, 13, e.v1, e.w1, n1, (e.o1 * 5.0 + e.o2) * j, j, c0, c1, K);
    add_gyroscopic(10, 13, 6, e.v2, e.w2, n2, (e.o2 * 5.0 + e.o1) * j, j, c0, c1, K);
}

// Rows and columns of (d, v1, v2, spin 1, spin 2) to those of the 14 unknowns: d = r2 - r1.
inline void expand(const Pack (*K)[LOCAL], Pack (*out)[14]) {
    constexpr int to[14] = {0, 1, 2, 3, 4, 5, 9, 0, 1, 2, 6, 7, 8, 10};
    for (int i = 0; i < 14; ++i)
        for (int j = 0; j < 14; ++j) out[i][j] = (i < 3) != (j < 3) ? -K[to[i]][to[j]] : K[to[i]][to[j]];
}

// g1, g2: d(omega)/dv of both nodes, see core/element.hpp.
template <bool DAMPED>
inline void beam_jacobian(const Pack* x, const Pack* y, const Pack* p, const double* c, const Pack* g1, const Pack* g2, Pack (*out)[14]) {
    const ElementMotion e = {vec(x + 7) - vec(x), vec(x + 3), vec(x + 10), vec(y + 7) - vec(y), vec(y + 3), vec(y + 10), x[6], x[13], y[6], y[13]};
    const Pack n1 = norm(e.v1), n2 = norm(e.v2);
    Pack K[LOCAL][LOCAL], by_angle[LOCAL];
    for (int i = 0; i < LOCAL; ++i) {
        for (int j = 0; j < LOCAL; ++j) K[i][j] = Pack(0.0);
        by_angle[i] = Pack(0.0);
    }
    if (c[0] != 0 || (DAMPED && c[1] != 0)) {
        add_torsion<DAMPED>(e, n1, n2, p, c[0], c[1], K, by_angle);
        add_axial_and_bending<DAMPED>(e, n1, n2, p, c[0], c[1], K);
    }
    expand(K, out);
    add_inertia(e, n1, n2, p, DAMPED ? c[2] + p[ALPHA] * c[1] : Pack(c[2]), c[0], c[1], out);
    // so far the columns of a spin hold its rate and acceleration only; these move with v as well
    for (int i = 0; i < 14; ++i) {
        for (int k = 0; k < 3; ++k) {
            out[i][3 + k] += out[i][6] * g1[k];
            out[i][10 + k] += out[i][13] * g2[k];
        }
        constexpr int from[14] = {0, 1, 2, 3, 4, 5, 9, 0, 1, 2, 6, 7, 8, 10};
        const Pack torque = i < 3 ? -by_angle[from[i]] : by_angle[from[i]];
        out[i][6] -= torque;
        out[i][13] += torque;
    }
}

// d(omega)/dv of the two nodes of each element
inline void gather_spin(const Lanes& lanes, const int* nodes, const double* spin, Pack* g1, Pack* g2) {
    for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 4; ++l) {
            g1[k].v[l] = spin[3 * nodes[2 * lanes.at[l]] + k];
            g2[k].v[l] = spin[3 * nodes[2 * lanes.at[l] + 1] + k];
        }
}

template <bool DAMPED>
void run_beam_jacobian(int n, const int* idx, const int* nodes, const double* par, void*, const double* c, const double* spin,
                       const double* x, const double* y, const double*, double* K) {
    for (int e = 0; e < n; e += 4) {
        Pack X[14], Y[14], P[BEAM_PARAMETERS], g1[3], g2[3], out[14][14];
        const Lanes lanes(e, n);
        lanes.gather(14, idx, x, X);
        lanes.gather(14, idx, y, Y);
        lanes.rows(BEAM_PARAMETERS, par, P);
        gather_spin(lanes, nodes, spin, g1, g2);
        beam_jacobian<DAMPED>(X, Y, P, c, g1, g2, out);
        lanes.store_rows(14 * 14, out[0], K);
    }
}

// Elements below a junction: their own Jacobians by positions, rates and accelerations, then the chain rule of beam/junction.hpp.
template <bool DAMPED>
void run_beam_junction_jacobian(int n, const int* idx, const int* nodes, const double* par, void*, const double* c, const double* spin,
                             const double* x, const double* y, const double* a, double* K) {
    constexpr double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int e = 0; e < n; e += 4) {
        Pack X[15], Y[15], A[15], P[BEAM_PARAMETERS], g1[3], g2[3], none[3] = {0.0, 0.0, 0.0}, J[3][14][14], rows[14], out[15][15];
        const Lanes lanes(e, n);
        lanes.gather(15, idx, x, X);
        lanes.gather(15, idx, y, Y);
        lanes.gather(15, idx, a, A);
        lanes.rows(BEAM_PARAMETERS, par, P);
        gather_spin(lanes, nodes, spin, g1, g2);
        JunctionSeeds<Pack> seeds;
        for (int l = 0; l < 4; ++l) {
            double xl[15], yl[15], al[15];
            for (int i = 0; i < 15; ++i) { xl[i] = X[i].v[l]; yl[i] = Y[i].v[l]; al[i] = A[i].v[l]; }
            const JunctionSeeds<double> s = junction_seeds(xl, yl, al, P[RIGID].v[l], c);
            for (int order = 0; order < 3; ++order)
                for (int k = 0; k < 6; ++k)
                    for (int j = 0; j < 4; ++j) seeds.by[order][k][j].v[l] = s.by[order][k][j];
        }
        const PackVec v0 = vec(X + 3);
        below_junction(P[RIGID], X, Y, A);
        Beam<DAMPED, false>::template force<Pack, Pack>(e, X, Y, A, P, nullptr, rows);
        for (int order = 0; order < 3; ++order) beam_jacobian<DAMPED>(X, Y, P, unit[order], none, none, J[order]);
        junction_columns(J, seeds, c, g1, g2, out);
        junction_rows(v0, X[14], P[RIGID], vec(rows), vec(rows + 3), c[0], out);
        for (int l = 0; l < lanes.count; ++l)
            for (int i = 0; i < 225; ++i) K[(long)(e + l) * 225 + i] = out[i / 15][i % 15].v[l];
    }
}

}  // namespace dp
