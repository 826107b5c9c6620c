// Contact along beam elements without rigid offset: derivatives times directions, of the points that touch.
#pragma once
#include "contact/contact_jacobian.hpp"

namespace dp {

// Derivatives of contact along beam elements by rates, and of the chosen ones by positions, times `count` directions dx, dy (length each): added to
// as many rows of r.  chosen: null for none.  Eight directions are the derivatives of one evaluation of each touching point.
inline void run_contact_by_rates(int n, const int* idx, const double* par, void* context, const double* x, const double* y, const double*, int count,
                                 long length, const signed char* chosen, const double* dx, const double* dy, const double*, double* r) {
    typedef BeamContact<false> P;
    const ContactLaw& law = *static_cast<ContactLaw*>(context);
    const Well well(law.well);
    for (int e = 0; e < n; ++e) {
        const int* at = idx + 14L * e;
        const double* p = par + (long)P::NP * e;
        for (int q = 0; q < law.points; ++q) {
            const int k = e * law.points + q;
            if (!law.touching[k]) continue;
            const double s = law.at[2 * q], weight = law.at[2 * q + 1] * p[P::LENGTH] * p[P::HARDNESS];
            const Interpolation<double> share(s, p[P::LENGTH]);
            Vec<double> place = {0, 0, 0}, speed = place, slope = place, slope_rate = place;
            for (int b = 0; b < 4; ++b) {
                const int* v = at + CONTACT_AT[b];
                const Vec<double> X = {x[v[0]], x[v[1]], x[v[2]]}, Y = {y[v[0]], y[v[1]], y[v[2]]};
                place += X * share.r[b]; slope += X * share.slope[b];
                speed += Y * share.r[b]; slope_rate += Y * share.slope[b];
            }
            const Foot foot = locate(well, place, law.segment[k]);
            const double ends[2] = {1 - s, s};
            for (int first = 0; first < count; first += 8) {
                const int some = count - first < 8 ? count - first : 8;
                Vec<PointDual> u = {PointDual(speed.x), PointDual(speed.y), PointDual(speed.z)};
                Vec<PointDual> w = {PointDual(slope_rate.x), PointDual(slope_rate.y), PointDual(slope_rate.z)};
                Vec<PointDual> still = {PointDual(place.x), PointDual(place.y), PointDual(place.z)};
                Vec<PointDual> along = {PointDual(slope.x), PointDual(slope.y), PointDual(slope.z)};
                PointDual spin(y[at[6]] * ends[0] + y[at[13]] * ends[1]);
                for (int d = 0; d < some; ++d) {
                    const double* move = dy + (first + d) * length;
                    Vec<double> du = {0, 0, 0}, dw = du;
                    for (int b = 0; b < 4; ++b) {
                        const int* v = at + CONTACT_AT[b];
                        const Vec<double> Y = {move[v[0]], move[v[1]], move[v[2]]};
                        du += Y * share.r[b]; dw += Y * share.slope[b];
                    }
                    u.x.set(d, du.x); u.y.set(d, du.y); u.z.set(d, du.z);
                    w.x.set(d, dw.x); w.y.set(d, dw.y); w.z.set(d, dw.z);
                    spin.set(d, move[at[6]] * ends[0] + move[at[13]] * ends[1]);
                    if (!chosen || !chosen[first + d]) continue;
                    const double* shift = dx + (first + d) * length;
                    Vec<double> to = {0, 0, 0}, turn = to;
                    for (int b = 0; b < 4; ++b) {
                        const int* v = at + CONTACT_AT[b];
                        const Vec<double> X = {shift[v[0]], shift[v[1]], shift[v[2]]};
                        to += X * share.r[b]; turn += X * share.slope[b];
                    }
                    still.x.set(d, to.x); still.y.set(d, to.y); still.z.set(d, to.z);
                    along.x.set(d, turn.x); along.y.set(d, turn.y); along.z.set(d, turn.z);
                }
                const PointLoad<PointDual> load = point_load<PointDual, double>(law, hole_point(well, foot, still), u, along, w, spin, p[P::RADIUS], p[P::FRICTION], weight, nullptr);
                for (int d = 0; d < some; ++d) {
                    double* rows = r + (first + d) * length;
                    const Vec<double> force = {load.force.x.d(d), load.force.y.d(d), load.force.z.d(d)}, bend = {load.bend.x.d(d), load.bend.y.d(d), load.bend.z.d(d)};
                    for (int b = 0; b < 4; ++b) {
                        const int* v = at + CONTACT_AT[b];
                        const Vec<double> push = force * share.r[b] + bend * share.slope[b];
                        rows[v[0]] -= push.x; rows[v[1]] -= push.y; rows[v[2]] -= push.z;
                    }
                    for (int b = 0; b < 2; ++b) rows[at[CONTACT_SPIN[b]]] -= load.torque.d(d) * ends[b];
                }
            }
        }
    }
}

}  // namespace dp
