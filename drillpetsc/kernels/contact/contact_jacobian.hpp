// Jacobian c0 dR/dx + c1 dR/dy of the contact along a beam element without rigid offset.
//
// A point's force, bending and torque depend on its place and speed, on r' and its rate, and on the spin rate; all are sums of the
// element's unknowns with the same scalar shares for positions (seed c0) and rates (seed c1).  So seven local derivatives are enough,
// and only elements with touching points cost anything; the shares carry them to the 14 unknowns.
#pragma once
#include <cstring>

#include "contact/contact.hpp"
#include "contact/off_wall.hpp"
#include "core/pack_dual.hpp"
#include "beam/beam_jacobian.hpp"

namespace dp {

constexpr int CONTACT_AT[4] = {0, 3, 7, 10}, CONTACT_SPIN[2] = {6, 13};  // rows of r1, v1, r2, v2 and of the spins

// Seven derivatives of a point's load, of an element or of those side by side.
typedef Dual<8> PointDual;
template <class S> struct PointDualOf { typedef PointDual Type; };
template <> struct PointDualOf<Pack> { typedef PackDual<7> Type; };
// Columns of an element's entries: those of a single one are padded to whole groups of four.
template <class S> constexpr int CONTACT_COLUMNS = std::is_same_v<S, Pack> ? 14 : 16;

// Change H of (force, bend, torque) by (place, r', spin) to the element: K -= S^T H S.
template <class S, class T>
inline void subtract_point(const Interpolation<S>& at, double s, const T* const (&rows)[7], S (*K)[CONTACT_COLUMNS<S>]) {
    constexpr int N = CONTACT_COLUMNS<S>;
    const double share[2] = {1 - s, s};
    S W[7][N];
    for (int i = 0; i < 7; ++i) {
        for (int b = 0; b < 4; ++b)
            for (int k = 0; k < 3; ++k) W[i][CONTACT_AT[b] + k] = at.r[b] * rows[i]->d(k) + at.slope[b] * rows[i]->d(3 + k);
        for (int b = 0; b < 2; ++b) W[i][CONTACT_SPIN[b]] = share[b] * rows[i]->d(6);
        for (int j = 14; j < N; ++j) W[i][j] = S(0.0);
    }
    for (int a = 0; a < 4; ++a)
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < N; ++j) K[CONTACT_AT[a] + k][j] -= at.r[a] * W[k][j] + at.slope[a] * W[3 + k][j];
    for (int a = 0; a < 2; ++a)
        for (int j = 0; j < N; ++j) K[CONTACT_SPIN[a]][j] -= share[a] * W[6][j];
}

template <class T, class S>
inline Vec<T> seeded(const Vec<S>& v, int at, double c) {
    Vec<T> r = {T(v.x), T(v.y), T(v.z)};
    r.x.set(at, c); r.y.set(at + 1, c); r.z.set(at + 2, c);
    return r;
}

// e: an element, or those side by side.  False, and K untouched, if no point touches.
template <class E, class S>
inline bool subtract_contact(const E& e, const S* x, const S* y, const S* p, const ContactLaw& law, double c0, double c1, S (*K)[CONTACT_COLUMNS<S>]) {
    bool some = false;
    typedef BeamContact<false> P;
    typedef typename PointDualOf<S>::Type T;
    const Vec<S> r1 = vec(x), v1 = vec(x + 3), r2 = vec(x + 7), v2 = vec(x + 10);
    const Vec<S> u1 = vec(y), w1 = vec(y + 3), u2 = vec(y + 7), w2 = vec(y + 10);
    const Well well(law.well);
    for (int q = 0; q < law.points; ++q) {
        const double s = law.at[2 * q];
        const S weight = law.at[2 * q + 1] * p[P::LENGTH] * p[P::HARDNESS];
        const Interpolation<S> at(s, p[P::LENGTH]);
        HolePoint<T> h;
        const auto touching = touches(law, well, e, q, seeded<T>(at.sum(at.r, r1, v1, r2, v2), 0, c0), p[P::RADIUS], h);
        if (!any(touching)) continue;
        some = true;
        T spin(y[6] * (1 - s) + y[13] * s);
        spin.set(6, c1);
        PointLoad<T> load =
            point_load<T, S>(law, h, seeded<T>(at.sum(at.r, u1, w1, u2, w2), 0, c1), seeded<T>(at.sum(at.slope, r1, v1, r2, v2), 3, c0),
                             seeded<T>(at.sum(at.slope, u1, w1, u2, w2), 3, c1), spin, p[P::RADIUS], p[P::FRICTION], weight, nullptr);
        finish(law, e, q, touching, load);
        const T* const rows[7] = {&load.force.x, &load.force.y, &load.force.z, &load.bend.x, &load.bend.y, &load.bend.z, &load.torque};
        subtract_point(at, s, rows, K);
    }
    return some;
}

// Entries of an element, or of those side by side.  False, and nothing is done, if no point touches.
template <class E, class S>
inline bool contact_entries(const E& e, const S* x, const S* y, const S* p, const ContactLaw& law, const double* c, const S* g1, const S* g2, S* out) {
    S K[14][CONTACT_COLUMNS<S>];
    for (auto& row : K) for (S& entry : row) entry = S(0.0);
    if (!subtract_contact(e, x, y, p, law, c[0], c[1], K)) return false;
    for (int i = 0; i < 14; ++i) {
        for (int k = 0; k < 3; ++k) {  // the spin rate moves with v as well
            K[i][3 + k] += K[i][6] * g1[k];
            K[i][10 + k] += K[i][13] * g2[k];
        }
        for (int j = 0; j < 14; ++j) out[14 * i + j] = K[i][j];
    }
    return true;
}

inline void run_contact_jacobian(int n, const int* idx, const int* nodes, const double* par, void* context, const double* c,
                                 const double* spin, const double* x, const double* y, const double*, double* K) {
    const ContactLaw& law = *static_cast<ContactLaw*>(context);
    constexpr int NP = BeamContact<false>::NP;
    const auto clear = [K](int e, int count) { std::memset(K + 196L * e, 0, 196L * count * sizeof(double)); };
    if (law.own) {  // which is asked for elements one by one
        for (int e = 0; e < n; ++e) {
            double X[14], Y[14];
            for (int i = 0; i < 14; ++i) { X[i] = x[idx[e * 14 + i]]; Y[i] = y[idx[e * 14 + i]]; }
            if (!contact_entries(e, X, Y, par + (long)e * NP, law, c, spin + 3 * nodes[2 * e], spin + 3 * nodes[2 * e + 1], K + 196L * e)) clear(e, 1);
        }
        return;
    }
    for_near_wall(law, n, idx, par, x, y, [&](const Lanes& lanes, const Pack* X, const Pack* Y, const Pack* P) {
        Pack g1[3], g2[3], out[196];
        gather_spin(lanes, nodes, spin, g1, g2);
        if (contact_entries(lanes, X, Y, P, law, c, g1, g2, out)) lanes.store_rows(196, out, K);
        else clear(lanes.first, lanes.count);
    }, clear);
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
        P::evaluate(e, X, Y, p, law, rows, nullptr);
        junction_columns(J, seeds, c, spin + 3 * nodes[2 * e], spin + 3 * nodes[2 * e + 1], out);
        junction_rows(v0, X[14], p[P::RIGID], vec(rows), vec(rows + 3), c[0], out);
    }
}

}  // namespace dp
