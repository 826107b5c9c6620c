// Jacobian of the flow in the bore (fluid/bore_flow.hpp, same names), four elements side by side; fluid/flow_jacobian.hpp says how.
//
// The rows on the string depend on four numbers besides the motion: m = rho A inner, its rate m1, G = rho0 q and G1 = rho0 q'.
#pragma once
#include "fluid/flow_jacobian.hpp"
#include "fluid/bore_flow.hpp"

namespace dp {

DP_APART void pipe_on_string(const PackFour& x, const PackFour& y, const PackFour& a, const Walls& w, const Pack* X, const Pack* Y, const Pack* p,
                             const Fluid& f, const Pack& density, const double* c, Pack (*K)[FLOW_WIDTH]) {
    typedef BoreFlow<false, false> Pipe;
    const Pack L = p[Pipe::LENGTH], area = density * p[Pipe::AREA], push = p[Pipe::AREA] * L * -1.0, G = X[AT_Q] * f.density, G1 = Y[AT_Q] * f.density;
    const double half = 0.5 * f.compressibility;
    const Pack rise = (Y[AT_P1] + Y[AT_P2]) * half, m = area * w.inner, m1 = m * rise + area * (w.squeeze1 + w.squeeze2), speed = G / m;
    const PackVec g = {f.gravity[0], f.gravity[1], f.gravity[2]};
    const PackFour along = slopes(x.r2 - x.r1, x.v1, x.v2, L), curve = stiffness(x.r2 - x.r1, x.v1, x.v2, L);
    const PackFour by_m = consistent(PackFour{a.r1 - g, a.v1, a.r2 - g, a.v2}, L) * (L * (1.0 / 420)) + curve * (speed * speed);
    const PackFour by_m1 = consistent(y, L) * (L * (1.0 / 420));
    const PackFour by_G = slopes(y.r2 - y.r1, y.v1, y.v2, L) * 2.0 + at_ends(y) - curve * (speed * 2.0);
    const Product products[2] = {{(by_m + by_m1 * rise) * area, w.by_inner}, {by_m1 * area, w.by_squeeze1 + w.by_squeeze2}};
    assemble_string(L, m * c[2] + m1 * c[1], G1 * c[0] + G * (2.0 * c[1]), speed * G * -c[0], G * c[1], nullptr, products, w, push, K);
    const PackFour common = by_m * (m * (half * c[0])) + by_m1 * (m1 * (half * c[0]) + m * (half * c[1]));
    put_column(common + on_nodes(w.push1) * (push * c[0]), AT_P1, K);
    put_column(common + on_nodes(w.push2) * (push * c[0]), AT_P2, K);
    put_column(by_G * (f.density * c[0]) + along * (f.density * c[1]), AT_Q, K);
}

// Rows of mass and of momentum.
DP_APART void pipe_along(const PackFour& x, const PackFour& a, const Walls& w, const Pack* X, const Pack* Y, const Pack* p, const Fluid& f,
                         const Compressed<Pack>& fluid, const double* c, Pack (*K)[FLOW_WIDTH]) {
    typedef BoreFlow<false, false> Pipe;
    const Pack L = p[Pipe::LENGTH], A = p[Pipe::AREA], q = X[AT_Q], density = fluid.density;
    const Compression by = compression(f, fluid, p[Pipe::WALL]);
    const Storage storage = {w.inner * A, w.squeeze1 * A, w.squeeze2 * A, on_nodes(w.by_inner * A), on_nodes(w.by_squeeze1 * A), on_nodes(w.by_squeeze2 * A)};
    put_mass_rows(storage, fluid, by, L, Y[AT_P1], Y[AT_P2], p[Pipe::CONTROL], c[0], c[1], K);
    const Pack open = f.density / (w.inner * A), by_q = open * w.stretch / density, speed = q * by_q;  // rho/area of the mud
    const WallShears wall = bore_shears(f, speed, density, p[Pipe::DIAMETER], p[Pipe::JOINT_SHARE], p[Pipe::TUBE_SPEED], p[Pipe::JOINT_DIAMETER], p[Pipe::JOINT_SPEED]);
    const Pack round = L * 4.0 / p[Pipe::DIAMETER], drag = wall.slope * (w.stretch * round), mass = open * w.stretch * w.stretch * L;
    const Pack carried = density * speed * L, spread = drag * speed + carried * w.rate, started = mass * Y[AT_Q];
    const PackFour along = slopes(x.r2 - x.r1, x.v1, x.v2, L);
    const PackVec g = {f.gravity[0], f.gravity[1], f.gravity[2]}, none = {0.0, 0.0, 0.0};
    const Pack inertia = dot(along.r1, a.r1) + dot(along.v1, a.v1) + dot(along.r2, a.r2) + dot(along.v2, a.v2);
    const Pack by_density = inertia - dot(x.r2 - x.r1, g) - drag * speed / density + wall.by_density * (w.stretch * round);
    const Pack by_stretch = (started * 2.0 + spread) / w.stretch + wall.stress * round;
    const Gradient change = w.by_stretch * by_stretch + w.by_inner * ((started + spread) / -w.inner) + w.by_rate * carried;
    // int N_i' N_j ds is the transposed of int N_i N_j' ds: the ends less that
    const PackFour turned = at_ends(a) + slopes(a.r2 - a.r1, a.v1, a.v2, L), weight = {-g, none, g, none};
    put_row((on_nodes(change) + along * (density * c[2]) - (turned + weight) * (density * c[0])) * MOMENTUM_ROW, K[AT_Q]);
    put_momentum(q, p[Pipe::STEP], p[Pipe::LOSS], f, density, by, by_density, open * w.stretch * w.rate * L + drag * by_q, mass, c[0], c[1], K[AT_Q]);
}

inline void bore_flow_jacobian(const Pack* X, const Pack* Y, const Pack* A, const Pack* p, const Fluid& f, const double* c, const Pack*, const Pack*,
                               Pack (*K)[FLOW_WIDTH]) {
    typedef BoreFlow<false, false> Pipe;
    const PackFour x = nodal(X), y = nodal(Y), a = nodal(A);
    const Compressed<Pack> fluid(f, (X[AT_P1] + X[AT_P2]) * 0.5, p[Pipe::WALL]);
    Walls w;
    move_walls(x, y, p[Pipe::LENGTH], p[Pipe::POISSON], X[AT_P1], X[AT_P2], c[0], c[1], w);
    clear_spins(K);
    pipe_on_string(x, y, a, w, X, Y, p, f, fluid.density, c, K);
    pipe_along(x, a, w, X, Y, p, f, fluid, c, K);
}

inline void run_bore_flow_jacobian(int n, const int* idx, const int* nodes, const double* par, void* fluid, const double* c, const double* spin,
                                   const double* x, const double* y, const double* a, double* K) {
    run_flow_jacobian<BoreFlow<false, false>::NP, false>(n, idx, nodes, par, fluid, c, spin, x, y, a, K, bore_flow_jacobian);
}

}  // namespace dp
