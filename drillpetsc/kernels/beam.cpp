#include "beam.hpp"

using namespace dp;
typedef Beam<false, false> BeamPlain;
typedef Beam<true, false> BeamDamped;
typedef Beam<false, true> BeamSplit;
typedef Beam<true, true> BeamSplitDamped;
DP_ENTRY(beam, BeamPlain)
DP_ENTRY(beam_damped, BeamDamped)
DP_ENTRY(beam_split, BeamSplit)
DP_ENTRY(beam_split_damped, BeamSplitDamped)
