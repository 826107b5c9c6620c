#include "contact/contact_jacobian.hpp"
#include "quaternion/on_quaternion.hpp"

using namespace dp;
typedef BeamContact<false> ContactPlain;
typedef BeamContact<true> ContactSplit;
DP_RESIDUAL(contact, ContactPlain)
DP_JACOBIAN(contact, run_contact_jacobian)
DP_RESIDUAL(contact_split, ContactSplit)
DP_JACOBIAN(contact_split, run_contact_split_jacobian)
DP_ENTRY(body_contact, BodyContact)
DP_ENTRY(bit_contact, BitContact)
DP_ON_QUATERNION(body_contact, BodyContact, 1)
DP_ON_QUATERNION(bit_contact, BitContact, 1)
// by differentiating all rows by all unknowns: the oracles of the tests
DP_JACOBIAN(contact_dual, run_jacobian<ContactPlain>)
DP_JACOBIAN(contact_split_dual, run_jacobian<ContactSplit>)

namespace {
template <class Kernel>
void report(int n, const int* idx, const double* par, void* context, const double* x, const double* y, double* out) {
    constexpr int D = Kernel::D;
    for (int e = 0; e < n; ++e) {
        double X[D], Y[D], R[D];
        for (int i = 0; i < D; ++i) { X[i] = x[idx[e * D + i]]; Y[i] = y[idx[e * D + i]]; }
        for (int i = 0; i < 7; ++i) out[7 * e + i] = 0;
        Kernel::template evaluate<double>(e, X, Y, par + e * Kernel::NP, *static_cast<ContactLaw*>(context), R, out + 7 * e);
    }
}
}  // namespace

// out (n, 7): normal force [N], stored energy [J], damping and friction power [W], penetration [m], axial force [N], torque [N m]
extern "C" void contact_report(int n, int kind, const int* idx, const double* par, void* context, const double* x, const double* y, double* out) {
    if (kind == 0) report<ContactPlain>(n, idx, par, context, x, y, out);
    else if (kind == 1) report<ContactSplit>(n, idx, par, context, x, y, out);
    else report<BodyContact>(n, idx, par, context, x, y, out);
}

// out: weight on bit [N], torque on bit [N m]
extern "C" void bit_report(const int* idx, const double* par, const double* x, const double* y, double* out) {
    double X[7], Y[7], R[7];
    for (int i = 0; i < 7; ++i) { X[i] = x[idx[i]]; Y[i] = y[idx[i]]; }
    BitContact::evaluate<double>(X, Y, par, R, out[0], out[1]);
}
