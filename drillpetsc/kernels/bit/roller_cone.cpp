// A bit whose bottom has a pattern: the lobes that roller cones leave.
#include "bit/bit.hpp"
#include "core/formulations.hpp"

using namespace dp;
typedef Bit<0, true, false> PatternBit;
typedef Bit<0, true, true> CuttingPatternBit;
DP_ENTRY(bit_rock_pattern, PatternBit)
DP_ENTRY(bit_rock_pattern_cutting, CuttingPatternBit)
DP_OTHER_FORMULATIONS(bit_rock_pattern, PatternBit, 1)
DP_OTHER_FORMULATIONS(bit_rock_pattern_cutting, CuttingPatternBit, 1)
DP_BIT_RESULTS(bit_rock_pattern, PatternBit)
DP_BIT_RESULTS(bit_rock_pattern_cutting, CuttingPatternBit)
