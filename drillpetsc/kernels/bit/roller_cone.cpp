// A bit whose bottom has a pattern: the lobes that roller cones leave.
#include "bit/bit.hpp"
#include "core/formulations.hpp"

using namespace dp;
typedef Bit<0, true> PatternBit;
DP_ENTRY(bit_rock_pattern, PatternBit)
DP_OTHER_FORMULATIONS(bit_rock_pattern, PatternBit, 1)

// results of the bit, a BitResults
extern "C" void bit_rock_pattern_results(const int* idx, const double* par, void* context, const double* x, const double* y, double* out) {
    bit_results<PatternBit>(idx, par, context, x, y, out);
}
