#include "fluid/hermite/hermite_annulus.hpp"
#include "fluid/hermite/hermite_bit.hpp"
#include "fluid/hermite/hermite_bore.hpp"

using namespace dp;
typedef HermiteBore<false, false> PipePlain;
typedef HermiteBore<true, false> PipeSplit;
typedef HermiteBore<false, true> PipeHeld;
typedef HermiteAnnulus<false, false> AnnulusPlain;
typedef HermiteAnnulus<true, false> AnnulusSplit;
typedef HermiteAnnulus<false, true> AnnulusHeld;
typedef HermiteBit<true, true, false> BitNozzle;
typedef HermiteBit<true, false, false> BitJet;
typedef HermiteBit<false, true, false> BitClosed;
typedef HermiteBit<true, true, true> BitNozzleHeld;
typedef HermiteBit<true, false, true> BitJetHeld;
typedef HermiteBit<false, true, true> BitClosedHeld;

#define DP_HERMITE(name, Kernel, Result, N) DP_ENTRY(name, Kernel) DP_FLOW_REPORT(name, Kernel, Result, N)
DP_HERMITE(hermite_bore, PipePlain, dp::FlowReport, 1)
DP_HERMITE(hermite_bore_split, PipeSplit, dp::FlowReport, 1)
DP_HERMITE(hermite_bore_held, PipeHeld, dp::FlowReport, 1)
DP_HERMITE(hermite_annulus, AnnulusPlain, dp::FlowReport, 1)
DP_HERMITE(hermite_annulus_split, AnnulusSplit, dp::FlowReport, 1)
DP_HERMITE(hermite_annulus_held, AnnulusHeld, dp::FlowReport, 1)
DP_HERMITE(hermite_bit, BitNozzle, double, 7)
DP_HERMITE(hermite_bit_jet, BitJet, double, 7)
DP_HERMITE(hermite_bit_closed, BitClosed, double, 7)
DP_HERMITE(hermite_bit_held, BitNozzleHeld, double, 7)
DP_HERMITE(hermite_bit_jet_held, BitJetHeld, double, 7)
DP_HERMITE(hermite_bit_closed_held, BitClosedHeld, double, 7)
