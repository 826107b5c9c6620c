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

// Elements of a block in a system beside a run: entry point of its residual and the arguments without the state.  moved: evaluated at positions
// moved along the guess, in which contacts open and close less than at those of the run.  others: the parameters, of a `size`, of this part in
// the other systems of the key, none where rows differ by more than these.
DP_RECORD(PartCall,
    const void* residual; const int* index; const double* parameters; const void* record; const void* others; int count, moved, other_count, size;
)

// A system beside a run, in which the parameter `key` is changed by `change`; weight: in the derivative by it.  parts: of the blocks that the
// parameter changes; they add to rows `first` to `last`, and those at moved
// positions depend on the unknowns from `low` to `high`.  follows: its prescribed motion differs from the run's by a constant at most.  ends: of the blocks at prescribed motion, for its reactions.
DP_RECORD(BesideCall,
    const StepCall* step; const PartCall* parts; const PartCall* ends; double change, weight; int key, part_count, end_count, first, last, follows, low, high, unused;
)

// Derivatives (keys, 7) of position and rate along a prescribed motion, and of the rows by its turning, or null; index (elements at the node):
// unknowns of each.  free (2, keys, 7): work.
DP_RECORD(GivenCall, double* position; double* rate; const double* turning; const void* index; double* free;)

// Constants of a multistep formula: sums of unknowns x and rates y (keys, length) at `count` nodes.
DP_RECORD(FormulaSums, const double* weights; const void* x; const void* y; int count, unused;)

// Derivatives of a step by `keys` parameters, each of `length` numbers (manual: eq-sensitivities-step).  products: of each block of the Jacobian,
// the entry point that multiplies its derivatives by rates and accelerations with directions, or null.  x, y, a: the state of the Jacobian.
// last_x, last_y: derivatives at the last step; with_rate (length): zero where no rate is an unknown.  moved (blocks, keys): 1 where a key has
// the block evaluated at moved positions.  sums: null where by_rate and by_second (keys, length)
// have the formula's v0 and v1; they get the directions.  along, lean,
// element: work.  rows (keys, length), owned (keys, n): right sides of the increments `found` (keys, n); moved_x, moved_y, moved_a: the derivatives.
DP_RECORD(TangentCall,
    const StepCall* step; const JacobianCall* jacobian; const void* products; const BesideCall* beside; const GivenCall* given; const FormulaSums* sums;
    const double* x; const double* y; const double* a; const double* last_x; const double* last_y; const signed char* with_rate;
    const signed char* moved; double* along; double* by_rate; double* by_second; double* lean; double* element; double* rows; double* owned;
    const double* found; double* moved_x; double* moved_y; double* moved_a; double second; int keys, length, besides, unused;
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
