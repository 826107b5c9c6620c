// A bit whose side wall gives way: the over-gauge of the hole beside the bit is a state.
#include "bit/bit.hpp"
#include "core/formulations.hpp"

using namespace dp;
typedef Bit<0, false, true> CuttingBit;
typedef Bit<CHIPS, false, true> CuttingProfileBit;
DP_ENTRY(bit_rock_cutting, CuttingBit)
DP_ENTRY(bit_rock_profile_cutting, CuttingProfileBit)
DP_OTHER_FORMULATIONS(bit_rock_cutting, CuttingBit, 1)
DP_OTHER_FORMULATIONS(bit_rock_profile_cutting, CuttingProfileBit, 1)
DP_BIT_RESULTS(bit_rock_cutting, CuttingBit)
DP_BIT_RESULTS(bit_rock_profile_cutting, CuttingProfileBit)
