// Generalised-alpha in end-point form on plain arrays (manual: sec-time-alpha); solvers/time/alpha_formula.py says what the arrays are.
#include <cmath>

#include "core/names.hpp"

namespace {

// Rows (n) of a history, in this order.
DP_ENUM(History, X, Y, W, RATE, SECOND, AX, AY, DW, DSECOND, DU, ROWS)

// second_order (n): zero for unknowns of first order, and algebraic ones.
DP_RECORD(AlphaCall,
    const signed char* second_order;
    double gamma, beta, mean_mass, mean_force, mean_rate, gamma_rate, lead, lead_rate, position_error, rate_error;
    int n, unused;
)

// Algorithmic accelerations, shifted to their lead at a step that is longer than the last one by ``change``.
struct Led {
    double x, y;
    Led(const AlphaCall& c, const double* q, double change, long i, bool two) {
        const long n = c.n;
        const double by_second = c.lead * q[DSECOND * n + i], by_rate = c.lead_rate * q[DU * n + i], slope = two ? by_second : by_rate;
        x = q[AX * n + i] + change * slope;
        y = q[AY * n + i] + (c.lead * change) * q[DW * n + i];
    }
};

// Algorithmic acceleration of an unknown of second order that moves by dx in a step h.
inline double algorithmic(const AlphaCall& c, double h, double dx, double rate, double before) {
    return (dx - h * rate - h * h * (0.5 - c.beta) * before) / (c.beta * h * h);
}

}  // namespace

DP_EXPORT(alpha_history, HistoryText)
DP_EXPORT_RECORD(alpha_call, AlphaCall)

extern "C" {

// Constants v0, v1 (n) of y = s x + v0 and a = s2 y + v1 in a step h from the history q (ROWS, n) whose last step was ``last``, and the first
// guess x (n).  Both kinds of unknowns are computed and one is chosen, so that the loop has no branches.
void alpha_begin(const AlphaCall* call, const double* q, double last, double h, double s, double s2, double* v0, double* v1,
                 double* x) {
    const AlphaCall c = *call;
    const long n = c.n;
    const double change = h - last, m = c.mean_mass, k = c.mean_force;
#pragma GCC ivdep  // no array overlaps another
    for (long i = 0; i < n; ++i) {
        const bool two = c.second_order[i];
        const Led a(c, q, change, i, two);
        const double x0 = q[X * n + i], y0 = q[Y * n + i], rate = q[RATE * n + i];
        const double later = (q[SECOND * n + i] - m * a.x) / (1 - m);  // the true acceleration stays
        const double v = rate + h * (1 - c.gamma) * a.x - s * (x0 + h * rate + h * h * (0.5 - c.beta) * a.x);
        const double w = -s * (x0 + h * (1 - c.gamma_rate) * a.x) + (c.mean_rate * a.x - k * y0) / (1 - k);
        v0[i] = two ? v : w;
        v1[i] = two ? -s2 * (y0 + h * (1 - c.gamma) * a.y) + (m * a.y - k * q[W * n + i]) / (1 - k) : 0.0;
        x[i] = two ? x0 + h * rate + h * h * ((0.5 - c.beta) * a.x + c.beta * later) : x0 + h * a.x;
    }
}

// Local error e (n) of the step h to the state x, y (n).  shares (count): local errors over the tolerances (count) of the controlled unknowns at
// these rows (count).
void alpha_error(const AlphaCall* call, const double* q, double last, double h, const double* x, const double* y, double* e, int count,
                 const int* rows, const double* tolerance, double* shares) {
    const AlphaCall c = *call;
    const long n = c.n;
    const double change = h - last, spread = last != 0.0 ? 2 * h / (h + last) : 0.0;
#pragma GCC ivdep  // no array overlaps another
    for (long i = 0; i < n; ++i) {
        const bool two = c.second_order[i];
        const Led a(c, q, change, i, two);
        const double dx = x[i] - q[X * n + i], dy = y[i] - q[Y * n + i], ax = algorithmic(c, h, dx, q[RATE * n + i], a.x), du = dy / h;
        e[i] = two ? c.position_error * h * h * (ax - a.x) : c.rate_error * h * h * (du - q[DU * n + i]) * spread;
    }
#pragma GCC ivdep
    for (int j = 0; j < count; ++j) shares[j] = e[rows[j]] / tolerance[j];
}

// The history goes on, in place, by the step h to the state x, y, w (n): a second copy of it would have to come through the caches.
void alpha_accept(const AlphaCall* call, double* q, double last, double h, const double* x, const double* y, const double* w) {
    const AlphaCall c = *call;
    const long n = c.n;
    const double change = h - last, m = c.mean_mass, k = c.mean_force, g = c.gamma;
#pragma GCC ivdep  // no array overlaps another
    for (long i = 0; i < n; ++i) {
        const bool two = c.second_order[i];
        const Led a(c, q, change, i, two);
        const double dx = x[i] - q[X * n + i], dy = y[i] - q[Y * n + i], rate = q[RATE * n + i], second = q[SECOND * n + i];
        const double ax = algorithmic(c, h, dx, rate, a.x), du = dy / h;
        const double next = two ? ((1 - m) * ax + m * a.x - k * second) / (1 - k) : 0.0, true_one = two ? w[i] : 0.0;
        q[X * n + i] = x[i];
        q[Y * n + i] = y[i];
        q[DW * n + i] = (true_one - q[W * n + i]) / h;
        q[W * n + i] = true_one;
        q[RATE * n + i] = two ? rate + h * ((1 - g) * a.x + g * ax) : 0.0;
        q[DSECOND * n + i] = (next - second) / h;
        q[SECOND * n + i] = next;
        q[AX * n + i] = two ? ax : (dx - h * (1 - c.gamma_rate) * a.x) / (c.gamma_rate * h);
        q[AY * n + i] = two ? (dy - h * (1 - g) * a.y) / (g * h) : 0.0;
        q[DU * n + i] = two ? 0.0 : du;
    }
}
}
