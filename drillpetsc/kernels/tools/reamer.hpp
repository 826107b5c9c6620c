// A reamer: blades above the bit that cut the ring between pilot hole and reamed hole, with a surface of its own.
//
// Unknowns r, v, phi of the node above; reamed: metres cut since the start; chips (N): the ring's profile ahead of a blade (motion only).
//   place    zeta = (r + l t - P).t_h + s_P, of the cutters along the hole, below the shoulder at the start
//   cutting  W = cut d, T = torque_cut d; in motion d = blades [zeta - B(0)] with the profile of a drag bit (bit/bit.hpp)
//            without inertia W = k [zeta - reamed], d = W/cut
//   shoulder reamed' = [omega]_+ d/2 pi
#pragma once
#include "bit/bit.hpp"

namespace dp {

DP_RECORD(ReamerResults, double weight, torque, rate, stored, dissipated;)  // [N], [N m], [m/s], [J], [W]

template <int N>  // number of states of the profile; 0: none
struct Reamer {
    static constexpr int D = 8 + N, NSPIN = 1;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{6, 3}};
    enum { REAMED = 7, CHIP = 8 };
    DP_ENUM(Parameter,
        FACE,                    // distance of the cutters below the node [m]
        STIFFNESS,               // of cutters on the shoulder, without inertia [N/m]
        AXIS, POINT = AXIS + 3,  // 3 each: direction of the hole, point on its axis [m]
        PLACE = POINT + 3,       // of that point below the shoulder at the start [m]
        MODE, SPIN,              // BitMode; imposed rotation [rad/s]
        NP)
    static constexpr int RESULTS = sizeof(ReamerResults) / sizeof(double);

    static void results(const double* x, const double* y, const double* p, void* context, double* out) {
        double r[D];
        ReamerResults now{};
        evaluate<double>(x, y, p, *static_cast<BitLaw*>(context), r, &now);
        *reinterpret_cast<ReamerResults*>(out) = now;
    }

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T*, const S* p, void* context, T* r) {
        evaluate<T>(x, y, p, *static_cast<BitLaw*>(context), r, nullptr);
    }

    template <class T>
    static void evaluate(const T* x, const T* y, const double* p, BitLaw& law, T* r, ReamerResults* results) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        law.touching = 0;
        const bool moving = p[MODE] == BitMode::MOTION;
        const Tangent<T> t(vec(x + 3), vec(y + 3), vec(y + 3));
        const Vec<double> axis = vec(p + AXIS);
        const Vec<T> arm = t.t * p[FACE], speed = vec(y) + t.t1 * p[FACE];
        const T zeta = dot(vec(x) + arm - vec(p + POINT), axis) + p[PLACE];
        const T omega = moving ? y[6] : T(p[SPIN]), turning = forward(omega);
        T depth = T(0.0), weight = T(0.0), elastic = T(0.0);  // depth of cut per turn
        if (N > 0 && moving) {
            const T gap = zeta - x[CHIP];
            law.touching = !(val(gap) <= -RAMP);
            const T chip = val(gap) <= -RAMP ? T(0.0) : onset(gap), inflow = x[CHIP] + chip;
            depth = chip * law.blades;
            weight = depth * law.cut;
            for (int k = 0; k < N; ++k) {
                const double* d = law.derivative + k * (N + 1);
                T slope = inflow * d[N];
                for (int j = 0; j < N; ++j) slope += x[CHIP + j] * d[j];
                r[CHIP + k] = (y[CHIP + k] - turning * slope) * ROCK_ROW;
            }
        } else {
            const T gap = zeta - x[REAMED];
            if (!(val(gap) <= -RAMP)) {
                law.touching = 1;
                elastic = onset(gap);
                weight = elastic * p[STIFFNESS];
                depth = weight * (1.0 / law.cut);
            }
            for (int k = 0; k < N; ++k) r[CHIP + k] = x[CHIP + k] * ROCK_ROW;  // at rest, before the first cut
        }
        const T sign = val(omega) > 0 ? omega / sqrt(omega * omega + law.turn_rounding * law.turn_rounding) : T(0.0);
        const T torque = depth * law.torque_cut * sign, rate = turning * depth * (1 / (2 * M_PI));
        if (p[MODE] == BitMode::STATICS) r[REAMED] = x[REAMED] * (1e3 * ROCK_ROW);
        else r[REAMED] = (y[REAMED] - rate) * ROCK_ROW;

        const Vec<T> F = axis * (-1.0 * weight), M = cross(arm, F), bend = cross(M, t.t) / t.n;
        r[0] = -1.0 * F.x; r[1] = -1.0 * F.y; r[2] = -1.0 * F.z;
        r[3] = -1.0 * bend.x; r[4] = -1.0 * bend.y; r[5] = -1.0 * bend.z;
        r[6] = torque;
        if (results) {
            results->weight = val(weight);
            results->torque = val(torque);
            results->rate = val(rate);
            results->stored = 0.5 * val(weight) * val(elastic);
            results->dissipated = val(torque * omega - dot(F, speed)) - (val(elastic) > 0 ? val(weight) * val(dot(speed, axis) - y[REAMED]) : 0.0);
        }
    }
};

}  // namespace dp
