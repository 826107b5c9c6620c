// Flow between string and hole by the volume that has passed (fluid/hermite/hermite_flow.hpp); reaction on the string as in fluid/annulus_flow.hpp, point by point.
#pragma once
#include "fluid/annulus_flow.hpp"
#include "fluid/hermite/hermite_flow.hpp"

namespace dp {

template <bool JUNCTION, bool HELD>
struct HermiteAnnulus {
    static constexpr int F = HELD ? 0 : JUNCTION ? 15 : 14, D = F + 4, NSPIN = HELD ? 0 : 2;
    static constexpr bool PACKED = true;
    static constexpr int SPINS[2][2] = {{6, 3}, {13, 10}};
    DP_ENUM(Parameter,
        LENGTH, RIGID, POISSON, OUTER, HOLE, OUTER_ABOVE, HOLE_ABOVE, WALL, DIAMETER, GAP, GAP_ABOVE, JOINT_SHARE, JOINT_GAP, TUBE_SPEED, JOINT_SPEED, TUBE_PULL, JOINT_PULL,
        CHI, DAMPING, TURNING,  // as in fluid/annulus_flow.hpp
        HEADS, REFERENCE_FLOW,  // as in fluid/hermite/hermite_bore.hpp
        OPEN, CONTROLLED,       // OPEN 1: the upper end has the pressure CONTROLLED + rho0 ((g.t_w)(t_w.r) + LEVEL) [Pa]
        DROP,                   // as in fluid/bore_flow.hpp
        TANGENT1, TANGENT2 = TANGENT1 + 3, BEND = TANGENT2 + 3,  // 3 each, as in fluid/annulus_flow.hpp
        HEAD = BEND + 3,        // as in fluid/bore_flow.hpp
        SURGE,                  // as in fluid/hermite/hermite_bore.hpp
        STEP,                   // what HEADS gains on the element above [1/m4]
        SHOULDER,               // as in fluid/annulus_flow.hpp
        LEVEL,                  // as in fluid/annulus_flow.hpp
        SHARE, SWIRL, SWIRL_RATE, SPIN_RATE, AXIS1, AXIS2 = AXIS1 + 3,  // as in fluid/annulus_flow.hpp
        TANGENT0 = AXIS2 + 3, LEVEL_ABOVE = TANGENT0 + 3,  // as in fluid/annulus_flow.hpp
        NP)

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        evaluate<T, S>(x, y, a, p, *static_cast<const Fluid*>(context), r, nullptr);
    }

    template <class T, class S>
    static void evaluate(const T* x, const T* y, const T* a, const S* p, const Fluid& f, T* r, FlowResults* results) {
        const S L = p[LENGTH], il = S(1.0) / L, A = p[HOLE] - p[OUTER], zero = S(0.0);
        if constexpr (HELD) {
            const Jet<T> c = {T(0.0) + A, T(0.0), T(0.0)}, none = {T(0.0), T(0.0), T(0.0)};
            VolumeLine<T, S> line(x, y, a, f, L, p[WALL], zero, c, none, c, none);
            for (int k = 0; k < 4; ++k) {
                const CubicShape at(XI4[k]);
                const T q = line.flow(at) + p[REFERENCE_FLOW], head = pressure_of(f, T(line.slope(at, il) / A * -1.0), p[WALL]);
                const T thick = exp((head - heads(f, q, head, p[HEADS])) * f.compressibility), w = q / (thick * A);
                const T drag = string_shear<HermiteAnnulus>(f, w, w, T(0.0), T(thick * f.density), p).loss * (S(4.0) / p[GAP]);
                line.add(at, W4[k], (line.surge(at) + p[SURGE]) * (S(f.density) / A) - thick * f.density * (p[DROP] * il) + drag, head);
                if constexpr (std::is_same_v<T, double>) if (results) {
                    results->dissipated += W4[k] * L * q / thick * drag;
                    count_held<HermiteAnnulus>(f, line, at, XI4[k], W4[k], A, q, w, head, thick, p, results);
                }
            }
            finish(line, y, T(0.0) + p[CONTROLLED], p, f, r, results);
        } else {
            const Ride<T, JUNCTION> on(x, y, a, p[RIGID]);
            const Vec<S> sum = vec(p + TANGENT1) + vec(p + TANGENT2), tw = sum * (S(1.0) / norm(sum));
            const Tube<T> t1(on.x.v1, on.y.v1, on.a.v1, p[POISSON]), t2(on.x.v2, on.y.v2, on.a.v2, p[POISSON]);
            const Jet<T> less1 = along(on.x.v1, on.y.v1, on.a.v1, tw, p) - t1.less.times(p[OUTER]), less2 = along(on.x.v2, on.y.v2, on.a.v2, tw, p) - t2.less.times(p[OUTER]);
            const Jet<T> rest = {T(0.0) + A, T(0.0), T(0.0)};
            VolumeLine<T, S> line(x + F, y + F, a + F, f, L, p[WALL], JUNCTION ? (p[HOLE_ABOVE] - p[OUTER_ABOVE]) * p[RIGID] : zero, less1 + rest, less1, less2 + rest, less2);
            const Vec<T> none = {T(0.0), T(0.0), T(0.0)};
            Four<T> rows = {none, none, none, none};
            const Stretch<T> stretch(on.x, il);
            const T upper = y[F] + p[REFERENCE_FLOW];
            // with the step of pressure where the section jumps, which loads the shoulder there
            Beside<T> beside = {};
            if constexpr (JUNCTION) beside = Beside<T>(on, y, a, upper, a[F] + p[SURGE], p, f, line.p1.x);
            const T gradient = (line.p2.x - line.p1.x - heads(f, upper, line.p1.x, p[STEP]) - beside.rise) * il;
            const Offset<T> off(on.x, p + AXIS1, p + AXIS2, vec(p + TANGENT1), vec(p + TANGENT2), tw);
            const T spin = (y[6] + y[13]) * (p[SHARE] * 0.5);  // swirl that is steady at the present spin
            T brake = T(0.0);
            for (int k = 0; k < 4; ++k) point(on, stretch, CubicShape(XI4[k]), XI4[k], W4[k], tw, gradient, p, f, off, spin, line, rows, brake, results);
            rows.r1 += tw * heads(f, upper, line.p1.x, p[SHOULDER]);
            if constexpr (JUNCTION) above(on, upper, beside, p, f, line, rows, results);
            on.store(rows, p[RIGID], r);
            if constexpr (JUNCTION) { r[0] += beside.force.x * 0.5; r[1] += beside.force.y * 0.5; r[2] += beside.force.z * 0.5; }
            r[6] = (y[6] * 2.0 + y[13]) * (p[TURNING] * L * (1.0 / 6)) + brake;
            r[13] = (y[13] * 2.0 + y[6]) * (p[TURNING] * L * (1.0 / 6)) + brake;
            if constexpr (std::is_same_v<T, double>) if (results) results->dissipated += p[TURNING] * L / 3 * (y[6] * y[6] + y[6] * y[13] + y[13] * y[13]);
            // r_s.t_w counts a motion across a bent hole as a change of the hole's length (manual: eq-mud-left-out)
            if constexpr (std::is_same_v<T, double>) if (results) {
                const Vec<double> t1 = vec(p + TANGENT1);
                results->left_out += p[HOLE] * (line.p2.x * dot(on.y.r2, vec(p + TANGENT2) - tw) - line.p1.x * dot(on.y.r1, t1 - tw));
                if constexpr (JUNCTION) {
                    const double V = dot((on.y.r1 + on.y.r2) * 0.5 + (on.y.v1 - on.y.v2) * (L * (1.0 / 12)), tw);
                    results->left_out += line.p1.x * p[HOLE_ABOVE] * (dot(on.y.r1, t1) - dot(vec(y), vec(p + TANGENT0))) + beside.rise * p[HOLE] * (V - beside.V);
                }
            }
            T level = T(0.0) + dot(on.above, tw) * dot(vec(f.gravity), tw) + p[LEVEL];
            if constexpr (JUNCTION) level = beside.height;
            finish(line, y + F, level * f.density + p[CONTROLLED], p, f, r + F, results);
        }
    }

    template <class T>
    struct Beside {  // as in fluid/annulus_flow.hpp, at the pressure of the node
        T thick, height, V, resistance, rise, pull;
        Vec<T> force;
        Beside() : thick(1.0), height(0.0), V(0.0), resistance(0.0), rise(0.0), pull(0.0) {}
        template <class R, class S>
        Beside(const R& on, const T* y, const T* a, const T& q, const T& q1, const S* p, const Fluid& f, const T& pressure) {
            const Vec<S> sum = vec(p + TANGENT0) + vec(p + TANGENT1), along = sum * (S(1.0) / norm(sum));
            const S A = p[HOLE_ABOVE] - p[OUTER_ABOVE], down = dot(vec(f.gravity), along);
            height = dot(on.above, along) * down + p[LEVEL_ABOVE];
            V = dot(vec(y) + on.y.r1, along) * 0.5;
            thick = exp((pressure - heads(f, q, pressure, p[HEADS])) * f.compressibility);
            const T tau = shear(f, T(q / (thick * A) + V * (1.0 - f.clinging)), T(thick * f.density), p[GAP_ABOVE], 1.0);
            resistance = tau * (p[RIGID] * 4.0 / p[GAP_ABOVE]);
            rise = thick * (dot(on.x.r1 - on.above, along) * down - dot(vec(a) + on.a.r1, along) * (p[RIGID] * 0.5)) * f.density - q1 * (p[RIGID] * f.density / A) - resistance;
            pull = tau * (p[RIGID] * 3.14159265358979324) * sqrt(p[OUTER_ABOVE] * (4.0 / 3.14159265358979324));
            force = along * (rise * p[OUTER_ABOVE] - pull) + (vec(f.gravity) - along * down) * (thick * (p[OUTER_ABOVE] * p[RIGID] * f.density));
        }
    };

    // what the hole's own section holds beyond rest: A_w (lam_w - 1)
    template <class T, class S>
    static Jet<T> along(const Vec<T>& v, const Vec<T>& w, const Vec<T>& z, const Vec<S>& tw, const S* p) {
        return Jet<T>{dot(v, tw) - 1.0, dot(w, tw), dot(z, tw)}.times(p[HOLE]);
    }

    template <class R, class T, class S>
    static void point(const R& on, const Stretch<T>& stretch, const CubicShape& at, double xi, double weight, const Vec<S>& tw, const T& gradient, const S* p, const Fluid& f,
                      const Offset<T>& off, const T& spin, VolumeLine<T, S>& line, Four<T>& rows, T& brake, FlowResults* results) {
        const S L = p[LENGTH], il = S(1.0) / L, AO = p[OUTER];
        const Vec<double> g = vec(f.gravity);
        const S gw = dot(g, tw);
        const Vec<T> rs = slope(at, on.x, il), V = value(at, on.y, L), Vs = slope(at, on.y, il), Vt = value(at, on.a, L);
        const Vec<S> here = vec(p + TANGENT1) * (1 - xi) + vec(p + TANGENT2) * xi;
        const T local = norm(rs), n = stretch.at(at), lam = dot(rs, tw), narrow = 1.0 - (n - 1.0) * (p[POISSON] * 2.0), bulge = 1.0 - (n * 2.0 - 1.0) * (p[POISSON] * 2.0);
        const T less = (lam - 1.0) * p[HOLE] - (n - 1.0) * (1.0 - n * (p[POISSON] * 2.0)) * AO, content = less + (p[HOLE] - AO);
        const T q = line.flow(at) + p[REFERENCE_FLOW], q1 = line.surge(at) + p[SURGE];
        const T head = pressure_of(f, T((line.slope(at, il) + less) / content * -1.0), p[WALL]), speed = heads(f, q, head, p[HEADS]);
        const T thick = exp((head - speed) * f.compressibility), density = thick * f.density, area = thick * content;
        const T w = q * lam / area, across = q / area, across1 = q1 / area, Va = dot(V, tw), wall = w + Va, sheared = wall - Va * f.clinging;
        const StringShear<T> tau = string_shear<HermiteAnnulus>(f, w, sheared, T(Va - Va * f.clinging), density, p);
        const T outer = narrow * AO, M = density * lam * (p[CHI] * AO);
        const T drag = tau.drag * (p[DIAMETER] * 3.14159265358979324);
        // along the hole and buoyancy; pressure straight between the nodes, as it loads the string
        const T push = (line.p1.x * (1 - xi) + line.p2.x * xi - speed) * bulge * AO;
        const Vec<T> side = ((g - tw * gw) * (density * lam) - vec(p + BEND) * (density * lam * wall * wall)) * outer;
        const auto cut = [&tw](const Vec<T>& u) { return u - tw * dot(u, tw); };
        Vec<T> moved = cut(Vt * M + V * (drag + p[DAMPING]) + rs * (M * across1 + drag * across) + Vs * (M * across)), bent = cut((V + rs * across) * (M * across));
        const bool swirling = swirls(p[SHARE]);
        if (swirling) {
            const Vec<T> turned = value(at, off.turned, L);
            moved -= cross(tw, V * 2.0 + rs * across) * (M * p[SWIRL]) + turned * (M * p[SWIRL_RATE] + (drag + p[DAMPING]) * p[SWIRL]) +
                     value(at, off.y, L) * (M * (p[SWIRL] * p[SWIRL]));
            bent -= turned * (M * across * p[SWIRL]);
            brake += (dot(turned, moved) - dot(slope(at, off.turned, il), bent)) * (p[SHARE] * L * (-0.5 * weight));
        }
        const Vec<T> N = here * (gradient * outer - tau.pull * (p[DIAMETER] * 3.14159265358979324)) + side + moved;
        const Vec<T> B = rs * (push / local) - bent;
        rows.r1 += N * (L * (at.N[0] * weight)) + B * (at.B[0] * weight);
        rows.v1 += N * (L * L * (at.N[1] * weight)) + B * (L * (at.B[1] * weight));
        rows.r2 += N * (L * (at.N[2] * weight)) + B * (at.B[2] * weight);
        rows.v2 += N * (L * L * (at.N[3] * weight)) + B * (L * (at.B[3] * weight));
        const T resistance = tau.loss * lam * (S(4.0) / p[GAP]);
        line.add(at, weight, density * lam * lam / area * q1 + density * w * dot(Vs, tw) + density * lam * (dot(Vt, tw) - gw) + resistance, head);
        if constexpr (std::is_same_v<T, double>) if (results) {
            const double part = weight * L, m = f.density * area, volume = q / thick;
            const Vec<double> X = value(at, on.x, L), turned = value(at, off.turned, L), carried = cut(V + rs * across);
            const Vec<double> passed = carried - turned * p[SWIRL], sideways = cut(V) - turned * spin;  // relative to the mud; the motion that feels the force
            const double relative = dot(turned, passed);
            // the flow across a bent string does work that its row leaves out (manual: eq-mud-energy-across)
            const Vec<double> across_hole = cut(V) - turned * p[SWIRL];
            const double mu = p[HOLE] - AO - line.slope(at, il), mu1 = -line.slope_rate(at, il), parting = dot(Vs, tw) * p[HOLE] - dot(rs, Vs) / local * bulge * AO;
            const double m1 = density * (content * ((line.p1.y * (1 - xi) + line.p2.y * xi) * f.compressibility) + parting);
            results->kinetic += part * (0.5 * (m * wall * wall + M * dot(across_hole, across_hole)) + M * (p[SWIRL] - spin) * relative);
            results->left_out += part * M * (relative * (p[SWIRL_RATE] - p[SHARE] * p[SPIN_RATE]) + across * across * dot(cut(rs), Vs));
            results->potential -= part * (mu * f.density * (gw * dot(X, tw) + p[LEVEL]) - density * AO * (dot(X, g - tw * gw) - p[LEVEL]));
            results->left_out -= part * (mu * f.density - m) * gw * Va;  // the give of the walls has no weight on the string
            count(f, {q, w, head, content, mu, mu1, m, m1, Va, dot(Vs, tw), parting}, (line.p2.x - line.p1.x) * il, p[WALL], p[HEADS], part, L, results);
            results->dissipated += part * (resistance * (volume + Va * content) - tau.pull * p[DIAMETER] * 3.14159265358979324 * Va + drag * dot(sideways, passed) +
                                          p[DAMPING] * dot(sideways, cut(V) - turned * p[SWIRL]));
        }
    }

    // the rigid item above the element (fluid/annulus_flow.hpp): its flow is that of the node
    template <class R, class T, class S>
    static void above(const R& on, const T& q, const Beside<T>& beside, const S* p, const Fluid& f, VolumeLine<T, S>& line, Four<T>& rows,
                      FlowResults* results) {
        line.spread(beside.rise * -1.0);
        rows.r1 += beside.force * 0.5;
        if constexpr (std::is_same_v<T, double>) if (results) {
            const Vec<double> g = vec(f.gravity), sum = vec(p + TANGENT0) + vec(p + TANGENT1), along = sum * (1.0 / norm(sum)), middle = (on.above + on.x.r1) * 0.5;
            const double A = p[HOLE_ABOVE] - p[OUTER_ABOVE], down = dot(g, along), V = beside.V;
            const double wall = q / (beside.thick * A) + V, m = beside.thick * f.density * A * p[RIGID];
            results->dissipated += beside.resistance * (q / beside.thick + V * A) - beside.pull * V;
            results->kinetic += 0.5 * m * wall * wall;
            const double give = A * p[RIGID] * f.density * (1.0 + Filled<double>(f, line.p1, p[WALL]).excess.x) - m;
            results->left_out -= give * down * V;
            results->potential -= (m + give) * (dot(middle, along) * down + p[LEVEL_ABOVE]) -
                                  beside.thick * f.density * p[OUTER_ABOVE] * p[RIGID] * (dot(middle, g - along * down) - p[LEVEL_ABOVE]);
        }
    }

    template <class T, class S>
    static void finish(VolumeLine<T, S>& line, const T* y, const T& outlet, const S* p, const Fluid& f, T* r, FlowResults* results) {
        line.row[0] -= outlet * p[OPEN];
        line.store(f, r);
        if constexpr (std::is_same_v<T, double>) if (results) {
            const double own = JUNCTION ? (p[HOLE_ABOVE] - p[OUTER_ABOVE]) * p[RIGID] : 0.0;
            results->content = (p[HOLE] - p[OUTER]) * p[LENGTH] + own + line.V1.x - line.V2.x;
            if (own > 0.0) results->content += own * Filled<double>(f, line.p1, p[WALL]).excess.x, results->stored += stored_energy(f, line.p1.x, p[WALL], own);
            results->storage_upper = 0.5 * (y[0] - y[1]); results->storage_lower = results->storage_upper;
        }
    }
};

}  // namespace dp
