// The channels across a joint of the string, and the seals of a telescoping joint (manual: sec-mud-joints).
//
// A joint is a cell without length between two nodes at the same place: A above and B below.  A rigid arm (RIGID) may lie between A and
// the joint; the travel of a telescoping joint lies between the arm's end and B.
//   bore     mud of the arm as one piece; between the nodes the pressure falls by weight, inertia, friction and losses
//   annulus  the hole between the nodes, less the arm; buoyancy of the arm
//   seal     sealed area A_s: parts that move apart by x draw A_s x into the bore and push as much out of the annulus; the pressures
//            do as much work by the force (p_i - p_o) A_s, which pushes the parts apart
// Storage of the seal and its pressures belong to node B.  The mud that the travel holds has weight but no inertia of its own.
#pragma once
#include "fluid/annulus_flow.hpp"
#include "fluid/bore_flow.hpp"

namespace dp {

// Motion of a joint's cell: the arm from node A to its end E, the travel from there to node B.
template <class T>
struct ArmRide {
    Vec<T> rA, rE, rB, vA, vE, vB, aA, aE, aB, t;
    T n;
    template <class S>
    ArmRide(const T* x, const T* y, const T* a, const S& arm) {
        const Tangent<T> q(vec(x + 3), vec(y + 3), vec(a + 3));
        t = q.t; n = q.n;
        rA = vec(x); vA = vec(y); aA = vec(a);
        rE = rA + t * arm; vE = vA + q.t1 * arm; aE = aA + q.t2 * arm;
        rB = vec(x + 7); vB = vec(y + 7); aB = vec(a + 7);
    }
    // rows of forces at A, at the arm's end and at B
    template <class S>
    void store(const Vec<T>& FA, const Vec<T>& FE, const Vec<T>& FB, const S& arm, T* r) const {
        const Vec<T> sum = FA + FE, bend = (FE - t * dot(t, FE)) * (arm / n);
        r[0] = sum.x; r[1] = sum.y; r[2] = sum.z; r[3] = bend.x; r[4] = bend.y; r[5] = bend.z;
        r[7] = FB.x; r[8] = FB.y; r[9] = FB.z;
        r[6] = r[10] = r[11] = r[12] = r[13] = T(0.0);
    }
};

// Parameters and unknowns are those of the bore of an element.
struct BoreJoint : BoreFlow<false, false> {
    static constexpr bool PACKED = true;

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        evaluate<false, T, S>(x, y, a, p, *static_cast<const Fluid*>(context), r, nullptr);
    }

    template <bool RESULTS, class T, class S>
    static void evaluate(const T* x, const T* y, const T* a, const S* p, const Fluid& f, T* r, FlowResultsOf<T>* results) {
        const T p1 = x[F], p2 = x[F + 1], q = x[F + 2], flow = y[F + 2], mean = (p1 + p2) * 0.5;
        const S arm = p[RIGID];
        const Compressed<T> c(f, mean, p[WALL]);
        const Vec<double> g = vec(f.gravity);
        const ArmRide<T> on(x, y, a, arm);
        const Vec<T> rod = on.rE - on.rA, gap = on.rB - on.rE;
        const T open = c.density * (1.0 / f.density) * p[AREA_ABOVE], line = c.density * p[AREA_ABOVE], half = line * arm * 0.5;
        const T G = q * f.density, G1 = flow * f.density, w = q / open;
        // momentum of the mud that passes: it enters with the node above and leaves with the one below
        const Vec<T> turn = rod * (G1 * 0.5), over = gap * (G1 * 0.5), jet = on.t * (G * w);
        on.store((on.aA - g) * half + turn + on.vE * G + jet, (on.aE - g) * half + turn + over + (on.vB - on.vA) * G, over - on.vE * G - jet, arm, r);
        const T resistance = shear(f, w, c.density, p[DIAMETER_ABOVE], 0.0) * (arm * 4.0 / p[DIAMETER_ABOVE]);
        const T mass = c.density * arm / open, inertia = c.density * (dot(rod, on.aA + on.aE) + dot(gap, on.aE + on.aB)) * 0.5;
        const T size = sqrt(q * q + 1e-20), heads = q * (q * p[STEP] + size * p[LOSS]) * (f.density * f.density) / c.density;
        const T volume = T(0.0) + p[AREA_ABOVE] * arm, stored = c.by_p * volume * (1.0 / 12);
        const T s1 = stored * (y[F] * 5.0 + y[F + 1]), s2 = stored * (y[F + 1] * 5.0 + y[F]);
        const S free = S(1.0) - p[CONTROL];
        r[F] = ((s1 + q) * free + (p1 - p[CONTROLLED]) * (p[CONTROL] * GIVEN_PRESSURE)) * MASS_ROW;
        r[F + 1] = (s2 - q) * MASS_ROW;
        r[F + 2] = (mass * flow + inertia - c.density * dot(on.rB - on.rA, g) + p2 - p1 + resistance + heads) * MOMENTUM_ROW;
        if constexpr (RESULTS) {
            const T lost = q * (f.density / c.density);
            results->stored = stored_energy(f, mean, p[WALL], volume);
            results->dissipated = lost * (resistance + q * size * p[LOSS] * f.density * f.density / c.density);
            results->content = c.theta * volume; results->storage_upper = s1; results->storage_lower = s2;
            results->speed = w; results->density = c.density;
            results->kinetic = half * 0.5 * (dot(on.vA, on.vA) + dot(on.vE, on.vE)) + 0.5 * mass * q * lost;
            results->kinetic += G * 0.5 * (dot(rod, on.vA + on.vE) + dot(gap, on.vE + on.vB));
            results->potential = -(half * dot(on.rA + on.rE, g));
            results->left_out = dot(jet, on.vB - on.vA);  // the mud of the travel takes up no kinetic energy
        }
    }
};

// Parameters and unknowns are those of the annulus about an element; OUTER_ABOVE is zero without an arm.
struct AnnulusJoint : AnnulusFlow<false, false> {
    static constexpr bool PACKED = true;

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        evaluate<false, T, S>(x, y, a, p, *static_cast<const Fluid*>(context), r, nullptr);
    }

    template <bool RESULTS, class T, class S>
    static void evaluate(const T* x, const T* y, const T* a, const S* p, const Fluid& f, T* r, FlowResultsOf<T>* results) {
        const T p1 = x[F], p2 = x[F + 1], q = x[F + 2], flow = y[F + 2], mean = (p1 + p2) * 0.5;
        const S arm = p[RIGID], AO = p[OUTER_ABOVE], AW = p[HOLE];
        const Compressed<T> c(f, mean, p[WALL]);
        const Vec<S> sum = vec(p + TANGENT1) + vec(p + TANGENT2), tw = sum * (S(1.0) / norm(sum));
        const Vec<double> g = vec(f.gravity);
        const S gw = dot(g, tw);
        const Vec<S> side = g - tw * gw;
        const ArmRide<T> on(x, y, a, arm);
        const T way = dot(on.rB - on.rA, tw), gap = dot(on.rB - on.rE, tw), rod_rate = dot(on.vE - on.vA, tw), gap_rate = dot(on.vB - on.vE, tw);
        const T V = dot(on.vA + on.vE, tw) * 0.5, V1 = dot(on.aA + on.aE, tw) * 0.5;
        const T open = c.density * (1.0 / f.density) * (AW - AO), w = q / open, volume = way * AW - AO * arm;
        const T tau = shear(f, w + V * (1.0 - f.clinging), c.density, p[GAP_ABOVE], 1.0), resistance = tau * (arm * 4.0 / p[GAP_ABOVE]);
        const T pull = tau * (arm * 3.14159265358979324) * sqrt(AO * (4.0 / 3.14159265358979324));
        // the arm's buoyancy along and across the hole and wall friction, half at either of its ends
        const T along = (p2 - p1 - c.density * gw * gap) * (AO * 0.5) - pull * 0.5;
        const T displaced = c.density * (AO * arm * 0.5);
        const Vec<T> push = tw * along + side * displaced, none = {T(0.0), T(0.0), T(0.0)};
        on.store(push + tw * shoulders(q, c, p, f), push, none, arm, r);
        const T mass = c.density * arm / open;
        const T momentum = mass * flow + c.density * arm * V1 - c.density * gw * way + resistance;
        const T swept1 = (rod_rate * AW + V * (p[WIDENING] * arm)) * 0.5, swept2 = swept1 + gap_rate * AW;
        const T head = dot(on.rA, tw) * (gw * f.density);
        rows<RESULTS>(x, y, c, p, f, volume, swept1 * c.theta, swept2 * c.theta, head + p[CONTROLLED], q, momentum, r, results);
        if constexpr (RESULTS) {
            const T wall = w + V, middle = dot(on.rA + on.rE, tw) * 0.5, below = dot(on.rB, tw), carried = q * (f.density / c.density);
            const T across = dot(on.rA + on.rE, side) * 0.5, travel = gap * AW;
            results->kinetic = 0.5 * c.density * (AW - AO) * arm * wall * wall;
            results->potential = -c.density * ((volume - travel) * (gw * middle + p[LEVEL]) + travel * (gw * below + p[LEVEL])) + displaced * 2.0 * (across - p[LEVEL]);
            results->dissipated += resistance * (carried + V * (AW - AO)) - pull * V;
            results->left_out = T(0.0);
            results->speed = w;
        }
    }
};

// A joint without an arm takes a share of the flow's inertia from the element above it.  Without inertia its flow rate would answer a jump of
// the pressure by an impulse (an unknown of index 2).  Unknowns: flow rates of the element above and of the joint.
struct JointInertia {
    static constexpr int D = 2, NSPIN = 0;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter, INERTIA, NP)  // pressure over rate of flow [kg/m4]

    template <class T, class S>
    static void force(int, const T*, const T* y, const T*, const S* p, void*, T* r) {
        r[0] = y[0] * (-p[INERTIA] * MOMENTUM_ROW);
        r[1] = y[1] * (p[INERTIA] * MOMENTUM_ROW);
    }
};

// Energy [J], volumes [m3] and their rates [m3/s] that the seals of a joint move, at zero pressure; force apart [N] and travel [m].
DP_RECORD(SealResults, double stored, potential, bore_content, annulus_content, push, travel;)

// Seals of a telescoping joint.  BORE, ANNULUS: there is mud inside, outside; else the pressure there is zero.
template <bool BORE, bool ANNULUS>
struct JointSeal {
    static constexpr int PI = 14, PO = 14 + (BORE ? 1 : 0), D = PO + (ANNULUS ? 1 : 0), NSPIN = 0;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter,
        RIGID, AREA,  // length of the arm [m], sealed area A_s [m2]
        AMBIENT,      // pressure outside a string without an annulus [Pa]
        NP)

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        evaluate<T, S>(x, y, a, p, *static_cast<const Fluid*>(context), r, nullptr);
    }

    template <class T, class S>
    static void evaluate(const T* x, const T* y, const T*, const S* p, const Fluid& f, T* r, SealResults* results) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        const Vec<double> g = vec(f.gravity);
        const Tangent<T> t(vec(x + 3), vec(y + 3), vec(y + 3));
        const Vec<T> rod = vec(x + 7) - vec(x), rod_rate = vec(y + 7) - vec(y);
        const T along = dot(t.t, rod), travel = along - p[RIGID], speed = dot(t.t1, rod) + dot(t.t, rod_rate);
        const double A = p[AREA];
        T apart = T(0.0), weight = T(0.0);
        if constexpr (BORE) {
            const Compressed<T> c(f, x[PI], 0.0);
            apart += x[PI];
            r[PI] = (c.theta * speed + c.by_p * travel * y[PI]) * (A * MASS_ROW);
            weight += c.density * travel * A;
            if (results) {
                results->bore_content = val(c.theta * travel) * A;
                results->stored += stored_energy(f, val(x[PI]), 0.0, val(travel) * A);
            }
        }
        if constexpr (ANNULUS) {
            const Compressed<T> c(f, x[PO], 0.0);
            apart -= x[PO];
            r[PO] = (c.theta * speed + c.by_p * travel * y[PO]) * (-A * MASS_ROW);
            weight -= c.density * travel * A;
            if (results) {
                results->annulus_content = -val(c.theta * travel) * A;
                results->stored -= stored_energy(f, val(x[PO]), 0.0, val(travel) * A);
            }
        } else {
            apart -= p[AMBIENT];
        }
        const T push = apart * A;
        const Vec<T> F = t.t * push, bend = (rod - t.t * along) * (push / t.n), G = g * weight;
        r[0] = F.x; r[1] = F.y; r[2] = F.z;
        r[3] = -bend.x; r[4] = -bend.y; r[5] = -bend.z;
        r[7] = -F.x - G.x; r[8] = -F.y - G.y; r[9] = -F.z - G.z;
        if (results) {
            results->potential = -val(weight) * dot(Vec<double>{val(x[7]), val(x[8]), val(x[9])}, g);
            results->push = val(push);
            results->travel = val(travel);
        }
    }
};

}  // namespace dp
