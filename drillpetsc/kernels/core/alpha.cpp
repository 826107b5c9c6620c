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
    Led(const AlphaCall& c, const double* q, double change, int i) {
        const long n = c.n;
        const double slope = c.second_order[i] ? c.lead * q[DSECOND * n + i] : c.lead_rate * q[DU * n + i];
        x = q[AX * n + i] + change * slope;
        y = q[AY * n + i] + (c.lead * change) * q[DW * n + i];
    }
};

}  // namespace

DP_EXPORT(alpha_history, HistoryText)
DP_EXPORT_RECORD(alpha_call, AlphaCall)

extern "C" {

// Constants v0, v1 (n) of y = s x + v0 and a = s2 y + v1 in a step h from the history q (ROWS, n) whose last step was ``last``, and the first
// guess x (n).
void alpha_begin(const AlphaCall* call, const double* q, double last, double h, double s, double s2, double* v0, double* v1, double* x) {
    const AlphaCall& c = *call;
    const long n = c.n;
    const double change = h - last, m = c.mean_mass, k = c.mean_force;
    for (int i = 0; i < c.n; ++i) {
        const Led a(c, q, change, i);
        const double x0 = q[X * n + i], y0 = q[Y * n + i], rate = q[RATE * n + i];
        if (c.second_order[i]) {
            v0[i] = rate + h * (1 - c.gamma) * a.x - s * (x0 + h * rate + h * h * (0.5 - c.beta) * a.x);
            v1[i] = -s2 * (y0 + h * (1 - c.gamma) * a.y) + (m * a.y - k * q[W * n + i]) / (1 - k);
            const double later = (q[SECOND * n + i] - m * a.x) / (1 - m);  // the true acceleration stays
            x[i] = x0 + h * rate + h * h * ((0.5 - c.beta) * a.x + c.beta * later);
        } else {
            v0[i] = -s * (x0 + h * (1 - c.gamma_rate) * a.x) + (c.mean_rate * a.x - k * y0) / (1 - k);
            v1[i] = 0.0;
            x[i] = x0 + h * a.x;
        }
    }
}

// The history after the step to the state x, y, w (n), and the local error e (n) of that step.
void alpha_advance(const AlphaCall* call, const double* q, double last, double h, const double* x, const double* y, const double* w, double* out,
                   double* e) {
    const AlphaCall& c = *call;
    const long n = c.n;
    const double change = h - last, spread = last != 0.0 ? 2 * h / (h + last) : 0.0, m = c.mean_mass, k = c.mean_force, g = c.gamma;
    for (int i = 0; i < c.n; ++i) {
        const Led a(c, q, change, i);
        const double dx = x[i] - q[X * n + i], dy = y[i] - q[Y * n + i], rate = q[RATE * n + i], second = q[SECOND * n + i];
        const bool two = c.second_order[i];
        out[X * n + i] = x[i];
        out[Y * n + i] = y[i];
        if (two) {
            const double ax = (dx - h * rate - h * h * (0.5 - c.beta) * a.x) / (c.beta * h * h);
            const double next = ((1 - m) * ax + m * a.x - k * second) / (1 - k);
            out[W * n + i] = w[i];
            out[RATE * n + i] = rate + h * ((1 - g) * a.x + g * ax);
            out[SECOND * n + i] = next;
            out[AX * n + i] = ax;
            out[AY * n + i] = (dy - h * (1 - g) * a.y) / (g * h);
            out[DW * n + i] = (w[i] - q[W * n + i]) / h;
            out[DSECOND * n + i] = (next - second) / h;
            out[DU * n + i] = 0.0;
            e[i] = c.position_error * h * h * (ax - a.x);
        } else {
            const double du = dy / h;
            out[W * n + i] = out[RATE * n + i] = out[SECOND * n + i] = out[AY * n + i] = 0.0;
            out[AX * n + i] = (dx - h * (1 - c.gamma_rate) * a.x) / (c.gamma_rate * h);
            out[DW * n + i] = -q[W * n + i] / h;
            out[DSECOND * n + i] = -second / h;
            out[DU * n + i] = du;
            e[i] = c.rate_error * h * h * (du - q[DU * n + i]) * spread;
        }
    }
}

// Local errors e of the m controlled unknowns at these rows, over their tolerances.
void error_over_tolerance(int m, const int* rows, const double* e, const double* tolerance, double* out) {
    for (int k = 0; k < m; ++k) out[k] = e[rows[k]] / tolerance[k];
}
}
