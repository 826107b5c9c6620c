#include "beam_jacobian.hpp"

using namespace dp;
typedef Beam<false, false> BeamPlain;
typedef Beam<true, false> BeamDamped;
typedef Beam<false, true> BeamSplit;
typedef Beam<true, true> BeamSplitDamped;
DP_RESIDUAL(beam, BeamPlain)
DP_RESIDUAL(beam_damped, BeamDamped)
DP_ENTRY(beam_split, BeamSplit)
DP_ENTRY(beam_split_damped, BeamSplitDamped)
DP_JACOBIAN(beam, run_beam_jacobian<false>)
DP_JACOBIAN(beam_damped, run_beam_jacobian<true>)
// the same by differentiating all rows by all unknowns: the oracle of the tests
DP_JACOBIAN(beam_dual, run_jacobian<BeamPlain>)
DP_JACOBIAN(beam_damped_dual, run_jacobian<BeamDamped>)
