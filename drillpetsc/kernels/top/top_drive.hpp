// Motor and speed controller of a top drive, on the uppermost node.  Unknowns r, v, phi and the states of the controller (manual:
// sec-top-drive).  A state that the controller does not have is an absent field, whose value is not used.
#pragma once
#include "core/element.hpp"

namespace dp {

struct TopMotor {
    static constexpr int D = 13, NSPIN = 1;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{6, 3}};
    // states: integrator [N m], torque behind the lag [N m], low-passed and high-passed torque [N m], delay [N m] and [N m/s]
    enum Slot { SPIN = 6, INTEGRAL, LAGGED, LOW_PASSED, HIGH_PASSED, DELAYED, DELAYED_RATE };
    DP_ENUM(Parameter,
        HELD, ANGLE,                   // stiffness that holds the section in statics [N m/rad], 0: in motion; at this angle [rad]
        INERTIA,                       // [kg m2]
        CLOSED,                        // 1: the controller acts; 0: the torque is GIVEN
        SPEED, GIVEN,                  // set point [rad/s]; torque [N m]
        PROPORTIONAL, INTEGRATION,     // p [N m s/rad], i [N m/rad]
        COMPENSATION,                  // compensated inertia [kg m2]
        COUPLING,                      // set point's change by the pipe's torque [rad/(N m s)]
        LOW_PASS, HIGH_PASS,           // time constants of the filters [s], 0: none
        ESTIMATED,                     // 1: the pipe's torque follows from torque and filtered acceleration
        DELAY_STATE, DELAY,            // delay of the states, and of the controller's output [s]
        LAG, RATE,                     // time constant of the motor [s], largest rate of its torque [N m/s]; 0: none
        MAX_TORQUE, MIN_TORQUE, POWER, // limits [N m], [N m], [W]; 0: none (MIN_TORQUE counts with MAX_TORQUE)
        NP)
    DP_ENUM(Result, TORQUE, PIPE, ERROR, COMMAND, LIMITED, RESULTS)

    static constexpr double ROUNDED = 0.005;  // half the width over which a limit is rounded, as a fraction of it

    template <class T>
    struct Values {
        T torque, pipe, filtered, error, command, output, raw, above, below;  // above, below: 1 inside the limits, 0 at the upper, lower one
    };

    // smaller of two, rounded where they differ by less than d > 0; g: its derivative by a
    template <class T>
    static T smaller(const T& a, const T& b, const T& d, T& g) {
        const T z = a - b;
        if (z <= -d) { g = T(1.0); return a; }
        if (z >= d) { g = T(0.0); return b; }
        g = (d - z) / (d * 2.0);
        return b - (z - d) * (z - d) / (d * 4.0);
    }

    // torque m within the limits of the motor at the spin rate w; above, below: its derivative by m at the upper and the lower limit
    template <class T, class S>
    static T limited(const T& m, const T& w, const S* p, T& above, T& below) {
        above = below = T(1.0);
        if (!(p[MAX_TORQUE] > 0)) return m;
        T upper = T(p[MAX_TORQUE]), low = T(-p[MIN_TORQUE]), g;
        const T speed = val(w) < 0 ? -w : w * 1.0;
        if (p[POWER] > 0 && val(speed) * p[MAX_TORQUE] > 0.5 * p[POWER]) {
            const T most = T(p[POWER]) / speed;
            upper = smaller(most, upper, T(ROUNDED * p[MAX_TORQUE]), g);
            if (p[MIN_TORQUE] < 0) low = smaller(most, low, T(-ROUNDED * p[MIN_TORQUE]), g);
        }
        const T least = upper * (0.1 * ROUNDED);  // a limit of 0 is rounded, too
        T width = (val(low) < 0 ? -low : low * 1.0) * ROUNDED;
        if (val(width) < val(least)) width = least;
        const T cut = smaller(m, upper, upper * ROUNDED, above);
        return -smaller(-cut, low, width, below);
    }

    template <class T, class S>
    static Values<T> evaluate(const T* x, const T* y, const T* a, const S* p) {
        Values<T> q;
        const T w = y[SPIN], push = a[SPIN] * p[INERTIA];
        const bool low = p[LOW_PASS] > 0, high = p[HIGH_PASS] > 0, lag = p[LAG] > 0;
        // the measured torque of the pipe is direct * torque + rest
        const bool direct = !low || p[ESTIMATED] != 0;
        const T filtered = low ? x[LOW_PASSED] : push;
        const T rest = direct ? -filtered : filtered;
        const T mean = high ? x[HIGH_PASSED] : T(0.0);
        const double k = p[COUPLING], kp = p[PROPORTIONAL];
        const T error = T(p[SPEED]) - w - (rest - mean) * k;
        const T held = x[INTEGRAL] * (p[INTEGRATION] != 0 ? 1.0 : 0.0);
        const T wanted = error * kp + held + a[SPIN] * p[COMPENSATION];
        const T late = p[DELAY] > 0 ? x[DELAYED_RATE] * p[DELAY] : T(0.0);
        const double share = direct ? k : 0.0;
        if (p[CLOSED] == 0) q.output = T(p[GIVEN]);
        else q.output = (lag ? wanted - x[LAGGED] * (kp * share) - late : (wanted - late) / (1.0 + kp * share));
        q.raw = limited(q.output, w, p, q.above, q.below);
        q.torque = lag ? x[LAGGED] : q.raw;
        q.error = error - q.torque * share;
        q.command = wanted - q.torque * (kp * share);
        q.pipe = q.torque - push;
        q.filtered = direct ? q.torque + rest : rest;
        return q;
    }

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void*, T* r) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        if (p[HELD] > 0) {
            r[SPIN] = a[SPIN] * p[INERTIA] + (x[SPIN] - p[ANGLE]) * p[HELD];
            for (int i = INTEGRAL; i < D; ++i) r[i] = x[i] * 1.0;
            return;
        }
        const Values<T> q = evaluate(x, y, a, p);
        r[SPIN] = a[SPIN] * p[INERTIA] - q.torque;
        // a limit holds the integrator where the error pushes against it
        T open = val(q.error) > 0 ? q.above : q.below;
        if (p[LAG] > 0) {
            T rate = (q.raw - x[LAGGED]) / p[LAG];
            if (p[RATE] > 0) {
                T above, below;
                const T width = T(ROUNDED * p[RATE]);
                const T cut = smaller(rate, T(p[RATE]), width, above);
                rate = -smaller(-cut, T(p[RATE]), width, below);
                open = open * (val(q.error) > 0 ? above : below);
            }
            r[LAGGED] = y[LAGGED] - rate;
        } else r[LAGGED] = y[LAGGED];
        r[INTEGRAL] = p[CLOSED] != 0 && p[INTEGRATION] != 0 ? y[INTEGRAL] - q.error * open * p[INTEGRATION] : y[INTEGRAL] * 1.0;
        const T measured = p[ESTIMATED] != 0 ? a[SPIN] * p[INERTIA] : q.pipe;
        r[LOW_PASSED] = p[LOW_PASS] > 0 ? y[LOW_PASSED] * p[LOW_PASS] + x[LOW_PASSED] - measured : x[LOW_PASSED] * 1.0;
        r[HIGH_PASSED] = p[HIGH_PASS] > 0 ? y[HIGH_PASSED] * p[HIGH_PASS] + x[HIGH_PASSED] - q.filtered : x[HIGH_PASSED] * 1.0;
        const double d = p[DELAY_STATE];
        r[DELAYED] = y[DELAYED] - x[DELAYED_RATE];
        r[DELAYED_RATE] = y[DELAYED_RATE] * (d * d / 12.0) + x[DELAYED_RATE] * (0.5 * d) + x[DELAYED] - q.command;
    }
};

}  // namespace dp
