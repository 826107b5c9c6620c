#include <cstring>

#include "contact/well.hpp"
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

// Puts the axis of the hole beside the middles of n items among their parameters; segment (n): warm start in, found segment of the hole out.
extern "C" void mud_item_axes(const double* packed, int n, const int* idx, const double* x, double* par, int* segment) {
    using namespace dp;
    const Well w(packed);
    for (int e = 0; e < n; ++e, par += MudItem::NP) {
        double X[6];
        for (int i = 0; i < 6; ++i) X[i] = x[idx[7 * e + i]];
        const Vec<double> v = vec(X + 3), middle = vec(X) + v * (par[MudItem::ARM] / norm(v));
        const HolePoint<double> h = closest_point(w, middle, segment[e]);
        const Vec<double> axis = middle - h.e;
        const double found[6] = {axis.x, axis.y, axis.z, h.t.x, h.t.y, h.t.z};
        std::memcpy(par + MudItem::AXIS, found, sizeof found);
    }
}
