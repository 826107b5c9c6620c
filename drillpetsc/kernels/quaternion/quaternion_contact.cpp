// Contact along the quaternion element: that of the ANCF element on position, slope and spin rate of the two nodes.
#include "contact/contact.hpp"
#include "quaternion/quaternion_node.hpp"

namespace dp {

struct QuaternionContact {
    static constexpr int D = 16, NSPIN = 0, NP = BeamContact<false>::NP;
    static constexpr const char* ParameterText = BeamContact<false>::ParameterText;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    static OwnLaw* own_law(void* context) { return static_cast<ContactLaw*>(context)->own; }

    template <class T, class S>
    static void force(int e, const T* x, const T* y, const T*, const S* p, void* context, T* r) {
        evaluate<T>(e, x, y, p, *static_cast<ContactLaw*>(context), r, nullptr);
    }

    template <class T>
    static void evaluate(int e, const T* x, const T* y, const double* p, const ContactLaw& law, T* r, ContactResults* results) {
        const Node<T> nodes[2] = {Node<T>(x, y, y), Node<T>(x + 8, y + 8, y + 8)};
        T X[14], Y[14], R[14];
        for (int k = 0; k < 2; ++k) {
            const Node<T>& n = nodes[k];
            for (int i = 0; i < 3; ++i) { X[7 * k + i] = x[8 * k + i]; Y[7 * k + i] = y[8 * k + i]; }
            X[7 * k + 3] = n.v.x; X[7 * k + 4] = n.v.y; X[7 * k + 5] = n.v.z; X[7 * k + 6] = T(0.0);
            Y[7 * k + 3] = n.w.x; Y[7 * k + 4] = n.w.y; Y[7 * k + 5] = n.w.z; Y[7 * k + 6] = n.spin / (n.length * n.length);
        }
        BeamContact<false>::evaluate<T>(e, X, Y, p, law, R, results);
        const Quat<T> none = {T(0.0), T(0.0), T(0.0), T(0.0)};
        for (int k = 0; k < 2; ++k)
            nodes[k].rows(vec(R + 7 * k), vec(R + 7 * k + 3), nodes[k].t * R[7 * k + 6], none, r + 8 * k);
    }
};

}  // namespace dp

DP_ENTRY(quaternion_contact, dp::QuaternionContact)

extern "C" void quaternion_contact_results(int n, int, const int* idx, const double* par, void* context, const double* x, const double* y, double* out) {
    dp::entries_by_law<dp::QuaternionContact>(context, false, out, [&](double* to) {
        for (int e = 0; e < n; ++e) {
            double X[16], Y[16], R[16];
            for (int i = 0; i < 16; ++i) { X[i] = x[idx[16 * e + i]]; Y[i] = y[idx[16 * e + i]]; }
            dp::ContactResults& now = reinterpret_cast<dp::ContactResults*>(to)[e];
            now = {};
            dp::QuaternionContact::evaluate<double>(e, X, Y, par + e * dp::QuaternionContact::NP, *static_cast<dp::ContactLaw*>(context), R, &now);
        }
    });
}
