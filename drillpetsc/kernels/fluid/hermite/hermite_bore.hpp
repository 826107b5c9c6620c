// Flow in the bore of the string by the volume that has passed (fluid/hermite/hermite_flow.hpp); reaction on the string as in fluid/bore_flow.hpp, point by point.
#pragma once
#include "fluid/hermite/hermite_flow.hpp"

namespace dp {

constexpr double ANCHOR = 100.0;  // rate at which a volume where the flow is given comes back from errors of the time integration [1/s]

template <bool JUNCTION, bool HELD>
struct HermiteBore {
    static constexpr int F = HELD ? 0 : JUNCTION ? 15 : 14, D = F + 4, NSPIN = 0;  // volumes of both nodes, pressures of both nodes
    static constexpr bool PACKED = true;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter,
        LENGTH, RIGID, POISSON, AREA, AREA_ABOVE, WALL, DIAMETER, DIAMETER_ABOVE, JOINT_SHARE, JOINT_DIAMETER, TUBE_SPEED, JOINT_SPEED,  // as in fluid/bore_flow.hpp
        HEADS,              // (1/A^2 - 1/A_0^2)/2 [1/m4]
        REFERENCE_FLOW,     // Q [m3/s]
        GIVEN, FLOW,        // GIVEN 1: FLOW enters at the upper end, where V is PUMPED [m3/s]
        DROP, HEAD,         // as in fluid/bore_flow.hpp
        SURGE,              // rate of Q [m3/s2]
        CLOSED,             // 1: nothing leaves at the lower end, where V stays KEPT
        PUMPED, KEPT,       // [m3]
        WAITS,              // 1: the flow's unknowns wait for the string (statics)
        OPEN_ABOVE,         // open to the flow in the rigid item above, also where its mud's forces are left out (output/measured/bending.py) [m2]
        NP)

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        evaluate<T, S>(x, y, a, p, *static_cast<const Fluid*>(context), r, nullptr);
    }

    template <class T, class S>
    static void evaluate(const T* x, const T* y, const T* a, const S* p, const Fluid& f, T* r, FlowResults* results) {
        const S L = p[LENGTH], il = S(1.0) / L, A = p[AREA], zero = S(0.0);
        const Jet<T> none = {T(0.0), T(0.0), T(0.0)};
        if constexpr (HELD) {
            const Jet<T> c = {T(0.0) + A, T(0.0), T(0.0)};
            VolumeLine<T, S> line(x, y, a, f, L, p[WALL] * A, zero, zero, none, c, none, c, none);
            for (int k = 0; k < 4; ++k) {
                const CubicShape at(XI4[k]);
                const T q = line.flow(at) + p[REFERENCE_FLOW], head = pressure_of(f, T(line.slope(at, il) * -1.0), T(T(0.0) + A), p[WALL] * A);
                const T inside = head - heads(f, q, head, p[HEADS]), thick = exp(inside * f.compressibility), w = q / (thick * A);
                const T drag = bore_shear(f, w, T(thick * f.density), p[DIAMETER], p[JOINT_SHARE], p[TUBE_SPEED], p[JOINT_DIAMETER], p[JOINT_SPEED]) * (S(4.0) / p[DIAMETER]);
                line.add(at, W4[k], ((line.surge(at) + p[SURGE]) / (thick * A) - p[DROP] * il) * f.density + drag / thick, flow_work(f, head));
                if constexpr (std::is_same_v<T, double>) if (results) {
                    results->dissipated += W4[k] * L * q / thick * drag;
                    count_held<HermiteBore>(f, line, at, XI4[k], W4[k], A, q, w, head, thick, p, results);
                }
            }
            finish(line, x, y, p, f, r, results);
        } else {
            const Ride<T, JUNCTION> on(x, y, a, p[RIGID]);
            const Tube<T> t1(on.x.v1, on.y.v1, on.a.v1, p[POISSON]), t2(on.x.v2, on.y.v2, on.a.v2, p[POISSON]);
            const Vec<double> g = vec(f.gravity);
            Jet<T> drop = none;
            if constexpr (JUNCTION) drop = Jet<T>{dot(on.x.r1 - on.above, g), dot(on.y.r1 - vec(y), g), dot(on.a.r1 - vec(a), g)}.times(f.density);
            const S item = JUNCTION ? p[OPEN_ABOVE] * p[RIGID] : zero;
            VolumeLine<T, S> line(x + F, y + F, a + F, f, L, p[WALL] * A, item, item * p[WALL], drop, t1.section.times(A), t1.less.times(A), t2.section.times(A),
                                  t2.less.times(A));
            const Vec<T> still = {T(0.0), T(0.0), T(0.0)};
            Four<T> rows = {still, still, still, still};
            Stretch<T> stretch(on.x, il);
            for (int k = 0; k < 4; ++k) point(on, stretch, CubicShape(XI4[k]), XI4[k], W4[k], p, f, line, rows, results);
            const auto press = [&] {
                stretch.add_to_ends(line.row[1] * line.full1 * bulge(stretch.end1, p[POISSON]) * (A * -1.0), line.row[3] * line.full2 * bulge(stretch.end2, p[POISSON]) * (A * -1.0));
                stretch.store(on.x, il, rows);
            };
            if constexpr (JUNCTION) {
                Vec<T> upper = above(on, vec(y), vec(a), y[F] + p[REFERENCE_FLOW], a[F] + p[SURGE], p, f, line, rows, results);
                const Vec<T> turn = g * line.by_drop() * f.density;
                rows.r1 += turn;
                upper -= turn;
                press();
                on.store(rows, p[RIGID], r);
                r[0] += upper.x; r[1] += upper.y; r[2] += upper.z;
            } else {
                press();
                on.store(rows, p[RIGID], r);
            }
            finish(line, x + F, y + F, p, f, r + F, results);
        }
    }

    template <class R, class T, class S>
    static void point(const R& on, Stretch<T>& stretch, const CubicShape& at, double xi, double weight, const S* p, const Fluid& f, VolumeLine<T, S>& line, Four<T>& rows,
                      FlowResults* results) {
        const S L = p[LENGTH], il = S(1.0) / L, A = p[AREA];
        const Vec<double> g = vec(f.gravity);
        const Vec<T> rs = slope(at, on.x, il), V = value(at, on.y, L), Vs = slope(at, on.y, il), Vt = value(at, on.a, L);
        const T local = norm(rs), n = stretch.at(at), n1 = dot(rs, Vs) / local, less = (n - 1.0) * (1.0 - n * (p[POISSON] * 2.0)), section = less + 1.0;
        const T q = line.flow(at) + p[REFERENCE_FLOW], q1 = line.surge(at) + p[SURGE];
        const T head = is_waiting(p[WAITS]) ? line.straight(xi) : pressure_of(f, T((line.slope(at, il) + less * A) * -1.0), T(section * A), p[WALL] * A), speed = heads(f, q, head, p[HEADS]);
        const T thick = exp((head - speed) * f.compressibility), area = thick * section * A, w = q * n / area;
        const T m = area * f.density, G = q * f.density;
        const T m1 = thick * (A * f.density) * (section * ((line.p1.y * (1 - xi) + line.p2.y * xi) * f.compressibility) + bulge(n, p[POISSON]) * n1);
        const Vec<T> N = (Vt - g) * m + V * m1 + rs * (q1 * f.density) + Vs * G, B = V * (-G) - rs * (G * G / m);
        stretch.add(at, (head - speed) * bulge(n, p[POISSON]) * (A * L * -weight));
        rows.r1 += N * (L * (at.N[0] * weight)) + B * (at.B[0] * weight);
        rows.v1 += N * (L * L * (at.N[1] * weight)) + B * (L * (at.B[1] * weight));
        rows.r2 += N * (L * (at.N[2] * weight)) + B * (at.B[2] * weight);
        rows.v2 += N * (L * L * (at.N[3] * weight)) + B * (L * (at.B[3] * weight));
        const T drag = bore_shear(f, w, T(thick * f.density), p[DIAMETER], p[JOINT_SHARE], p[TUBE_SPEED], p[JOINT_DIAMETER], p[JOINT_SPEED]) * n * (S(4.0) / p[DIAMETER]);
        line.add(at, weight, (n * n / area * q1 + w * n1 + dot(rs, Vt - g)) * f.density + drag / thick, flow_work(f, head));
        if constexpr (std::is_same_v<T, double>) if (results) {
            results->dissipated += weight * L * q / thick * drag;
            const Vec<T> own = V * m + rs * G;
            results->kinetic += weight * L * 0.5 * dot(own, own) / m;
            const double part = weight * L, mu = A - line.slope(at, il), mu1 = -line.slope_rate(at, il);
            results->potential -= part * mu * f.density * dot(value(at, on.x, L), g);
            // the give of the walls has no weight on the string; mud that comes in brings the velocity of its nodes along
            results->left_out += part * ((mu * f.density - m) * dot(V, g) * -1.0 + 0.5 * (mu1 * f.density - m1) * dot(V, V) + G * w * n1);
            count(f, {q, w, head, section * A, mu, mu1, m, m1, 0.0, 0.0}, (line.p2.x - line.p1.x) * il, p[WALL] * A, p[HEADS], part, L, results);
        }
    }

    // the rigid item above the element: its flow is that of the node, its mud one piece with straight motion between its ends, of which the
    // upper has the rate V0 and the acceleration A0; returns the rows there
    template <class R, class T, class S>
    static Vec<T> above(const R& on, const Vec<T>& V0, const Vec<T>& A0, const T& q, const T& q1, const S* p, const Fluid& f, VolumeLine<T, S>& line,
                        Four<T>& rows, FlowResults* results) {
        const Vec<double> g = vec(f.gravity);
        const T thick = exp((line.middle.x - heads(f, q, line.middle.x, p[HEADS])) * f.compressibility), w = q / (thick * p[OPEN_ABOVE]);
        const T drag = shear(f, w, T(thick * f.density), p[DIAMETER_ABOVE], 0.0) * (p[RIGID] * 4.0 / p[DIAMETER_ABOVE]);
        const T half = thick * (p[AREA_ABOVE] * p[RIGID] * (0.5 * f.density)), G = q * f.density;
        const Vec<T> rod = on.x.r1 - on.above, turn = rod * (q1 * (0.5 * f.density));
        line.at_node = (q1 * (p[RIGID] / p[OPEN_ABOVE]) + dot(rod, (A0 + on.a.r1) * 0.5 - g)) * f.density;
        line.spread(drag / thick);
        rows.r1 += (on.a.r1 - g) * half + turn - V0 * G;
        if constexpr (std::is_same_v<T, double>) if (results) {
            results->dissipated += q / thick * drag;
            const double give = (p[AREA_ABOVE] * p[RIGID] + line.item_more) * f.density - 2.0 * half;
            results->potential -= (half + 0.5 * give) * dot(on.x.r1 + on.above, g);
            results->left_out -= 0.5 * give * dot(on.y.r1 + V0, g);
            results->kinetic += 0.5 * half * (dot(V0, V0) + dot(on.y.r1, on.y.r1)) + 0.5 * G * dot(rod, V0 + on.y.r1) + 0.5 * G * w * p[RIGID];
        }
        return (A0 - g) * half + turn + on.y.r1 * G;
    }

    template <class T, class S>
    static void finish(VolumeLine<T, S>& line, const T* x, const T* y, const S* p, const Fluid& f, T* r, FlowResults* results) {
        line.store(f, r);
        // the rate, and some of the volume, without which the steady flow would leave the level open and errors in time would stay
        r[0] = r[0] * (S(1.0) - p[GIVEN]) + (y[0] + p[REFERENCE_FLOW] - p[FLOW] + (x[0] - p[PUMPED]) * ANCHOR) * (p[GIVEN] * MASS_ROW);
        r[1] = r[1] * (S(1.0) - p[CLOSED]) + (y[1] + p[REFERENCE_FLOW] + (x[1] - p[KEPT]) * ANCHOR) * (p[CLOSED] * MASS_ROW);
        if constexpr (std::is_same_v<T, double>) if (results) {
            const double own = HELD ? 0.0 : p[AREA_ABOVE] * p[RIGID] * JUNCTION;
            results->content = p[AREA] * p[LENGTH] + own + line.V1.x - line.V2.x;
            if (own > 0.0) results->content += line.item_more, results->stored += stored_energy(f, line.middle.x, p[WALL], own);
            results->storage_upper = 0.5 * (y[0] - y[1]); results->storage_lower = results->storage_upper;
        }
    }
};

}  // namespace dp
