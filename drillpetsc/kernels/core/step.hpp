// What a condensed step needs from Python: the blocks, prescribed motion, the residual, the Jacobian.  The addresses stay those of the same
// arrays through a run; times, shifts and weights change.
#pragma once
#include "core/names.hpp"

namespace dp {

// A block of elements: entry point of its residual and the arguments.
DP_RECORD(BlockCall,
    const void* residual; const int* index; const double* parameters; const void* record; const double* x; const double* y; const double* a; int count;
)

// Prescribed motion of a node, as core/constraint.cpp takes it; places: of the node's rows in the residual, null where another rank has them.
// axis: from which a spin counts that is held where the slope is free, else null; lean, keep, direction: see there.
// rate_directions (count, 7): over the rates, `direction` is the last of them.
DP_RECORD(PrescribedCall,
    const double* directions; const int* rows; const double* rate; const double* value; const int* places; double* reaction;
    const double* axis; double* lean; double* keep; double* direction; const double* rate_directions; int count, unused;
)

// What the residual of a condensed step needs: n unknowns at places `owned` of x, y, a, r; constants v0, v1 of the time formula;
// spins nodes with a spin angle (core/nodes.cpp); prescribed motion; blocks; dead: null, or a dead load at the `size` local unknowns.
DP_RECORD(StepCall,
    const int* owned; double* x; double* y; double* a; double* r; const double* v0; const double* v1; const int* where; const double* reference;
    const PrescribedCall* prescribed; const BlockCall* blocks; const double* dead; double sigma, second, scale; int n, size, length, spins, prescriptions, count;
)

// A block of elements: entry point of its Jacobian and the arguments; values: of its `width` x `width` entries for each element.
DP_RECORD(MatrixCall,
    const void* jacobian; const int* index; const int* nodes; const double* parameters; const void* record; double* values; int count, width;
)

// Entries at prescribed motion: those of the `count` elements at the node (core/constraint.cpp), and its own (7, 7), null on another rank.
// applied: (49) `keep` of the last entries, null where it is not stored.
DP_RECORD(PrescribedMatrix,
    const double* keep; const void* at; const int* width; const int* slots; const double* projector; double* own; double* applied; int count, unused;
)

// What the Jacobian of a condensed step needs beside the state of a StepCall; weights (3) of dR/dx, dR/dy, dR/da; spin: core/nodes.cpp.
DP_RECORD(JacobianCall,
    const StepCall* step; const MatrixCall* blocks; const PrescribedMatrix* prescribed; double* values; double* weights; double* spin; int count, unused;
)

// A system beside a run, in which the parameter `key` is changed by `change`; weight: of its rows in the derivative by it.
DP_RECORD(BesideCall,
    const StepCall* step; double change, weight; int key, unused;
)

// State (x, y, a, v1) of the run, and its derivatives by each parameter (keys, size); v1 and moved_v1 are null if rates are not prescribed.
// rows (n) is work, or null if the systems are only moved; sums (keys, n), to which the rows are added, or null.
DP_RECORD(BesideState,
    const double* x; const double* y; const double* a; const double* v1; const double* moved_x; const double* moved_y; const double* moved_a;
    const double* moved_v1; double* rows; double* sums; double second;
)

}  // namespace dp

extern "C" {
void step_rows(const dp::StepCall*, const double* q, double* rows);
void weigh_entries(const dp::JacobianCall*);
void block_entries(const dp::JacobianCall*, const dp::MatrixCall*);
void replace_rows(const dp::JacobianCall*, const dp::PrescribedMatrix*);
void prescribed_entries(const dp::JacobianCall*, double by_position);
double residual_power(const dp::StepCall*, int n, const int* i, const double* rows, const int* j);
}
