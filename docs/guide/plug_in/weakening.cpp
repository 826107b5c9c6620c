// A bit whose torque falls with its speed: the built-in velocity weakening, outside the program.
#include "core/plug_in.hpp"

using namespace dp;

struct Weakening {
    DP_ENUM(Parameter, STATIC, DYNAMIC, SPEED, NP)  // [N m, N m, rad/s]

    template <class T>
    static void results(const T* state, const double* p, T* result) {
        const T omega = state[OwnBit::SPEED];
        const double rest = p[SPEED] / 100, way = val(omega) > 0 ? 1.0 : -1.0;
        if (val(omega) * way < rest) {  // rises smoothly to the static torque
            const T u = omega / rest, u2 = u * u;
            result[OwnBit::TORQUE] = u * (15.0 - 10.0 * u2 + 3.0 * u2 * u2) * (p[STATIC] / 8);
            return;
        }
        const T q = (omega * way - rest) / p[SPEED];
        result[OwnBit::TORQUE] = (p[DYNAMIC] + (p[STATIC] - p[DYNAMIC]) * exp(-(q * q))) * way;
    }
};

DP_BIT_LAW(weakening, Weakening)
