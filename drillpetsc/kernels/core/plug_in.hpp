// Laws of a plug-in in C++ (manual: sec-plug-ins): a struct with the law as a template over the number type, and one line that exports it.
//
//   struct Weakening {
//       DP_ENUM(Parameter, STATIC, DYNAMIC, SPEED, NP)             // numbers that the case gives by name, in lower case
//       template <class T> static void results(const T* state, const double* p, T* result) { ... }
//   };
//   DP_BIT_LAW(weakening, Weakening)
//
// State and result are those of dp::OwnBit or dp::OwnFriction; results that the law does not set are not given.  Derivatives are exact.
#pragma once
#include "bit/bit.hpp"
#include "contact/contact.hpp"

namespace dp {

constexpr double NOT_GIVEN = __builtin_nan("");  // in a result that a law does not set

// Results that follow from others if the law does not set them.
template <class Of>
struct Complete {
    template <class T> static void results(T*) {}
};
template <>
struct Complete<OwnBit> {
    template <class T> static void results(T* r) {
        if (std::isnan(r[OwnBit::GRIP].v)) r[OwnBit::GRIP] = r[OwnBit::TORQUE] * (r[OwnBit::TORQUE].v < 0 ? -1.0 : 1.0);
    }
};

// Values and exact derivatives of Law::results(state, parameters, results) at n points.
template <class Law, class Of>
inline void plug_in_law(const void* context, int n, int derivatives, const double* state, double* out) {
    constexpr int STATES = Of::STATES, RESULTS = Of::RESULTS;
    const double* parameters = static_cast<const double*>(context);
    typedef Dual<(STATES + 3) / 4 * 4> T;
    for (int k = 0; k < n; ++k, state += STATES) {
        T s[STATES], r[RESULTS];
        for (int i = 0; i < STATES; ++i) {
            s[i] = T(state[i]);
            if (derivatives) s[i].set(i, 1.0);
        }
        for (int j = 0; j < RESULTS; ++j) r[j] = T(NOT_GIVEN);
        Law::results(s, parameters, r);
        Complete<Of>::results(r);
        for (int j = 0; j < RESULTS; ++j, out += 1 + STATES) {
            out[0] = r[j].v;
            for (int i = 0; i < STATES; ++i) out[1 + i] = r[j].d(i);
        }
    }
}

}  // namespace dp

#define DP_PLUG_IN_LAW(name, Law, Of)                                                                                               \
    extern "C" void own_##name(const void* context, int n, int derivatives, const double* state, double* results) {                  \
        dp::plug_in_law<Law, Of>(context, n, derivatives, state, results);                                                            \
    }                                                                                                                               \
    DP_EXPORT(own_##name##_parameters, Law::ParameterText)
#define DP_BIT_LAW(name, Law) DP_PLUG_IN_LAW(name, Law, dp::OwnBit)
#define DP_FRICTION_LAW(name, Law) DP_PLUG_IN_LAW(name, Law, dp::OwnFriction)
#define DP_ROCK_LAW(name, Law) DP_PLUG_IN_LAW(name, Law, dp::OwnRock)
