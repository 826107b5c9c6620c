// A bit whose torque falls with its speed: the built-in velocity weakening, outside the program.
#include "core/plug_in.hpp"

using namespace dp;

struct Weakening {
    DP_ENUM(Parameter, STATIC, DYNAMIC, SPEED, NP)  // [N m, N m, rad/s]

    template <class T>
    static void results(const T* state, const double* p, T* result) {
        const T omega = state[OwnBit::SPEED], q = omega * (1.0 / p[SPEED]), u = q * 100.0, u2 = u * u;
        const T torque = p[DYNAMIC] + (p[STATIC] - p[DYNAMIC]) * exp(-(q * q));
        // its sign is rounded below a hundredth of the speed
        if (val(u2) < 1) result[OwnBit::TORQUE] = torque * u * (15.0 - 10.0 * u2 + 3.0 * u2 * u2) * 0.125;
        else result[OwnBit::TORQUE] = torque * (val(omega) > 0 ? 1.0 : -1.0);
    }
};

DP_BIT_LAW(weakening, Weakening)
