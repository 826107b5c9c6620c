// Nozzles in the side of the string, above the bit: one link with inertance from a node of the bore to the annulus beside it.
//
//   link   L q' + p_o - p_i + rho0^2/rho(p_o) q sqrt(q^2 + (v_0 A)^2)/(2 C_d^2 A^2) = 0   [Pa]
//   mass   q leaves the bore and enters the annulus at the same node                     [m3/s]
//   string rho0 q V: the jets point outward all around, and carry away the momentum of the string alone
// What the mud in the bore had along the string, (G_1^2/m_1 - G_2^2/m_2) t, stays with the string (rows of the bore).
// ANNULUS: the jets end in the mud of the hole, else in a pressure AMBIENT.
#pragma once
#include "fluid/bit_flow.hpp"

namespace dp {

// Power lost [W], flow out of the string [m3/s], kinetic energy [J], speed of the jets [m/s].
DP_RECORD(SideNozzleResults, double lost, flow, kinetic, jet;)

template <bool ANNULUS, bool HELD>
struct SideNozzle {
    static constexpr int PI = HELD ? 0 : 7, PO = PI + 1, Q = PO + (ANNULUS ? 1 : 0), D = Q + 1, NSPIN = 0;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter,
        INERTANCE, NOZZLE,  // L [kg/m4], area A [m2]
        LOSS,               // 1/(2 C_d^2 A^2) [1/m4]
        AMBIENT,            // pressure outside a string without an annulus [Pa]
        NP)

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        evaluate<T, S>(x, y, a, p, *static_cast<const Fluid*>(context), r, nullptr);
    }

    template <class T, class S>
    static void evaluate(const T* x, const T* y, const T*, const S* p, const Fluid& f, T* r, SideNozzleResults* results) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        T outside = T(p[AMBIENT]);
        if constexpr (ANNULUS) outside = x[PO];
        const T q = x[Q], slow = T(p[NOZZLE] * JET_ROUNDING), size = sqrt(q * q + slow * slow), thin = exp(outside * (-f.compressibility));
        const T loss = q * size * thin * (p[LOSS] * f.density);
        r[Q] = (y[Q] * p[INERTANCE] + outside - x[PI] + loss) * MOMENTUM_ROW;
        r[PI] = q * MASS_ROW;
        if constexpr (ANNULUS) r[PO] = -q * MASS_ROW;
        if constexpr (!HELD) {
            const Vec<T> carried = vec(y) * (q * f.density);
            r[0] = carried.x; r[1] = carried.y; r[2] = carried.z;
        }
        if (results) {
            const double mean = 0.5 * (val(x[PI]) + val(outside));
            results->lost = val(loss * q) * std::exp(-f.compressibility * mean);
            results->flow = val(q);
            results->kinetic = 0.5 * p[INERTANCE] * val(q) * val(q);
            results->jet = val(q * thin) / p[NOZZLE];
        }
    }
};

}  // namespace dp
