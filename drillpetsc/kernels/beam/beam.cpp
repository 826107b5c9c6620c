#include "beam/beam_jacobian.hpp"

using namespace dp;
typedef Beam<false, false> BeamPlain;
typedef Beam<true, false> BeamDamped;
typedef Beam<false, true> BeamSplit;
typedef Beam<true, true> BeamSplitDamped;
DP_RESIDUAL(beam, BeamPlain)
DP_RESIDUAL(beam_damped, BeamDamped)
DP_RESIDUAL(beam_split, BeamSplit)
DP_RESIDUAL(beam_split_damped, BeamSplitDamped)
DP_JACOBIAN(beam, run_beam_jacobian<false>)
DP_JACOBIAN(beam_damped, run_beam_jacobian<true>)
DP_JACOBIAN(beam_split, run_beam_split_jacobian<false>)
DP_JACOBIAN(beam_split_damped, run_beam_split_jacobian<true>)
// the same by differentiating all rows by all unknowns: the oracles of the tests
DP_JACOBIAN(beam_dual, run_jacobian<BeamPlain>)
DP_JACOBIAN(beam_damped_dual, run_jacobian<BeamDamped>)
DP_JACOBIAN(beam_split_dual, run_jacobian<BeamSplit>)
DP_JACOBIAN(beam_split_damped_dual, run_jacobian<BeamSplitDamped>)
