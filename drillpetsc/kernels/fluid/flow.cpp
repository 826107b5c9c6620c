#include "fluid/annulus_flow_jacobian.hpp"
#include "fluid/bit_flow.hpp"
#include "fluid/bore_flow_jacobian.hpp"
#include "fluid/joint_flow.hpp"
#include "fluid/side_nozzle.hpp"

using namespace dp;
typedef BoreFlow<false, false> PipePlain;
typedef BoreFlow<true, false> PipeJunction;
typedef BoreFlow<false, true> PipeHeld;
typedef AnnulusFlow<false, false> AnnulusPlain;
typedef AnnulusFlow<true, false> AnnulusJunction;
typedef AnnulusFlow<false, true> AnnulusHeld;
typedef AnnulusFlow<false, false, true> AnnulusAside;
typedef AnnulusFlow<true, false, true> AnnulusAsideJunction;
typedef BitFlow<true, true, false> BitNozzle;
typedef BitFlow<true, false, false> BitJet;
typedef BitFlow<false, true, false> BitClosed;
typedef BitFlow<true, true, false, true> BitNozzleGrow;
typedef BitFlow<false, true, false, true> BitClosedGrow;
typedef BitFlow<true, true, true> BitNozzleHeld;
typedef JointSeal<true, true> SealBoth;
typedef JointSeal<true, false> SealBore;
typedef JointSeal<false, true> SealAnnulus;
typedef SideNozzle<true, false> SideBoth;
typedef SideNozzle<false, false> SideJet;
typedef SideNozzle<true, true> SideBothHeld;
typedef SideNozzle<false, true> SideJetHeld;
typedef BitFlow<true, false, true> BitJetHeld;
typedef BitFlow<false, true, true> BitClosedHeld;
DP_RESIDUAL(bore_flow, PipePlain)
DP_JACOBIAN(bore_flow, PipePlain, run_bore_flow_jacobian)
DP_ENTRY(bore_flow_junction, PipeJunction)
DP_ENTRY(bore_flow_held, PipeHeld)
DP_ENTRY(bore_flow_joint, BoreJoint)
DP_RESIDUAL(annulus_flow, AnnulusPlain)
DP_JACOBIAN(annulus_flow, AnnulusPlain, run_annulus_flow_jacobian)
DP_ENTRY(annulus_flow_junction, AnnulusJunction)
DP_ENTRY(annulus_flow_held, AnnulusHeld)
DP_ENTRY(annulus_flow_joint, AnnulusJoint)
DP_ENTRY(annulus_flow_aside, AnnulusAside)
DP_ENTRY(annulus_flow_aside_junction, AnnulusAsideJunction)
DP_ENTRY(annulus_flow_aside_joint, AnnulusJoint)
DP_ENTRY(joint_inertia, JointInertia)
DP_ENTRY(joint_seal, SealBoth)
DP_ENTRY(joint_seal_bore, SealBore)
DP_ENTRY(joint_seal_annulus, SealAnnulus)
DP_ENTRY(bit_flow, BitNozzle)
DP_ENTRY(bit_flow_jet, BitJet)
DP_ENTRY(bit_flow_closed, BitClosed)
DP_ENTRY(bit_flow_grow, BitNozzleGrow)
DP_ENTRY(bit_flow_closed_grow, BitClosedGrow)
DP_ENTRY(bit_flow_held, BitNozzleHeld)
DP_ENTRY(bit_flow_jet_held, BitJetHeld)
DP_ENTRY(bit_flow_closed_held, BitClosedHeld)
DP_ENTRY(side_nozzle, SideBoth)
DP_ENTRY(side_nozzle_jet, SideJet)
DP_ENTRY(side_nozzle_held, SideBothHeld)
DP_ENTRY(side_nozzle_jet_held, SideJetHeld)
// the same by differentiating all rows by all unknowns: the tests compare with these
DP_JACOBIAN(bore_flow_dual, PipePlain, run_jacobian<PipePlain>)
DP_JACOBIAN(annulus_flow_dual, AnnulusPlain, run_jacobian<AnnulusPlain>)
DP_ENTRY(pump, Pump)
DP_ENTRY(annulus_top, AnnulusTop)
DP_ENTRY(choke, Choke)
DP_ENTRY(moving_choke, MovingChoke)
DP_ENTRY(reamed_ring, ReamedRing)

DP_EXPORT_RECORD(fluid, Fluid)
DP_EXPORT(flow_results, FlowResultsText)
DP_EXPORT(bit_flow_results, BitFlowResultsText)
DP_EXPORT(seal_results, SealResultsText)
DP_EXPORT(side_nozzle_results, SideNozzleResultsText)
DP_CONSTANT(gap_rounding, GAP_ROUNDING)
DP_CONSTANT(chi_rounding, CHI_ROUNDING)
DP_CONSTANT(flow_rounding, FLOW_ROUNDING)
DP_CONSTANT(jet_rounding, JET_ROUNDING)

// for tests: the friction of elements side by side, n values each (a multiple of four)
extern "C" void wall_shears_of_packs(const double* law, int n, const double* w, const double* d, double alpha, const double* density, double* stress, double* slope,
                                     double* by_density) {
    for (int i = 0; i < n; i += 4) {
        const auto four = [i](const double* v) { return Pack(V4{v[i], v[i + 1], v[i + 2], v[i + 3]}); };
        const WallShears s = wall_shears(law, four(w), four(d), alpha, four(density));
        for (int l = 0; l < 4; ++l) { stress[i + l] = s.stress.v[l]; slope[i + l] = s.slope.v[l]; by_density[i + l] = s.by_density.v[l]; }
    }
}

DP_CHANNEL_RESULTS(bore_flow, PipePlain)
DP_CHANNEL_RESULTS(bore_flow_junction, PipeJunction)
DP_CHANNEL_RESULTS(bore_flow_held, PipeHeld)
DP_CHANNEL_RESULTS(bore_flow_joint, BoreJoint)
DP_CHANNEL_RESULTS(annulus_flow, AnnulusPlain)
DP_CHANNEL_RESULTS(annulus_flow_junction, AnnulusJunction)
DP_CHANNEL_RESULTS(annulus_flow_held, AnnulusHeld)
DP_CHANNEL_RESULTS(annulus_flow_joint, AnnulusJoint)
DP_CHANNEL_RESULTS(annulus_flow_aside, AnnulusAside)
DP_CHANNEL_RESULTS(annulus_flow_aside_junction, AnnulusAsideJunction)
DP_CHANNEL_RESULTS(annulus_flow_aside_joint, AnnulusJoint)
DP_FLOW_RESULTS(bit_flow, BitNozzle, BitFlowResults)
DP_FLOW_RESULTS(bit_flow_jet, BitJet, BitFlowResults)
DP_FLOW_RESULTS(bit_flow_closed, BitClosed, BitFlowResults)
DP_FLOW_RESULTS(bit_flow_grow, BitNozzleGrow, BitFlowResults)
DP_FLOW_RESULTS(bit_flow_closed_grow, BitClosedGrow, BitFlowResults)
DP_FLOW_RESULTS(bit_flow_held, BitNozzleHeld, BitFlowResults)
DP_FLOW_RESULTS(bit_flow_jet_held, BitJetHeld, BitFlowResults)
DP_FLOW_RESULTS(bit_flow_closed_held, BitClosedHeld, BitFlowResults)
DP_FLOW_RESULTS(joint_seal, SealBoth, SealResults)
DP_FLOW_RESULTS(joint_seal_bore, SealBore, SealResults)
DP_FLOW_RESULTS(joint_seal_annulus, SealAnnulus, SealResults)
DP_FLOW_RESULTS(side_nozzle, SideBoth, SideNozzleResults)
DP_FLOW_RESULTS(side_nozzle_jet, SideJet, SideNozzleResults)
DP_FLOW_RESULTS(side_nozzle_held, SideBothHeld, SideNozzleResults)
DP_FLOW_RESULTS(side_nozzle_jet_held, SideJetHeld, SideNozzleResults)
