// The other components on the unknowns of the quaternion element: rigid bodies, eccentricity, contact, bit, fluid.
#include "beam/eccentric.hpp"
#include "beam/rigid_body.hpp"
#include "bit/bit.hpp"
#include "contact/contact.hpp"
#include "fluid/annulus_flow.hpp"
#include "fluid/bit_flow.hpp"
#include "fluid/bore_flow.hpp"
#include "quaternion/on_quaternion.hpp"

typedef dp::BoreFlow<false, false> QuaternionPipe;
typedef dp::AnnulusFlow<false, false> QuaternionAnnulus;
typedef dp::BitFlow<true, true, false> QuaternionNozzle;
typedef dp::BitFlow<true, false, false> QuaternionJet;
typedef dp::BitFlow<false, true, false> QuaternionClosed;
typedef dp::BitFlow<true, true, false, true> QuaternionNozzleGrow;
typedef dp::BitFlow<false, true, false, true> QuaternionClosedGrow;
typedef dp::Eccentric<false> QuaternionEccentric;
typedef dp::Bit<0> QuaternionBit;
typedef dp::Bit<dp::CHIPS> QuaternionProfileBit;

DP_EXPORT_RECORD(start_frames, dp::StartFrames)
DP_ON_QUATERNION(body, dp::Body, 1)
DP_ON_QUATERNION(eccentric, QuaternionEccentric, 2)
DP_ON_QUATERNION(body_contact, dp::BodyContact, 1)
DP_ON_QUATERNION(bit_contact, dp::BitContact, 1)
DP_ON_QUATERNION(bit_rock, QuaternionBit, 1)
DP_ON_QUATERNION(bit_rock_profile, QuaternionProfileBit, 1)
DP_ON_QUATERNION(bore_flow, QuaternionPipe, 2)
DP_ON_QUATERNION(annulus_flow, QuaternionAnnulus, 2)
DP_ON_QUATERNION(annulus_top, dp::AnnulusTop, 1)
DP_ON_QUATERNION(bit_flow, QuaternionNozzle, 1)
DP_ON_QUATERNION(bit_flow_jet, QuaternionJet, 1)
DP_ON_QUATERNION(bit_flow_closed, QuaternionClosed, 1)
DP_ON_QUATERNION(bit_flow_grow, QuaternionNozzleGrow, 1)
DP_ON_QUATERNION(bit_flow_closed_grow, QuaternionClosedGrow, 1)
