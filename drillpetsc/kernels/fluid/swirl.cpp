// Swirl of the mud about elements after the last step, and among the parameters of their blocks (manual: sec-mud-swirl).
#include <cmath>

#include "core/names.hpp"

namespace {

// Rows (n) of the state: share [-], then of the last step spin, swirl [rad/s], trend of the spin [rad/s2], rate at which the swirl follows
// [1/s]; at the time asked for last: swirl and its rate.
DP_ENUM(Swirl, SHARE, SPIN, SWIRL, TREND, FOLLOW, NOW, RATE, ROWS)

// A block whose parameters (count, width) have share, swirl, swirl_rate and spin_rate at these columns; rows: of its elements in the state.
DP_RECORD(SwirlBlock, const int* rows; double* parameters; const int* columns; int count, width;)

// A swirl about n elements: its state and blocks; places (n, 2) of the spins of the elements' nodes in the rates; spins (n): work.
DP_RECORD(SwirlCall, double* state; const SwirlBlock* blocks; const int* places; const double* rates; double* spins; int n, block_count;)

}  // namespace

DP_EXPORT(swirl_rows, SwirlText)
DP_EXPORT_RECORD(swirl_block, SwirlBlock)
DP_EXPORT_RECORD(swirl_call, SwirlCall)

extern "C" {

// Swirl and its rate a time `step` after the last step: exact for a spin on a straight line (manual: eq-mud-swirl-lag).
void swirl_at(int n, double step, double* v) {
    for (int i = 0; i < n; ++i) {
        const double share = v[SHARE * n + i], spin = v[SPIN * n + i], trend = v[TREND * n + i], k = v[FOLLOW * n + i];
        const double steady = share * (spin + trend * step);
        if (std::isinf(k)) {  // at once
            v[NOW * n + i] = steady;
            v[RATE * n + i] = share * trend;
            continue;
        }
        const double behind = v[SWIRL * n + i] - share * spin;
        const double fallen = k > 0.0 && step > 0.0 ? -std::expm1(-k * step) : 0.0, waited = k > 0.0 ? fallen / k : step;
        const double left = behind * (1.0 - fallen) - share * trend * waited;
        v[NOW * n + i] = steady + left;
        v[RATE * n + i] = -k * left;
    }
}

// Sets the parameters of all blocks a time `step` after the last step; moves: else the mud is at rest.
void swirl_write(int n, double* v, int moves, double step, int blocks, const SwirlBlock* block) {
    if (moves) swirl_at(n, step, v);
    for (int b = 0; b < blocks; ++b, ++block)
        for (int e = 0; e < block->count; ++e) {
            const int i = block->rows[e], *columns = block->columns;
            double* p = block->parameters + (long)e * block->width;
            p[columns[0]] = moves ? v[SHARE * n + i] : 0.0;
            p[columns[1]] = moves ? v[NOW * n + i] : 0.0;
            p[columns[2]] = moves ? v[RATE * n + i] : 0.0;
            p[columns[3]] = v[TREND * n + i];
        }
}

// Goes on to the end of a step, 0 at the start of a continued run, with the spins (n) there: their trend, the swirl, the parameters of all
// blocks.  known: v has the swirl at that time.
void swirl_accept(int n, double step, int known, const double* spins, double* v, int blocks, const SwirlBlock* block) {
    if (step > 0.0) {
        if (!known) swirl_at(n, step, v);
        for (int i = 0; i < n; ++i) {
            v[SWIRL * n + i] = v[NOW * n + i];
            v[TREND * n + i] = (spins[i] - v[SPIN * n + i]) / step;
        }
    }
    for (int i = 0; i < n; ++i) v[SPIN * n + i] = spins[i];
    swirl_write(n, v, 1, 0.0, blocks, block);
}

// swirl_write and swirl_accept of several swirls, which have the same times.
void swirls_write(int count, const SwirlCall* calls, int moves, double step) {
    for (const SwirlCall* c = calls; c < calls + count; ++c) swirl_write(c->n, c->state, moves, step, c->block_count, c->blocks);
}

void mean_spins(int n, const int* places, const double* y, double* out);

void swirls_accept(int count, const SwirlCall* calls, double step, int known) {
    for (const SwirlCall* c = calls; c < calls + count; ++c) {
        mean_spins(c->n, c->places, c->rates, c->spins);
        swirl_accept(c->n, step, known, c->spins, c->state, c->block_count, c->blocks);
    }
}

// Mean spins (n) of pairs of nodes with their spins at places (n, 2) of the rates y.
void mean_spins(int n, const int* places, const double* y, double* out) {
    for (int i = 0; i < n; ++i) out[i] = 0.5 * (y[places[2 * i]] + y[places[2 * i + 1]]);
}

// Whether a rate at which the swirl follows is not known, or a flow at the places (n) of x, none at -1, has changed by more than `limit` since.
int following_is_old(int n, const int* places, const double* x, const double* flow, const double* v, double limit) {
    for (int i = 0; i < n; ++i) {
        if (std::isinf(v[FOLLOW * n + i])) return 1;
        if (places[i] >= 0 && std::fabs(x[places[i]] - flow[i]) > limit) return 1;
    }
    return 0;
}
}
