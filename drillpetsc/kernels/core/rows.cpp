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
