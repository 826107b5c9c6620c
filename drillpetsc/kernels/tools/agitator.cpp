#include "tools/agitator.hpp"

using namespace dp;
DP_ENTRY(agitator, Agitator<false>)
DP_ENTRY(agitator_flowing, Agitator<true>)
DP_EXPORT(agitator_results, AgitatorParameters::ResultText)

// Results of n agitators (columns agitator_results); width: unknowns of one in idx.
extern "C" void agitator_values(int n, int width, const int* idx, const double* par, const double* x, const double* y, double* out) {
    for (int e = 0; e < n; ++e) {
        double X[18], Y[18];
        for (int i = 0; i < width; ++i) { X[i] = x[idx[width * e + i]]; Y[i] = y[idx[width * e + i]]; }
        const double* p = par + e * AgitatorParameters::NP;
        double* o = out + e * AgitatorParameters::RESULTS;
        if (width == 18) Agitator<true>::results(X, Y, p, o);
        else Agitator<false>::results(X, Y, p, o);
    }
}
