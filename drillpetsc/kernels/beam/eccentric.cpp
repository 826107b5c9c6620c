#include "beam/eccentric.hpp"
#include "core/formulations.hpp"

namespace dp {

template <class Kernel>
void eccentric_energies(int n, const int* idx, const double* par, const double* x, const double* y, double* out) {
    constexpr int D = Kernel::D;
    if constexpr (Kernel::PACKED) {
        for (int e = 0; e < n; e += 4) {
            Pack X[D], Y[D], P[Kernel::NP], both[2];
            const Lanes lanes(e, n);
            lanes.gather(D, idx, x, X);
            lanes.gather(D, idx, y, Y);
            lanes.rows(Kernel::NP, par, P);
            Kernel::energy(X, Y, P, both);
            lanes.store_rows(2, both, out);
        }
    } else {
        for (int e = 0; e < n; ++e) {
            double X[D], Y[D];
            for (int i = 0; i < D; ++i) { X[i] = x[idx[e * D + i]]; Y[i] = y[idx[e * D + i]]; }
            Kernel::energy(X, Y, par + e * Kernel::NP, out + 2 * e);
        }
    }
}

}  // namespace dp

typedef dp::Eccentric<false> EccentricPlain;
typedef dp::Eccentric<true> EccentricJunction;
DP_RESIDUAL(eccentric, EccentricPlain)
DP_JACOBIAN(eccentric, EccentricPlain, dp::run_eccentric_jacobian)
// the same by differentiating all rows by all unknowns: the tests compare with it
DP_JACOBIAN(eccentric_dual, EccentricPlain, dp::run_jacobian<EccentricPlain>)
DP_ENTRY(eccentric_junction, EccentricJunction)
DP_OTHER_FORMULATIONS(eccentric, EccentricPlain, 2)
DP_OTHER_FORMULATIONS(eccentric_junction, EccentricJunction, 2)

// kinetic and potential energy of n elements (D unknowns each): out (n, 2) [J]
extern "C" void eccentric_energy(int n, int D, const int* idx, const double* par, const void*, const double* x, const double* y, double* out) {
    if (D == EccentricJunction::D) dp::eccentric_energies<EccentricJunction>(n, idx, par, x, y, out);
    else dp::eccentric_energies<EccentricPlain>(n, idx, par, x, y, out);
}
