// Jacobian c0 dR/dx + c1 dR/dy of the contact along a beam element without rigid offset.
//
// A point's force, bending and torque depend on its place and speed, on r' and its rate, and on the spin rate; all are sums of the
// element's unknowns with the same scalar shares for positions (seed c0) and rates (seed c1).  So seven local derivatives are enough,
// and only touching points cost anything; the shares carry them to the 14 unknowns.
#pragma once
#include <cstring>

#include "contact/contact.hpp"
#include "contact/off_wall.hpp"
#include "beam/junction.hpp"

namespace dp {

constexpr int CONTACT_AT[4] = {0, 3, 7, 10}, CONTACT_SPIN[2] = {6, 13};  // rows of r1, v1, r2, v2 and of the spins

// Change H of (force, bend, torque) by (place, r', spin) to the element: K -= S^T H S.  Rows are padded to whole groups of four.
inline void subtract_point(const Interpolation<double>& at, double s, const double (*H)[8], double (*K)[16]) {
    const double share[2] = {1 - s, s};
    double W[7][16];
    for (int i = 0; i < 7; ++i) {
        for (int b = 0; b < 4; ++b)
            for (int k = 0; k < 3; ++k) W[i][CONTACT_AT[b] + k] = at.r[b] * H[i][k] + at.slope[b] * H[i][3 + k];
        for (int b = 0; b < 2; ++b) W[i][CONTACT_SPIN[b]] = share[b] * H[i][6];
        W[i][14] = W[i][15] = 0;
    }
    for (int a = 0; a < 4; ++a)
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 16; ++j) K[CONTACT_AT[a] + k][j] -= at.r[a] * W[k][j] + at.slope[a] * W[3 + k][j];
    for (int a = 0; a < 2; ++a)
        for (int j = 0; j < 16; ++j) K[CONTACT_SPIN[a]][j] -= share[a] * W[6][j];
}

typedef Dual<8> PointDual;

inline Vec<PointDual> seeded(const Vec<double>& v, int at, double c) {
    Vec<PointDual> r = {PointDual(v.x), PointDual(v.y), PointDual(v.z)};
    r.x.set(at, c); r.y.set(at + 1, c); r.z.set(at + 2, c);
    return r;
}

// False, and K untouched, if no point touches.
inline bool subtract_contact(int e, const double* x, const double* y, const double* p, const ContactLaw& law, double c0, double c1,
                             double (*K)[16]) {
    bool any = false;
    typedef BeamContact<false> P;
    const Vec<double> r1 = vec(x), v1 = vec(x + 3), r2 = vec(x + 7), v2 = vec(x + 10);
    const Vec<double> u1 = vec(y), w1 = vec(y + 3), u2 = vec(y + 7), w2 = vec(y + 10);
    const Well well(law.well);
    for (int q = 0; q < law.points; ++q) {
        const double s = law.at[2 * q], weight = law.at[2 * q + 1] * p[P::LENGTH] * p[P::HARDNESS];
        const Interpolation<double> at(s, p[P::LENGTH]);
        HolePoint<PointDual> h;
        if (!touches(law, well, e, q, seeded(at.sum(at.r, r1, v1, r2, v2), 0, c0), p[P::RADIUS], h)) continue;
        any = true;
        PointDual spin(y[6] * (1 - s) + y[13] * s);
        spin.set(6, c1);
        const PointLoad<PointDual> load =
            point_load<PointDual, double>(law, h, seeded(at.sum(at.r, u1, w1, u2, w2), 0, c1), seeded(at.sum(at.slope, r1, v1, r2, v2), 3, c0),
                                          seeded(at.sum(at.slope, u1, w1, u2, w2), 3, c1), spin, p[P::RADIUS], p[P::FRICTION], weight, nullptr);
        law.normal[(long)e * law.points + q] = load.normal.v;
        const PointDual* rows[7] = {&load.force.x, &load.force.y, &load.force.z, &load.bend.x, &load.bend.y, &load.bend.z, &load.torque};
        double H[7][8];
        for (int i = 0; i < 7; ++i)
            for (int j = 0; j < 8; ++j) H[i][j] = rows[i]->d(j);
        subtract_point(at, s, H, K);
    }
    return any;
}

inline void run_contact_jacobian(int n, const int* idx, const int* nodes, const double* par, void* context, const double* c,
                                 const double* spin, const double* x, const double* y, const double*, double* K) {
    const ContactLaw& law = *static_cast<ContactLaw*>(context);
    constexpr int NP = BeamContact<false>::NP;
    const OffWall off_wall(law, idx, par, x);
    int free = 0;
    for (int e = 0; e < n; ++e) {
        double* out = K + (long)e * 196;
        if (e % 4 == 0) free = e + 4 <= n ? off_wall.four(e) : 0;
        if (free >> (e % 4) & 1) {
            std::memset(out, 0, 196 * sizeof(double));
            continue;
        }
        double X[14], Y[14], R[14][16] = {};
        for (int i = 0; i < 14; ++i) { X[i] = x[idx[e * 14 + i]]; Y[i] = y[idx[e * 14 + i]]; }
        if (!subtract_contact(e, X, Y, par + e * NP, law, c[0], c[1], R)) {
            std::memset(out, 0, 196 * sizeof(double));
            continue;
        }
        const double *g1 = spin + 3 * nodes[2 * e], *g2 = spin + 3 * nodes[2 * e + 1];
        for (int i = 0; i < 14; ++i) {
            for (int k = 0; k < 3; ++k) {  // the spin rate moves with v as well
                R[i][3 + k] += R[i][6] * g1[k];
                R[i][10 + k] += R[i][13] * g2[k];
            }
            std::memcpy(out + 14 * i, R[i], 14 * sizeof(double));
        }
    }
}

// Elements below a junction: the chain rule of beam/junction.hpp, for those that touch.
inline void run_contact_junction_jacobian(int n, const int* idx, const int* nodes, const double* par, void* context, const double* c,
                                       const double* spin, const double* x, const double* y, const double* a, double* K) {
    const ContactLaw& law = *static_cast<ContactLaw*>(context);
    typedef BeamContact<false> P;
    for (int e = 0; e < n; ++e) {
        double X[15], Y[15], A[15], J[3][14][16] = {}, rows[14];
        const double* p = par + e * P::NP;
        for (int i = 0; i < 15; ++i) { const int k = idx[e * 15 + i]; X[i] = x[k]; Y[i] = y[k]; A[i] = a[k]; }
        double(*out)[15] = reinterpret_cast<double(*)[15]>(K + (long)e * 225);
        const Vec<double> v0 = vec(X + 3);
        const JunctionSeeds<double> seeds = junction_seeds(X, Y, A, p[P::RIGID], c);
        below_junction(p[P::RIGID], X, Y, A);
        if (!subtract_contact(e, X, Y, p, law, 1.0, 0.0, J[0])) {
            std::memset(out, 0, 225 * sizeof(double));
            continue;
        }
        subtract_contact(e, X, Y, p, law, 0.0, 1.0, J[1]);
        P::evaluate<double>(e, X, Y, p, law, rows, nullptr);
        junction_columns(J, seeds, c, spin + 3 * nodes[2 * e], spin + 3 * nodes[2 * e + 1], out);
        junction_rows(v0, X[14], p[P::RIGID], vec(rows), vec(rows + 3), c[0], out);
    }
}

}  // namespace dp
