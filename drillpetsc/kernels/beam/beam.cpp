#include "beam/beam_jacobian.hpp"

using namespace dp;
typedef Beam<false, false> BeamPlain;
typedef Beam<true, false> BeamDamped;
typedef Beam<false, true> BeamJunction;
typedef Beam<true, true> BeamJunctionDamped;
DP_RESIDUAL(beam, BeamPlain)
DP_RESIDUAL(beam_damped, BeamDamped)
DP_RESIDUAL(beam_junction, BeamJunction)
DP_RESIDUAL(beam_junction_damped, BeamJunctionDamped)
DP_JACOBIAN(beam, BeamPlain, run_beam_jacobian<false>)
DP_JACOBIAN(beam_damped, BeamDamped, run_beam_jacobian<true>)
DP_JACOBIAN(beam_junction, BeamJunction, run_beam_junction_jacobian<false>)
DP_JACOBIAN(beam_junction_damped, BeamJunctionDamped, run_beam_junction_jacobian<true>)
// the same by differentiating all rows by all unknowns: the tests compare with these
DP_JACOBIAN(beam_dual, BeamPlain, run_jacobian<BeamPlain>)
DP_JACOBIAN(beam_damped_dual, BeamDamped, run_jacobian<BeamDamped>)
DP_JACOBIAN(beam_junction_dual, BeamJunction, run_jacobian<BeamJunction>)
DP_JACOBIAN(beam_junction_damped_dual, BeamJunctionDamped, run_jacobian<BeamJunctionDamped>)
