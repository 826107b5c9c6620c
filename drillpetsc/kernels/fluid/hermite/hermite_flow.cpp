#include "fluid/hermite/hermite_annulus.hpp"
#include "fluid/hermite/hermite_bit.hpp"
#include "fluid/hermite/hermite_bore.hpp"

using namespace dp;
typedef HermiteBore<false, false> PipePlain;
typedef HermiteBore<true, false> PipeJunction;
typedef HermiteBore<false, true> PipeHeld;
typedef HermiteAnnulus<false, false> AnnulusPlain;
typedef HermiteAnnulus<true, false> AnnulusJunction;
typedef HermiteAnnulus<false, true> AnnulusHeld;
typedef HermiteBit<true, true, false> BitNozzle;
typedef HermiteBit<true, false, false> BitJet;
typedef HermiteBit<false, true, false> BitClosed;
typedef HermiteBit<true, true, true> BitNozzleHeld;
typedef HermiteBit<true, false, true> BitJetHeld;
typedef HermiteBit<false, true, true> BitClosedHeld;

#define DP_HERMITE(name, Kernel, Results) DP_ENTRY(name, Kernel) DP_FLOW_RESULTS(name, Kernel, Results)
DP_HERMITE(hermite_bore, PipePlain, FlowResults)
DP_HERMITE(hermite_bore_junction, PipeJunction, FlowResults)
DP_HERMITE(hermite_bore_held, PipeHeld, FlowResults)
DP_HERMITE(hermite_annulus, AnnulusPlain, FlowResults)
DP_HERMITE(hermite_annulus_junction, AnnulusJunction, FlowResults)
DP_HERMITE(hermite_annulus_held, AnnulusHeld, FlowResults)
DP_HERMITE(hermite_bit, BitNozzle, BitFlowResults)
DP_HERMITE(hermite_bit_jet, BitJet, BitFlowResults)
DP_HERMITE(hermite_bit_closed, BitClosed, BitFlowResults)
DP_HERMITE(hermite_bit_held, BitNozzleHeld, BitFlowResults)
DP_HERMITE(hermite_bit_jet_held, BitJetHeld, BitFlowResults)
DP_HERMITE(hermite_bit_closed_held, BitClosedHeld, BitFlowResults)
