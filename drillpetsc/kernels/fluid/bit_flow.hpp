// The fluid at the lower end of the string: nozzles (one link with inertance), the mud under the bit, the jet's reaction.
//
//   nozzle   L_b q_b' + p_ub - p_i + rho0^2/rho q_b |q_b| / (2 C_d^2 A_n^2) = 0                       [Pa]
//   chamber  (V_ub/E) p_ub' + dV_ub/dt - q_b added to the mass row of the annulus' lowest node   [m3/s]
//   string   G v_jet, v_jet = V + w_j t; bore's exit, chamber and face of the bit as one control volume
// PIPE: there is a bore that ends in a link; ANNULUS: it ends in the mud of the hole, else in a pressure AMBIENT.
// GROW: the hole's end moves as it is drilled (its displacement and the metres drilled are unknowns of another component).  The chamber keeps
// volume V_0 + A_w gap about a bit that follows; rock of volume CUT per metre drilled goes into the mud, as if it were mud under its
// pressure: CUT = 0 where cuttings are removed, the hole's area where they are returned (then they fill just what they leave).
#pragma once
#include "fluid/flow.hpp"

namespace dp {

constexpr double FLOW_ROUNDING = 1e-5;  // rounds off q |q| at zero [m3/s]
constexpr double JET_ROUNDING = 0.025;  // speed v_0 that rounds off q |q| at zero [m/s]; a nozzle of any size keeps its law
constexpr double GAP_ROUNDING = 1e-3;   // distance over which a bit on bottom stops displacing mud [m]

template <class T> inline T softplus(const T& g) { return val(g) > 40 ? g : log(1.0 + exp(g)); }

// Pressure drop [Pa] of nozzles with LOSS 1/(2 C_d^2 A_n^2) [1/m4] and of a check valve that holds back flow with SHUT [Pa s/m3] (manual:
// eq-mud-check-valve); THIN rho0/rho where the flow leaves.
template <class T>
inline T nozzle_drop(const T& q, const T& thin, double density, double loss, double shut) {
    const T drop = q * sqrt(q * q + FLOW_ROUNDING * FLOW_ROUNDING) * thin * (loss * density);
    return val(q) < 0 ? T(drop + q * shut) : drop;
}

// INERTANCE L_b [kg/m4]; NOZZLE A_n [m2]; LOSS 1/(2 C_d^2 A_n^2) [1/m4], SHUT of the valve [Pa s/m3], 0: none; AMBIENT [Pa]; HOLE A_w [m2];
// VOLUME V_0 [m3]; ELASTIC 1/E [1/Pa]; FACE distance from the node to the face [m]; ADDED chi A_o, OPEN area of the annulus [m2]; BUOYANT
// volume of rigid items below the node [m3]; HELD_GAP distance between face and bottom where the string is held [m]; END, AXIS the hole's
// end (at the start, where it grows) and direction; TANGENT of the hole at the node; CUT [m2]; potential LIFT [J] of the chamber's mud when
// its content was REFERENCE [m3] and the node had the HEAD g.r [m2/s2], at the start of the step
#define DP_BIT_FLOW_PARAMETERS                                                                                                      \
    INERTANCE, NOZZLE, LOSS, SHUT, AMBIENT, HOLE, VOLUME, ELASTIC, FACE, ADDED, OPEN, BUOYANT, HELD_GAP, END, AXIS = END + 3, \
    TANGENT = AXIS + 3, CUT = TANGENT + 3, LIFT, REFERENCE, HEAD

// Power lost [W], flow through the nozzles [m3/s]; kinetic and stored energy [J], content [m3] and potential [J] of the chamber; cuttings that
// enter it [m3/s at zero pressure]; power that the bottom supplies with cuttings and with mud that moves across the hole, less the work of
// pressure on rock that gives way [W].
DP_RECORD(BitFlowResults, double lost, flow, kinetic, stored, content, potential, cuttings, bottom;)

// 1/(1 + exp(-z)); neither exponential overflows, whose derivative would be no number
template <class T>
inline T logistic(const T& z) {
    if (val(z) > 0) return 1.0 / (1.0 + exp(-z));
    const T e = exp(z);
    return e / (1.0 + e);
}

template <bool PIPE, bool ANNULUS, bool HELD, bool GROW = false>
struct BitFlow {
    static constexpr int B = HELD ? 0 : 7, PI = B, PA = PI + (PIPE ? 1 : 0), QA = PA + 1, QB = PA + (ANNULUS ? (HELD ? 1 : 2) : 0);
    static constexpr int MOVED = QB + (PIPE ? 1 : 0), DRILLED = MOVED + 3, D = MOVED + (GROW ? 4 : 0);
    static constexpr int NSPIN = 0;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter, DP_BIT_FLOW_PARAMETERS, NP)

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        evaluate<T, S>(x, y, a, p, *static_cast<const Fluid*>(context), r, nullptr);
    }

    template <class T, class S>
    static void evaluate(const T* x, const T* y, const T*, const S* p, const Fluid& f, T* r, BitFlowResults* results) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        Vec<T> F = {T(0.0), T(0.0), T(0.0)};
        const Vec<double> g = vec(f.gravity);
        T under = T(p[AMBIENT]);
        if constexpr (ANNULUS) under = x[PA];
        if constexpr (PIPE) {
            const T q = x[QB], thin = exp(under * (-f.compressibility)), loss = nozzle_drop(q, thin, f.density, p[LOSS], p[SHUT]);
            r[QB] = (y[QB] * p[INERTANCE] + under - x[PI] + loss) * MOMENTUM_ROW;
            r[PI] = q * MASS_ROW;
            if constexpr (!HELD) {
                const Tangent<T> t(vec(x + 3), vec(y + 3), vec(y + 3));
                F += (vec(y) + t.t * (q * thin / p[NOZZLE])) * (q * f.density);
            }
            // what leaves the system with the flow: loss, and the speed of the jet where it ends in the open
            if (results) { results->lost = val(loss * q) * std::exp(-0.5 * f.compressibility * val(x[PI] + under)); results->flow = val(q); results->kinetic = 0.5 * p[INERTANCE] * val(q) * val(q); }
        }
        if constexpr (ANNULUS) {
            const Compressed<T> c(f, x[PA], p[ELASTIC] - f.compressibility);
            T gap = T(p[HELD_GAP]), swept = T(0.0);
            if constexpr (!HELD) {
                const Tangent<T> t(vec(x + 3), vec(y + 3), vec(y + 3));
                const Vec<double> end = vec(p + END), axis = vec(p + AXIS);
                Vec<T> apart = end - vec(x) - t.t * p[FACE], parting = vec(y) + t.t1 * p[FACE];
                if constexpr (GROW) { apart += vec(x + MOVED); parting = parting - vec(y + MOVED); }
                gap = dot(apart, axis);
                const T open = logistic(gap * (1.0 / GAP_ROUNDING));
                swept = dot(parting, axis) * open * (-p[HOLE]);
                if (results) {  // pressure on the face of the bit does work that no mud gives up where a closed gap displaces none
                    double driven = val(dot(vec(y) + t.t1 * p[FACE], axis)) - val(open) * val(dot(parting, axis));
                    results->bottom = -val(x[PA]) * p[HOLE] * driven;
                }
                if constexpr (GROW) {
                    if (results) {
                        results->cuttings = val(c.theta) * p[CUT] * val(y[DRILLED]);
                        const double work = -std::expm1(-f.compressibility * val(x[PA])) / f.compressibility;  // as FluidConstants.enthalpy
                        results->bottom += results->cuttings * (work - f.density * val(dot(vec(x), g)));
                    }
                    swept -= y[DRILLED] * p[CUT];
                }
                const Vec<double> tw = vec(p + TANGENT);
                const T rate = x[QA] * f.density / (c.density * p[OPEN]), M = c.density * p[ADDED] * rate;
                const Vec<T> carried = (vec(y) + vec(x + 3) * rate) * M;
                const Vec<T> across = carried - tw * dot(carried, tw);
                F += across + g * (c.density * p[BUOYANT]);
                if (results) results->bottom -= val(dot(across, vec(y)));  // the mud that enters brings its momentum across the hole along
            }
            const T volume = p[VOLUME] + p[HOLE] * GAP_ROUNDING * softplus(gap * (1.0 / GAP_ROUNDING));
            r[PA] = (volume * c.by_p * y[PA] + c.theta * swept) * MASS_ROW;
            if constexpr (PIPE) r[PA] -= x[QB] * MASS_ROW;
            if (results) {
                results->stored = stored_energy(f, val(x[PA]), p[ELASTIC] - f.compressibility, val(volume));
                results->content = val(c.theta * volume);
                if constexpr (HELD)  // all at the bit, which does not move
                    results->potential = -results->content * f.density * dot(vec(p + END) - vec(p + AXIS) * (p[HELD_GAP] + p[FACE]), g);
                else {  // mud enters and leaves at the bit, from which the chamber has no drop of pressure; rigid items there displace mud
                    const double head = val(dot(vec(x), g));
                    results->potential = p[LIFT] - f.density * (results->content - p[REFERENCE]) * 0.5 * (head + p[HEAD]) +
                                         val(c.density) * p[BUOYANT] * (head - p[HEAD]);
                }
            }
        }
        if constexpr (!HELD) { r[0] += F.x; r[1] += F.y; r[2] += F.z; }
    }
};

// Where the string leaves the annulus: no mud presses on its section from above, which the virtual work of pressure along it takes for
// granted at both ends (an outlet under pressure pushes the string out: snubbing force p A_o).
struct AnnulusTop {
    static constexpr int D = 8, NSPIN = 0;  // r, v, phi, pressure
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter, OUTER, NP)  // area A_o [m2]
    template <class T, class S>
    static void force(int, const T* x, const T*, const T*, const S* p, void*, T* r) {
        const Vec<T> v = vec(x + 3), push = v * (x[7] * p[OUTER] / norm(v));
        r[0] = push.x; r[1] = push.y; r[2] = push.z;
        r[3] = r[4] = r[5] = r[6] = r[7] = T(0.0);
    }
};

// Flow rate that rounds off q |q| of a choke [m3/s]: v_0 C_d A of a small one; loss: 1/(2 C_d^2 A^2) [1/m4].
inline double choke_rounding(double loss) { return std::fmin(FLOW_ROUNDING, JET_ROUNDING / std::sqrt(2.0 * loss)); }

// Pressure that a valve at the flow line holds against the outflow -q, added to the row that gives the upper node of the annulus its pressure.
struct Choke {
    static constexpr int D = 2, NSPIN = 0;  // pressure of the upper node, flow rate of the first element
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter, LOSS, NP)  // 1/(2 C_d^2 A^2) [1/m4]
    template <class T, class S>
    static void force(int, const T* x, const T*, const T*, const S* p, void* context, T* r) {
        const Fluid& f = *static_cast<const Fluid*>(context);
        const double slow = choke_rounding(p[LOSS]);
        r[0] = x[1] * sqrt(x[1] * x[1] + slow * slow) * (p[LOSS] * f.density * GIVEN_PRESSURE * MASS_ROW);
        r[1] = T(0.0);
    }
};

// The same where the string moves: the hole between the upper node and the fixed flow line takes AREA V of the flow out of the node.
struct MovingChoke {
    static constexpr int D = 9, NSPIN = 0;  // r, v, phi and pressure of the upper node, flow rate of the first element
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter, LOSS, AREA, DIRECTION, NP = DIRECTION + 3)  // [1/m4], of the annulus [m2], of the hole, downwards
    template <class T, class S>
    static void force(int, const T* x, const T* y, const T*, const S* p, void* context, T* r) {
        const Fluid& f = *static_cast<const Fluid*>(context);
        const T in = x[8] + (y[0] * p[DIRECTION] + y[1] * p[DIRECTION + 1] + y[2] * p[DIRECTION + 2]) * p[AREA];
        for (int k = 0; k < D; k++) r[k] = T(0.0);
        const double slow = choke_rounding(p[LOSS]);
        r[7] = in * sqrt(in * in + slow * slow) * (p[LOSS] * f.density * GIVEN_PRESSURE * MASS_ROW);
    }
};

// Mud that takes the place of the rock of a reamed ring, or rock that becomes mud.
struct ReamedRing {
    static constexpr int D = 2, NSPIN = 0;  // pressure at the reamer, metres reamed
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter, RING, NP)  // volume that the mud gains per metre reamed [m2], negative: rock that it takes up
    template <class T, class S>
    static void force(int, const T* x, const T* y, const T*, const S* p, void* context, T* r) {
        const Fluid& f = *static_cast<const Fluid*>(context);
        r[0] = y[1] * exp(x[0] * f.compressibility) * (p[RING] * MASS_ROW);
        r[1] = T(0.0);
    }
};

// Flow rate that a pump delivers into the bore.
struct Pump {
    static constexpr int D = 1, NSPIN = 0;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter, FLOW, NP)  // [m3/s]
    template <class T, class S>
    static void force(int, const T*, const T*, const T*, const S* p, void*, T* r) { r[0] = T(-MASS_ROW * p[FLOW]); }
};

}  // namespace dp
