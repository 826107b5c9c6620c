// Local errors of a time formula in its last states, summed over the steps (manual: eq-time-local-error).
#include <cmath>

#include "core/names.hpp"

namespace {

// rows (n): of the unknowns; states (kept, n), times (kept): of the last states, the next one goes to place ``next``; count: how many there are.
// weights (kept): of the states in the local error, ascending in time: of BDF of an ``order``, for order 0 ``third`` times the last step^3 times the third derivative.
// net, total, largest (n): sum of the errors, of their sizes, largest size.
DP_RECORD(LocalErrorCall,
    const int* rows; double* states; double* times; double* weights; double* net; double* total; double* largest;
    double third;
    int n, kept, order, next, count, unused;
)

constexpr int MOST_STATES = 8;  // BDF of order 6

// Adds the errors of n unknowns, sums of KEPT states by their weights.  With a number of states that the compiler knows, several unknowns are taken at once.
template <int KEPT>
void add_errors(int n, const double* weights, const double* const* states, double* net, double* total, double* largest) {
#pragma GCC ivdep  // no array overlaps another
    for (int i = 0; i < n; ++i) {
        double e = 0.0;
        for (int k = 0; k < KEPT; ++k) e += weights[k] * states[k][i];
        const double size = std::fabs(e);
        net[i] += e;
        total[i] += size;
        largest[i] = size > largest[i] ? size : largest[i];
    }
}

// State k of the last ``kept`` ones, in the order of time.
int place(const LocalErrorCall& c, int k) { return (c.next + k) % c.kept; }

}  // namespace

DP_EXPORT_RECORD(local_error_call, LocalErrorCall)

extern "C" {

// Weights (order + 2) of the states at ascending times (order + 2) in the local error of BDF in the last one.
void bdf_error_weights(int order, const double* times, double* weights) {
    const int m = order + 2;
    double gaps = 1.0, sum = 0.0;
    for (int i = order; i > 0; --i) {
        const double gap = times[m - 1] - times[i];
        gaps *= gap;
        sum += 1.0 / gap;
    }
    for (int k = 0; k < m; ++k) {
        double product = 1.0;
        for (int j = 0; j < m; ++j)
            if (j != k) product *= times[k] - times[j];
        weights[k] = gaps / sum / product;
    }
}

// Weights (4) of the states at ascending times (4) in ``factor`` times the last step^3 times the third derivative: six times their divided difference.
void third_difference_weights(double factor, const double* times, double* weights) {
    const double step = times[3] - times[2];
    for (int k = 0; k < 4; ++k) {
        double product = 1.0;
        for (int j = 0; j < 4; ++j)
            if (j != k) product *= times[k] - times[j];
        weights[k] = 6.0 * factor * step * step * step / product;
    }
}

// Keep the unknowns of x at the time t; 1 where there are as many states as a local error needs.
int keep_state(LocalErrorCall* c, const double* x, double t) {
    double* state = c->states + static_cast<long>(c->next) * c->n;
    for (int i = 0; i < c->n; ++i) state[i] = x[c->rows[i]];
    c->times[c->next] = t;
    c->next = (c->next + 1) % c->kept;
    if (c->count < c->kept) ++c->count;
    return c->count == c->kept;
}

// Keep the unknowns of x at the time t, and add their local error; 0 where there are too few states.
int local_error_of_step(LocalErrorCall* c, const double* x, double t) {
    if (!keep_state(c, x, t)) return 0;
    double ascending[MOST_STATES];
    const double* states[MOST_STATES];
    const int kept = c->kept, n = c->n;
    for (int k = 0; k < kept; ++k) {
        ascending[k] = c->times[place(*c, k)];
        states[k] = c->states + static_cast<long>(place(*c, k)) * n;
    }
    if (c->order > 0)
        bdf_error_weights(c->order, ascending, c->weights);
    else
        third_difference_weights(c->third, ascending, c->weights);
    const auto add = kept == 3 ? add_errors<3> : kept == 4 ? add_errors<4> : kept == 5 ? add_errors<5> : kept == 6 ? add_errors<6> : kept == 7 ? add_errors<7> : add_errors<8>;
    add(n, c->weights, states, c->net, c->total, c->largest);
    return 1;
}
}
