#include "contact/contact_jacobian.hpp"
#include "core/formulations.hpp"

using namespace dp;
typedef BeamContact<false> ContactPlain;
typedef BeamContact<true> ContactJunction;
DP_RESIDUAL_BY(contact, ContactPlain, run_contact_residual)
DP_JACOBIAN(contact, ContactPlain, run_contact_jacobian)
DP_RESIDUAL(contact_junction, ContactJunction)
DP_JACOBIAN(contact_junction, ContactJunction, run_contact_junction_jacobian)
DP_ENTRY(body_contact, BodyContact)
DP_ENTRY(bit_contact, BitContact)
DP_OTHER_FORMULATIONS(contact_junction, ContactJunction, 2)
DP_OTHER_FORMULATIONS(body_contact, BodyContact, 1)
DP_OTHER_FORMULATIONS(bit_contact, BitContact, 1)
// the same by differentiating all rows by all unknowns: the tests compare with these
DP_JACOBIAN(contact_dual, ContactPlain, run_jacobian<ContactPlain>)
DP_JACOBIAN(contact_junction_dual, ContactJunction, run_jacobian<ContactJunction>)

DP_EXPORT_RECORD(contact_law, ContactLaw)
DP_EXPORT(contact_results, ContactResultsText)
DP_EXPORT(bit_contact_results, BitContactResultsText)
DP_EXPORT(own_friction_state, OwnFriction::StateText)
DP_EXPORT(own_friction_result, OwnFriction::ResultText)
DP_CONSTANT(contact_onset, RAMP)
DP_CONSTANT(statics_slip, STATICS_SLIP)
DP_CONSTANT(not_imposed, NOT_IMPOSED)

namespace {
template <class Kernel>
void evaluate(int n, const int* idx, const double* par, void* context, const double* x, const double* y, ContactResults* out) {
    constexpr int D = Kernel::D;
    const ContactLaw& law = *static_cast<ContactLaw*>(context);
    for (int e = 0; e < n; ++e) out[e] = {};
    if (std::is_same_v<Kernel, ContactPlain> && !law.own) {
        return for_near_wall(law, n, idx, par, x, y, [&](const Lanes& lanes, const Pack* X, const Pack* Y, const Pack* P) {
            Pack R[14];
            ContactPlain::evaluate(lanes, X, Y, P, law, R, out + lanes.first);
        }, [](int, int) {});
    }
    for (int e = 0; e < n; ++e) {
        double X[D], Y[D], R[D];
        for (int i = 0; i < D; ++i) { X[i] = x[idx[e * D + i]]; Y[i] = y[idx[e * D + i]]; }
        Kernel::evaluate(e, X, Y, par + e * Kernel::NP, law, R, out + e);
    }
}
}  // namespace

#define DP_CONTACT_RESULTS(name, Kernel)                                                                                                       \
    extern "C" void name##_results(int n, int, const int* idx, const double* par, void* context, const double* x, const double* y, double* out) { \
        dp::entries_by_law<Kernel>(context, false, out, [&](double* to) { evaluate<Kernel>(n, idx, par, context, x, y, reinterpret_cast<ContactResults*>(to)); }); \
    }
DP_CONTACT_RESULTS(contact, ContactPlain)
DP_CONTACT_RESULTS(contact_junction, ContactJunction)
DP_CONTACT_RESULTS(body_contact, BodyContact)

// Largest size of the spin, in each part of the string, beside its contacts with a normal force: n contacts with the places (n) of their
// forces, places (n, 2) in the rates y of the spins beside them, and their parts (n).  fastest (parts): zero where none touches.
extern "C" void fastest_on_wall(int n, const double* const* force, const int* spins, const double* y, const int* part, int parts, double* fastest) {
    for (int k = 0; k < parts; ++k) fastest[k] = 0.0;
    for (int i = 0; i < n; ++i) {
        if (!(*force[i] > 0.0)) continue;
        const double size = std::fmax(std::fabs(y[spins[2 * i]]), std::fabs(y[spins[2 * i + 1]]));
        if (size > fastest[part[i]]) fastest[part[i]] = size;
    }
}

// out: a BitContactResults for each
extern "C" void bit_contact_results(int n, int, const int* idx, const double* par, const void*, const double* x, const double* y, double* out) {
    for (int e = 0; e < n; ++e) {
        double X[7], Y[7], R[7];
        for (int i = 0; i < 7; ++i) { X[i] = x[idx[7 * e + i]]; Y[i] = y[idx[7 * e + i]]; }
        BitContactResults& now = reinterpret_cast<BitContactResults*>(out)[e];
        now = {};
        BitContact::evaluate<double>(X, Y, par + e * BitContact::NP, R, &now);
    }
}
