// The fluid in and about the quaternion string, and at its bit.
#include "fluid/annulus_flow.hpp"
#include "fluid/bit_flow.hpp"
#include "fluid/side_nozzle.hpp"
#include "quaternion/on_quaternion.hpp"
#include "fluid/bore_flow.hpp"

typedef dp::BoreFlow<false, false> QuaternionPipe;
typedef dp::BoreFlow<true, false> QuaternionPipeJunction;
typedef dp::AnnulusFlow<false, false> QuaternionAnnulus;
typedef dp::AnnulusFlow<true, false> QuaternionAnnulusJunction;
typedef dp::BitFlow<true, true, false> QuaternionNozzle;
typedef dp::BitFlow<true, false, false> QuaternionJet;
typedef dp::BitFlow<false, true, false> QuaternionClosed;
typedef dp::BitFlow<true, true, false, true> QuaternionNozzleGrow;
typedef dp::BitFlow<false, true, false, true> QuaternionClosedGrow;
typedef dp::SideNozzle<true, false> QuaternionSide;
typedef dp::SideNozzle<false, false> QuaternionSideJet;
DP_ON_QUATERNION(bore_flow, QuaternionPipe, 2)
DP_ON_QUATERNION(bore_flow_junction, QuaternionPipeJunction, 2)
DP_ON_QUATERNION(annulus_flow, QuaternionAnnulus, 2)
DP_ON_QUATERNION(annulus_flow_junction, QuaternionAnnulusJunction, 2)
DP_ON_QUATERNION(annulus_top, dp::AnnulusTop, 1)
DP_ON_QUATERNION(bit_flow, QuaternionNozzle, 1)
DP_ON_QUATERNION(bit_flow_jet, QuaternionJet, 1)
DP_ON_QUATERNION(bit_flow_closed, QuaternionClosed, 1)
DP_ON_QUATERNION(bit_flow_grow, QuaternionNozzleGrow, 1)
DP_ON_QUATERNION(bit_flow_closed_grow, QuaternionClosedGrow, 1)
DP_ON_QUATERNION(side_nozzle, QuaternionSide, 1)
DP_ON_QUATERNION(side_nozzle_jet, QuaternionSideJet, 1)

DP_EXPORT_RECORD(start_frames, dp::StartFrames)
