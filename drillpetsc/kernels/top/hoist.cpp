#include "top/hoist.hpp"

DP_ENTRY(hoist_line, dp::HoistLine)
DP_EXPORT(hoist_line_results, dp::HoistLine::ResultText)

// the columns of HoistLine::Result; while the top is locked, zeros but for the travel
extern "C" void hoist_line_results(int n, const int* idx, const double* par, const double* x, const double* y, const double* a, double* out) {
    using namespace dp;
    typedef HoistLine H;
    for (int e = 0; e < n; ++e) {
        const double* p = par + e * H::NP;
        double X[H::D], Y[H::D], A[H::D], *o = out + e * H::RESULTS;
        for (int i = 0; i < H::D; ++i) { X[i] = x[idx[H::D * e + i]]; Y[i] = y[idx[H::D * e + i]]; A[i] = a[idx[H::D * e + i]]; }
        const H::Values<double> q = H::evaluate(X, Y, A, p);
        for (int i = 0; i < H::RESULTS; ++i) o[i] = 0;
        o[H::DEPTH] = q.depth;
        o[H::SPEED] = q.speed;
        if (p[H::LOCKED] != 0) continue;
        o[H::LINE] = q.line;
        o[H::HOOK] = q.hook;
        o[H::DRUM] = q.drum;
        o[H::MODE] = q.mode;
        o[H::LOAD] = q.seen[0];
        const double paid = Y[H::PAYOUT];
        if (p[H::DAMPING] > 0) o[H::LOST] = q.damper * q.damper / p[H::DAMPING];
        // rope that leaves the drum brings its strain energy along
        o[H::SUPPLIED] = q.line * (p[H::HEAVE_RATE] - paid) - 0.5 * q.strain * q.elastic * paid;
        o[H::ENERGY] = 0.5 * q.elastic * q.gap;
    }
}
