// Flow between string and hole by the volume that has passed (fluid/hermite/hermite_flow.hpp); reaction on the string as in fluid/annulus_flow.hpp, point by point.
#pragma once
#include "fluid/annulus_flow.hpp"
#include "fluid/hermite/hermite_flow.hpp"

namespace dp {

// How far along the hole a place of the string is: a cubic of its places at the nodes, r.t with the direction t of the hole, and of the slopes r_s.t + r.t_s
// there, with t linear between the nodes.  So the hole between two nodes has its own length, and a motion across a bend moves no mud
// (fluid/annulus_flow.hpp).  What works on it loads the string by its derivatives.
template <class T, class S>
struct HolePassed {
    Jet<T> s1, s2, end1, end2;  // places; slopes
    Vec<S> t0, t1, t2, turning;
    S L, il;
    T row[4];
    // tw0: direction at the upper node, from which a rigid item leads to the element; bent: as BENT
    template <class R>
    HolePassed(const R& on, const T* y, const T* a, const Vec<S>& tw1, const Vec<S>& tw2, const Vec<S>& tw0, const S& bent, const S& length)
        : t0(tw0), t1(tw1), t2(tw2), turning((tw2 - tw1) * (S(1.0) / length)), L(length), il(S(1.0) / length), row{T(0.0), T(0.0), T(0.0), T(0.0)} {
        const auto jet = [](const T& u, const T& v, const T& w) -> Jet<T> { return {u, v, w}; };
        const auto apart = [this](const Vec<T>& first, const Vec<T>& upper) -> T { return (dot(first, t1) - dot(upper, t0)) * il; };
        // what the item leaves to the element
        const Jet<T> more = jet(apart(on.x.r1, on.above) + bent * il, apart(on.y.r1, vec(y)), apart(on.a.r1, vec(a)));
        const auto at = [this](const Vec<T>& r, const Vec<T>& v, const Vec<S>& t) -> T { return dot(v, t) + dot(r, turning); };
        s1 = jet(dot(on.above, t0) - bent, dot(vec(y), t0), dot(vec(a), t0));
        s2 = jet(dot(on.x.r2, t2), dot(on.y.r2, t2), dot(on.a.r2, t2));
        end1 = jet(at(on.x.r1, on.x.v1, t1), at(on.y.r1, on.y.v1, t1), at(on.a.r1, on.a.v1, t1)) + more;
        end2 = jet(at(on.x.r2, on.x.v2, t2), at(on.y.r2, on.y.v2, t2), at(on.a.r2, on.a.v2, t2)) + more;
    }
    T slope(const CubicShape& c) const { return (s2.x - s1.x) * (il * c.B[2]) + end1.x * c.B[1] + end2.x * c.B[3]; }
    T slope_rate(const CubicShape& c) const { return (s2.y - s1.y) * (il * c.B[2]) + end1.y * c.B[1] + end2.y * c.B[3]; }
    T speed(const CubicShape& c) const { return s1.y * c.N[0] + end1.y * (L * c.N[1]) + s2.y * c.N[2] + end2.y * (L * c.N[3]); }
    T surge(const CubicShape& c) const { return s1.a * c.N[0] + end1.a * (L * c.N[1]) + s2.a * c.N[2] + end2.a * (L * c.N[3]); }
    // force per length and work of the slope [N], at a point of weight w
    void add(const CubicShape& c, double w, const T& force, const T& work) {
        row[0] += (force * (L * c.N[0]) + work * c.B[0]) * w;
        row[1] += (force * (L * c.N[1]) + work * c.B[1]) * (L * w);
        row[2] += (force * (L * c.N[2]) + work * c.B[2]) * w;
        row[3] += (force * (L * c.N[3]) + work * c.B[3]) * (L * w);
    }
    void store(Four<T>& rows, Vec<T>& upper) const {
        const T more = (row[1] + row[3]) * il;
        rows.r1 += turning * row[1] + t1 * more;
        rows.v1 += t1 * row[1];
        rows.r2 += turning * row[3] + t2 * row[2];
        rows.v2 += t2 * row[3];
        upper += t0 * (row[0] - more);
    }
};

// A ledge of the hole at a node, where its section falls by D.  The elements keep their sections, so that the ledge goes along with the string; yet the
// mud passes a ledge that stands: below it the flow relative to the string is greater by D times the speed of the node.  The volume at zero pressure is
// e^(beta p) times that, with the pressure p of mud at rest at the ledge.  By the work of this flow, less what the mud of the volume has stored, the
// pressure on the ledge does not load the string (manual: eq-mud-hermite-ledge).
template <class T, class S>
struct Ledge {
    S volume, push;  // of mud per way [m2]; D times the energy stored per volume [N]
    T speed;
    Jet<T> moved;    // [m3]
    Ledge() : volume(0.0), push(0.0), speed(0.0), moved{T(0.0), T(0.0), T(0.0)} {}
    Ledge(const Jet<T>& along, const S& per_way, const S& stored, const S& place)
        : volume(per_way), push(stored), speed(along.y), moved(Jet<T>{along.x - place, along.y, along.a}.times(per_way)) {}
    // that the mud brings which the elements hold in excess; depth: times gravity [m2/s2]
    double power(const Fluid& f, double depth) const { return push * speed - f.density * depth * moved.y; }
};

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
        SHOULDER,               // as in fluid/annulus_flow.hpp
        LEVEL,                  // as in fluid/annulus_flow.hpp
        SHARE, SWIRL, SWIRL_RATE, SPIN_RATE, AXIS1, AXIS2 = AXIS1 + 3,  // as in fluid/annulus_flow.hpp
        TANGENT0 = AXIS2 + 3, LEVEL_ABOVE = TANGENT0 + 3,  // as in fluid/annulus_flow.hpp
        BENT,                   // as in fluid/annulus_flow.hpp
        WAITS, OPEN_ABOVE,      // as in fluid/hermite/hermite_bore.hpp
        PASSED1, PASSED2 = PASSED1 + 3,  // 3 each: volume of hole that both nodes pass by their motion, per length [m2]; the same for all that meet there
        // ledges of the hole below the rigid item above and at the lower node (Ledge), with t.r of both nodes where they are at their ledges [m]
        LEDGE_ABOVE = PASSED2 + 3, LEDGE, PUSH_ABOVE, PUSH, LEDGE_PLACE_ABOVE, LEDGE_PLACE,
        NP)

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        evaluate<T, S>(x, y, a, p, *static_cast<const Fluid*>(context), r, nullptr);
    }

    template <class T, class S>
    static void evaluate(const T* x, const T* y, const T* a, const S* p, const Fluid& f, T* r, FlowResults* results) {
        const S L = p[LENGTH], il = S(1.0) / L, A = p[HOLE] - p[OUTER], zero = S(0.0);
        const Jet<T> none = {T(0.0), T(0.0), T(0.0)}, rest = {T(0.0) + A, T(0.0), T(0.0)};
        if constexpr (HELD) {
            VolumeLine<T, S> line(x, y, a, f, L, p[WALL] * A, zero, zero, none, rest, none, rest, none);
            for (int k = 0; k < 4; ++k) {
                const CubicShape at(XI4[k]);
                const T q = line.flow(at) + p[REFERENCE_FLOW], head = pressure_of(f, T(line.slope(at, il) * -1.0), rest.x, p[WALL] * A);
                const T thick = exp((head - heads(f, q, head, p[HEADS])) * f.compressibility), w = q / (thick * A);
                const T drag = string_shear<HermiteAnnulus>(f, w, w, T(0.0), T(thick * f.density), p).loss * (S(4.0) / p[GAP]);
                line.add(at, W4[k], ((line.surge(at) + p[SURGE]) / (thick * A) - p[DROP] * il) * f.density + drag / thick, flow_work(f, head));
                if constexpr (std::is_same_v<T, double>) if (results) {
                    results->dissipated += W4[k] * L * q / thick * drag;
                    count_held<HermiteAnnulus>(f, line, at, XI4[k], W4[k], A, q, w, head, thick, p, results);
                }
            }
            line.row[0] -= flow_work(f, T(T(0.0) + p[CONTROLLED])) * p[OPEN];
            finish(line, y, p, f, r, results);
        } else {
            const Ride<T, JUNCTION> on(x, y, a, p[RIGID]);
            const Vec<S> tw1 = vec(p + TANGENT1), tw2 = vec(p + TANGENT2), sum = tw1 + tw2, tw = sum * (S(1.0) / norm(sum));
            const Tube<T> t1(on.x.v1, on.y.v1, on.a.v1, p[POISSON]), t2(on.x.v2, on.y.v2, on.a.v2, p[POISSON]);
            HolePassed<T, S> hole(on, y, a, tw1, tw2, JUNCTION ? vec(p + TANGENT0) : tw1, p[BENT], L);
            const Jet<T> one = {T(1.0), T(0.0), T(0.0)};
            const Jet<T> less1 = (hole.end1 - one).times(p[HOLE]) - t1.less.times(p[OUTER]), less2 = (hole.end2 - one).times(p[HOLE]) - t2.less.times(p[OUTER]);
            const T upper = y[F] + p[REFERENCE_FLOW];
            Jet<T> drop = none;
            Beside<T> beside = {};
            if constexpr (JUNCTION) drop = beside.rises(on, y, a, p, f).times(f.density);
            const S item = JUNCTION ? p[OPEN_ABOVE] * p[RIGID] : zero;
            VolumeLine<T, S> line(x + F, y + F, a + F, f, L, p[WALL] * A, item, item * p[WALL], drop, less1 + rest, less1, less2 + rest, less2);
            const Ledge<T, S> ledge2(hole.s2, p[LEDGE], p[PUSH], p[LEDGE_PLACE]);
            Ledge<T, S> ledge1;
            line.V2 = line.V2 - ledge2.moved;
            if constexpr (JUNCTION) {
                ledge1 = Ledge<T, S>({hole.s1.x + p[BENT], hole.s1.y, hole.s1.a}, p[LEDGE_ABOVE], p[PUSH_ABOVE], p[LEDGE_PLACE_ABOVE]);
                line.V1 = line.V1 + ledge1.moved;
            }
            const Vec<T> still = {T(0.0), T(0.0), T(0.0)};
            Four<T> rows = {still, still, still, still};
            Stretch<T> stretch(on.x, il);
            const Offset<T> off(on.x, p + AXIS1, p + AXIS2, tw1, tw2, tw);
            const T spin = (y[6] + y[13]) * (p[SHARE] * 0.5);  // swirl that is steady at the present spin
            T brake = T(0.0);
            for (int k = 0; k < 4; ++k) point(on, stretch, CubicShape(XI4[k]), XI4[k], W4[k], tw, hole, p, f, off, spin, line, rows, brake, results);
            if constexpr (JUNCTION) {
                beside.set(on, y, a, upper, a[F] + p[SURGE], line.middle.x, p, f);
                line.at_node = beside.push;
                line.spread(beside.resistance / beside.thick);
            }
            const T end1 = line.row[1] * line.full1, end2 = line.row[3] * line.full2;
            stretch.add_to_ends(end1 * bulge(stretch.end1, p[POISSON]) * p[OUTER], end2 * bulge(stretch.end2, p[POISSON]) * p[OUTER]);
            stretch.store(on.x, il, rows);
            hole.row[1] -= end1 * p[HOLE];
            hole.row[3] -= end2 * p[HOLE];
            if constexpr (JUNCTION) hole.row[0] += line.row[0] * ledge1.volume - ledge1.push;
            hole.row[2] -= line.row[2] * ledge2.volume + ledge2.push;
            rows.r1 += tw * heads(f, upper, line.p1.x, p[SHOULDER]);
            Vec<T> first = still;  // row of the upper node, which is that of r1 without an item
            hole.store(rows, first);
            T height = T(0.0) + dot(on.above, tw) * dot(vec(f.gravity), tw) + p[LEVEL];
            if constexpr (JUNCTION) {
                height = beside.height;
                const Vec<T> lean = beside.along * (line.by_drop() * beside.down * f.density);
                const T friction = beside.resistance / beside.thick;  // works on the item, not on the element
                first -= vec(p + PASSED1) * (friction * 0.5);
                rows.r2 += vec(p + PASSED2) * (friction * 0.5);
                above(on, upper, beside, p, f, line, results);
                rows.r1 += beside.force * 0.5 + lean;
                first += beside.force * 0.5 - lean;
            }
            // at the flow line the mud in the hole above presses on the annulus
            const T work = (flow_work(f, T(T(0.0) + p[CONTROLLED])) + height * f.density) * p[OPEN];
            line.row[0] -= work;
            first -= tw1 * (log1p(work * -f.compressibility) * (A * (-1.0 / f.compressibility)));
            // the mud stays beside the hole where the string moves past it: the rows of the flow, which are zero, by the volume that the nodes pass
            first -= vec(p + PASSED1) * (line.row[0] + line.at_node);
            rows.r2 -= vec(p + PASSED2) * line.row[2];
            if constexpr (!JUNCTION) rows.r1 += first;
            on.store(rows, p[RIGID], r);
            if constexpr (JUNCTION) { r[0] += first.x; r[1] += first.y; r[2] += first.z; }
            r[6] = (y[6] * 2.0 + y[13]) * (p[TURNING] * L * (1.0 / 6)) + brake;
            r[13] = (y[13] * 2.0 + y[6]) * (p[TURNING] * L * (1.0 / 6)) + brake;
            if constexpr (std::is_same_v<T, double>) if (results) {
                results->dissipated += p[TURNING] * L / 3 * (y[6] * y[6] + y[6] * y[13] + y[13] * y[13]);
                results->content -= ledge1.moved.x + ledge2.moved.x;
                // the mud that appears or vanishes there has its height
                const double gw = dot(vec(f.gravity), tw);
                results->left_out += ledge1.power(f, gw * dot(on.x.r1, tw) + p[LEVEL]) + ledge2.power(f, gw * dot(on.x.r2, tw) + p[LEVEL]);
            }
            finish(line, y + F, p, f, r + F, results);
        }
    }

    // the mud beside the rigid item above the element (fluid/annulus_flow.hpp), with the flow of the node
    template <class T>
    struct Beside {
        Vec<T> along, force;  // direction of the hole there; row on the string [N]
        T down, thick, height, V, resistance, push, pull;  // push: row of the flow without friction [J/m3]
        Beside() : along{T(0.0), T(0.0), T(0.0)}, force(along), down(0.0), thick(1.0), height(0.0), V(0.0), resistance(0.0), push(0.0), pull(0.0) {}
        // g.(lower end - upper end) along the hole
        template <class R, class S>
        Jet<T> rises(const R& on, const T* y, const T* a, const S* p, const Fluid& f) {
            const Vec<S> sum = vec(p + TANGENT0) + vec(p + TANGENT1), unit = sum * (S(1.0) / norm(sum));
            const Vec<T> zero = {T(0.0), T(0.0), T(0.0)};
            along = zero + unit;
            down = T(0.0) + dot(vec(f.gravity), unit);
            return Jet<T>{dot(on.x.r1 - on.above, along), dot(on.y.r1 - vec(y), along), dot(on.a.r1 - vec(a), along)}.times(down);
        }
        template <class R, class S>
        void set(const R& on, const T* y, const T* a, const T& q, const T& q1, const T& pressure, const S* p, const Fluid& f) {
            const S A = p[OPEN_ABOVE];
            height = dot(on.above, along) * down + p[LEVEL_ABOVE];
            V = dot(vec(y) + on.y.r1, along) * 0.5;
            thick = exp((pressure - heads(f, q, pressure, p[HEADS])) * f.compressibility);
            const T tau = shear(f, T(q / (thick * A) + V * (1.0 - f.clinging)), T(thick * f.density), p[GAP_ABOVE], 1.0);
            resistance = tau * (p[RIGID] * 4.0 / p[GAP_ABOVE]);
            push = (q1 * (p[RIGID] / A) / thick + dot(vec(a) + on.a.r1, along) * (p[RIGID] * 0.5) - dot(on.x.r1 - on.above, along) * down) * f.density;
            pull = tau * (p[RIGID] * 3.14159265358979324) * sqrt(p[OUTER_ABOVE] * (4.0 / 3.14159265358979324));
            force = along * ((push * thick + resistance) * (p[HOLE_ABOVE] - p[OUTER_ABOVE]) - pull) + (vec(f.gravity) - along * down) * (thick * (p[OUTER_ABOVE] * p[RIGID] * f.density));
        }
    };

    template <class R, class T, class S>
    static void point(const R& on, Stretch<T>& stretch, const CubicShape& at, double xi, double weight, const Vec<S>& tw, HolePassed<T, S>& hole, const S* p, const Fluid& f,
                      const Offset<T>& off, const T& spin, VolumeLine<T, S>& line, Four<T>& rows, T& brake, FlowResults* results) {
        const S L = p[LENGTH], il = S(1.0) / L, AO = p[OUTER];
        const Vec<double> g = vec(f.gravity);
        const S gw = dot(g, tw);
        const Vec<T> rs = slope(at, on.x, il), V = value(at, on.y, L), Vs = slope(at, on.y, il), Vt = value(at, on.a, L);
        const Vec<S> here = vec(p + TANGENT1) * (1 - xi) + vec(p + TANGENT2) * xi;
        const T local = norm(rs), n = stretch.at(at), narrow = 1.0 - (n - 1.0) * (p[POISSON] * 2.0);
        const T less = (hole.slope(at) - 1.0) * p[HOLE] - (n - 1.0) * (1.0 - n * (p[POISSON] * 2.0)) * AO, content = less + (p[HOLE] - AO);
        // mud that stays between its walls goes along with the hole's section less the string's: lam per length, with the speed `carry`
        const S of_hole = p[HOLE] / (p[HOLE] - AO);
        const T of_string = narrow * (AO / (p[HOLE] - AO));
        const T lam = content / (p[HOLE] - AO), lam1 = hole.slope_rate(at) * of_hole - dot(rs, Vs) / local * bulge(n, p[POISSON]) * (AO / (p[HOLE] - AO));
        const T carry = hole.speed(at) * of_hole - dot(V, here) * of_string;
        const T q = line.flow(at) + p[REFERENCE_FLOW], q1 = line.surge(at) + p[SURGE];
        const T head = is_waiting(p[WAITS]) ? line.straight(xi) : pressure_of(f, T((line.slope(at, il) + less) * -1.0), content, p[WALL] * (p[HOLE] - AO)), speed = heads(f, q, head, p[HEADS]);
        const T thick = exp((head - speed) * f.compressibility), density = thick * f.density, area = thick * content;
        const T w = q * lam / area, across = q / area, across1 = q1 / area, Va = dot(V, here), wall = w + carry, sheared = w + Va - Va * f.clinging;
        const StringShear<T> tau = string_shear<HermiteAnnulus>(f, w, sheared, T(Va - Va * f.clinging), density, p);
        const T outer = narrow * AO, beside = density * dot(rs, tw), M = beside * (p[CHI] * AO);
        const T drag = tau.drag * (p[DIAMETER] * 3.14159265358979324);
        const T resistance = tau.loss * lam * (S(4.0) / p[GAP]);
        const T push = (lam * lam / area * q1 + w * lam1 + lam * (hole.surge(at) * of_hole - dot(Vt, here) * of_string) - dot(rs, here) * (dot(g, here) / dot(here, here))) * f.density + resistance / thick;
        line.add(at, weight, push, flow_work(f, head));
        // pressure works on the section of the hole, with its heads, and on that of the string
        stretch.add(at, (head - speed) * bulge(n, p[POISSON]) * (AO * L * weight));
        const T force = push * thick * (p[HOLE] - AO);
        hole.add(at, weight, force * of_hole, head * (p[HOLE] * -1.0));
        const Vec<T> side = ((g - tw * gw) - vec(p + BEND) * (wall * wall)) * (beside * outer);
        const auto cut = [&tw](const Vec<T>& u) { return u - tw * dot(u, tw); };
        Vec<T> moved = cut(Vt * M + V * (drag + p[DAMPING]) + rs * (M * across1 + drag * across) + Vs * (M * across)), carried = cut((V + rs * across) * (M * across));
        const bool swirling = swirls(p[SHARE]);
        if (swirling) {
            const Vec<T> turned = value(at, off.turned, L);
            moved -= cross(tw, V * 2.0 + rs * across) * (M * p[SWIRL]) + turned * (M * p[SWIRL_RATE] + (drag + p[DAMPING]) * p[SWIRL]) +
                     value(at, off.y, L) * (M * (p[SWIRL] * p[SWIRL]));
            carried -= turned * (M * across * p[SWIRL]);
            brake += (dot(turned, moved) - dot(slope(at, off.turned, il), carried)) * (p[SHARE] * L * (-0.5 * weight));
        }
        const Vec<T> N = here * (force * of_string * -1.0 - tau.pull * (p[DIAMETER] * 3.14159265358979324)) + side + moved;
        rows.r1 += N * (L * (at.N[0] * weight)) - carried * (at.B[0] * weight);
        rows.v1 += N * (L * L * (at.N[1] * weight)) - carried * (L * (at.B[1] * weight));
        rows.r2 += N * (L * (at.N[2] * weight)) - carried * (at.B[2] * weight);
        rows.v2 += N * (L * L * (at.N[3] * weight)) - carried * (L * (at.B[3] * weight));
        if constexpr (std::is_same_v<T, double>) if (results) {
            const double part = weight * L, m = f.density * area, volume = q / thick;
            const Vec<double> X = value(at, on.x, L), turned = value(at, off.turned, L), relative_to = cut(V + rs * across);
            const Vec<double> passed = relative_to - turned * p[SWIRL], sideways = cut(V) - turned * spin;  // relative to the mud; the motion that feels the force
            const double relative = dot(turned, passed);
            // the flow across a bent string does work that its row leaves out (manual: eq-mud-energy-across)
            const Vec<double> across_hole = cut(V) - turned * p[SWIRL];
            const double mu = p[HOLE] - AO - line.slope(at, il), mu1 = -line.slope_rate(at, il), parting = val(lam1) * (p[HOLE] - AO);
            const double m1 = density * (content * ((line.p1.y * (1 - xi) + line.p2.y * xi) * f.compressibility) + parting);
            results->kinetic += part * (0.5 * (m * wall * wall + M * dot(across_hole, across_hole)) + M * (p[SWIRL] - spin) * relative);
            results->left_out += part * M * (relative * (p[SWIRL_RATE] - p[SHARE] * p[SPIN_RATE]) + across * across * dot(cut(rs), Vs));
            results->potential -= part * (mu * f.density * (gw * dot(X, tw) + p[LEVEL]) - density * AO * (dot(X, g - tw * gw) - p[LEVEL]));
            results->left_out -= part * (mu * f.density - m) * dot(g, here) * carry;  // the give of the walls has no weight on the string
            count(f, {q, w, head, content, mu, mu1, m, m1, carry, lam1}, (line.p2.x - line.p1.x) * il, p[WALL] * (p[HOLE] - AO), p[HEADS], part, L, results);
            results->dissipated += part * (resistance * (volume + carry * content) - tau.pull * p[DIAMETER] * 3.14159265358979324 * Va + drag * dot(sideways, passed) +
                                          p[DAMPING] * dot(sideways, cut(V) - turned * p[SWIRL]));
        }
    }

    template <class R, class T, class S>
    static void above(const R& on, const T& q, const Beside<T>& beside, const S* p, const Fluid& f, const VolumeLine<T, S>& line, FlowResults* results) {
        if constexpr (std::is_same_v<T, double>) if (results) {
            const Vec<double> g = vec(f.gravity), along = beside.along, middle = (on.above + on.x.r1) * 0.5;
            const double A = p[HOLE_ABOVE] - p[OUTER_ABOVE], down = beside.down, V = beside.V;
            const double wall = q / (beside.thick * A) + V, m = beside.thick * f.density * A * p[RIGID];
            results->dissipated += beside.resistance * (q / beside.thick + V * A) - beside.pull * V;
            results->kinetic += 0.5 * m * wall * wall;
            const double give = (A * p[RIGID] + line.item_more) * f.density - m;
            results->left_out -= give * down * V;
            results->potential -= (m + give) * (dot(middle, along) * down + p[LEVEL_ABOVE]) -
                                  beside.thick * f.density * p[OUTER_ABOVE] * p[RIGID] * (dot(middle, g - along * down) - p[LEVEL_ABOVE]);
        }
    }

    template <class T, class S>
    static void finish(const VolumeLine<T, S>& line, const T* y, const S* p, const Fluid& f, T* r, FlowResults* results) {
        line.store(f, r);
        if constexpr (std::is_same_v<T, double>) if (results) {
            const double own = JUNCTION ? (p[HOLE_ABOVE] - p[OUTER_ABOVE]) * p[RIGID] : 0.0;
            results->content += (p[HOLE] - p[OUTER]) * p[LENGTH] + own + line.V1.x - line.V2.x;
            if (own > 0.0) results->content += line.item_more, results->stored += stored_energy(f, line.middle.x, p[WALL], own);
            results->storage_upper = 0.5 * (y[0] - y[1]); results->storage_lower = results->storage_upper;
        }
    }
};

}  // namespace dp
