#include "fluid/tool_loss.hpp"

using namespace dp;
DP_ENTRY(tool_loss, ToolLoss)
DP_EXPORT(tool_loss_results, ToolLossResultsText)

extern "C" void tool_loss_results(int n, int, const int* idx, const double* par, const void* table, const double* x, const double*, double* out) {
    for (int e = 0; e < n; ++e) {
        const double X[3] = {x[idx[3 * e]], x[idx[3 * e + 1]], x[idx[3 * e + 2]]};
        double loss, flow;
        ToolLoss::evaluate(X, par + e * ToolLoss::NP, static_cast<const double*>(table), loss, flow);
        out[2 * e] = loss;
        out[2 * e + 1] = loss * flow;
    }
}
