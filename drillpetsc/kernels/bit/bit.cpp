#include "bit/bit.hpp"
#include "quaternion/on_quaternion.hpp"

using namespace dp;
typedef Bit<0> PlainBit;
typedef Bit<12> ProfileBit;
DP_ENTRY(bit_rock, PlainBit)
DP_ENTRY(bit_rock_profile, ProfileBit)
DP_ON_QUATERNION(bit_rock, PlainBit, 1)
DP_ON_QUATERNION(bit_rock_profile, ProfileBit, 1)

namespace {
template <class Kernel>
void report(const int* idx, const double* par, void* context, const double* x, const double* y, double* out) {
    constexpr int D = Kernel::D;
    double X[D], Y[D], R[D];
    for (int i = 0; i < D; ++i) { X[i] = x[idx[i]]; Y[i] = y[idx[i]]; }
    BitReport now{};
    Kernel::template evaluate<double>(X, Y, par, *static_cast<BitLaw*>(context), R, &now);
    const double row[11] = {now.weight, now.torque, now.rate, now.side, now.stored, now.dissipated, now.depth, now.offset,
                            now.velocity.x, now.velocity.y, now.velocity.z};
    for (int i = 0; i < 11; ++i) out[i] = row[i];
}
}  // namespace

// out (11): weight on bit [N], torque on bit [N m], rate of penetration [m/s], side force [N], stored energy [J], power into rock and heat [W],
// depth of the ellipsoid below the end [m], offset of its centre from the hole's axis [m],
// rate of penetration in space (3) [m/s]
extern "C" void bit_rock_report(int profile, const int* idx, const double* par, void* context, const double* x, const double* y, double* out) {
    if (profile) report<ProfileBit>(idx, par, context, x, y, out);
    else report<PlainBit>(idx, par, context, x, y, out);
}

// rate of penetration out (3) [m/s] under the force F (3) of a bit with axis e (3) that turns with omega, `drilled` metres into the formation
extern "C" void rock_rate(void* context, const double* F, const double* e, double omega, double drilled, double* out) {
    const Vec<double> v = rock_rate<double>(*static_cast<const BitLaw*>(context), drilled, vec(F), vec(e), omega, nullptr);
    out[0] = v.x; out[1] = v.y; out[2] = v.z;
}
