// A bit that cuts rock: an ellipsoid in a bucket whose end moves with the rate of penetration, three laws of the bit.
//
// Unknowns r, v, phi of the last node; e (3) displacement of the hole's end and s metres drilled, both since the start; chips (N): the rock's
// profile ahead of a blade (drag bit in motion only); u over-gauge of the hole beside the bit (a wall that gives way only).
//   bottom   depth_b = (x_c - h).t_h + |t_h|_Q - c,   Q = a^2 (I - e_b e_b^T) + c^2 e_b e_b^T   (x_c centre of the ellipsoid, h = END + TURNED + e)
//   side     depth_s = rho + |n|_Q - (a + clearance + u),   u' = [N - N_y]_+ / eta - u |v|/l_g   (a wall that gives way), or u = 0
//            guided: friction does not push the bit round the hole; in gauge the side is a spring towards the axis, depth_s = rho
//   hole     e' = v(F),  s' = |v|                      (state)   or e, s held and moved between the steps (post_step)
//   rock     v = D (Omega/Omega_ref)^a (W_eff/W_ref)^(b-1) (W_eff/W) M_r M_b F
//   pattern  depth_b + h(phi - phi0),  h = sum a_k (sin(n_k psi + p_k) - sin p_k): the bottom that a roller cone leaves (in motion only)
//   body     F_b = STIFFNESS (chip - exposure), beside cutters that cut no more than their exposure (eq-bit-body)
//   profile  B_t = [omega]_+ B_xi,  B(2 pi/blades) = max(U, B(0)),  chip per blade d_n = U - B(0),  U = s + depth_b
#pragma once
#include "bit/face_friction.hpp"
#include "contact/contact.hpp"

namespace dp {

constexpr double ROCK_ROW = 1e5;          // row of a hole's rate [N s/m]: of the size of the string's rows
constexpr double THRESHOLD_ROUNDING = 0.05;  // share of the threshold weight over which it is rounded off
constexpr double SPEED_ROUNDING = 1e-3;   // share of the reference speed below which |Omega| is rounded off
constexpr double TURN_ROUNDING = 2e-2;    // speed below which the cutting of a drag bit is rounded off [rad/s]

constexpr int CHIPS = 16;                 // states of the rock's profile ahead of a blade

struct BitKind { DP_ENUM(Kind, ROP, DRAG_BIT, VELOCITY_WEAKENING, OWN, KINDS) };

// Law of the user (core/own_law.hpp): state at the bit [N, rad/s, rad, m/s, m] and what it gives [N m, N m, m/s].
struct OwnBit {
    DP_ENUM(State, WEIGHT, SPEED, ANGLE, ADVANCE, DEPTH, STATES);
    DP_ENUM(Result, TORQUE, GRIP, RATE, RESULTS);
};

// Law of the user for the rock: measured depth [m], and how many times the force it needs for the same cut [-].
struct OwnRock {
    DP_ENUM(State, DEPTH, STATES);
    DP_ENUM(Result, STRENGTH, RESULTS);
};
struct BitMode { DP_ENUM(Mode, MOTION, STATICS, QUASI_STATIC, MODES) };

// Laws of bit and rock; filled by the component of the bit.
DP_RECORD(BitLaw,
    double kind, bit_axis, walk_cos, walk_sin;             // direction: 1 along the bit's axis
    double reference_speed, reference_weight, width;       // width over which one layer goes over into the next [m]
    double cut, contact, torque_cut, rub;                  // drag bit: W = cut d + contact, T = torque_cut d + rub contact [N/m, N, N, m]
    double exposure, saturated;                            // chip per blade at which the body touches [m], weight on the bit then [N]; infinite: none
    double blades, onset, rest;                            // depth over which the wear flat comes into contact [m]; rounding of its speed [m/s]
    double static_torque, dynamic_torque, speed, by_weight; // weakening: torques [N m], or lever arms [m] of the weight
    double turn_rounding;                                  // rounding of the direction of turning [rad/s]
    const double* layers; int count;                       // rows of BitLayer::COLUMNS
    const double* derivative;                              // (N, N+1) of the profile by xi [1/rad]
    const double* orders; int order_count;                 // rows of BitOrder, pattern of the bottom
    OwnLaw* own; OwnLaw* rock;                             // laws of the user for the bit and for the rock, null without
    double own_rate, start;                                // 1: it gives the rate of penetration; measured depth of the hole's end at the start [m]
    int touching;                                          // of the last evaluation: 1 bottom, 2 side
)

struct BitLayer {
    DP_ENUM(Column,
        START, DRILLABILITY,               // [m drilled], D [m/(s N)]
        ROTARY_EXPONENT, WEIGHT_EXPONENT,  // a and b
        THRESHOLD, BIT_ANISOTROPY,         // [N], I_b
        ROCK,                              // 9: M_r, row by row
        COLUMNS = ROCK + 9)
};

struct BitOrder { DP_ENUM(Column, ORDER, AMPLITUDE, PHASE, COLUMNS) };  // waves per turn, [m], [rad]

// |Omega|^a / Omega_ref^a, zero and smooth at standstill; 1 for a = 0
template <class T>
inline T speed_factor(const T& omega, double a, double reference) {
    if (a == 0) return T(1.0);
    const T q = omega * (1.0 / reference), q2 = q * q;
    return q2 * pow(q2 + SPEED_ROUNDING * SPEED_ROUNDING, 0.5 * a - 1.0);
}

// share of its cutting with which a bit turns forward: rises from 0 to 1 over TURN_ROUNDING, so that rate and torque of cutting have one factor
template <class T>
inline T cutting(const T& omega) {
    if (val(omega) <= 0) return T(0.0);
    const T u = omega * (1.0 / TURN_ROUNDING), u2 = u * u;
    return val(u) >= 1 ? T(1.0) : u * (15.0 - 10.0 * u2 + 3.0 * u2 * u2) * 0.125;
}

// speed of turning that cuts, [omega]_+
template <class T>
inline T forward(const T& omega) { return omega * cutting(omega); }

// weight beyond the threshold, C1
template <class T>
inline T beyond(const T& weight, double threshold) {
    if (threshold <= 0) return weight;
    const double w = THRESHOLD_ROUNDING * threshold;
    const T g = weight - threshold;
    if (val(g) <= -w) return T(0.0);
    return val(g) >= w ? g : (g + w) * (g + w) * (0.25 / w);
}

// Direction in which the bit goes under the force F on the rock: M_r M_b F, M_b = e e^T + I_b Rot(walk)(I - e e^T).
template <class T>
inline Vec<T> cut_direction(const BitLaw& law, const double* layer, const Vec<T>& F, const Vec<T>& e) {
    const T axial = dot(F, e);
    const Vec<T> across = F - e * axial;
    const Vec<T> g = e * axial + (across * law.walk_cos + cross(e, across) * law.walk_sin) * layer[BitLayer::BIT_ANISOTROPY];
    const double* M = layer + BitLayer::ROCK;
    return {g.x * M[0] + g.y * M[1] + g.z * M[2], g.x * M[3] + g.y * M[4] + g.z * M[5], g.x * M[6] + g.y * M[7] + g.z * M[8]};
}

// Rate of penetration [m/s] in one layer.  chip_rate: along the bit, where its profile is known or the law of the user gives it.
template <class T>
inline Vec<T> layer_rate(const BitLaw& law, const double* layer, const Vec<T>& F, const Vec<T>& e, const T& omega, const T* chip_rate) {
    const T weight = dot(F, e);
    const Vec<T> zero = {T(0.0), T(0.0), T(0.0)}, w = cut_direction(law, layer, F, e);
    if (val(weight) <= 0) return zero;
    T along;
    if (law.kind == BitKind::DRAG_BIT || chip_rate) {
        T rate;
        if (chip_rate) {
            rate = *chip_rate;
        } else {  // steady cutting: W = cut d + contact
            const T free = beyond(weight, law.contact) - beyond(weight, law.saturated);
            rate = free * forward(omega) * (1.0 / (law.cut * 2 * M_PI));
        }
        along = rate / dot(w, e);
        return w * along;
    }
    const T free = beyond(weight, layer[BitLayer::THRESHOLD]);
    if (val(free) <= 0) return zero;
    T scale = speed_factor(omega, layer[BitLayer::ROTARY_EXPONENT], law.reference_speed) * (free / weight) * layer[BitLayer::DRILLABILITY];
    if (layer[BitLayer::WEIGHT_EXPONENT] != 1) scale = scale * pow(free * (1.0 / law.reference_weight), layer[BitLayer::WEIGHT_EXPONENT] - 1.0);
    return w * scale;
}

// Rate of penetration where `drilled` metres are drilled: one layer goes over into the next.
template <class T>
inline Vec<T> rock_rate(const BitLaw& law, const T& drilled, const Vec<T>& F, const Vec<T>& e, const T& omega, const T* chip_rate) {
    int k = 0;
    while (k + 1 < law.count && val(drilled) >= law.layers[(k + 1) * BitLayer::COLUMNS + BitLayer::START]) ++k;
    Vec<T> v = layer_rate(law, law.layers + k * BitLayer::COLUMNS, F, e, omega, chip_rate);
    if (k > 0) {
        const T u = (drilled - law.layers[k * BitLayer::COLUMNS + BitLayer::START]) * (1.0 / law.width);
        if (val(u) < 1) {
            const T share = u * u * (3.0 - 2.0 * u);
            v = v * share + layer_rate(law, law.layers + (k - 1) * BitLayer::COLUMNS, F, e, omega, chip_rate) * (1.0 - share);
        }
    }
    return law.bit_axis != 0 ? e * dot(v, e) : v;
}

// Weight on bit [N], torque on bit [N m], rate of penetration [m/s], side force [N], stored energy [J], power into rock and heat [W], depth
// of the ellipsoid below the end [m], offset of its centre from the hole's axis [m], rate of penetration in space [m/s]; of the side: force on
// the bit without and with friction [N], couple about the ellipsoid's centre [N m].
DP_RECORD(BitResults, double weight, torque, rate, side, stored, dissipated, depth, offset; Vec<double> velocity, push, force, couple;)

// N: number of states of the profile, 0: none; PATTERN: the bottom has a pattern; CUTTING: the side gives way
template <int N, bool PATTERN, bool CUTTING>
struct Bit {
    static constexpr int D = 11 + N + CUTTING, NSPIN = 1;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{6, 3}};
    static OwnLaw* own_law(void* context) { return static_cast<BitLaw*>(context)->own ? static_cast<BitLaw*>(context)->own : static_cast<BitLaw*>(context)->rock; }
    enum { HOLE = 7, DRILLED = 10, CHIP = 11, OVERGAUGE = CHIP + N };
    DP_ENUM(Parameter,
        FACE, CENTRE,            // distances from the node [m]
        RADIUS, HALF,            // semi-axes a and c [m]
        STIFFNESS, SIDE,         // of bottom and side [N/m]
        CLEARANCE,               // radial, of the bit in its own hole [m]
        FRICTION, WALL,          // coefficients of bottom and side
        SLIP, DAMPING,           // [m/s]; c [s/m]
        END, AXIS = END + 3,     // 3 each: centre of the hole's end at the start [m], its direction
        MODE = AXIS + 3,         // BitMode
        AXIAL, SPIN, SHARE,      // imposed sliding [m/s], [rad/s]; share of the sideways push
        TORQUE0, TORQUE1,        // T = TORQUE0 + TORQUE1 W in statics [N m], [m]
        HELD, HOLD,              // 1: e, s are those of HOLD (4)
        ANGLE = HOLD + 4,        // spin angle phi0 from which a pattern counts [rad]
        GUIDED,                  // 1: friction of the side does not push the bit round the hole
        STRENGTH, RELAXATION, GAUGE,  // of a side that gives way: N_y [N], eta [N s/m], l_g [m]
        TURNED,                  // 3: displacement of the end as its direction turns [m]
        NP = TURNED + 3)

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T*, const S* p, void* context, T* r) {
        evaluate<T>(x, y, p, *static_cast<BitLaw*>(context), r, nullptr);
    }

    // contact force with the damping of the wall's law
    template <class T>
    static T damped(const T& elastic, const T& rate, double c) {
        if (c == 0) return elastic;
        const T a = 1.0 + rate * c, root = sqrt(a * a + CLIP * CLIP);
        return elastic * (val(a) > 0 ? 0.5 * (a + root) : (0.5 * CLIP * CLIP) / (root - a));
    }

    template <class T>
    static void evaluate(const T* x, const T* y, const double* p, BitLaw& law, T* r, BitResults* results) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        law.touching = 0;
        const bool moving = p[MODE] == BitMode::MOTION, held = p[HELD] != 0;
        const Vec<T> zero = {T(0.0), T(0.0), T(0.0)};
        const Tangent<T> t(vec(x + 3), vec(y + 3), vec(y + 3));
        const Vec<double> axis = vec(p + AXIS);
        const Vec<T> hole_speed = held ? zero : vec(y + HOLE);
        const Vec<T> speed = vec(y) + t.t1 * p[CENTRE];
        // depths below the surface first: their difference is exact
        const Vec<T> e = (vec(x) - vec(p + END)) + (t.t * p[CENTRE] - vec(x + HOLE) - vec(p + TURNED));
        const T omega = moving ? y[6] : T(p[SPIN]);
        const double a = p[RADIUS], c = p[HALF], squeeze = c * c - a * a;

        T strength = T(1.0);
        if (law.rock) {
            const T at[OwnRock::STATES] = {x[DRILLED] + law.start};
            T found[OwnRock::RESULTS];
            own_results(*law.rock, at, found);
            if (!law.rock->noting) strength = found[OwnRock::STRENGTH];
        }

        // bottom
        const T tilt = dot(t.t, axis), reach = sqrt(a * a + squeeze * tilt * tilt), axial = dot(e, axis);
        T depth = axial + reach - c, climb = T(0.0);  // climb: slope of the pattern by the angle [m/rad]
        if constexpr (PATTERN)
            if (moving) pattern(law, x[6] - p[ANGLE], depth, climb);
        const Vec<T> contact = (t.t * (squeeze * tilt) + a * a * axis) / reach;  // from the centre to where the ellipsoid touches
        const T sign = omega / sqrt(omega * omega + law.turn_rounding * law.turn_rounding);
        T advance = dot(speed - hole_speed, axis) + dot(t.t1, axis) * tilt * squeeze / reach;  // rate of depth
        if constexpr (PATTERN) advance += climb * omega;
        T closing_b = advance, depth_e = depth, weight = T(0.0), elastic = T(0.0), torque = T(0.0), chip_rate = T(0.0), grip = T(0.0);  // grip: size of the torque
        if (N > 0 && moving) {
            const T U = x[DRILLED] + depth, gap = U - x[CHIP];
            law.touching = !(val(gap) <= -RAMP);
            const T reach = onset_or_none(gap), sunk = onset_or_none(reach - law.exposure), chip = reach - sunk, cut = chip * law.blades;
            elastic = sunk * p[STIFFNESS];
            closing_b = y[DRILLED] + advance - y[CHIP];
            const T body = damped(elastic, closing_b, p[DAMPING]);
            const T down = dot(speed, axis), engaged = law.contact > 0 ? engagement(gap, law.onset) : T(0.0);
            const T flat = engaged * (0.5 * law.contact) * (1.0 + down / sqrt(down * down + law.rest * law.rest));
            weight = (cut * law.cut + flat) * strength + body;
            const T cutters = cut * law.torque_cut * cutting(omega) * strength, rubbing = (flat * strength + body) * law.rub;
            grip = cutters + rubbing;
            torque = cutters + rubbing * sign;
            depth_e = sunk;
            chip_rate = forward(omega) * cut * (1 / (2 * M_PI));
            profile(x, y, law, forward(omega), x[CHIP] + chip, r);
        } else if (!(val(depth) <= -RAMP)) {
            law.touching = 1;
            elastic = onset(depth) * p[STIFFNESS];
            weight = moving ? damped(elastic, advance, p[DAMPING]) : elastic;
            if (law.own) {
                const T state[OwnBit::STATES] = {weight, omega, x[6], dot(speed, axis), x[DRILLED] + law.start}, share = touching(depth);
                T found[OwnBit::RESULTS];
                own_results(*law.own, state, found);
                torque = found[OwnBit::TORQUE] * share;
                grip = found[OwnBit::GRIP] * share;
                chip_rate = found[OwnBit::RATE] * share;
            } else if (moving) bottom_torque(law, p, weight, strength, depth, omega, sign, grip, torque);
            else torque = steady_torque(law, p, weight, strength, depth) * direction(p);
        }
        Vec<T> sliding = zero, rub = zero;  // velocity of the face across the hole's axis, friction of the face against it
        if (moving && val(grip) > 0) {
            const Vec<T> face_speed = vec(y) + t.t1 * p[FACE];
            sliding = face_speed - axis * dot(face_speed, axis);
            const FaceFriction<T> face(sliding, omega, a, a * law.turn_rounding);
            torque = torque * face.share;
            rub = face.slide * (grip * (-1.5 / a));
        }
        if constexpr (PATTERN)
            if (moving) torque += climb * weight;  // the bit climbs its pattern: the power goes into weight and spring
        if (N > 0 && !moving)
            for (int k = 0; k < N; ++k) r[CHIP + k] = x[CHIP + k] * ROCK_ROW;  // at rest, before the first cut

        // side
        const Vec<T> across = e - axial * axis;
        const T rho = sqrt(dot(across, across) + WELL_RHO0 * WELL_RHO0);
        const Vec<T> n = across / rho;
        const bool guided = p[GUIDED] != 0, spring = guided && p[CLEARANCE] <= 0;  // spring: towards the axis
        const T lean = spring ? T(0.0) : dot(n, t.t), girth = sqrt(a * a + squeeze * lean * lean);
        T depth_s = rho + girth - (a + p[CLEARANCE]), closing = dot(speed - hole_speed, n) + dot(t.t1, n) * lean * squeeze / girth;
        if constexpr (CUTTING) {
            depth_s -= x[OVERGAUGE];
            closing -= y[OVERGAUGE];
        }
        T side = T(0.0), load = T(0.0), elastic_s = T(0.0);  // load: of the side, with friction
        Vec<T> push = zero, drag = zero;
        const Vec<T> touch = (n * (a * a) + t.t * (squeeze * lean)) / girth;
        if (p[SIDE] != 0 && !(val(depth_s) <= -RAMP)) {
            law.touching |= 2;
            elastic_s = (spring ? depth_s : onset(depth_s)) * p[SIDE];
            side = moving ? damped(elastic_s, closing, p[DAMPING]) : elastic_s;
            const Vec<T> around = cross(axis, n);
            load = spring ? side * offset_share(across, rho) : side;
            if (moving) {
                const Vec<T> rim = cross(cross(t.t, t.t1) + t.t * omega, touch), surface = speed + rim;
                const T va = dot(surface, axis), vb = dot(guided ? rim : surface, around), v2 = va * va + vb * vb;
                const T hold = -(load * p[WALL]) / sqrt(v2 + p[SLIP] * p[SLIP]);
                drag = push = (axis * va + around * vb) * hold;
                if (guided) push = axis * (va * hold);
            } else {
                const double vb = p[SPIN] * a, size = std::sqrt(p[AXIAL] * p[AXIAL] + vb * vb), share = size > 0 ? p[WALL] / size : 0.0;
                drag = (axis * (p[AXIAL] * share) + around * (vb * share)) * (-load);
                push = (axis * (p[AXIAL] * share) + around * (guided ? 0.0 : vb * share * p[SHARE])) * (-load);
            }
        }

        // the hole
        const Vec<T> on_rock = (axis * weight + n * side) / strength;  // a stronger rock is cut as fast by as many times the force
        Vec<T> rate = zero;
        const bool known = (N > 0 && moving) || law.own_rate != 0;
        if (p[MODE] != BitMode::STATICS) rate = rock_rate(law, x[DRILLED], on_rock, t.t, omega, known ? &chip_rate : nullptr);
        if (held || p[MODE] == BitMode::STATICS) {
            for (int i = 0; i < 4; ++i) r[HOLE + i] = (x[HOLE + i] - p[HOLD + i]) * (1e3 * ROCK_ROW);
        } else {
            r[HOLE] = (y[HOLE] - rate.x) * ROCK_ROW;
            r[HOLE + 1] = (y[HOLE + 1] - rate.y) * ROCK_ROW;
            r[HOLE + 2] = (y[HOLE + 2] - rate.z) * ROCK_ROW;
            r[DRILLED] = (y[DRILLED] - norm(rate)) * ROCK_ROW;
        }
        if constexpr (CUTTING) {
            const T over = side - p[STRENGTH], crushed = val(over) > 0 ? over / p[RELAXATION] : T(0.0);
            if (p[MODE] == BitMode::STATICS) r[OVERGAUGE] = x[OVERGAUGE] * (1e3 * ROCK_ROW);
            else r[OVERGAUGE] = (y[OVERGAUGE] - crushed + x[OVERGAUGE] * norm(rate) / p[GAUGE]) * ROCK_ROW;
        }

        // on the string: the bottom's force at its point, the side's at its own, the torque
        const Vec<T> bottom = axis * (-weight), wall = n * (-side) + push;
        const Vec<T> arm = t.t * p[CENTRE], F = bottom + wall;
        const Vec<T> M = cross(arm + contact, bottom) + cross(arm, wall) + cross(touch, n * (-side) + drag) + cross(t.t * p[FACE], rub);
        const Vec<T> bend = cross(M, t.t) / t.n, whole = F + rub;
        r[0] = -whole.x; r[1] = -whole.y; r[2] = -whole.z;
        r[3] = -bend.x; r[4] = -bend.y; r[5] = -bend.z;
        r[6] = torque - dot(M, t.t);
        if (results) {
            results->weight = val(weight * tilt);
            results->torque = val(r[6]);
            results->velocity = values(rate);
            results->rate = norm(results->velocity);
            results->side = val(load);
            results->push = values(n) * -val(side);
            results->force = values(wall);
            results->couple = values(cross(touch, n * (-side) + drag));
            results->stored = 0.5 * (val(elastic) * val(onset_or_none(depth_e)) + val(elastic_s) * val(spring ? depth_s : onset_or_none(depth_s)));
            // what the bit gives and the two springs do not store goes into rock and heat
            const Vec<T> turning = cross(t.t, t.t1) + t.t * omega, twist = cross(contact, bottom) + cross(touch, n * (-side) + drag);
            results->dissipated = val(torque * omega - dot(F, speed) - dot(rub, sliding) - dot(twist, turning) - elastic * closing_b - elastic_s * closing);
            results->depth = val(depth);
            results->offset = val(rho);
        }
    }

    template <class T>
    static T onset_or_none(const T& d) { return val(d) <= -RAMP ? T(0.0) : onset(d); }

    // Adds the height of the pattern at the angle psi to the depth, and gives its slope by the angle.
    template <class T>
    static void pattern(const BitLaw& law, const T& psi, T& depth, T& climb) {
        for (int k = 0; k < law.order_count; ++k) {
            const double* q = law.orders + k * BitOrder::COLUMNS;
            const T angle = psi * q[BitOrder::ORDER] + q[BitOrder::PHASE];
            depth += q[BitOrder::AMPLITUDE] * (sin(angle) - std::sin(q[BitOrder::PHASE]));
            climb += (q[BitOrder::ORDER] * q[BitOrder::AMPLITUDE]) * cos(angle);
        }
    }

    // smooth 0..1 as a gap closes over `width`
    template <class T>
    static T engagement(const T& gap, double width) {
        const T u = gap * (1.0 / width);
        if (val(u) <= 0) return T(0.0);
        return val(u) >= 1 ? T(1.0) : u * u * (3.0 - 2.0 * u);
    }

    // 1 from the moment at which the bit touches
    template <class T>
    static T touching(const T& depth) { return engagement(depth + RAMP, RAMP); }

    static double direction(const double* p) { return (p[SPIN] > 0) - (p[SPIN] < 0); }

    // torque or lever arm of a bit that turns, at a speed of either sign
    template <class T>
    static T fall(const BitLaw& law, const T& omega) {
        const T q = omega * (1.0 / law.speed);
        return law.dynamic_torque + (law.static_torque - law.dynamic_torque) * exp(-(q * q));
    }

    // the same with its sign, which is rounded below turn_rounding only (C2): a smooth sign over all speeds would lower the torque that a bit sticks with
    template <class T>
    static T weakening(const BitLaw& law, const T& omega) {
        const T u = omega * (1.0 / law.turn_rounding), u2 = u * u;
        if (val(u2) < 1) return fall(law, omega) * u * (15.0 - 10.0 * u2 + 3.0 * u2 * u2) * 0.125;
        return fall(law, omega) * (val(omega) > 0 ? 1.0 : -1.0);
    }

    // without a profile: linear in the weight, of which the body of a drag bit carries what the cutters cannot
    template <class T>
    static T steady_torque(const BitLaw& law, const double* p, const T& weight, const T& strength, const T& depth) {
        if (law.kind != BitKind::DRAG_BIT) return weight * p[TORQUE1] + p[TORQUE0] * touching(depth);
        const T share = weight / strength;
        return (share * p[TORQUE1] + p[TORQUE0] * touching(depth) - beyond(share, law.saturated) * (p[TORQUE1] - law.rub)) * strength;
    }

    // torque of a bit whose face does not slide, and its size without the rounding at standstill
    template <class T>
    static void bottom_torque(const BitLaw& law, const double* p, const T& weight, const T& strength, const T& depth, const T& omega, const T& sign, T& size, T& torque) {
        if (law.kind == BitKind::VELOCITY_WEAKENING) {
            const T load = law.by_weight != 0 ? weight : touching(depth);
            size = load * fall(law, omega);
            torque = load * weakening(law, omega);
            return;
        }
        if (law.kind == BitKind::DRAG_BIT) size = steady_torque(law, p, weight, strength, depth);
        else size = weight * (p[FRICTION] * p[RADIUS] * (2.0 / 3));
        torque = size * sign;
    }

    // rows of the rock's profile, carried along by the turning bit; `inflow` is what the blade ahead leaves
    template <class T>
    static void profile(const T* x, const T* y, const BitLaw& law, const T& turn, const T& inflow, T* r) {
        for (int k = 0; k < N; ++k) {
            const double* d = law.derivative + k * (N + 1);
            T slope = inflow * d[N];
            for (int j = 0; j < N; ++j) slope += x[CHIP + j] * d[j];
            r[CHIP + k] = (y[CHIP + k] - turn * slope) * ROCK_ROW;
        }
    }
};

// Results of n bits: out is a BitResults for each.
template <class Kernel>
void bit_results(int n, const int* idx, const double* par, void* context, const double* x, const double* y, double* out) {
    constexpr int D = Kernel::D;
    for (int e = 0; e < n; ++e) {
        double X[D], Y[D], R[D];
        for (int i = 0; i < D; ++i) { X[i] = x[idx[e * D + i]]; Y[i] = y[idx[e * D + i]]; }
        BitResults now{};
        Kernel::template evaluate<double>(X, Y, par + e * Kernel::NP, *static_cast<BitLaw*>(context), R, &now);
        reinterpret_cast<BitResults*>(out)[e] = now;
    }
}

#define DP_BIT_RESULTS(name, Kernel)                                                                                                               \
    extern "C" void name##_results(int n, int, const int* idx, const double* par, void* context, const double* x, const double* y, double* out) { \
        dp::entries_by_law<Kernel>(context, false, out, [&](double* to) { bit_results<Kernel>(n, idx, par, context, x, y, to); });                 \
    }

}  // namespace dp
