#include "fluid/mud_item.hpp"
#include "core/formulations.hpp"

DP_ENTRY(mud_item, dp::MudItem)
DP_OTHER_FORMULATIONS(mud_item, dp::MudItem, 1)
DP_EXPORT(mud_item_results, dp::MudItemResultsText)

extern "C" void mud_item_results(int n, int, const int* idx, const double* par, const void*, const double* x, const double* y, double* out) {
    using namespace dp;
    for (int e = 0; e < n; ++e) {
        double X[7], Y[7];
        for (int i = 0; i < 7; ++i) { X[i] = x[idx[7 * e + i]]; Y[i] = y[idx[7 * e + i]]; }
        MudItem::results(X, Y, par + e * MudItem::NP, reinterpret_cast<MudItemResults*>(out) + e);
    }
}
