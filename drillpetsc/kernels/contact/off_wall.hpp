// Elements without rigid offset none of whose contact points can touch: all points are as near to a place that was found off the wall as
// that place allows (`touches`).  Four elements side by side; they are most of a string, and have nothing to add to rows or entries.
#pragma once
#include "contact/contact.hpp"

namespace dp {

class OffWall {
public:
    static constexpr int POINTS = 8;  // more are not looked at

    OffWall(const ContactLaw& l, const int* indices, const double* parameters, const double* unknowns)
        : law(l), idx(indices), par(parameters), x(unknowns), known(l.points <= POINTS) {
        for (int q = 0; known && q < law.points; ++q) {
            const Interpolation<double> at(law.at[2 * q], 1.0);
            for (int i = 0; i < 4; ++i) share[q][i] = at.r[i];
        }
    }

    // Bit l is set where element e + l is one of them; e + 3 is the last element at most.  Their points are noted as open.
    int four(int e) const {
        if (!known) return 0;
        typedef BeamContact<false> P;
        const int* at[4];
        const double* p[4];
        V4 length = splat(0.0), radius = splat(0.0);
        for (int l = 0; l < 4; ++l) {
            at[l] = idx + 14L * (e + l);
            p[l] = par + (long)P::NP * (e + l);
            length[l] = p[l][P::LENGTH];
            radius[l] = p[l][P::RADIUS];
        }
        V4 node[4][3];  // r1, v1, r2, v2
        for (int b = 0; b < 4; ++b)
            for (int k = 0; k < 3; ++k) {
                const int i = PLACES[b] + k;
                node[b][k] = V4{x[at[0][i]], x[at[1][i]], x[at[2][i]], x[at[3][i]]};
            }
        int free = 15;
        for (int q = 0; q < law.points && free; ++q) {
            const double *c = share[q], *f[4];
            for (int l = 0; l < 4; ++l) f[l] = law.free + 5L * ((long)(e + l) * law.points + q);
            V4 distance = splat(0.0);
            for (int k = 0; k < 3; ++k) {
                const V4 place = node[0][k] * c[0] + node[2][k] * c[2] + (node[1][k] * c[1] + node[3][k] * c[3]) * length;
                const V4 way = place - V4{f[0][k], f[1][k], f[2][k], f[3][k]};
                distance += way * way;
            }
            for (int l = 0; l < 4; ++l)
                if (!(radius[l] == f[l][3] && distance[l] < f[l][4])) free &= ~(1 << l);
        }
        for (int l = 0; l < 4; ++l)
            for (int q = 0; (free >> l & 1) && q < law.points; ++q) {
                const long k = (long)(e + l) * law.points + q;
                law.touching[k] = 0;
                law.normal[k] = 0.0;
            }
        return free;
    }

private:
    static constexpr int PLACES[4] = {0, 3, 7, 10};
    const ContactLaw& law;
    const int* idx;
    const double *par, *x;
    double share[POINTS][4];
    bool known;
};

// Four elements at a time: near(lanes, x, y, parameters) where one of them may touch, else off(first, count).
template <class Near, class Off>
inline void for_near_wall(const ContactLaw& law, int n, const int* idx, const double* par, const double* x, const double* y, const Near& near, const Off& off) {
    constexpr int NP = BeamContact<false>::NP;
    const OffWall off_wall(law, idx, par, x);
    for (int e = 0; e < n; e += 4) {
        if (e + 4 <= n && off_wall.four(e) == 15) {
            off(e, 4);
            continue;
        }
        Pack X[14], Y[14], P[NP];
        const Lanes lanes(e, n);
        lanes.gather(14, idx, x, X);
        lanes.gather(14, idx, y, Y);
        lanes.rows(NP, par, P);
        near(lanes, X, Y, P);
    }
}

// run_residual for contact along beam elements.
inline void run_contact_residual(int n, const int* idx, const double* par, void* context, const double* x, const double* y, const double* a, double* r) {
    typedef BeamContact<false> Contact;
    const ContactLaw& law = *static_cast<ContactLaw*>(context);
    if (law.own) return run_residual<Contact>(n, idx, par, context, x, y, a, r);  // which is asked for elements one by one
    for_near_wall(law, n, idx, par, x, y, [&](const Lanes& lanes, const Pack* X, const Pack* Y, const Pack* P) {
        Pack R[14];
        Contact::evaluate(lanes, X, Y, P, law, R, nullptr);
        for (int l = 0; l < lanes.count; ++l)
            for (int i = 0; i < 14; ++i) r[idx[14L * lanes.at[l] + i]] += R[i].v[l];
    }, [](int, int) {});
}

}  // namespace dp
