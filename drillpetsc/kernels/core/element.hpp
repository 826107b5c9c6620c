// Drivers that run one kernel over all elements: gather, evaluate, scatter-add.
//
// A kernel is a struct with
//   D       unknowns it couples;  PACKED: may be evaluated four elements at once;
//   DP_ENUM(Parameter, ..., NP)   its NP parameters per element by name (core/names.hpp), which Python fills;
//   SPINS   pairs {slot of a spin angle, slot of the tangent that belongs to it};
//   own_law(ctx), if there may be one: the law of the user in its record, or null (core/own_law.hpp);
//   force<T, S>(e, x, y, a, p, ctx, r)   r[D] = residual from x (unknowns), y (rates), a (accelerations).
// y of a spin angle is the spin rate omega = phi' + c(v).v', so a change of v changes omega: `spin` (3 per node) is d(omega)/dv for
// the combination asked for by `c` = (dx, dy, da): K = c0 dR/dx + c1 dR/dy + c2 dR/da.
#pragma once
#include "core/ad.hpp"
#include "core/names.hpp"
#include "core/own_law.hpp"

namespace dp {

constexpr int round4(int n) { return (n + 3) / 4 * 4; }

// Four elements side by side: entries idx of x, or row-wise parameters; beyond the n-th element the first of the four is repeated.
typedef double Unaligned __attribute__((vector_size(32), aligned(8), may_alias));
struct Lanes {
    int first, count;  // element of the first lane, lanes in use
    int at[4];         // element of each lane
    Lanes(int e, int n) : first(e), count(n - e < 4 ? n - e : 4) {
        for (int l = 0; l < 4; ++l) at[l] = l < count ? e + l : e;
    }
    void gather(int D, const int* idx, const double* x, Pack* X) const {
        for (int i = 0; i < D; ++i)
            X[i] = Pack(V4{x[idx[at[0] * D + i]], x[idx[at[1] * D + i]], x[idx[at[2] * D + i]], x[idx[at[3] * D + i]]});
    }
    void rows(int N, const double* table, Pack* P) const {
        for (int i = 0; i < N; ++i) P[i] = Pack(V4{table[at[0] * N + i], table[at[1] * N + i], table[at[2] * N + i], table[at[3] * N + i]});
    }
    // the other way: N results of each lane to its row of the table
    void store_rows(int N, const Pack* P, double* table) const {
        int i = 0;
        for (; i + 4 <= N; i += 4) {
            V4 row[4] = {P[i].v, P[i + 1].v, P[i + 2].v, P[i + 3].v};
            transpose(row);
            for (int l = 3; l >= 0; --l) *reinterpret_cast<Unaligned*>(table + (long)at[l] * N + i) = row[l];  // unused lanes are overwritten
        }
        for (; i < N; ++i)
            for (int l = 3; l >= 0; --l) table[(long)at[l] * N + i] = P[i].v[l];
    }
};

template <class Kernel>
void run_residual(int n, const int* idx, const double* par, void* ctx, const double* x, const double* y, const double* a, double* r) {
    constexpr int D = Kernel::D, NP = Kernel::NP;
    int e = 0;
    if constexpr (Kernel::PACKED) {
        for (; e < n; e += 4) {
            Pack X[D], Y[D], A[D], P[NP], R[D];
            const Lanes lanes(e, n);
            lanes.gather(D, idx, x, X);
            lanes.gather(D, idx, y, Y);
            lanes.gather(D, idx, a, A);
            lanes.rows(NP, par, P);
            Kernel::template force<Pack, Pack>(e, X, Y, A, P, ctx, R);
            for (int l = 0; l < lanes.count; ++l)
                for (int i = 0; i < D; ++i) r[idx[(e + l) * D + i]] += R[i].v[l];
        }
    } else {
        for (; e < n; ++e) {
            double X[D], Y[D], A[D], R[D];
            for (int i = 0; i < D; ++i) {
                const int k = idx[e * D + i];
                X[i] = x[k]; Y[i] = y[k]; A[i] = a[k];
            }
            Kernel::template force<double, double>(e, X, Y, A, par + e * NP, ctx, R);
            for (int i = 0; i < D; ++i) r[idx[e * D + i]] += R[i];
        }
    }
}

template <class Kernel>
void run_jacobian(int n, const int* idx, const int* nodes, const double* par, void* ctx, const double* c, const double* spin,
                  const double* x, const double* y, const double* a, double* K) {
    constexpr int D = Kernel::D, NP = Kernel::NP;
    typedef Dual<round4(D)> T;
    for (int e = 0; e < n; ++e) {
        T X[D], Y[D], A[D], R[D];
        for (int i = 0; i < D; ++i) {
            const int k = idx[e * D + i];
            X[i] = T(x[k]); Y[i] = T(y[k]); A[i] = T(a[k]);
            X[i].set(i, c[0]); Y[i].set(i, c[1]); A[i].set(i, c[2]);
        }
        for (int s = 0; s < Kernel::NSPIN; ++s) {
            const int phi = Kernel::SPINS[s][0], v = Kernel::SPINS[s][1];
            const double* g = spin + 3 * nodes[e * Kernel::NSPIN + s];
            for (int k = 0; k < 3; ++k) {
                Y[phi].set(v + k, c[1] * g[k]);
                A[phi].set(v + k, c[2] * g[k]);
            }
        }
        Kernel::template force<T, double>(e, X, Y, A, par + e * NP, ctx, R);
        double* out = K + (long)e * D * D;
        for (int i = 0; i < D; ++i)
            for (int j = 0; j < D; ++j) out[i * D + j] = R[i].d(j);
    }
}

// Results of n elements: Kernel::results(x, y, p, ctx, out) fills RESULTS numbers from the unknowns and rates of each.
template <class Kernel>
void run_element_results(int n, const int* idx, const double* par, void* ctx, const double* x, const double* y, double* out) {
    constexpr int D = Kernel::D;
    for (int e = 0; e < n; ++e) {
        double X[D], Y[D];
        for (int i = 0; i < D; ++i) { X[i] = x[idx[e * D + i]]; Y[i] = y[idx[e * D + i]]; }
        Kernel::results(X, Y, par + e * Kernel::NP, ctx, out + e * Kernel::RESULTS);
    }
}

#define DP_RESULTS(name, Kernel)                                                                                                              \
    extern "C" void name##_results(int n, int, const int* idx, const double* par, void* ctx, const double* x, const double* y, double* out) { \
        dp::run_element_results<Kernel>(n, idx, par, ctx, x, y, out);                                                                         \
    }
#define DP_RESIDUAL(name, Kernel) DP_RESIDUAL_BY(name, Kernel, dp::run_residual<Kernel>)
#define DP_RESIDUAL_BY(name, Kernel, run)                                                                            \
    extern "C" void name##_residual(int n, const int* idx, const double* par, void* ctx, const double* x,           \
                                    const double* y, const double* a, double* r) {                                  \
        dp::rows_by_law<Kernel>(ctx, n, idx, r, [&](double* out) { run(n, idx, par, ctx, x, y, a, out); });         \
    }                                                                                                               \
    DP_EXPORT(name##_parameters, Kernel::ParameterText)
#define DP_JACOBIAN(name, Kernel, run)                                                                                       \
    extern "C" void name##_jacobian(int n, const int* idx, const int* nodes, const double* par, void* ctx,          \
                                    const double* c, const double* spin, const double* x, const double* y,          \
                                    const double* a, double* K) {                                                   \
        dp::entries_by_law<Kernel>(ctx, true, K, [&](double* out) { run(n, idx, nodes, par, ctx, c, spin, x, y, a, out); }); \
    }
#define DP_ENTRY(name, Kernel) DP_RESIDUAL(name, Kernel) DP_JACOBIAN(name, Kernel, dp::run_jacobian<Kernel>)

}  // namespace dp
