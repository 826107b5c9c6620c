// Measured pressure loss of a tool in the string: (rho/rho_m) f(Q) in the row of momentum of an element of the bore (manual: eq-mud-tool-curve).
//
// Q = rho0 q/rho is the flow rate at the pressure there, rho_m the density of the fluid of the measurement.  f is a cubic of Q|Q| between the
// points, odd in Q, and goes on straight beyond the last one.
#pragma once
#include "fluid/flow.hpp"

namespace dp {

// Loss [Pa], and the power that the mud loses by it [W].
DP_RECORD(ToolLossResults, double loss, power;)

// Unknowns: pressures at both nodes and flow rate of the bore's element.  The context is the table of all tools: rows of flow rate squared
// [m6/s2], loss [Pa] and slope.
struct ToolLoss {
    static constexpr int D = 3, NSPIN = 0;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter,
        FIRST, COUNT,      // row of no flow in the table, number of rows
        SHARE,             // of the tool's loss that the element has, over the density of the measurement [m3/kg]
        DENSITY,           // of the mud at zero pressure [kg/m3]
        COMPRESSIBILITY,   // of the mud [1/Pa]
        NP)

    // loss [Pa] and flow rate at the pressure there [m3/s]
    template <class T, class S>
    static void evaluate(const T* x, const S* p, const double* table, T& loss, T& flow) {
        const T density = exp((x[0] + x[1]) * (0.5 * p[COMPRESSIBILITY])) * p[DENSITY];
        flow = x[2] * p[DENSITY] / density;
        const double* at = table + 3 * static_cast<int>(p[FIRST]);
        const int last = static_cast<int>(p[COUNT]) - 1;
        const T square = flow * flow;
        T found;
        if (val(square) >= at[3 * last]) {
            found = (square - at[3 * last]) * at[3 * last + 2] + at[3 * last + 1];
        } else {
            while (val(square) >= at[3]) at += 3;
            const double h = at[3] - at[0];
            const T s = (square - at[0]) * (1.0 / h), u = 1.0 - s;
            found = u * u * ((s * 2.0 + 1.0) * at[1] + s * (h * at[2])) + s * s * ((u * 2.0 + 1.0) * at[4] - u * (h * at[5]));
        }
        loss = found * density * (val(flow) < 0 ? -p[SHARE] : p[SHARE] * 1.0);
    }

    template <class T, class S>
    static void force(int, const T* x, const T*, const T*, const S* p, void* context, T* r) {
        T loss, flow;
        evaluate(x, p, static_cast<const double*>(context), loss, flow);
        r[0] = r[1] = T(0.0);
        r[2] = loss * MOMENTUM_ROW;
    }
};

}  // namespace dp
