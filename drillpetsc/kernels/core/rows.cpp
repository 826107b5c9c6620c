// Rows of all blocks of an assembly, and results of one block with their sums, each in one call from Python.
#include "core/names.hpp"

namespace {
typedef void (*Residual)(int, const int*, const double*, void*, const double*, const double*, const double*, double*);
typedef void (*Results)(int, int, const int*, const double*, void*, const double*, const double*, double*);
}  // namespace

// A block of elements: entry point of its residual and the arguments.
DP_RECORD(BlockCall,
    const void* residual; const int* index; const double* parameters; const void* record; const double* x; const double* y; const double* a; int count;
)
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
    for (int j = 0; j < c.columns; ++j) c.sums[j] = 0.0;
    for (int e = 0; e < c.count; ++e)
        for (int j = 0; j < c.columns; ++j) c.sums[j] += c.out[(long)e * c.columns + j];
}

// The same of n blocks.
extern "C" void run_all_results(int n, const ResultCall* const* calls) {
    for (int k = 0; k < n; ++k) run_results(calls[k]);
}

// The same, and then n numbers from anywhere into a column of a table (n, steps): what is kept of a step.
extern "C" void record_step(int blocks, const ResultCall* const* calls, int n, int steps, const double* const* from, double* column) {
    run_all_results(blocks, calls);
    for (int i = 0; i < n; ++i) column[(long)i * steps] = *from[i];
}

extern "C" {
void condensed_rates(int, const double*, double, double, const double*, const double*, int, const int*, const double*, double*, double*);
void constraint_rates(int, const double*, const int*, const double*, double, const double*, double*, double*);
void constraint_rows(int, const double*, const int*, const int*, const double*, const double*, double, double*, double*);
void lean_at(const int*, const double*, const double*, double*, double*, double*);
void lean_rates(const int*, const double*, double, const double*, double*, double*);
void lean_rows(const int*, const double*, double, double*);
}

// Prescribed motion of a node, as core/constraint.cpp takes it; places: of the node's rows in the residual, null where another rank has them.
// axis: from which a spin counts that is held where the slope is free, else null; lean, keep, direction: see there.
DP_RECORD(PrescribedCall,
    const double* directions; const int* rows; const double* rate; const double* value; const int* places; double* reaction;
    const double* axis; double* lean; double* keep; double* direction; int count, unused;
)
DP_EXPORT_RECORD(prescribed_call, PrescribedCall)

// What the residual of a condensed step needs: n unknowns at places `owned` of x, y, a, r; constants v0, v1 of the time formula;
// spins nodes with a spin angle (core/nodes.cpp); prescribed motion; blocks; dead: null, or a dead load at the `size` local unknowns.
DP_RECORD(StepCall,
    const int* owned; double* x; double* y; double* a; double* r; const double* v0; const double* v1; const int* where; const double* reference;
    const PrescribedCall* prescribed; const BlockCall* blocks; const double* dead; double sigma, second, scale; int n, size, length, spins, prescriptions, count;
)
DP_EXPORT_RECORD(step_call, StepCall)

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
