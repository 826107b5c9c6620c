#include "hermite_annulus.hpp"
#include "hermite_bit.hpp"
#include "hermite_pipe.hpp"

using namespace dp;
typedef HermitePipe<false, false> PipePlain;
typedef HermitePipe<true, false> PipeSplit;
typedef HermitePipe<false, true> PipeHeld;
typedef HermiteAnnulus<false, false> AnnulusPlain;
typedef HermiteAnnulus<true, false> AnnulusSplit;
typedef HermiteAnnulus<false, true> AnnulusHeld;
typedef HermiteBit<true, true, false> BitNozzle;
typedef HermiteBit<true, false, false> BitJet;
typedef HermiteBit<false, true, false> BitClosed;
typedef HermiteBit<true, true, true> BitNozzleHeld;
typedef HermiteBit<true, false, true> BitJetHeld;
typedef HermiteBit<false, true, true> BitClosedHeld;

namespace {

template <class Kernel, int N, class Result>
void report(int n, const int* idx, const double* par, const void* fluid, const double* x, const double* y, Result* out) {
    constexpr int D = Kernel::D;
    for (int e = 0; e < n; ++e) {
        double X[D], Y[D], A[D], R[D];
        for (int i = 0; i < D; ++i) { X[i] = x[idx[e * D + i]]; Y[i] = y[idx[e * D + i]]; A[i] = 0.0; }
        Kernel::template evaluate<double, double>(X, Y, A, par + e * Kernel::NP, *static_cast<const Fluid*>(fluid), R, out + e * N);
    }
}
}  // namespace

#define DP_HERMITE(name, Kernel, Result, N)                                                                                                  \
    DP_ENTRY(name, Kernel)                                                                                                                   \
    extern "C" void name##_report(int n, const int* idx, const double* par, const void* fluid, const double* x, const double* y, double* out) { \
        report<Kernel, N>(n, idx, par, fluid, x, y, reinterpret_cast<Result*>(out));                                                         \
    }
DP_HERMITE(hermite_pipe, PipePlain, FlowReport, 1)
DP_HERMITE(hermite_pipe_split, PipeSplit, FlowReport, 1)
DP_HERMITE(hermite_pipe_held, PipeHeld, FlowReport, 1)
DP_HERMITE(hermite_annulus, AnnulusPlain, FlowReport, 1)
DP_HERMITE(hermite_annulus_split, AnnulusSplit, FlowReport, 1)
DP_HERMITE(hermite_annulus_held, AnnulusHeld, FlowReport, 1)
DP_HERMITE(hermite_bit, BitNozzle, double, 6)
DP_HERMITE(hermite_bit_jet, BitJet, double, 6)
DP_HERMITE(hermite_bit_closed, BitClosed, double, 6)
DP_HERMITE(hermite_bit_held, BitNozzleHeld, double, 6)
DP_HERMITE(hermite_bit_jet_held, BitJetHeld, double, 6)
DP_HERMITE(hermite_bit_closed_held, BitClosedHeld, double, 6)
