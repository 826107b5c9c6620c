// Block on a drilling line, on the uppermost node, and the autodriller that turns the drum.  Unknowns r, v, phi, the pay-out of the drum
// and the states of the autodriller (manual: sec-hoist).  A state that the autodriller does not have is an absent field, whose value is
// not used.
#pragma once
#include "core/element.hpp"
#include "top/top_drive.hpp"

namespace dp {

struct HoistLine {
    static constexpr int D = 14, NSPIN = 1, LOOPS = 3;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{6, 3}};
    // states: pay-out as motion of the block [m], integrators [m/s] and filtered measurements of the loops
    enum Slot { PAYOUT = 7, INTEGRAL = 8, FILTERED = INTEGRAL + LOOPS };
    DP_ENUM(Parameter,
        LOCKED,                                // 1: the top's position is prescribed (statics), the line takes no part
        AXIS, ORIGIN = AXIS + 3,               // 3 each: the block's travel is TRAVEL + AXIS.(r - ORIGIN), down positive
        TRAVEL = ORIGIN + 3,                   // [m]
        MASS, WEIGHT,                          // of the block [kg], its weight along the axis [N]
        MODULUS, ROPE, LINES,                  // n^2 EA [N]; unstrained rope at pay-out 0 [m]; n
        STRETCH, DAMPING,                      // stretch of the lines in the state of pay-out 0 and travel 0 [m]; [N s/m]
        HEAVE, HEAVE_RATE,                     // upward motion of the crown [m], [m/s]
        CLOSED,                                // 1: the autodriller acts; 0: the drum has the speed GIVEN
        GIVEN, LEAST, MOST,                    // speed of the drum, its limits [m/s]
        USED, SET = USED + 3,              // of the loops (weight, torque, pressure): whether it is there, set point [N, N m, Pa]
        PROPORTIONAL = SET + 3, INTEGRATION = PROPORTIONAL + 3,  // gains [m/s and m/s2 per unit]
        FILTER = INTEGRATION + 3,          // time constants of the measurements [s], 0: none
        SENSED = FILTER + 3,               // 1: the measurement is MEASURED; 0 (weight only): TARE - hook load
        MEASURED = SENSED + 3,
        TARE = MEASURED + 3,               // hook load without weight on bit [N]
        RATED, RATE,                           // whether there is a set point of the rate of penetration; it [m/s]
        NP)
    // force of the lines, pull on the string [N], speed of the drum [m/s], travel [m], its rate [m/s], mode, measured weight [N],
    // power lost in the damper, power of drum and heave [W], energy of the lines [J]
    DP_ENUM(Result, LINE, HOOK, DRUM, DEPTH, SPEED, MODE, LOAD, LOST, SUPPLIED, ENERGY, RESULTS)

    static constexpr double ROUNDED = 1e-5;  // width over which limits and the change of loops are rounded [m/s]
    static constexpr double ROW = 1e6;       // weight of rows in m/s, which gives them the size of forces [N s/m]

    template <class T>
    struct Values {
        T depth, speed, gap, elastic, damper, line, hook, strain, drum, measured[LOOPS], seen[LOOPS];
        int mode;
    };

    template <class T, class S>
    static Values<T> evaluate(const T* x, const T* y, const T* a, const S* p) {
        Values<T> q;
        T pull = T(0.0);
        q.depth = T(p[TRAVEL]);
        q.speed = T(0.0);
        for (int i = 0; i < 3; ++i) {
            q.depth += (x[i] - p[ORIGIN + i]) * p[AXIS + i];
            q.speed += y[i] * p[AXIS + i];
            pull += a[i] * p[AXIS + i];
        }
        const T rope = T(p[ROPE]) + x[PAYOUT] * p[LINES];
        q.gap = q.depth - x[PAYOUT] + (p[STRETCH] + p[HEAVE]);
        q.elastic = q.gap * p[MODULUS] / rope;
        q.damper = (q.speed - y[PAYOUT] + p[HEAVE_RATE]) * p[DAMPING];
        q.line = q.elastic + q.damper;
        q.hook = q.line + pull * p[MASS] - p[WEIGHT];
        q.strain = q.gap * p[LINES] / rope;
        for (int j = 0; j < LOOPS; ++j) {
            q.measured[j] = p[SENSED + j] != 0 ? T(p[MEASURED + j]) : T(p[TARE]) - q.hook;
            q.seen[j] = p[FILTER + j] > 0 ? x[FILTERED + j] * 1.0 : q.measured[j];
        }
        q.mode = 0;
        q.drum = T(p[GIVEN]);
        if (p[CLOSED] == 0) return q;
        // the loop with the least speed acts
        bool first = true;
        T unused;
        double least = 0;
        for (int j = -1; j < LOOPS; ++j) {
            if (j < 0 ? p[RATED] == 0 : p[USED + j] == 0) continue;
            T wanted = j < 0 ? T(p[RATE]) : (T(p[SET + j]) - q.seen[j]) * p[PROPORTIONAL + j];
            if (j >= 0 && p[INTEGRATION + j] > 0) wanted += x[INTEGRAL + j];
            if (first || val(wanted) < least) { least = val(wanted); q.mode = j < 0 ? 2 : (j == 0 ? 1 : j + 2); }
            q.drum = first ? wanted : TopMotor::smaller(q.drum, wanted, T(ROUNDED), unused);
            first = false;
        }
        q.drum = TopMotor::smaller(q.drum, T(p[MOST]), T(ROUNDED), unused);
        q.drum = -TopMotor::smaller(-q.drum, T(-p[LEAST]), T(ROUNDED), unused);
        return q;
    }

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void*, T* r) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        if (p[LOCKED] != 0) {
            r[PAYOUT] = x[PAYOUT] * ROW;
            for (int j = 0; j < LOOPS; ++j) {
                if (p[INTEGRATION + j] > 0) r[INTEGRAL + j] = x[INTEGRAL + j] * ROW;
                if (p[FILTER + j] > 0) r[FILTERED + j] = x[FILTERED + j] * 1.0;
            }
            return;
        }
        const Values<T> q = evaluate(x, y, a, p);
        for (int i = 0; i < 3; ++i) r[i] = q.hook * p[AXIS + i];
        // the drum's surface has the speed of stretched rope
        r[PAYOUT] = (y[PAYOUT] * (q.strain + 1.0) - q.drum) * ROW;
        for (int j = 0; j < LOOPS; ++j) {
            // the integrator follows the drum's speed with the time p/i: where the loop is in charge, the integral of i e
            const double i = p[INTEGRATION + j];
            if (i > 0) r[INTEGRAL + j] = (y[INTEGRAL + j] * (p[PROPORTIONAL + j] / i) + x[INTEGRAL + j] - q.drum) * ROW;
            const double tau = p[FILTER + j];
            if (tau > 0) r[FILTERED + j] = y[FILTERED + j] * tau + x[FILTERED + j] - q.measured[j];
        }
    }
};

}  // namespace dp
