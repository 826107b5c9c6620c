// Rows of all blocks of an assembly in one call, so that a residual costs one call from Python.
#include "core/names.hpp"

namespace {
typedef void (*Residual)(int, const int*, const double*, void*, const double*, const double*, const double*, double*);
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
