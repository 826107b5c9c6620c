// Derivatives of a kernel by positions, rates and accelerations, times given directions: eight directions are the derivatives of one evaluation.
#pragma once
#include "core/element.hpp"

namespace dp {

// Adds to each of `count` rows (length) of r.  dx, dy, da: the directions, in rows as long; chosen: those that have positions, null for none.
template <class Kernel>
void run_by_rates(int n, const int* idx, const double* par, void* ctx, const double* x, const double* y, const double* a, int count, long length,
                  const signed char* chosen, const double* dx, const double* dy, const double* da, double* r) {
    constexpr int D = Kernel::D, NP = Kernel::NP, MANY = 8;
    typedef Dual<MANY> T;
    for (int e = 0; e < n; ++e) {
        const int* at = idx + (long)e * D;
        for (int first = 0; first < count; first += MANY) {
            const int some = count - first < MANY ? count - first : MANY;
            T X[D], Y[D], A[D], R[D];
            for (int i = 0; i < D; ++i) {
                X[i] = T(x[at[i]]); Y[i] = T(y[at[i]]); A[i] = T(a[at[i]]);
                for (int d = 0; d < some; ++d) {
                    const long place = (first + d) * length + at[i];
                    if (chosen && chosen[first + d]) X[i].set(d, dx[place]);
                    Y[i].set(d, dy[place]);
                    A[i].set(d, da[place]);
                }
            }
            Kernel::template force<T, double>(e, X, Y, A, par + (long)e * NP, ctx, R);
            for (int d = 0; d < some; ++d)
                for (int i = 0; i < D; ++i) r[(first + d) * length + at[i]] += R[i].d(d);
        }
    }
}

}  // namespace dp

// Entry point `name`_by_rates; `call` has the arguments n, idx, par, ctx, x, y, a, count, length, chosen, dx, dy, da, r.
#define DP_PRODUCT(name, ...)                                                                                                                          \
    extern "C" void name##_by_rates(int n, const int* idx, const double* par, void* ctx, const double* x, const double* y, const double* a, int count, \
                                    int length, const signed char* chosen, const double* dx, const double* dy, const double* da, double* r) {          \
        (void)n, (void)idx, (void)par, (void)ctx, (void)x, (void)y, (void)a, (void)count, (void)length, (void)chosen, (void)dx, (void)dy, (void)da, (void)r; \
        __VA_ARGS__;                                                                                                                                   \
    }
#define DP_BY_RATES(name, Kernel) DP_PRODUCT(name, dp::run_by_rates<Kernel>(n, idx, par, ctx, x, y, a, count, length, chosen, dx, dy, da, r))
