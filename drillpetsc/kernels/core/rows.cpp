// Rows and Jacobian entries of all blocks of an assembly, and results of one block with their sums, each in one call from Python.
#include <cstring>

#include "core/element.hpp"
#include "core/step.hpp"

using namespace dp;

namespace {
typedef void (*Jacobian)(int, const int*, const int*, const double*, void*, const double*, const double*, const double*, const double*, const double*, double*);
typedef void (*Residual)(int, const int*, const double*, void*, const double*, const double*, const double*, double*);
typedef void (*Results)(int, int, const int*, const double*, void*, const double*, const double*, double*);
}  // namespace

DP_EXPORT_RECORD(block_call, BlockCall)

// Adds the rows of n blocks to r; its first `length` entries are set to zero before.
extern "C" void run_residuals(int n, const BlockCall* calls, int length, double* r) {
    for (int i = 0; i < length; ++i) r[i] = 0.0;
    for (int k = 0; k < n; ++k) {
        const BlockCall& c = calls[k];
        reinterpret_cast<Residual>(const_cast<void*>(c.residual))(c.count, c.index, c.parameters, const_cast<void*>(c.record), c.x, c.y, c.a, r);
    }
}

// Rows (count, width) of each element of a block; separate (count, width): 0, 1, 2, ...; work (3, count, width): its x, y, a.
extern "C" void element_rows(const BlockCall* call, int width, const int* separate, double* work, double* rows) {
    const BlockCall& c = *call;
    const long size = (long)c.count * width;
    double *x = work, *y = work + size, *a = y + size;
    for (long i = 0; i < size; ++i) {
        const int k = c.index[i];
        x[i] = c.x[k]; y[i] = c.y[k]; a[i] = c.a[k];
        rows[i] = 0.0;
    }
    reinterpret_cast<Residual>(const_cast<void*>(c.residual))(c.count, separate, c.parameters, const_cast<void*>(c.record), x, y, a, rows);
}

// Results of a block of elements: entry point of the kernel and its arguments; out (count, columns), sums (columns) of the columns.
DP_RECORD(ResultCall,
    const void* results; const int* index; const double* parameters; const void* record; const double* x; const double* y; double* out; double* sums;
    int count, width, columns, unused;
)
DP_EXPORT_RECORD(result_call, ResultCall)

extern "C" void run_results(const ResultCall* call) {
    const ResultCall& c = *call;
    for (long i = 0; i < (long)c.count * c.columns; ++i) c.out[i] = 0.0;  // kernels may add up
    if (c.count) reinterpret_cast<Results>(const_cast<void*>(c.results))(c.count, c.width, c.index, c.parameters, const_cast<void*>(c.record), c.x, c.y, c.out);
    // four columns at a time, whose sums stay in a register
    int j = 0;
    for (; j + 4 <= c.columns; j += 4) {
        V4 sum = splat(0.0);
        for (int e = 0; e < c.count; ++e) sum += *reinterpret_cast<const Unaligned*>(c.out + (long)e * c.columns + j);
        *reinterpret_cast<Unaligned*>(c.sums + j) = sum;
    }
    for (; j < c.columns; ++j) {
        double sum = 0.0;
        for (int e = 0; e < c.count; ++e) sum += c.out[(long)e * c.columns + j];
        c.sums[j] = sum;
    }
}

// The same of n blocks.
extern "C" void run_all_results(int n, const ResultCall* const* calls) {
    for (int k = 0; k < n; ++k) run_results(calls[k]);
}

// The same, and then n numbers from anywhere, one after the other: what is kept of a step.
extern "C" void record_step(int blocks, const ResultCall* const* calls, int n, const double* const* from, double* to) {
    run_all_results(blocks, calls);
    for (int i = 0; i < n; ++i) to[i] = *from[i];
}

// The same of `count` systems, each into its row of a table of n columns.
DP_RECORD(RecordCall, const void* results; const void* sources; double* table; int blocks, n;)
DP_EXPORT_RECORD(record_call, RecordCall)

extern "C" void record_steps(int count, const RecordCall* calls, int row) {
    for (int k = 0; k < count; ++k) {
        const RecordCall& c = calls[k];
        record_step(c.blocks, static_cast<const ResultCall* const*>(c.results), c.n, static_cast<const double* const*>(c.sources), c.table + (long)row * c.n);
    }
}

extern "C" {
void condensed_rates(int, const double*, double, double, const double*, const double*, int, const int*, const double*, double*, double*);
void constraint_rates(int, const double*, const int*, const double*, double, const double*, double*, double*);
void constraint_rows(int, const double*, const int*, const int*, const double*, const double*, double, double*, double*);
void lean_at(const int*, const double*, const double*, double*, double*, double*);
void lean_rates(const int*, const double*, double, const double*, double*, double*);
void lean_rows(const int*, const double*, double, double*);
void lean_derivative(const int*, const double*, const double*, double*);
void constraint_matrix(int, const double*, const long long*, const int*, const int*, double*);
void spin_gradient(int, const int*, const double*, const double*, const double*, double, double, double*);
double gathered_product(int, const int*, const double*, const int*, const double*);
}

DP_EXPORT_RECORD(prescribed_call, PrescribedCall)
DP_EXPORT_RECORD(step_call, StepCall)
DP_EXPORT_RECORD(matrix_call, MatrixCall)
DP_EXPORT_RECORD(prescribed_matrix, PrescribedMatrix)
DP_EXPORT_RECORD(jacobian_call, JacobianCall)

// Both parts of a global state in local arrays of n unknowns, x and y, and the constants v0, v1 of the time formula, rate - shift state; zero
// where a place is negative.
extern "C" void load_step(int n, const int* x_from, const int* y_from, const double* state, const double* rate, double shift, double* x, double* y,
                          double* v0, double* v1) {
    for (int i = 0; i < n; ++i) {
        const int p = x_from[i], q = y_from[i];
        x[i] = p >= 0 ? state[p] : 0.0;
        v0[i] = p >= 0 ? rate[p] - shift * state[p] : 0.0;
        y[i] = q >= 0 ? state[q] : 0.0;
        v1[i] = q >= 0 ? rate[q] - shift * state[q] : 0.0;
    }
}

// The other way: n unknowns and m rates.
extern "C" void store_step(int n, const int* unknowns, const int* x_to, int m, const int* rates, const int* y_to, const double* x, const double* y,
                           double* state) {
    for (int i = 0; i < n; ++i) state[x_to[i]] = x[unknowns[i]];
    for (int i = 0; i < m; ++i) state[y_to[i]] = y[rates[i]];
}

// State of a condensed step from the owned unknowns q (n).
extern "C" void step_state(const StepCall* call, const double* q) {
    const StepCall& c = *call;
    for (int i = 0; i < c.n; ++i) c.x[c.owned[i]] = q[i];
}


// Rates and accelerations of all `size` local unknowns; rows of the owned ones (n), without what other ranks add.
extern "C" void step_blocks(const StepCall* call, double* rows) {
    const StepCall& c = *call;
    condensed_rates(c.size, c.x, c.sigma, c.second, c.v0, c.v1, c.spins, c.where, c.reference, c.y, c.a);
    for (int k = 0; k < c.prescriptions; ++k) {
        const PrescribedCall& p = c.prescribed[k];
        constraint_rates(p.count, p.directions, p.rows, p.rate, c.second, c.v1, c.y, c.a);
        if (p.axis) {
            lean_at(p.rows, p.axis, c.x, p.lean, p.keep, p.direction);
            lean_rates(p.rows, p.lean, c.second, c.v1, c.y, c.a);
        }
    }
    if (c.dead) {
        for (int i = 0; i < c.size; ++i) c.r[i] = 0.0 - c.dead[i];
        for (int i = c.size; i < c.length; ++i) c.r[i] = 0.0;
    }
    run_residuals(c.count, c.blocks, c.dead ? 0 : c.length, c.r);
    for (int i = 0; i < c.n; ++i) rows[i] = c.r[c.owned[i]];
}

// Replaces the rows (n) along prescribed directions.
extern "C" void step_prescribed(const StepCall* call, double* rows) {
    const StepCall& c = *call;
    for (int k = 0; k < c.prescriptions; ++k) {
        const PrescribedCall& p = c.prescribed[k];
        if (!p.places) continue;
        constraint_rows(p.count, p.directions, p.rows, p.places, c.x, p.value, c.scale, rows, p.reaction);
        if (p.axis) lean_rows(p.places, p.lean, p.reaction[p.count - 1], rows);
    }
}

// All three on one rank.
extern "C" void step_rows(const StepCall* call, const double* q, double* rows) {
    step_state(call, q);
    step_blocks(call, rows);
    step_prescribed(call, rows);
}

// Derivatives of the spin rates for the weights of the next entries.
extern "C" void weigh_entries(const JacobianCall* call) {
    const StepCall& s = *call->step;
    const double by_rate = call->weights[1];
    spin_gradient(s.spins, s.where, s.reference, s.x, s.y, by_rate, by_rate ? 1.0 / by_rate : 0.0, call->spin);
}

// Entries of one block.
extern "C" void block_entries(const JacobianCall* call, const MatrixCall* block) {
    const StepCall& s = *call->step;
    const MatrixCall& b = *block;
    reinterpret_cast<Jacobian>(const_cast<void*>(b.jacobian))(b.count, b.index, b.nodes, b.parameters, const_cast<void*>(b.record), call->weights,
                                                              call->spin, s.x, s.y, s.a, b.values);
}

// Leaves in the entries of elements at a prescribed motion what remains of the node's rows.
extern "C" void replace_rows(const JacobianCall* call, const PrescribedMatrix* matrix) {
    const PrescribedMatrix& m = *matrix;
    constraint_matrix(m.count, m.keep, static_cast<const long long*>(m.at), m.width, m.slots, call->values);
}

// Replaces the rows along prescribed directions; by_position: 1 with dR/dx in the sum, else 0.  Those of all nodes first, since an element may have two.
extern "C" void prescribed_entries(const JacobianCall* call, double by_position) {
    const StepCall& s = *call->step;
    for (int k = 0; k < s.prescriptions; ++k) {
        const PrescribedCall& p = s.prescribed[k];
        if (p.axis) lean_at(p.rows, p.axis, s.x, p.lean, p.keep, p.direction);
        replace_rows(call, call->prescribed + k);
    }
    for (int k = 0; k < s.prescriptions; ++k) {
        const PrescribedCall& p = s.prescribed[k];
        const PrescribedMatrix& m = call->prescribed[k];
        std::memcpy(m.applied, m.keep, 49 * sizeof(double));
        if (!m.own) continue;
        for (int i = 0; i < 49; ++i) m.own[i] = by_position * s.scale * m.projector[i];
        if (!p.axis) continue;
        double change[9];
        lean_derivative(p.rows, p.axis, s.x, change);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) m.own[7 * (3 + i) + 3 + j] += by_position * p.reaction[p.count - 1] * change[3 * i + j];
    }
}

// Power of the rows that are left: the sum of rows[i] y[j] over n pairs, without the rows along prescribed directions.
extern "C" double residual_power(const StepCall* call, int n, const int* i, const double* rows, const int* j) {
    const StepCall& c = *call;
    double power = gathered_product(n, i, rows, j, c.y);
    for (int k = 0; k < c.prescriptions; ++k) {
        const PrescribedCall& p = c.prescribed[k];
        for (int m = 0; p.places && m < p.count; ++m) {
            double force = 0.0, rate = 0.0;
            for (int q = 0; q < 7; ++q) {
                force += p.directions[7 * m + q] * rows[p.places[q]];
                rate += p.rate_directions[7 * m + q] * c.y[p.rows[q]];
            }
            power -= force * rate;
        }
    }
    return power;
}
