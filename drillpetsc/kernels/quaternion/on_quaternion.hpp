// A kernel of the ANCF element on the unknowns of the quaternion element: r, eps, q in the place of r, v, phi at each of its nodes.
//
// The kernel receives position, slope and spin angle with their rates, and its rows are those of virtual displacements, slopes and turns
// about the tangent, which Node carries back.  The spin angle is that from the frame at the start (the directors of an unbalance need it).
#pragma once
#include "quaternion/quaternion_node.hpp"

namespace dp {

DP_RECORD(StartFrames,
    void* inner;           // context of the kernel itself
    const double* frames;  // (elements, nodes, 4) Euler parameters of the frames at the start
    double spin;           // [rad/s] of sections that turn in place, besides the rates of q (a string without inertia)
)

// angle about the tangent beyond the smallest rotation of the frame f: f* q = (smallest rotation)(rotation about e1)
template <class T>
inline T spin_angle(const Quat<double>& f, const Quat<T>& q) {
    const Quat<double> e = times_e1(f);
    const T top = q.w * e.w + q.x * e.x + q.y * e.y + q.z * e.z, low = q.w * f.w + q.x * f.x + q.y * f.y + q.z * f.z;
    return 2.0 * atan2(top, low);
}

template <class K, int NODES>
struct OnQuaternion {
    static constexpr int D = K::D + NODES, NSPIN = 0, NP = K::NP, REST = K::D - 7 * NODES;
    static constexpr const char* ParameterText = K::ParameterText;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    static OwnLaw* own_law(void* context) { return OwnLawOf<K>::at(static_cast<StartFrames*>(context)->inner); }

    template <class T, class S>
    static void force(int e, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        const StartFrames& at = *static_cast<StartFrames*>(context);
        T X[K::D], Y[K::D], A[K::D], R[K::D];
        for (int k = 0; k < NODES; ++k) {
            const Node<T> n(x + 8 * k, y + 8 * k, a + 8 * k);
            const T square = 1.0 / (n.length * n.length);
            for (int i = 0; i < 3; ++i) { X[7 * k + i] = x[8 * k + i]; Y[7 * k + i] = y[8 * k + i]; A[7 * k + i] = a[8 * k + i]; }
            const Vec<T>* from[3] = {&n.v, &n.w, &n.z};
            T* to[3] = {X, Y, A};
            for (int i = 0; i < 3; ++i) { to[i][7 * k + 3] = from[i]->x; to[i][7 * k + 4] = from[i]->y; to[i][7 * k + 5] = from[i]->z; }
            X[7 * k + 6] = spin_angle(quat(at.frames + 4 * (NODES * e + k)), n.q);
            Y[7 * k + 6] = n.spin * square + at.spin; A[7 * k + 6] = n.spin_rate * square;
        }
        for (int i = 0; i < REST; ++i) { X[7 * NODES + i] = x[8 * NODES + i]; Y[7 * NODES + i] = y[8 * NODES + i]; A[7 * NODES + i] = a[8 * NODES + i]; }
        K::template force<T, S>(e, X, Y, A, p, at.inner, R);
        const Quat<T> none = {T(0.0), T(0.0), T(0.0), T(0.0)};
        for (int k = 0; k < NODES; ++k) {
            const Node<T> n(x + 8 * k, y + 8 * k, a + 8 * k);
            n.rows(vec(R + 7 * k), vec(R + 7 * k + 3), n.t * R[7 * k + 6], none, r + 8 * k);
        }
        for (int i = 0; i < REST; ++i) r[8 * NODES + i] = R[7 * NODES + i];
    }
};

}  // namespace dp

#define DP_ON_QUATERNION(name, Kernel, NODES)             \
    typedef dp::OnQuaternion<Kernel, NODES> on_##name;    \
    DP_ENTRY(quaternion_##name, on_##name)
