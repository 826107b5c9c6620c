// Drivers that run one kernel over all elements: gather, evaluate, scatter-add.
//
// A kernel is a struct with
//   D       unknowns it couples;  NP parameters per element;  PACKED: may be evaluated four elements at once;
//   SPINS   pairs {slot of a spin angle, slot of the tangent that belongs to it};
//   force<T, S>(e, x, y, a, p, ctx, r)   r[D] = residual from x (unknowns), y (rates), a (accelerations).
// y of a spin angle is the spin rate omega = phi' + c(v).v', so a change of v changes omega: `spin` (3 per node) is d(omega)/dv for
// the combination asked for by `c` = (dx, dy, da): K = c0 dR/dx + c1 dR/dy + c2 dR/da.
#pragma once
#include "ad.hpp"

namespace dp {

constexpr int round4(int n) { return (n + 3) / 4 * 4; }

template <class Kernel>
void run_residual(int n, const int* idx, const double* par, void* ctx, const double* x, const double* y, const double* a, double* r) {
    constexpr int D = Kernel::D, NP = Kernel::NP;
    int e = 0;
    if constexpr (Kernel::PACKED) {
        for (; e < n; e += 4) {
            Pack X[D], Y[D], A[D], P[NP], R[D];
            const int lanes = n - e < 4 ? n - e : 4;
            for (int l = 0; l < 4; ++l) {
                const int f = e + (l < lanes ? l : 0);
                for (int i = 0; i < D; ++i) {
                    const int k = idx[f * D + i];
                    X[i].v[l] = x[k]; Y[i].v[l] = y[k]; A[i].v[l] = a[k];
                }
                for (int i = 0; i < NP; ++i) P[i].v[l] = par[f * NP + i];
            }
            Kernel::template force<Pack, Pack>(e, X, Y, A, P, ctx, R);
            for (int l = 0; l < lanes; ++l)
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

#define DP_ENTRY(name, Kernel)                                                                                       \
    extern "C" void name##_residual(int n, const int* idx, const double* par, void* ctx, const double* x,           \
                                    const double* y, const double* a, double* r) {                                  \
        dp::run_residual<Kernel>(n, idx, par, ctx, x, y, a, r);                                                     \
    }                                                                                                               \
    extern "C" void name##_jacobian(int n, const int* idx, const int* nodes, const double* par, void* ctx,          \
                                    const double* c, const double* spin, const double* x, const double* y,          \
                                    const double* a, double* K) {                                                   \
        dp::run_jacobian<Kernel>(n, idx, nodes, par, ctx, c, spin, x, y, a, K);                                     \
    }

}  // namespace dp
