// Flow in the bore of the string, exact in space: mass, momentum along the string, and its reaction on the string.
//
// Per reference length m = rho A lam = rho0 mu, f(lam) = lam (1 - 2 nu (lam - 1)) with the bore's narrowing by stretch.
//   mass, node j       int psi_j d(mu)/dt ds - int psi_j' q ds = 0                          [m3/s]
//   momentum, element  int rho lam [w_t + w lam_t/lam + t.V_t - g.t] ds + [p] + 4 tau L/d = 0  [Pa],   w = q lam/mu
//   string             int dr.[d(m V + G r_s)/dt - m g] ds - int dr_s.[G V + G^2/m r_s + p A f' t] ds
// The walls' give counts for what the channel holds, not for its momentum and weight: m = rho A f there.  With it, an open string in still
// mud would carry p^2 d(ln A)/dp A/2 for a flare of its bore that the equal pressure outside does not let it have.
// The conservative form of the momentum of the fluid needs no second derivatives and no end terms but the jet's.
#pragma once
#include "fluid/flow.hpp"

namespace dp {

template <bool JUNCTION, bool HELD>
struct BoreFlow {
    static constexpr int F = HELD ? 0 : JUNCTION ? 15 : 14, D = F + 3, NSPIN = 0;
    static constexpr bool PACKED = true;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter,
        LENGTH, RIGID,             // of the element and of the rigid item above it [m]
        POISSON,                   // 0: rigid walls
        AREA, AREA_ABOVE,          // of the bore, here and in the rigid item [m2]
        WALL,                      // d(ln A)/dp [1/Pa]
        DIAMETER, DIAMETER_ABOVE,  // of the bore, here and in the rigid item [m]
        JOINT_SHARE, JOINT_DIAMETER,  // share of the length that tool joints have, and their bore [m]
        TUBE_SPEED, JOINT_SPEED,   // mean area over that of the tube, of the tool joints
        STEP, LOSS,                // (1/A^2 - 1/A_up^2)/2, K/(2 A^2) [1/m4]
        CONTROL, CONTROLLED,       // CONTROL 1: pressure of the upper node is CONTROLLED [Pa]
        DROP, HEAD,                // when held: g.(r2 - r1), g.(r1 + r2)/2 [m2/s2]
        NP)

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        evaluate<false, T, S>(x, y, a, p, *static_cast<const Fluid*>(context), r, nullptr);
    }

    template <bool RESULTS, class T, class S>
    static void evaluate(const T* x, const T* y, const T* a, const S* p, const Fluid& f, T* r, FlowResultsOf<T>* results) {
        const T p1 = x[F], p2 = x[F + 1], q = x[F + 2], flow = y[F + 2], mean = (p1 + p2) * 0.5;
        const S L = p[LENGTH], A = p[AREA];
        const Compressed<T> c(f, mean, p[WALL]);
        T stretch = T(1.0), content = T(1.0), rate = T(0.0), squeeze1 = T(0.0), squeeze2 = T(0.0), inertia = T(0.0), drop = T(0.0) + p[DROP];
        Four<T> rows;
        const Vec<double> g = vec(f.gravity);
        if constexpr (!HELD) {
            const Ride<T, JUNCTION> on(x, y, a, p[RIGID]);
            const Vec<T> d = on.x.r2 - on.x.r1, d_rate = on.y.r2 - on.y.r1;
            const S il = S(1.0) / L;
            stretch = T(0.0); content = T(0.0);
            Vec<T> Qd = {T(0.0), T(0.0), T(0.0)}, Q1 = Qd, Q2 = Qd;
            for (int k = 0; k < 3; ++k) {
                const Shape<T, S> N(XI3[k], il);
                const Vec<T> slope = N.slope(d, on.x.v1, on.x.v2);
                const T n = norm(slope), bulge = 1.0 - (n * 2.0 - 1.0) * (p[POISSON] * 2.0);  // f'
                const Vec<T> t = slope / n;
                const T n_rate = dot(t, N.slope(d_rate, on.y.v1, on.y.v2));
                stretch += n * W3[k];
                content += n * (1.0 - (n - 1.0) * (p[POISSON] * 2.0)) * W3[k];
                rate += n_rate * W3[k];
                squeeze1 += bulge * n_rate * ((1 - XI3[k]) * W3[k]);
                squeeze2 += bulge * n_rate * (XI3[k] * W3[k]);
                const Vec<T> push = t * (bulge * (p1 * (1 - XI3[k]) + p2 * XI3[k]) * (A * L * -W3[k]));
                Qd += push * N.B0; Q1 += push * N.B1; Q2 += push * N.B2;
            }
            const T m = c.density * content * A, G = q * f.density, G1 = flow * f.density;
            const T m1 = c.density * (content * ((y[F] + y[F + 1]) * (0.5 * f.compressibility)) + squeeze1 + squeeze2) * A;
            const Four<T> along = slopes(d, on.x.v1, on.x.v2, L);
            inertia = c.density * (dot(along.r1, on.a.r1) + dot(along.v1, on.a.v1) + dot(along.r2, on.a.r2) + dot(along.v2, on.a.v2));
            if constexpr (JUNCTION) inertia += c.density * dot(on.t0, on.a.r1) * p[RIGID];
            drop = dot(on.x.r2 - on.above, g);
            const Four<T> push = {on.a.r1 * m + on.y.r1 * m1 - g * m, on.a.v1 * m + on.y.v1 * m1, on.a.r2 * m + on.y.r2 * m1 - g * m,
                                  on.a.v2 * m + on.y.v2 * m1};
            const Vec<T> zero = {T(0.0), T(0.0), T(0.0)};
            rows = {zero - Qd, Q1, Qd, Q2};
            accumulate(rows, consistent(push, L), L * (1.0 / 420));
            accumulate(rows, along, G1);
            accumulate(rows, slopes(d_rate, on.y.v1, on.y.v2, L), G * 2.0);
            rows.r1 += on.y.r1 * G;
            rows.r2 -= on.y.r2 * G;
            accumulate(rows, stiffness(d, on.x.v1, on.x.v2, L), -(G * G / m));
            if constexpr (JUNCTION) {  // mud in the rigid item, as one piece with straight motion between its ends
                const T half = c.density * (p[AREA_ABOVE] * p[RIGID] * 0.5);
                const Vec<T> turn = (on.x.r1 - on.above) * (G1 * 0.5), upper = (vec(a) - g) * half + turn + on.y.r1 * G;
                rows.r1 += (on.a.r1 - g) * half + turn - vec(y) * G;
                on.store(rows, p[RIGID], r);
                r[0] += upper.x; r[1] += upper.y; r[2] += upper.z;
            } else {
                on.store(rows, p[RIGID], r);
            }
            if constexpr (RESULTS) energies(on, m, G, c, p, f, y, (squeeze1 + squeeze2) * (A * L), mean, results);
        }
        const T thick = c.density * (1.0 / f.density), area = thick * content * A, w = q * stretch / area;
        T resistance = bore_shear(f, w, c.density, p[DIAMETER], p[JOINT_SHARE], p[TUBE_SPEED], p[JOINT_DIAMETER], p[JOINT_SPEED]) * (stretch * L * 4.0 / p[DIAMETER]);
        T mass = c.density * stretch * stretch * L / area;
        T volume = content * (A * L);
        if constexpr (JUNCTION) {
            const T open = thick * p[AREA_ABOVE];
            resistance += shear(f, q / open, c.density, p[DIAMETER_ABOVE], 0.0) * (p[RIGID] * 4.0 / p[DIAMETER_ABOVE]);
            mass += c.density * p[RIGID] / open;
            volume += T(0.0) + p[AREA_ABOVE] * p[RIGID];
        }
        const T size = sqrt(q * q + 1e-20), heads = q * (q * p[STEP] + size * p[LOSS]) * (f.density * f.density) / c.density;
        const T stored = c.by_p * volume * (1.0 / 12);
        const T s1 = stored * (y[F] * 5.0 + y[F + 1]) + c.theta * squeeze1 * (A * L);
        const T s2 = stored * (y[F + 1] * 5.0 + y[F]) + c.theta * squeeze2 * (A * L);
        const S free = S(1.0) - p[CONTROL];
        r[F] = ((s1 + q) * free + (p1 - p[CONTROLLED]) * (p[CONTROL] * GIVEN_PRESSURE)) * MASS_ROW;
        r[F + 1] = (s2 - q) * MASS_ROW;
        r[F + 2] = (mass * flow + c.density * w * rate * L + inertia - c.density * drop + p2 - p1 + resistance + heads) * MOMENTUM_ROW;
        if constexpr (RESULTS) {
            const T lost = q * (f.density / c.density);
            results->stored = stored_energy(f, mean, p[WALL], volume);
            results->dissipated = lost * (resistance + q * size * p[LOSS] * f.density * f.density / c.density);
            results->content = c.theta * volume; results->storage_upper = s1; results->storage_lower = s2;
            results->speed = w; results->density = c.density;
            // the row of momentum leaves out the flow's own convection (manual: eq-mud-left-out-flow)
            T convection = -(w * w * f.density) * ((s1 + s2) * 1.5 + q * (p2 - p1) * f.compressibility);
            if constexpr (HELD) {
                results->kinetic = 0.5 * mass * q * lost;
                results->potential = -(c.theta * volume) * f.density * p[HEAD];
                results->left_out = T(0.0);
            } else {  // G q^2/2m of a bore whose nodes move apart
                convection += q * w * rate * L * f.density - w * w * (squeeze1 + squeeze2) * c.density * (A * L) * 0.5;
            }
            convection -= 0.5 * mass * q * lost * ((y[F] + y[F + 1]) * (0.5 * f.compressibility));
            results->left_out += convection;
        }
    }

    // widens: rate of the volume at zero pressure by the motion of the string [m3/s].  The potential is that of all mud, with that in the give.
    // kinetic energy m |V|^2/2 + G V.r_s + G^2 |r_s|^2/2m of the fluid in motion with the string
    template <class R, class T, class S>
    static void energies(const R& on, const T& m, const T& G, const Compressed<T>& c, const S* p, const Fluid& f, const T* y, const T& widens,
                         const T& pressure, FlowResultsOf<T>* results) {
        const S L = p[LENGTH];
        const auto pair = [](const Four<T>& u, const Four<T>& v) { return dot(u.r1, v.r1) + dot(u.v1, v.v1) + dot(u.r2, v.r2) + dot(u.v2, v.v2); };
        const Vec<T> d = on.x.r2 - on.x.r1;
        const T speed = pair(on.y, consistent(on.y, L)) * (L * (0.5 / 420)) * m;
        const T mixed = pair(slopes(d, on.x.v1, on.x.v2, L), on.y) * G;
        const T own = pair(on.x, stiffness(d, on.x.v1, on.x.v2, L)) * (G * G / m) * 0.5;
        results->kinetic = speed + mixed + own;
        const Vec<T> middle = (on.x.r1 + on.x.r2) * 0.5 + (on.x.v1 - on.x.v2) * (L * (1.0 / 12));
        const Vec<T> middle_rate = (on.y.r1 + on.y.r2) * 0.5 + (on.y.v1 - on.y.v2) * (L * (1.0 / 12));
        const T give = pressure * p[WALL], g_rate = dot(middle_rate, vec(f.gravity));
        results->potential = -(m * L * dot(middle, vec(f.gravity))) * (1.0 + give);
        results->left_out = -give * (m * L * g_rate + 0.5 * (pressure * widens));
        if constexpr (JUNCTION) {
            const T line = c.density * p[AREA_ABOVE];
            const S a = p[RIGID];
            const Vec<T> rod = on.x.r1 - on.above, V = vec(y), V1 = on.y.r1;
            results->potential -= 0.5 * line * a * (1.0 + give) * dot(on.x.r1 + on.above, vec(f.gravity));
            results->left_out -= 0.5 * line * a * give * dot(V1 + V, vec(f.gravity));
            results->kinetic += 0.25 * line * a * (dot(V, V) + dot(V1, V1)) + 0.5 * G * (dot(rod, V) + dot(rod, V1)) + 0.5 * G * G * a / line;
        }
    }
};

}  // namespace dp
