// Agitator: a valve that a rotor of the mud opens and closes; its pressure pulses push the halves of a slider apart (manual: sec-agitator).
// Unknowns: those of both nodes of the slider, the angle of the rotor [rad]; FLOWING: the pressures and the flow rate of the bore, which
// loses the pressure of the pulses there.
#pragma once
#include "fluid/flow.hpp"

namespace dp {

struct AgitatorParameters {
    DP_ENUM(Parameter,
        HELD,               // 1: statics, the rotor stands; 0: in motion
        TURN,               // angle of the rotor per volume [rad/m3]
        AMPLITUDE, AREA,    // of the pressure [Pa], of the piston [m2]
        SQUARE,             // 1: square pulses, 0: sine
        FLOW,               // flow rate where no mud is modelled [m3/s]
        COMPRESSIBILITY,    // of the mud [1/Pa]
        NP)
    DP_ENUM(Result, PRESSURE, FORCE, FLOW_RATE, SPEED, RESULTS)
};

template <bool FLOWING>
struct Agitator : AgitatorParameters {
    static constexpr int D = FLOWING ? 18 : 15, NSPIN = 2;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[2][2] = {{6, 3}, {13, 10}};
    enum Slot { ANGLE = 14, PRESSURE1, PRESSURE2, RATE };
    static constexpr double EDGE = 0.05;         // sine over which a square pulse turns its sign
    static constexpr double LEAST_FLOW = 1e-4;   // flow rate over which the pulses set in [m3/s]

    template <class T> struct Values { T flow, pressure; };

    template <class T>
    static Values<T> evaluate(const T* x, const double* p) {
        Values<T> q;
        if constexpr (FLOWING) q.flow = x[RATE] * exp((x[PRESSURE1] + x[PRESSURE2]) * (-0.5 * p[COMPRESSIBILITY]));
        else q.flow = T(p[FLOW]);
        T wave = sin(x[ANGLE]);
        if (p[SQUARE] != 0) wave = wave / sqrt(wave * wave + EDGE * EDGE) * std::sqrt(1.0 + EDGE * EDGE);
        const T square = q.flow * q.flow;
        q.pressure = wave * (square / (square + LEAST_FLOW * LEAST_FLOW)) * p[AMPLITUDE];
        return q;
    }

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T*, const S* p, void*, T* r) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        const Values<T> q = evaluate(x, p);
        const Vec<T> v = vec(x + 3), push = v / norm(v) * (q.pressure * p[AREA]);
        r[0] = push.x; r[1] = push.y; r[2] = push.z;
        r[7] = -push.x; r[8] = -push.y; r[9] = -push.z;
        r[ANGLE] = p[HELD] > 0 ? x[ANGLE] * 1.0 : y[ANGLE] - q.flow * p[TURN];
        if constexpr (FLOWING) r[RATE] = q.pressure * MOMENTUM_ROW;
    }

    // speed: of the halves apart [m/s]
    static void results(const double* x, const double* y, const double* p, void*, double* out) {
        const Values<double> q = evaluate(x, p);
        const Vec<double> v = vec(x + 3), t = v / norm(v);
        out[PRESSURE] = q.pressure; out[FORCE] = q.pressure * p[AREA]; out[FLOW_RATE] = q.flow;
        out[SPEED] = dot(t, vec(y + 7) - vec(y));
    }
};

}  // namespace dp
