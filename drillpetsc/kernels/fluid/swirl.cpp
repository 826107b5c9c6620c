// Swirl of the mud about elements after the last step, and among the parameters of their blocks (manual: sec-mud-swirl).
#include <cmath>

#include "core/names.hpp"

namespace {

// Rows (n) of the state: share [-], then of the last step spin, swirl [rad/s], trend of the spin [rad/s2], rate at which the swirl follows
// [1/s]; at the time asked for last: swirl and its rate.
DP_ENUM(Swirl, SHARE, SPIN, SWIRL, TREND, FOLLOW, NOW, RATE, ROWS)

}  // namespace

DP_EXPORT(swirl_rows, SwirlText)

extern "C" {

// Swirl and its rate a time `step` after the last step: exact for a spin on a straight line (manual: eq-mud-swirl-lag).
void swirl_at(int n, double step, double* v) {
    for (int i = 0; i < n; ++i) {
        const double share = v[SHARE * n + i], spin = v[SPIN * n + i], trend = v[TREND * n + i], k = v[FOLLOW * n + i];
        const double steady = share * (spin + trend * step);
        if (std::isinf(k)) {  // at once
            v[NOW * n + i] = steady;
            v[RATE * n + i] = share * trend;
            continue;
        }
        const double behind = v[SWIRL * n + i] - share * spin;
        const double fallen = k > 0.0 ? -std::expm1(-k * step) : 0.0, waited = k > 0.0 ? fallen / k : step;
        const double left = behind * (1.0 - fallen) - share * trend * waited;
        v[NOW * n + i] = steady + left;
        v[RATE * n + i] = -k * left;
    }
}

// share, swirl, swirl_rate and spin_rate of a block's parameters (count, width) at these columns; rows: of its elements in the state.
// moves: else the mud is at rest.
void swirl_parameters(int count, const int* rows, int n, const double* v, int moves, double* parameters, int width, const int* columns) {
    for (int e = 0; e < count; ++e) {
        const int i = rows[e];
        double* p = parameters + (long)e * width;
        p[columns[0]] = moves ? v[SHARE * n + i] : 0.0;
        p[columns[1]] = moves ? v[NOW * n + i] : 0.0;
        p[columns[2]] = moves ? v[RATE * n + i] : 0.0;
        p[columns[3]] = v[TREND * n + i];
    }
}
}
