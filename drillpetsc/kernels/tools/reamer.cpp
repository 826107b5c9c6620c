#include "tools/reamer.hpp"
#include "core/formulations.hpp"

using namespace dp;
typedef Reamer<0> SteadyReamer;
typedef Reamer<CHIPS> ProfileReamer;
DP_ENTRY(reamer, SteadyReamer)
DP_ENTRY(reamer_profile, ProfileReamer)
DP_OTHER_FORMULATIONS(reamer, SteadyReamer, 1)
DP_OTHER_FORMULATIONS(reamer_profile, ProfileReamer, 1)

namespace {
template <class Kernel>
void results(const int* idx, const double* par, void* context, const double* x, const double* y, double* out) {
    constexpr int D = Kernel::D;
    double X[D], Y[D], R[D];
    for (int i = 0; i < D; ++i) { X[i] = x[idx[i]]; Y[i] = y[idx[i]]; }
    ReamerResults now{};
    Kernel::template evaluate<double>(X, Y, par, *static_cast<BitLaw*>(context), R, &now);
    *reinterpret_cast<ReamerResults*>(out) = now;
}
}  // namespace

// results of the reamer, a ReamerResults; profile: 1 with the states of the ring's profile
extern "C" void reamer_results(int profile, const int* idx, const double* par, void* context, const double* x, const double* y, double* out) {
    if (profile) results<ProfileReamer>(idx, par, context, x, y, out);
    else results<SteadyReamer>(idx, par, context, x, y, out);
}
DP_EXPORT(reamer_results, ReamerResultsText)
