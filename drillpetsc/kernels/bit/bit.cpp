#include "bit/bit.hpp"
#include "core/formulations.hpp"

using namespace dp;
typedef Bit<0, false, false> PlainBit;
typedef Bit<CHIPS, false, false> ProfileBit;
DP_ENTRY(bit_rock, PlainBit)
DP_ENTRY(bit_rock_profile, ProfileBit)
DP_OTHER_FORMULATIONS(bit_rock, PlainBit, 1)
DP_OTHER_FORMULATIONS(bit_rock_profile, ProfileBit, 1)
DP_BIT_RESULTS(bit_rock, PlainBit)
DP_BIT_RESULTS(bit_rock_profile, ProfileBit)

// along: rate of penetration along the bit [m/s] if it is known, else null
// rate of penetration out (3) [m/s] under the force F (3) of a bit with axis e (3) that turns with omega, `drilled` metres into the formation
extern "C" void rock_rate(void* context, const double* F, const double* e, double omega, double drilled, const double* along, double* out) {
    const Vec<double> v = rock_rate<double>(*static_cast<const BitLaw*>(context), drilled, vec(F), vec(e), omega, along);
    out[0] = v.x; out[1] = v.y; out[2] = v.z;
}

// weight [N] beyond a threshold, rounded off
extern "C" double bit_beyond(double weight, double threshold) { return beyond(weight, threshold); }

DP_EXPORT_RECORD(bit_law, BitLaw)
DP_EXPORT(bit_rock_results, BitResultsText)
DP_EXPORT(bit_layer, BitLayer::ColumnText)
DP_EXPORT(bit_order, BitOrder::ColumnText)
DP_EXPORT(bit_kind, BitKind::KindText)
DP_EXPORT(own_bit_state, OwnBit::StateText)
DP_EXPORT(own_bit_result, OwnBit::ResultText)
DP_EXPORT(own_rock_state, OwnRock::StateText)
DP_EXPORT(own_rock_result, OwnRock::ResultText)
DP_EXPORT(bit_mode, BitMode::ModeText)
DP_CONSTANT(bit_chips, CHIPS)
