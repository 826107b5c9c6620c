// Products of kernels' derivatives with directions.  They stand apart from the kernels, whose code and rounding they leave as they are.
#include "beam/eccentric.hpp"
#include "bit/bit.hpp"
#include "fluid/bit_flow.hpp"
#include "tangent/beam_by_rates.hpp"
#include "tangent/by_rates.hpp"
#include "tangent/contact_by_rates.hpp"
#include "tangent/flow_by_rates.hpp"

using namespace dp;
typedef Beam<false, true> BeamJunction;
typedef Beam<true, true> BeamJunctionDamped;
typedef Bit<0, false, false> PlainBit;
typedef BoreFlow<true, false> BoreJunction;
typedef AnnulusFlow<true, false> AnnulusJunction;
typedef AnnulusFlow<false, false, true> AnnulusAside;
typedef AnnulusFlow<true, false, true> AnnulusAsideJunction;
typedef BitFlow<true, true, false> BitNozzle;

DP_PRODUCT(beam, run_beam_by_rates<false>(n, idx, par, x, y, count, length, dy, da, r))
DP_PRODUCT(beam_damped, run_beam_by_rates<true>(n, idx, par, x, y, count, length, dy, da, r))
DP_PRODUCT(contact, run_contact_by_rates(n, idx, par, ctx, x, y, a, count, length, chosen, dx, dy, da, r))
DP_PRODUCT(bore_flow, run_flow_by_rates<BoreByRates>(n, idx, par, ctx, x, y, a, count, length, dy, da, r))
DP_PRODUCT(annulus_flow, run_flow_by_rates<AnnulusByRates>(n, idx, par, ctx, x, y, a, count, length, dy, da, r))
DP_PRODUCT(curved, (void)n)  // the rows depend on positions alone
DP_PRODUCT(curved_junction, (void)n)
DP_BY_RATES(beam_junction, BeamJunction)
DP_BY_RATES(beam_junction_damped, BeamJunctionDamped)
DP_BY_RATES(eccentric, Eccentric<false>)
DP_BY_RATES(eccentric_junction, Eccentric<true>)
DP_BY_RATES(contact_junction, BeamContact<true>)
DP_BY_RATES(body_contact, BodyContact)
DP_BY_RATES(bit_contact, BitContact)
DP_BY_RATES(bit_rock, PlainBit)
DP_BY_RATES(bore_flow_junction, BoreJunction)
DP_BY_RATES(annulus_flow_junction, AnnulusJunction)
DP_BY_RATES(annulus_flow_aside, AnnulusAside)
DP_BY_RATES(annulus_flow_aside_junction, AnnulusAsideJunction)
DP_BY_RATES(bit_flow, BitNozzle)
