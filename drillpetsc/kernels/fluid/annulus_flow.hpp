// Flow between string and hole, along the hole; its reaction on the string: pressure, buoyancy, confined added mass, drag.
//
// t_w: tangent of the hole, linear between the element's ends; P = I - t_w t_w^T with the mean one.  Content per reference length
// mu = theta (A_w lam_w - A_o f(lam)), lam_w = r_s.t_w, f as in fluid/bore_flow.hpp: what the string gives way by, the mud takes.
//   string  int dr_s.(p A_o f' t) ds + int dr.[A_o p_s t_w + rho A_o (P g - w^2 kappa)] ds
//         + int dr.P [M_a (V_t + c_t r_s + c V_s) + k_v V + k_f (V + c r_s)] ds - int dr_s.P M_a c (V + c r_s) ds - int dr.t_w tau pi D_o ds
// M_a = chi rho A_o lam_w, c = w/lam_w (added momentum of a slender body: Lighthill, J. Fluid Mech. 9:305, 1960; the confined form of Paidoussis).
// Where the string turns, the mud swirls at the rate W about the hole, and the forces across it are those of the motion relative to the
// swirl; their moment about the hole's axis, times the mud's share l of the spin, brakes the spin (manual: sec-mud-swirl).
#pragma once
#include "fluid/flow.hpp"

namespace dp {

constexpr double SLOWEST = 1e-3;  // flow speed below which the drag across the pipe by the axial flow fades [m/s]

// Stresses of the flow past a string whose tool joints have a share of its length, tube and tool joints in series: `loss`, times 4/gap of
// the tube, is the loss per length; `pull`, times pi D_o, the force on the string along the hole, with that on the shoulders of the tool joints;
// `drag`, times pi D_o, the damping across the hole [N s/m3].
template <class T> struct StringShear { T loss, pull, drag; };

// w: speed in the mean area, relative to the string; drift: what the motion of the string adds to it at its wall; sheared: their sum.
template <class At, class T, class S>
inline StringShear<T> string_shear(const Fluid& f, const T& w, const T& sheared, const T& drift, const T& density, const S* p) {
    const auto by_speed = [](const T& tau, const T& speed) -> T { return tau * speed / (speed * speed + SLOWEST * SLOWEST); };
    if (!has_joints(p[At::JOINT_SHARE])) {
        const T tau = shear(f, sheared, density, p[At::GAP], 1.0);
        return {tau, tau, by_speed(tau, sheared)};
    }
    const T u = w * p[At::TUBE_SPEED] + drift, v = w * p[At::JOINT_SPEED] + drift;
    const T tube = shear(f, u, density, p[At::GAP], 1.0), joint = shear(f, v, density, p[At::JOINT_GAP], 1.0);
    return {tube * (S(1.0) - p[At::JOINT_SHARE]) + joint * (p[At::JOINT_SHARE] * p[At::GAP] / p[At::JOINT_GAP]),
            tube * p[At::TUBE_PULL] + joint * p[At::JOINT_PULL], by_speed(tube, u) * p[At::TUBE_PULL] + by_speed(joint, v) * p[At::JOINT_PULL]};
}

// Motion across the hole that the swirl of the mud changes: offset y of the string from the hole's axis, and J y = t_w x y.
template <class T> struct Offset {
    Four<T> y, turned;
    template <class S, class X>
    Offset(const X& x, const S* axis1, const S* axis2, const Vec<S>& tw1, const Vec<S>& tw2, const Vec<S>& tw) {
        const auto cut = [&tw](const Vec<T>& u) -> Vec<T> { return u - tw * dot(u, tw); };
        y = {cut(x.r1 - vec(axis1)), cut(x.v1 - tw1), cut(x.r2 - vec(axis2)), cut(x.v2 - tw2)};
        turned = turn(tw, y);
    }
    template <class S>
    static Four<T> turn(const Vec<S>& tw, const Four<T>& u) { return {cross(tw, u.r1), cross(tw, u.v1), cross(tw, u.r2), cross(tw, u.v2)}; }
};
template <class T> inline T pair(const Four<T>& u, const Four<T>& v) { return dot(u.r1, v.r1) + dot(u.v1, v.v1) + dot(u.r2, v.r2) + dot(u.v2, v.v2); }

// whether the mud about an element, or about one of several, swirls
inline bool swirls(double share) { return share != 0.0; }
inline bool swirls(const Pack& share) { return share.v[0] != 0.0 || share.v[1] != 0.0 || share.v[2] != 0.0 || share.v[3] != 0.0; }

// Added mass over displaced mass of a string aside in its hole: chi = k_0/r + k_1 + k_2 r + k_3 r^2 + k_4 r^3 with r^2 = h + 1 - e^2, e the offset of
// the element's middle over the clearance, h a rounding: 1 - e^2 ends at 0 smoothly; and its gradient by the offset [1/m] (manual: eq-mud-chi-place).
constexpr double CHI_ROUNDING = 0.01;
template <class T> struct AddedMassAside {
    T chi;
    Vec<T> gradient;
    template <class S>
    AddedMassAside(const Four<T>& y, const S& L, const S* k, const S& clearance) {
        const Vec<T> e = ((y.r1 + y.r2) * 0.5 + (y.v1 - y.v2) * (L * 0.125)) * (S(1.0) / clearance);
        const T z = 1.0 - dot(e, e), root = sqrt(z * z + 4.0 * CHI_ROUNDING * CHI_ROUNDING), open = (z + root) * 0.5, r = sqrt(open + CHI_ROUNDING);
        chi = k[0] / r + k[1] + r * (k[2] + r * (k[3] + r * k[4]));
        gradient = e * ((k[2] + r * (2.0 * k[3] + r * (3.0 * k[4])) - k[0] / (r * r)) * open / (r * root) * (S(-1.0) / clearance));
    }
    // by the unknowns of the element
    template <class S>
    Four<T> on_nodes(const S& L) const {
        const Vec<T> arm = gradient * (L * 0.125);
        return {gradient * 0.5, arm, gradient * 0.5, -arm};
    }
};

template <bool JUNCTION, bool HELD, bool ASIDE = false>
struct AnnulusFlow {
    static constexpr int F = HELD ? 0 : JUNCTION ? 15 : 14, D = F + 3, NSPIN = HELD ? 0 : 2;
    static constexpr bool PACKED = true;
    static constexpr int SPINS[2][2] = {{6, 3}, {13, 10}};  // the drag on the turning string
    DP_ENUM(Parameter,
        LENGTH, RIGID,             // of the element and of the rigid item above it [m]
        POISSON,                   // 0: the string does not narrow by stretch
        OUTER, HOLE,               // areas A_o, A_w [m2]
        OUTER_ABOVE, HOLE_ABOVE,   // those of the rigid item and of the hole around it [m2]
        WALL,                      // d(ln A)/dp [1/Pa]
        DIAMETER, GAP, GAP_ABOVE,  // D_o; D_w less the tube's diameter; the gap about the rigid item [m]
        JOINT_SHARE, JOINT_GAP,    // share of the length that tool joints have; D_w less their diameter [m]
        TUBE_SPEED, JOINT_SPEED,   // mean area of the flow over that about the tube, about the tool joints
        TUBE_PULL, JOINT_PULL,     // force along the string per pi D_o and stress at the tube, at the tool joints
        CHI, DAMPING, TURNING,     // added mass / (rho A_o); k_v [N s/m2]; drag torque per length and spin [N s]
        STEP, LOSS,                // as in fluid/bore_flow.hpp
        SHOULDER,                  // lift by the string's shoulders at the upper end, over rho q^2 [1/m2]
        CONTROL, CONTROLLED,       // CONTROL 1: the upper node has the pressure CONTROLLED + rho0 ((g.t_w)(t_w.r) + LEVEL) [Pa]
        DROP,                      // as in fluid/bore_flow.hpp
        TANGENT1, TANGENT2 = TANGENT1 + 3, BEND = TANGENT2 + 3,  // 3 each: directions of the hole at both ends, its curvature [1/m]
        HEAD = BEND + 3,           // as in fluid/bore_flow.hpp
        LEVEL,                     // (g - t_w t_w.g).c at a point c of the hole's axis, for the height of the mud [m2/s2]
        WIDENING,                  // dA_w per metre that the element moves down the hole [m]: HOLE is the area when the hole was read
        PLACE1, PLACE2,            // t_w.r of both nodes when the hole was read there [m]
        EXCESS1, EXCESS2,          // area of the hole at the nodes less HOLE [m2]
        MOMENT,                    // of the hole beside the element about its middle, along the hole, when it was read [m4]
        BENT,                      // length of the hole between the nodes less r_s.t_w L, where both nodes were at the origin [m]
        SHARE,                     // swirl of the mud over the spin of the string, when steady [-]; 0: the mud does not swirl, and SWIRL and SWIRL_RATE are 0
        SWIRL, SWIRL_RATE,         // swirl of the mud [rad/s] and its rate [rad/s2]
        SPIN_RATE,                 // rate of the string's spin, for the energies [rad/s2]
        AXIS1, AXIS2 = AXIS1 + 3,  // 3 each: points of the hole's axis beside the nodes [m]
        CHI_BY = AXIS2 + 3,        // 5: chi by the place of the string in its hole (AddedMassAside), where ASIDE
        CLEARANCE = CHI_BY + 5,    // of the string in its hole [m]
        TANGENT0,                  // 3: direction of the hole at the upper end of the rigid item above
        LEVEL_ABOVE = TANGENT0 + 3,  // LEVEL of the hole beside that item [m2/s2]
        NP)

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        evaluate<false, T, S>(x, y, a, p, *static_cast<const Fluid*>(context), r, nullptr);
    }

    template <bool RESULTS, class T, class S>
    static void evaluate(const T* x, const T* y, const T* a, const S* p, const Fluid& f, T* r, FlowResultsOf<T>* results) {
        const T p1 = x[F], p2 = x[F + 1], q = x[F + 2], flow = y[F + 2], mean = (p1 + p2) * 0.5;
        const S L = p[LENGTH];
        const Compressed<T> c(f, mean, p[WALL]);
        if constexpr (HELD) {
            const T content = T(1.0) * (p[HOLE] - p[OUTER]), area = c.density * content * (1.0 / f.density), w = q / area;
            const T resistance = string_shear<AnnulusFlow>(f, w, w, T(0.0), c.density, p).loss * (L * 4.0 / p[GAP]), mass = c.density * L / area;
            rows<RESULTS>(x, y, c, p, f, content * L, T(0.0), T(0.0), p[CONTROLLED], q, mass * flow - c.density * p[DROP] + resistance, r, results);
            if constexpr (RESULTS) {
                results->dissipated += q * (f.density / c.density) * resistance;
                results->kinetic = 0.5 * mass * q * q * (f.density / c.density);
                results->speed = w;
                results->potential = -(c.theta * content) * f.density * p[LENGTH] * p[HEAD];
                // as in fluid/bore_flow.hpp
                results->left_out = -(w * w * f.density) * ((results->storage_upper + results->storage_lower) * 1.5 + q * (x[F + 1] - x[F]) * f.compressibility)
                    - results->kinetic * ((y[F] + y[F + 1]) * (0.5 * f.compressibility));
            }
        } else {
            const Ride<T, JUNCTION> on(x, y, a, p[RIGID]);
            moving<RESULTS>(on, x, y, a, c, p, f, p1, p2, q, flow, r, results);
        }
    }

    // mass and momentum rows; swept1, swept2: what the motion of the string adds to the content at the ends [m3/s]
    template <bool RESULTS, class T, class S, class C>
    static void rows(const T* x, const T* y, const Compressed<T>& c, const S* p, const Fluid& f, const T& volume, const T& swept1, const T& swept2,
                     const C& controlled, const T& q, const T& momentum, T* r, FlowResultsOf<T>* results) {
        const T size = sqrt(q * q + 1e-20), heads = q * (q * p[STEP] + size * p[LOSS]) * (f.density * f.density) / c.density;
        const T stored = c.by_p * volume * (1.0 / 12);
        const T s1 = stored * (y[F] * 5.0 + y[F + 1]) + swept1, s2 = stored * (y[F + 1] * 5.0 + y[F]) + swept2;
        const S free = S(1.0) - p[CONTROL];
        r[F] = ((s1 + q) * free + (x[F] - controlled) * (p[CONTROL] * GIVEN_PRESSURE)) * MASS_ROW;
        r[F + 1] = (s2 - q) * MASS_ROW;
        r[F + 2] = (momentum + x[F + 1] - x[F] + heads) * MOMENTUM_ROW;
        if constexpr (RESULTS) {
            results->stored = stored_energy(f, (x[F] + x[F + 1]) * 0.5, p[WALL], volume);
            results->dissipated = q * (f.density / c.density) * (q * size * p[LOSS]) * f.density * f.density / c.density;
            results->content = c.theta * volume; results->storage_upper = s1; results->storage_lower = s2; results->density = c.density;
        }
    }

    // The mud beside the rigid item above the element, which has the flow of the element and the item's own direction in the hole.  It passes the
    // pressure of its own weight, inertia and friction on to the item, whatever the pressures at the element below do; wall friction pulls the
    // item along.  Its forces act at the item's middle (manual: sec-mud-force-annulus).
    template <class T>
    struct Beside {
        T open, height, V, pushed, resistance, rise, pull;  // open area [m2]; height of the upper node [m2/s2]; speed of the item along the hole
        Vec<T> force;  // pushed: pressure of weight and inertia, without that of the flow's rate; rise: pressure at the lower end less that at
                       // the upper one [Pa]; pull: against the hole's direction; force: row on the string [N]
        Beside() : open(0.0), height(0.0), V(0.0), pushed(0.0), resistance(0.0), rise(0.0), pull(0.0) {}
        template <class R, class S>
        Beside(const R& on, const T* y, const T* a, const Compressed<T>& c, const S* p, const Fluid& f, const T& q, const T& flow) {
            const Vec<S> sum = vec(p + TANGENT0) + vec(p + TANGENT1), along = sum * (S(1.0) / norm(sum));
            const S down = dot(vec(f.gravity), along);
            height = dot(on.above, along) * down + p[LEVEL_ABOVE];
            V = dot(vec(y) + on.y.r1, along) * 0.5;
            open = c.density * (1.0 / f.density) * (p[HOLE_ABOVE] - p[OUTER_ABOVE]);
            const T tau = shear(f, q / open + V * (1.0 - f.clinging), c.density, p[GAP_ABOVE], 1.0);
            resistance = tau * (p[RIGID] * 4.0 / p[GAP_ABOVE]);
            pushed = c.density * (dot(on.x.r1 - on.above, along) * down - dot(vec(a) + on.a.r1, along) * (p[RIGID] * 0.5));
            rise = pushed - flow * (c.density * p[RIGID] / open) - resistance;
            pull = tau * (p[RIGID] * 3.14159265358979324) * sqrt(p[OUTER_ABOVE] * (4.0 / 3.14159265358979324));
            force = along * (rise * p[OUTER_ABOVE] - pull) + (vec(f.gravity) - along * down) * (c.density * p[OUTER_ABOVE] * p[RIGID]);
        }
    };

    // Lift by shoulders of the string [N] (manual: eq-mud-shoulder).
    template <class T, class S>
    static T shoulders(const T& q, const Compressed<T>& c, const S* p, const Fluid& f) { return q * q * (p[SHOULDER] * (f.density * f.density)) / c.density; }

    template <bool RESULTS, class R, class T, class S>
    static void moving(const R& on, const T* x, const T* y, const T* a, const Compressed<T>& c, const S* p, const Fluid& f, const T& p1, const T& p2, const T& q,
                       const T& flow, T* r, FlowResultsOf<T>* results) {
        const S L = p[LENGTH], il = S(1.0) / L, AO = p[OUTER], AW = p[HOLE];
        const Vec<S> tw1 = vec(p + TANGENT1), tw2 = vec(p + TANGENT2), sum = tw1 + tw2, tw = sum * (S(1.0) / norm(sum));
        const Vec<double> g = vec(f.gravity);
        const Vec<T> d = on.x.r2 - on.x.r1, d_rate = on.y.r2 - on.y.r1, zero = {T(0.0), T(0.0), T(0.0)};
        const S gw = dot(g, tw);
        Vec<T> Qd = zero, Q1 = zero, Q2 = zero;
        T content = dot(d, tw) * (AW * il), outer = T(0.0), swept1 = T(0.0), swept2 = T(0.0);
        const T lam = dot(d, tw) * il;
        for (int k = 0; k < 3; ++k) {
            const Shape<T, S> N(XI3[k], il);
            const Vec<T> slope = N.slope(d, on.x.v1, on.x.v2), slope_rate = N.slope(d_rate, on.y.v1, on.y.v2);
            const T n = norm(slope), bulge = 1.0 - (n * 2.0 - 1.0) * (p[POISSON] * 2.0);
            const Vec<T> t = slope / n;
            const T section = (1.0 - (n - 1.0) * (p[POISSON] * 2.0)) * (AO * W3[k]);
            outer += section;
            content -= n * section;
            const T swept = dot(slope_rate, tw) * AW - bulge * dot(t, slope_rate) * AO;
            swept1 += swept * ((1 - XI3[k]) * W3[k]);
            swept2 += swept * (XI3[k] * W3[k]);
            const Vec<T> push = t * (bulge * (p1 * (1 - XI3[k]) + p2 * XI3[k]) * (AO * L * W3[k]));
            Qd += push * N.B0; Q1 += push * N.B1; Q2 += push * N.B2;
        }
        const T thick = c.density * (1.0 / f.density), area = thick * content, w = q * lam / area, across = q / area, across1 = flow / area;  // w, c and its rate
        // speed and acceleration of the string along the hole, mean over the element
        const T V = dot((on.y.r1 + on.y.r2) * 0.5 + (on.y.v1 - on.y.v2) * (L * (1.0 / 12)), tw);
        const T V1 = dot((on.a.r1 + on.a.r2) * 0.5 + (on.a.v1 - on.a.v2) * (L * (1.0 / 12)), tw);
        T widens = V * lam * (p[WIDENING] * 0.5);
        if constexpr (JUNCTION) widens += V * (p[WIDENING] * p[RIGID] * il * 0.5);
        swept1 += widens;
        swept2 += widens;
        const T wall = w + V, sheared = wall - V * f.clinging;
        const StringShear<T> tau = string_shear<AnnulusFlow>(f, w, sheared, T(V - V * f.clinging), c.density, p);
        T resistance = tau.loss * (lam * L * 4.0 / p[GAP]), mass = c.density * lam * lam * L / area, volume = content * L;
        T momentum = c.density * w * dot(d_rate, tw) + c.density * lam * L * V1 - c.density * gw * dot(d, tw);
        const Vec<T> weight = (g - tw * gw) * (c.density * lam), bend = vec(p + BEND) * (c.density * lam * wall * wall);
        const Vec<T> side = (weight - bend) * outer;  // buoyancy across the hole, less what guides the flow round its bends
        Beside<T> beside = {};
        if constexpr (JUNCTION) {
            beside = Beside<T>(on, y, a, c, p, f, q, flow);
            resistance += beside.resistance;
            mass += c.density * p[RIGID] / beside.open;
            momentum -= beside.pushed;
            volume += T(0.0) + (p[HOLE_ABOVE] - p[OUTER_ABOVE]) * p[RIGID];
        }
        // the hole between the nodes has its length along its own direction at each node: with the mean one, volume would come from nowhere
        // when the directions are read anew
        const Vec<S> off1 = (JUNCTION ? vec(p + TANGENT0) : tw1) - tw, off2 = tw2 - tw;
        T bent = dot(on.x.r2, off2) - dot(on.above, off1) + p[BENT], turned = dot(vec(y), off1);
        if constexpr (JUNCTION) { bent += dot(on.x.r1 - on.above, tw); turned -= dot(on.y.r1 - vec(y), tw); }
        volume += bent * AW;
        swept1 -= turned * (AW * il);
        swept2 += dot(on.y.r2, off2) * (AW * il);
        const T gradient = (p2 - p1 - beside.rise) * il;
        // static part: pressure along the hole and buoyancy across
        const T along = gradient * outer - tau.pull * (p[DIAMETER] * 3.14159265358979324);
        const Vec<T> at1 = tw1 * along, at2 = tw2 * along;
        Four<T> F4 = {(at1 * 0.35 + at2 * 0.15 + side * 0.5) * L - Qd, (at1 * 0.05 + at2 * (1.0 / 30) + side * (1.0 / 12)) * (L * L) + Q1,
                      (at1 * 0.15 + at2 * 0.35 + side * 0.5) * L + Qd, (at1 * (-1.0 / 30) - at2 * 0.05 - side * (1.0 / 12)) * (L * L) + Q2};
        F4.r1 += tw * shoulders(q, c, p, f);
        if constexpr (JUNCTION) F4.r1 += beside.force * 0.5;
        // motion across the hole
        T M = c.density * lam * (p[CHI] * AO), mass_rate = T(0.0);
        Four<T> by_place = {zero, zero, zero, zero};  // of M
        if constexpr (ASIDE) {
            const AddedMassAside<T> at(Offset<T>(on.x, p + AXIS1, p + AXIS2, tw1, tw2, tw).y, L, p + CHI_BY, p[CLEARANCE]);
            M = c.density * lam * (at.chi * AO);
            by_place = at.on_nodes(L);
            const T displaced = c.density * lam * AO;
            by_place = {by_place.r1 * displaced, by_place.v1 * displaced, by_place.r2 * displaced, by_place.v2 * displaced};
            mass_rate = pair(by_place, on.y);
        }
        const T drag = tau.drag * (p[DIAMETER] * 3.14159265358979324), damping = drag + p[DAMPING];
        Four<T> carried = {on.a.r1 * M + on.y.r1 * damping, on.a.v1 * M + on.y.v1 * damping, on.a.r2 * M + on.y.r2 * damping, on.a.v2 * M + on.y.v2 * damping};
        Four<T> C = {zero, zero, zero, zero};
        T brake = T(0.0);
        const bool swirling = swirls(p[SHARE]);
        if (swirling) {
            const Offset<T> off(on.x, p + AXIS1, p + AXIS2, tw1, tw2, tw);
            accumulate(carried, Offset<T>::turn(tw, on.y), M * (p[SWIRL] * -2.0));
            accumulate(carried, off.turned, T(-(M * p[SWIRL_RATE] + damping * p[SWIRL])));
            accumulate(carried, off.y, M * (-p[SWIRL] * p[SWIRL]));
            const T convected = M * across * p[SWIRL];
            accumulate(C, Offset<T>::turn(tw, slopes(d, on.x.v1, on.x.v2, L)), T(-convected));
            accumulate(C, slopes(off.turned.r2 - off.turned.r1, off.turned.v1, off.turned.v2, L), T(-convected));
            C.r1 -= off.turned.r1 * convected;
            C.r2 += off.turned.r2 * convected;
        }
        accumulate(C, consistent(carried, L), L * (1.0 / 420));
        accumulate(C, slopes(d, on.x.v1, on.x.v2, L), M * across1 + drag * across);
        accumulate(C, slopes(d_rate, on.y.v1, on.y.v2, L), M * across * 2.0);
        C.r1 += on.y.r1 * (M * across);
        C.r2 -= on.y.r2 * (M * across);
        accumulate(C, stiffness(d, on.x.v1, on.x.v2, L), -(M * across * across));
        if constexpr (ASIDE) {
            // momentum of the mass that comes and goes, and the pull to where there is more of it
            const auto cut = [&tw](const Vec<T>& u) -> Vec<T> { return u - tw * dot(u, tw); };
            Four<T> u = {cut(on.y.r1), cut(on.y.v1), cut(on.y.r2), cut(on.y.v2)};
            if (swirling) accumulate(u, Offset<T>(on.x, p + AXIS1, p + AXIS2, tw1, tw2, tw).turned, T(-p[SWIRL]));
            const Four<T> X = {cut(on.x.r1), cut(on.x.v1), cut(on.x.r2), cut(on.x.v2)}, slope = slopes(X.r2 - X.r1, X.v1, X.v2, L), even = consistent(u, L);
            const T energy = pair(u, even) * (L * (1.0 / 840)) + across * pair(slope, u) + 0.5 * across * across * pair(X, stiffness(X.r2 - X.r1, X.v1, X.v2, L));
            accumulate(C, even, mass_rate * (L * (1.0 / 420)));
            accumulate(C, slope, mass_rate * across);
            accumulate(C, by_place, -energy);
        }
        if (swirling) brake = pair(Offset<T>(on.x, p + AXIS1, p + AXIS2, tw1, tw2, tw).turned, C) * (p[SHARE] * -0.5);
        const auto cross_part = [&tw](const Vec<T>& u) { return u - tw * dot(u, tw); };
        F4.r1 += cross_part(C.r1); F4.v1 += cross_part(C.v1); F4.r2 += cross_part(C.r2); F4.v2 += cross_part(C.v2);
        on.store(F4, p[RIGID], r);
        if constexpr (JUNCTION) { r[0] += beside.force.x * 0.5; r[1] += beside.force.y * 0.5; r[2] += beside.force.z * 0.5; }
        r[6] = (y[6] * 2.0 + y[13]) * (p[TURNING] * L * (1.0 / 6)) + brake;
        r[13] = (y[13] * 2.0 + y[6]) * (p[TURNING] * L * (1.0 / 6)) + brake;
        T head = T(0.0) + (dot(on.above, tw) * gw + p[LEVEL]) * f.density;  // at the hole's axis, wherever in the hole the string is held
        if constexpr (JUNCTION) head = beside.height * f.density;
        rows<RESULTS>(x, y, c, p, f, volume, swept1 * (c.theta * L), swept2 * (c.theta * L), head + p[CONTROLLED], q, mass * flow + momentum + resistance, r, results);
        if constexpr (RESULTS) {
            // what the element has gained since the hole was read, of which the rows have the rate
            const T now = volume + (dot(on.x.r2, tw) - p[PLACE2]) * p[EXCESS2] - (dot(on.above, tw) - p[PLACE1]) * p[EXCESS1];
            results->content = c.theta * now;
            results->stored = stored_energy(f, (p1 + p2) * 0.5, p[WALL], now);
            energies(on, y, c, p, f, area, M, across, across1, w, wall, V, tau.pull, resistance - beside.resistance, q, drag, (swept1 + swept2) * L, (p1 + p2) * 0.5, now, p1, p2, results);
            // where the hole narrows within the element, its mud lies higher than the middle
            const T moment = ((dot(on.x.r2, tw) - p[PLACE2]) * p[EXCESS2] + (dot(on.above, tw) - p[PLACE1]) * p[EXCESS1]) * (L * 0.5) + p[MOMENT];
            results->potential -= c.density * gw * moment;
            if constexpr (JUNCTION) energies_beside(on, y, c, p, f, q, beside, (p1 + p2) * 0.5 * p[WALL], V, results);
        }
    }

    template <class R, class T, class S, class B>
    static void energies_beside(const R& on, const T* y, const Compressed<T>& c, const S* p, const Fluid& f, const T& q, const B& beside,
                                const T& give, const T& V, FlowResultsOf<T>* results) {
        const Vec<double> g = vec(f.gravity);
        const Vec<S> tw1 = vec(p + TANGENT1), sum = tw1 + vec(p + TANGENT2), tw = sum * (S(1.0) / norm(sum));
        const Vec<S> both = vec(p + TANGENT0) + tw1, along = both * (S(1.0) / norm(both));
        const S space = p[HOLE_ABOVE] - p[OUTER_ABOVE], down = dot(g, along);
        const Vec<T> middle = (on.above + on.x.r1) * 0.5;
        const T wall = q / beside.open + beside.V, element = dot(g, tw) * dot((on.x.r1 + on.x.r2) * 0.5, tw) + p[LEVEL];
        results->kinetic += 0.5 * c.density * space * p[RIGID] * wall * wall;
        // its height is that of the item, not of the element
        results->potential -= c.density * (1.0 + give) * space * p[RIGID] * (down * dot(middle, along) + p[LEVEL_ABOVE] - element);
        results->potential += c.density * p[OUTER_ABOVE] * p[RIGID] * (dot(middle, g - along * down) - p[LEVEL_ABOVE]);
        results->dissipated += beside.resistance * (q * f.density / c.density + beside.V * space) - beside.pull * beside.V;
        // the pressure of its mud does work on the difference of both directions that no force on the string takes up
        results->left_out += beside.rise * p[HOLE] * (V - beside.V);
    }

    // of the mud: half m (w + V)^2 along, M_a (|P V|^2 - |c P r_s|^2)/2 across; weight at the hole's axis, less what the pipe displaces sideways.
    // The second is M_a |P(V + c r_s)|^2/2 less M_a c P r_s.(V + c r_s): the flow along a bent string works on its motion, and its row of momentum
    // leaves that out (manual: eq-mud-energy-across)
    template <class R, class T, class S>
    static void energies(const R& on, const T* y, const Compressed<T>& c, const S* p, const Fluid& f, const T& area, const T& M,
                         const T& across, const T& across1, const T& w, const T& wall, const T& V, const T& tau, const T& resistance, const T& q, const T& drag,
                         const T& widens, const T& pressure, const T& held, const T& p1, const T& p2, FlowResultsOf<T>* results) {
        const S L = p[LENGTH];
        const T density = c.density, per_length = f.density * area;
        const Vec<S> t = vec(p + TANGENT1) + vec(p + TANGENT2), tw = t / norm(t);
        const Vec<double> g = vec(f.gravity);
        const S gw = dot(g, tw);
        const Vec<S> side = g - tw * gw;
        const auto cut = [&tw](const Vec<T>& v) -> Vec<T> { return v - tw * dot(v, tw); };
        const Four<T> X = {cut(on.x.r1), cut(on.x.v1), cut(on.x.r2), cut(on.x.v2)}, Y = {cut(on.y.r1), cut(on.y.v1), cut(on.y.r2), cut(on.y.v2)};
        const T a = pair(Y, consistent(Y, L)) * L * (1.0 / 420), b = pair(slopes(X.r2 - X.r1, X.v1, X.v2, L), Y);
        const T s = pair(X, stiffness(X.r2 - X.r1, X.v1, X.v2, L));
        results->kinetic = 0.5 * per_length * L * wall * wall + 0.5 * M * (a - across * across * s);
        const Vec<T> middle = (on.x.r1 + on.x.r2) * 0.5;
        // the mud at the hole's axis, all of it with that in the give of the walls, less what the pipe displaces across the hole
        const T give = pressure * p[WALL], content = density * held;
        results->potential = -content * (1.0 + give) * (gw * dot(middle, tw) + p[LEVEL]) + density * p[OUTER] * L * (dot(middle, side) - p[LEVEL]);
        results->left_out = -give * (content * gw * V + 0.5 * (pressure * widens));
        // the row of momentum leaves out the flow's own convection (manual: eq-mud-left-out-flow)
        const T along = dot(on.y.r2 - on.y.r1, tw);
        results->left_out -= 2.0 * f.density * w * wall * (results->storage_upper + results->storage_lower) + f.density * q * wall * (w * (p2 - p1) * f.compressibility - along);
        const T volume = q * f.density / density;
        const S round = p[DIAMETER] * 3.14159265358979324;
        results->dissipated += resistance * (volume + V * area * f.density / density) - tau * round * L * V;
        results->dissipated += drag * (a + across * b) + p[DAMPING] * a;
        results->left_out -= M * across1 * (b + across * s);
        const T o1 = y[6], o2 = y[13];
        if (swirls(p[SHARE])) {
            const Offset<T> off(on.x, p + AXIS1, p + AXIS2, vec(p + TANGENT1), vec(p + TANGENT2), tw);
            const T turning = pair(off.turned, consistent(Y, L)) * L * (1.0 / 420), size = pair(off.y, consistent(off.y, L)) * L * (1.0 / 420);
            const T bent = pair(slopes(X.r2 - X.r1, X.v1, X.v2, L), off.turned), along_spin = (o1 + o2) * (p[SHARE] * 0.5);
            const T relative = turning + across * bent - size * p[SWIRL];  // of J y to the velocity relative to the mud
            results->kinetic += M * (p[SWIRL] * p[SWIRL] * 0.5 * size - turning * p[SWIRL] + (p[SWIRL] - along_spin) * relative);
            results->left_out += M * (relative * (p[SWIRL_RATE] - p[SHARE] * p[SPIN_RATE]) + across1 * bent * p[SWIRL]);
            results->dissipated += (drag + p[DAMPING]) * (along_spin * p[SWIRL] * size - (along_spin + p[SWIRL]) * turning) - drag * across * along_spin * bent;
        }
        results->dissipated += p[TURNING] * L * (1.0 / 3) * (o1 * o1 + o1 * o2 + o2 * o2);
        results->speed = w;
    }
};

}  // namespace dp
