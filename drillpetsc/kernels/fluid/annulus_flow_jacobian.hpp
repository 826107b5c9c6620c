// Jacobian of the flow between string and hole (fluid/annulus_flow.hpp, same names), four elements side by side; fluid/flow_jacobian.hpp says how.
//
// The rows on the string are sums of nine forces, each a scalar times a vector of the motion.  The scalars depend on the stretch lam along
// the hole, the content, the string's section `outer`, the string's speed V, density, flow, its rate and the pressure gradient; so one
// vector of rows per unit of each of these is formed, with the speed of the mud at the wall taken together, and multiplied by its change.
#pragma once
#include "fluid/annulus_flow.hpp"
#include "fluid/flow_jacobian.hpp"

namespace dp {

// StringShear with its derivatives by w, by the string's speed V and by the density.
struct StringShears { Pack loss, loss_w, loss_v, loss_density, pull, pull_w, pull_v, pull_density, drag, drag_w, drag_v, drag_density; };

DP_APART StringShears string_shears(const Fluid& f, const Pack& w, const Pack& sheared, const Pack& drift, const Pack& kept, const Pack& density, const Pack* p) {
    typedef AnnulusFlow<false, false> At;
    struct Part { WallShears tau; Pack drag, by_speed, by_density; };
    const auto part = [&](const Pack& speed, const Pack& gap) -> Part {
        const WallShears s = wall_shears(f.rheology, speed, gap, 1.0, density);
        const Pack slow = 1.0 / (speed * speed + SLOWEST * SLOWEST), share = speed * slow;
        return {s, s.stress * share, s.slope * share + s.stress * slow * (1.0 - 2.0 * speed * share), s.by_density * share};
    };
    const Pack share = p[At::JOINT_SHARE];
    if (!has_joints(share)) {
        const Part a = part(sheared, p[At::GAP]);
        return {a.tau.stress, a.tau.slope, a.tau.slope * kept, a.tau.by_density, a.tau.stress, a.tau.slope, a.tau.slope * kept, a.tau.by_density,
                a.drag, a.by_speed, a.by_speed * kept, a.by_density};
    }
    const Pack tube_speed = p[At::TUBE_SPEED], joint_speed = p[At::JOINT_SPEED], tube_pull = p[At::TUBE_PULL], joint_pull = p[At::JOINT_PULL];
    const Part a = part(w * tube_speed + drift, p[At::GAP]), b = part(w * joint_speed + drift, p[At::JOINT_GAP]);
    const Pack tube_loss = 1.0 - share, joint_loss = share * p[At::GAP] / p[At::JOINT_GAP];
    return {a.tau.stress * tube_loss + b.tau.stress * joint_loss, a.tau.slope * (tube_loss * tube_speed) + b.tau.slope * (joint_loss * joint_speed),
            (a.tau.slope * tube_loss + b.tau.slope * joint_loss) * kept,
            a.tau.by_density * tube_loss + b.tau.by_density * joint_loss,
            a.tau.stress * tube_pull + b.tau.stress * joint_pull, a.tau.slope * (tube_pull * tube_speed) + b.tau.slope * (joint_pull * joint_speed),
            (a.tau.slope * tube_pull + b.tau.slope * joint_pull) * kept,
            a.tau.by_density * tube_pull + b.tau.by_density * joint_pull,
            a.drag * tube_pull + b.drag * joint_pull, a.by_speed * (tube_pull * tube_speed) + b.by_speed * (joint_pull * joint_speed),
            (a.by_speed * tube_pull + b.by_speed * joint_pull) * kept,
            a.by_density * tube_pull + b.by_density * joint_pull};
}

// What rows on the string and along the hole both need.
struct AnnulusState {
    PackVec tw1, tw2, tw, g;
    PackFour x, y, a;
    Walls walls;
    Pack L, gw, lam, content, outer, density, thin, w, across, speed, wall;  // thin: 1/area; speed: of the string, V
    StringShears tau;
    Gradient by_content, by_outer;
    AnnulusState(const Pack* X, const Pack* Y, const Pack* A, const Pack* p, const Fluid& f, const Pack& rho, const double* c)
        : tw1(vec(p + At::TANGENT1)), tw2(vec(p + At::TANGENT2)), x(nodal(X)), y(nodal(Y)), a(nodal(A)), L(p[At::LENGTH]), density(rho) {
        const PackVec sum = tw1 + tw2, zero = {0.0, 0.0, 0.0};
        const Pack AO = p[At::OUTER], AW = p[At::HOLE], il = 1.0 / L, narrowing = p[At::POISSON] * 2.0;
        tw = sum * (1.0 / norm(sum));
        g = {f.gravity[0], f.gravity[1], f.gravity[2]};
        gw = dot(g, tw);
        move_walls(x, y, L, p[At::POISSON], X[AT_P1], X[AT_P2], c[0], c[1], walls);
        lam = dot(x.r2 - x.r1, tw) * il;
        content = lam * AW - walls.inner * AO;
        outer = (1.0 - (walls.stretch - 1.0) * narrowing) * AO;
        by_content = Gradient{tw * (AW * il * c[0]), zero, zero} + walls.by_inner * -AO;
        by_outer = walls.by_stretch * (AO * -narrowing);
        thin = f.density / (density * content);
        across = X[AT_Q] * thin;
        w = across * lam;
        speed = mean_along(y);
        wall = w + speed;
        const Pack kept = Pack(1.0 - f.clinging);
        tau = string_shears(f, w, wall - speed * f.clinging, speed * kept, kept, density, p);
    }
    // along the hole, mean over the element
    Pack mean_along(const PackFour& u) const { return dot((u.r1 + u.r2) * 0.5 + (u.v1 - u.v2) * (L * (1.0 / 12)), tw); }
    typedef AnnulusFlow<false, false> At;
};

// Rows on the string per unit of each variable.  `square`: of the density at rest.
struct AnnulusRows { PackFour lam, content, outer, speed, density, flow, flow_rate, gradient; };

// Weights of the forces across the hole: of the matrices of the cubic shapes for the motion and, where the mud swirls, for its vectors turned
// about the hole; and the vectors that belong to the swirl.
struct Across {
    Pack M, drag, damping, k1, k2, k3;  // k1, k2, k3: of int N x' ds, int N x'' ds and int N' x' ds
    Offset<Pack> off;
    bool swirling;
    PackFour rows;  // of all forces across the hole
};

// Forces across the hole: their rows per unit of each variable, and what `assemble_string` needs of them.
DP_APART Across across_rows(const AnnulusState& s, const Pack* Y, const Pack* p, const PackMatrix& P, AnnulusRows& by) {
    typedef AnnulusFlow<false, false> At;
    const Pack L = s.L, round = p[At::DIAMETER] * 3.14159265358979324, drag = s.tau.drag * round, M = s.density * s.lam * (p[At::CHI] * p[At::OUTER]);
    const Pack carried = M * s.thin * Y[AT_Q], damping = drag + p[At::DAMPING], k1 = carried + drag * s.across, k2 = M * s.across, k3 = k2 * s.across;
    Across z = {M, drag, damping, k1, k2, k3, Offset<Pack>(s.x, p + At::AXIS1, p + At::AXIS2, s.tw1, s.tw2, s.tw), swirls(p[At::SHARE]), {}};
    const auto cut = [&P](const PackFour& u) -> PackFour { return {u.r1 * P, u.v1 * P, u.r2 * P, u.v2 * P}; };
    PackFour pushed = s.a, moved = s.y;
    const PackFour slope = cut(slopes(s.x.r2 - s.x.r1, s.x.v1, s.x.v2, L)), curve = cut(stiffness(s.x.r2 - s.x.r1, s.x.v1, s.x.v2, L)) * -1.0;
    PackFour swing = cut(slopes(s.y.r2 - s.y.r1, s.y.v1, s.y.v2, L) * 2.0 + at_ends(s.y));
    if (z.swirling) {
        const Pack swirl = p[At::SWIRL];
        const PackFour& turned = z.off.turned;
        pushed = pushed + Offset<Pack>::turn(s.tw, s.y) * (swirl * -2.0) - turned * p[At::SWIRL_RATE] - z.off.y * (swirl * swirl);
        moved = moved - turned * swirl;
        swing = swing - (Offset<Pack>::turn(s.tw, slope) + slopes(turned.r2 - turned.r1, turned.v1, turned.v2, L) + at_ends(turned)) * swirl;
    }
    const PackFour mass = cut(consistent(pushed, L)) * (L * (1.0 / 420)), damped = cut(consistent(moved, L)) * (L * (1.0 / 420));
    // by the speed at the wall, through the drag it makes
    const PackFour dragged = damped + slope * s.across, by_w = dragged * (s.tau.drag_w * round);
    const Pack il = 1.0 / s.lam, ic = 1.0 / s.content, ir = 1.0 / s.density;
    by.lam = by_w * s.across + (mass * M + slope * carried + swing * k2 + curve * k3) * il;
    by.content = (by_w * s.w + slope * k1 + swing * k2 + curve * (2.0 * k3)) * -ic;
    by.speed = dragged * (s.tau.drag_v * round);
    by.density = (mass * M - by_w * s.w - slope * (drag * s.across) - curve * k3) * ir + dragged * (s.tau.drag_density * round);
    by.flow = (by_w * s.lam + slope * drag + swing * M + curve * (2.0 * k2)) * s.thin;
    by.flow_rate = slope * (M * s.thin);
    if (z.swirling) z.rows = mass * M + damped * damping + slope * k1 + swing * k2 + curve * k3;
    return z;
}

// Adds the forces along the hole and those of still mud across it.
DP_APART void add_along_rows(const AnnulusState& s, const Pack* X, const Pack* p, double square, AnnulusRows& by) {
    typedef AnnulusFlow<false, false> At;
    const Pack L = s.L, L2 = L * L, lift = s.density * s.lam * s.outer, half = L * 0.5, twelfth = L2 * (1.0 / 12), round = p[At::DIAMETER] * 3.14159265358979324;
    // unit forces: push along the hole, weight and centrifugal force across it
    const PackFour push = {s.tw1 * (L * 0.35) + s.tw2 * (L * 0.15), s.tw1 * (L2 * 0.05) + s.tw2 * (L2 * (1.0 / 30)),
                           s.tw1 * (L * 0.15) + s.tw2 * (L * 0.35), s.tw1 * (L2 * (-1.0 / 30)) - s.tw2 * (L2 * 0.05)};
    const PackVec down = s.g - s.tw * s.gw, bend = -vec(p + At::BEND);
    const PackFour weight = {down * half, down * twelfth, down * half, down * -twelfth}, guide = {bend * half, bend * twelfth, bend * half, bend * -twelfth};
    const PackFour turned = guide * (2.0 * lift * s.wall), lifted = (weight + guide * (s.wall * s.wall)) * lift, by_w = turned - push * (s.tau.pull_w * round);
    const Pack gradient = (X[AT_P2] - X[AT_P1]) / L, ir = 1.0 / s.density;
    by.lam = by.lam + by_w * s.across + lifted * (1.0 / s.lam);
    by.content = by.content - by_w * (s.w / s.content);
    by.outer = push * gradient + lifted * (1.0 / s.outer);
    by.speed = by.speed + turned - push * (s.tau.pull_v * round);
    by.density = by.density + (lifted - by_w * s.w) * ir - push * (s.tau.pull_density * round);
    by.flow = by.flow + by_w * (s.lam * s.thin);
    const PackVec shoulder = s.tw * (X[AT_Q] * p[At::SHOULDER] * square * ir);
    by.density.r1 += shoulder * (-X[AT_Q] * ir);
    by.flow.r1 += shoulder * 2.0;
    by.gradient = push * s.outer;
}

// Rows of the spins: the moment of the forces across the hole about its axis, J y contracted with their rows.
DP_APART void brake_spins(const AnnulusState& s, const Pack* p, const Across& z, const AnnulusRows& by, const Compression& fluid, const double* c,
                          Pack (*K)[FLOW_WIDTH]) {
    typedef AnnulusFlow<false, false> At;
    const Pack swirl = p[At::SWIRL], L = s.L, half = p[At::SHARE] * -0.5;
    const PackFour& u = z.off.turned;
    const auto back = [&s](const PackFour& v) -> PackFour { return {cross(v.r1, s.tw), cross(v.v1, s.tw), cross(v.r2, s.tw), cross(v.v2, s.tw)}; };  // J^T v
    // transposed matrices of the shapes: int N_i N_j is symmetric, int N' N' too; int N_j N_i' = [N_i N_j] - int N_i N_j'
    const auto by_slopes = [&](const PackFour& v) -> PackFour { return (slopes(v.r2 - v.r1, v.v1, v.v2, L) + at_ends(v)) * -1.0; };
    const PackFour even = consistent(u, L) * (L * (1.0 / 420)), tilted = by_slopes(u), back_u = back(u);
    const PackFour ends = at_ends(u);
    PackFour row = even * (z.M * (c[2] - swirl * swirl * c[0]) + z.damping * c[1]) + tilted * (z.k1 * c[0] + z.k2 * (2.0 * c[1])) +
                   stiffness(u.r2 - u.r1, u.v1, u.v2, L) * (z.k3 * -c[0]) + ends * (z.k2 * c[1]);
    const PackFour even_back = consistent(back_u, L) * (L * (1.0 / 420));
    row = row - even_back * (z.M * (p[At::SWIRL_RATE] * c[0] + swirl * (2.0 * c[1])) + z.damping * swirl * c[0]);
    row = row - (by_slopes(back_u) * 2.0 + at_ends(back_u)) * (z.k2 * swirl * c[0]);
    row = row + back(z.rows) * c[0];
    const Pack opened = pair(u, by.lam) * (c[0] / L), pulled = pair(u, by.speed) * c[1], stored = pair(u, by.content);
    const PackVec chord = s.tw * opened, middle = s.tw * (pulled * 0.5), arm = s.tw * (pulled * L * (1.0 / 12));
    row.r1 += middle - chord; row.v1 += arm; row.r2 += middle + chord; row.v2 -= arm;
    row = (row + on_nodes(s.by_content * stored)) * half;
    const Pack pressed = pair(u, by.density) * fluid.density * (0.5 * c[0]) * half, driven = (pair(u, by.flow) * c[0] + pair(u, by.flow_rate) * c[1]) * half;
    for (int at : SPIN_AT) {
        put_row(row, K[at]);
        K[at][AT_P1] = K[at][AT_P2] = pressed;
        K[at][AT_Q] = driven;
    }
}

DP_APART void annulus_on_string(const AnnulusState& s, const Pack* X, const Pack* Y, const Pack* p, const Fluid& f, const Compression& fluid, const double* c,
                                Pack (*K)[FLOW_WIDTH]) {
    typedef AnnulusFlow<false, false> At;
    const PackMatrix P = scalar_matrix(Pack(1.0)) - outer(s.tw, s.tw);
    AnnulusRows by;
    const Across z = across_rows(s, Y, p, P, by);
    if (z.swirling) brake_spins(s, p, z, by, fluid, c, K);
    add_along_rows(s, X, p, f.density * f.density, by);
    const Pack L = s.L, push = p[At::OUTER] * L;
    const Product products[2] = {{by.content, s.by_content}, {by.outer, s.by_outer}};
    const Pack fling = z.swirling ? z.M * (p[At::SWIRL] * p[At::SWIRL] * c[0]) : Pack(0.0);
    assemble_string(L, z.M * c[2] + z.damping * c[1] - fling, z.k1 * c[0] + z.k2 * (2.0 * c[1]), z.k3 * -c[0], z.k2 * c[1], &P, products, s.walls, push, K);
    if (z.swirling) {
        const Pack swirl = p[At::SWIRL];
        add_turned(L, -(z.M * (p[At::SWIRL_RATE] * c[0] + swirl * (2.0 * c[1])) + z.damping * swirl * c[0]), z.k2 * swirl * (-2.0 * c[0]),
                   z.k2 * swirl * -c[0], skew(s.tw), K);
    }
    // lam and V change along the hole only
    const PackFour half = by.speed * (0.5 * c[1]), turn = by.speed * (L * (c[1] / 12)), stretch = by.lam * (c[0] / L);
    const PackFour upper = half - stretch, lower = half + stretch;
    const auto rows = [](const PackFour& u, int a) { return a == 0 ? u.r1 : a == 1 ? u.v1 : a == 2 ? u.r2 : u.v2; };
    for (int a = 0; a < 4; ++a) {
        add(K, ROWS_AT[a], 0, outer(rows(upper, a), s.tw));
        add(K, ROWS_AT[a], 3, outer(rows(turn, a), s.tw));
        add(K, ROWS_AT[a], 7, outer(rows(lower, a), s.tw));
        add(K, ROWS_AT[a], 10, outer(rows(turn, a), -s.tw));
    }
    const PackFour common = by.density * (fluid.density * (0.5 * c[0])), steeper = by.gradient * (c[0] / L);
    put_column(common - steeper + on_nodes(s.walls.push1) * (push * c[0]), AT_P1, K);
    put_column(common + steeper + on_nodes(s.walls.push2) * (push * c[0]), AT_P2, K);
    put_column(by.flow * c[0] + by.flow_rate * c[1], AT_Q, K);
}

// Rows of mass and of momentum.
DP_APART void annulus_along(const AnnulusState& s, const Pack* X, const Pack* Y, const Pack* p, const Fluid& f, const Compressed<Pack>& fluid,
                            const Compression& by, const double* c, Pack (*K)[FLOW_WIDTH]) {
    typedef AnnulusFlow<false, false> At;
    const Pack L = s.L, AO = p[At::OUTER], AW = p[At::HOLE], q = X[AT_Q], rho = s.density, ic = 1.0 / s.content;
    // int psi_j t_w.r_s' ds / L = t_w.(d'/(2 L) +- (v1' - v2')/12)
    const PackVec d_rate = s.y.r2 - s.y.r1;
    const Pack opened = dot(d_rate, s.tw), chord = opened * 0.5 / L, tilt = dot(s.y.v1 - s.y.v2, s.tw) * (1.0 / 12);
    const PackVec way = s.tw * (AW * (0.5 * c[1]) / L), lever = s.tw * (AW * (c[1] / 12));
    // the hole's area where the element comes to
    const Pack widening = p[At::WIDENING] * 0.5, widens = s.speed * s.lam * widening, moved = s.lam * widening * c[1];
    const PackVec deeper = s.tw * (moved * 0.5), turned = s.tw * (moved * L * (1.0 / 12)), longer = s.tw * (s.speed * widening * c[0] / L);
    const PackFour by_widens = {deeper - longer, turned, deeper + longer, -turned};
    // the length of the hole by its directions at the nodes
    const PackVec zero = {0.0, 0.0, 0.0}, off1 = s.tw1 - s.tw, off2 = s.tw2 - s.tw;
    const Pack along = AW / L, bent = (dot(s.x.r2, off2) - dot(s.x.r1, off1) + p[At::BENT]) * along;
    const PackFour by_bent = {off1 * (along * -c[0]), zero, off2 * (along * c[0]), zero};
    const PackFour by_off1 = {off1 * (along * -c[1]), zero, zero, zero}, by_off2 = {zero, zero, off2 * (along * c[1]), zero};
    const Storage storage = {s.content + bent, (chord + tilt) * AW - s.walls.squeeze1 * AO + widens - dot(s.y.r1, off1) * along,
                             (chord - tilt) * AW - s.walls.squeeze2 * AO + widens + dot(s.y.r2, off2) * along, on_nodes(s.by_content) + by_bent,
                             on_nodes(s.walls.by_squeeze1 * -AO + Gradient{way, lever, -lever}) + by_widens + by_off1,
                             on_nodes(s.walls.by_squeeze2 * -AO + Gradient{way, -lever, lever}) + by_widens + by_off2};
    put_mass_rows(storage, fluid, by, L, Y[AT_P1], Y[AT_P2], p[At::CONTROL], c[0], c[1], K);
    const PackVec head = s.tw * (s.gw * p[At::CONTROL] * (f.density * 1e-7 * MASS_ROW * c[0]));
    K[AT_P1][0] -= head.x; K[AT_P1][1] -= head.y; K[AT_P1][2] -= head.z;
    const Pack round = L * 4.0 / p[At::GAP], wet = s.lam * round, drag = s.tau.loss_w * wet, mass = f.density * s.lam * s.lam * L * ic, started = mass * Y[AT_Q];
    const Pack carried = rho * s.w, pulled = L * (s.mean_along(s.a) - s.gw);  // acceleration less gravity
    const Pack by_lam = (started * 2.0 + carried * opened) / s.lam + rho * pulled + s.tau.loss * round + drag * s.across;
    const Pack by_content = (started + carried * opened + drag * s.w) * -ic, by_speed = s.tau.loss_v * wet;
    const Pack by_density = s.lam * pulled - drag * s.w / rho + s.tau.loss_density * wet, by_q = f.density * s.lam * ic * opened + drag * s.lam * s.thin;
    // along the hole: change of chord, speed and acceleration
    const Pack chords = by_lam * (c[0] / L) + carried * c[1], means = by_speed * c[1] + rho * s.lam * L * c[2], arm = means * L * (1.0 / 12);
    const PackVec turn = s.tw * arm, by_r1 = s.tw * (means * 0.5 - chords), by_r2 = s.tw * (means * 0.5 + chords);
    const PackFour direct = {by_r1, turn, by_r2, -turn};
    put_row((on_nodes(s.by_content * by_content) + direct) * MOMENTUM_ROW, K[AT_Q]);
    put_momentum(q, p[At::STEP], p[At::LOSS], f, rho, by, by_density, by_q, mass, c[0], c[1], K[AT_Q]);
}

inline void annulus_flow_jacobian(const Pack* X, const Pack* Y, const Pack* A, const Pack* p, const Fluid& f, const double* c, const Pack* g1,
                                  const Pack* g2, Pack (*K)[FLOW_WIDTH]) {
    typedef AnnulusFlow<false, false> At;
    const Compressed<Pack> fluid(f, (X[AT_P1] + X[AT_P2]) * 0.5, p[At::WALL]);
    const Compression by = compression(f, fluid, p[At::WALL]);
    const AnnulusState s(X, Y, A, p, f, fluid.density, c);
    clear_spins(K);
    annulus_on_string(s, X, Y, p, f, by, c, K);
    annulus_along(s, X, Y, p, f, fluid, by, c, K);
    // drag on the turning string: by the spin rates, which move with v as well
    const Pack torque = p[At::TURNING] * s.L * (c[1] / 6);
    for (int i = 0; i < 2; ++i) {
        const Pack first = torque * (i == 0 ? 2.0 : 1.0), second = torque * (i == 0 ? 1.0 : 2.0);
        Pack* row = K[SPIN_AT[i]];
        row[6] = first;
        row[13] = second;
        for (int k = 0; k < 3; ++k) { row[3 + k] += first * g1[k]; row[10 + k] += second * g2[k]; }
    }
}

inline void run_annulus_flow_jacobian(int n, const int* idx, const int* nodes, const double* par, void* fluid, const double* c, const double* spin,
                                      const double* x, const double* y, const double* a, double* K) {
    run_flow_jacobian<AnnulusFlow<false, false>::NP, true>(n, idx, nodes, par, fluid, c, spin, x, y, a, K, annulus_flow_jacobian);
}

}  // namespace dp
