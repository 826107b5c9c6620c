// The fluid of the displacement formulation in and about the quaternion string, and at its bit.
#include "fluid/hermite/hermite_annulus.hpp"
#include "fluid/hermite/hermite_bit.hpp"
#include "fluid/hermite/hermite_bore.hpp"
#include "quaternion/on_quaternion.hpp"

typedef dp::HermiteBore<false, false> QuaternionPipe;
typedef dp::HermiteBore<true, false> QuaternionPipeJunction;
typedef dp::HermiteAnnulus<false, false> QuaternionAnnulus;
typedef dp::HermiteAnnulus<true, false> QuaternionAnnulusJunction;
typedef dp::HermiteBit<true, true, false> QuaternionNozzle;
typedef dp::HermiteBit<true, false, false> QuaternionJet;
typedef dp::HermiteBit<false, true, false> QuaternionClosed;
DP_ON_QUATERNION(hermite_bore, QuaternionPipe, 2)
DP_ON_QUATERNION(hermite_bore_junction, QuaternionPipeJunction, 2)
DP_ON_QUATERNION(hermite_annulus, QuaternionAnnulus, 2)
DP_ON_QUATERNION(hermite_annulus_junction, QuaternionAnnulusJunction, 2)
DP_ON_QUATERNION(hermite_bit, QuaternionNozzle, 1)
DP_ON_QUATERNION(hermite_bit_jet, QuaternionJet, 1)
DP_ON_QUATERNION(hermite_bit_closed, QuaternionClosed, 1)
