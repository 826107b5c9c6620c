// Derivatives of the flow in both channels by rates and accelerations, times directions: four elements side by side, all directions at once.
//
// Rows are linear in accelerations and, but for the friction along the hole, in rates.  The names are those of the Jacobians
// (fluid/bore_flow_jacobian.hpp, fluid/annulus_flow_jacobian.hpp).
#pragma once
#include "fluid/annulus_flow_jacobian.hpp"
#include "fluid/bore_flow_jacobian.hpp"

namespace dp {

constexpr double BY_RATES[3] = {0.0, 1.0, 0.0};  // seeds of what depends on the shape

inline Pack along_shape(const Gradient& by, const PackFour& u) { return dot(by.d, u.r2 - u.r1) + dot(by.v1, u.v1) + dot(by.v2, u.v2); }

// Rows of mass: the pressures' rates u[AT_P1], u[AT_P2], and what the motion of the string adds to the volume per length at the ends.
inline void mass_rows_by_rates(const Compressed<Pack>& fluid, const Pack& L, const Pack& content, const Pack& control, const Pack* u, const Pack& swept1,
                               const Pack& swept2, Pack* R) {
    const Pack stored = fluid.by_p * content * L * (1.0 / 12), moved = fluid.theta * L;
    R[AT_P1] = (stored * (u[AT_P1] * 5.0 + u[AT_P2]) + moved * swept1) * (1.0 - control) * MASS_ROW;
    R[AT_P2] = (stored * (u[AT_P2] * 5.0 + u[AT_P1]) + moved * swept2) * MASS_ROW;
}

struct BoreByRates {
    static constexpr int NP = BoreFlow<false, false>::NP;
    typedef BoreFlow<false, false> Pipe;
    Compressed<Pack> fluid;
    PackFour along, by_m1;
    Pack L, control, area, m, m1, rise, G, content, mass, carried;
    double rest;
    Walls w;

    BoreByRates(const Pack* X, const Pack* Y, const Pack*, const Pack* p, const Fluid& f)
        : fluid(f, (X[AT_P1] + X[AT_P2]) * 0.5, p[Pipe::WALL]), L(p[Pipe::LENGTH]), control(p[Pipe::CONTROL]), rest(f.density) {
        const PackFour x = nodal(X), y = nodal(Y);
        move_walls(x, y, L, p[Pipe::POISSON], X[AT_P1], X[AT_P2], BY_RATES[0], BY_RATES[1], w);
        along = slopes(x.r2 - x.r1, x.v1, x.v2, L);
        by_m1 = consistent(y, L) * (L * (1.0 / 420));
        content = w.inner * p[Pipe::AREA];
        area = fluid.density * p[Pipe::AREA];
        m = area * w.inner;
        rise = Pack(0.5 * f.compressibility);
        m1 = m * (Y[AT_P1] + Y[AT_P2]) * rise + area * (w.squeeze1 + w.squeeze2);
        G = X[AT_Q] * f.density;
        const Pack open = f.density / content;
        mass = open * w.stretch * w.stretch * L;
        carried = X[AT_Q] * open * w.stretch * L;
    }
    void rows(const Pack* p, const Pack* U, const Pack* A, Pack* R) const {
        const PackFour u = nodal(U), a = nodal(A);
        const Pack squeeze1 = along_shape(w.push1, u), squeeze2 = along_shape(w.push2, u);
        const Pack m1_change = m * rise * (U[AT_P1] + U[AT_P2]) + area * (squeeze1 + squeeze2);
        const PackFour F = consistent(a * m + u * m1, L) * (L * (1.0 / 420)) + by_m1 * m1_change + slopes(u.r2 - u.r1, u.v1, u.v2, L) * (G * 2.0) + at_ends(u) * G +
                           along * (U[AT_Q] * rest);
        put_row(F, R);
        mass_rows_by_rates(fluid, L, content, control, U, squeeze1 * p[Pipe::AREA], squeeze2 * p[Pipe::AREA], R);
        const Pack inertia = dot(along.r1, a.r1) + dot(along.v1, a.v1) + dot(along.r2, a.r2) + dot(along.v2, a.v2);
        R[AT_Q] = (mass * U[AT_Q] + carried * along_shape(w.by_rate, u) + fluid.density * inertia) * MOMENTUM_ROW;
    }
};

struct AnnulusByRates {
    static constexpr int NP = AnnulusFlow<false, false>::NP;
    typedef AnnulusFlow<false, false> At;
    Compressed<Pack> fluid;
    AnnulusState s;
    PackMatrix P;
    AnnulusRows by;
    Across z;
    PackFour across_speed;  // rows across the hole per unit of the string's speed
    Pack content, widening, chord, torque, half, along, mass;

    AnnulusByRates(const Pack* X, const Pack* Y, const Pack* A, const Pack* p, const Fluid& f)
        : fluid(f, (X[AT_P1] + X[AT_P2]) * 0.5, p[At::WALL]), s(X, Y, A, p, f, fluid.density, BY_RATES), P(scalar_matrix(Pack(1.0)) - outer(s.tw, s.tw)),
          z(across_rows(s, Y, p, P, by)), across_speed(by.speed) {
        add_along_rows(s, X, p, f.density * f.density, by);
        chord = p[At::HOLE] / s.L;
        content = s.content + (dot(s.x.r2, s.tw2 - s.tw) - dot(s.x.r1, s.tw1 - s.tw) + p[At::BENT]) * chord;
        widening = s.lam * p[At::WIDENING] * 0.5;
        torque = p[At::TURNING] * s.L * (1.0 / 6);
        half = p[At::SHARE] * -0.5;
        along = s.tau.loss_v * (s.lam * s.L * 4.0 / p[At::GAP]);
        mass = f.density * s.lam * s.lam * s.L / s.content;
    }
    void rows(const Pack* p, const Pack* U, const Pack* A, Pack* R) const {
        const Pack L = s.L;
        const PackFour u = nodal(U), a = nodal(A);
        const PackVec d = u.r2 - u.r1;
        const Pack speed = s.mean_along(u);
        PackFour carried = a * z.M + u * z.damping;
        if (z.swirling) carried = carried + Offset<Pack>::turn(s.tw, u) * (z.M * p[At::SWIRL] * -2.0);
        const PackFour C = consistent(carried, L) * (L * (1.0 / 420)) + (slopes(d, u.v1, u.v2, L) * 2.0 + at_ends(u)) * z.k2;
        const PackFour started = by.flow_rate * U[AT_Q];
        put_row(PackFour{C.r1 * P, C.v1 * P, C.r2 * P, C.v2 * P} + by.speed * speed + started, R);
        R[6] = torque * (U[6] * 2.0 + U[13]);
        R[13] = torque * (U[13] * 2.0 + U[6]);
        if (z.swirling) {
            const Pack brake = pair(z.off.turned, C + across_speed * speed + started) * half;
            R[6] += brake;
            R[13] += brake;
        }
        const Pack opened = dot(d, s.tw), tilt = dot(u.v1 - u.v2, s.tw) * (p[At::HOLE] * (1.0 / 12)), widens = speed * widening;
        mass_rows_by_rates(fluid, L, content, p[At::CONTROL], U,
                           opened * chord * 0.5 + tilt - along_shape(s.walls.push1, u) * p[At::OUTER] + widens - dot(u.r1, s.tw1 - s.tw) * chord,
                           opened * chord * 0.5 - tilt - along_shape(s.walls.push2, u) * p[At::OUTER] + widens + dot(u.r2, s.tw2 - s.tw) * chord, R);
        R[AT_Q] = (mass * U[AT_Q] + s.density * (s.w * opened + s.lam * L * s.mean_along(a)) + along * speed) * MOMENTUM_ROW;
    }
};

// Adds to each of `count` rows (length) of r; dy, da: the directions, in rows as long.
template <class Flow>
void run_flow_by_rates(int n, const int* idx, const double* par, void* fluid, const double* x, const double* y, const double* a, int count, long length,
                       const double* dy, const double* da, double* r) {
    for (int e = 0; e < n; e += 4) {
        const Lanes lanes(e, n);
        Pack X[FLOW_WIDTH], Y[FLOW_WIDTH], A[FLOW_WIDTH], p[Flow::NP], R[FLOW_WIDTH];
        lanes.gather(FLOW_WIDTH, idx, x, X);
        lanes.gather(FLOW_WIDTH, idx, y, Y);
        lanes.gather(FLOW_WIDTH, idx, a, A);
        lanes.rows(Flow::NP, par, p);
        const Flow flow(X, Y, A, p, *static_cast<const Fluid*>(fluid));
        for (int k = 0; k < count; ++k) {
            lanes.gather(FLOW_WIDTH, idx, dy + k * length, Y);
            lanes.gather(FLOW_WIDTH, idx, da + k * length, A);
            flow.rows(p, Y, A, R);
            double* rows = r + k * length;
            for (int l = 0; l < lanes.count; ++l)
                for (int i = 0; i < FLOW_WIDTH; ++i) rows[idx[(e + l) * FLOW_WIDTH + i]] += R[i].v[l];
        }
    }
}

}  // namespace dp
