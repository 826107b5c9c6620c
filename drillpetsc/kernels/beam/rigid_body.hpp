// Kernels that live on one node: rigid body or unbalance, load, rotary drive.  Unknowns r, v, phi.
#pragma once
#include "core/element.hpp"
#include "core/frame.hpp"

namespace dp {

struct VertexKernel {
    static constexpr int D = 7, NSPIN = 1;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{6, 3}};
};

// Rigid body carried by the node's frame.
struct Body : VertexKernel {
    DP_ENUM(Parameter,
        MASS,               // [kg]
        CENTER, OFFSET,     // mass centre: along the tangent, and 2: along the two directors [m]
        AXIAL = OFFSET + 2, TRANSVERSE,  // moments of inertia [kg m2]
        GRAVITY,            // 3: [m/s2]
        REFERENCE = GRAVITY + 3, SECOND = REFERENCE + 3,  // 3 each: the node's frame
        NP = SECOND + 3)

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void*, T* r) {
        const Vec<T> v = vec(x + 3), acceleration = vec(a);
        const T spin = y[6], spin_rate = a[6];
        const Tangent<T> t(v, vec(y + 3), vec(a + 3));
        const Vec<double> g = vec(p + GRAVITY);
        Vec<T> offset = t.t * p[CENTER];
        if (p[OFFSET] != 0 || p[OFFSET + 1] != 0) {
            Vec<T> d2, d3;
            directors(vec(p + REFERENCE), vec(p + SECOND), t.t, x[6], d2, d3);
            offset += d2 * p[OFFSET] + d3 * p[OFFSET + 1];
        }
        const Vec<T> turning = cross(t.t, t.t1) + t.t * spin;
        const Vec<T> turning_rate = cross(t.t, t.t2) + t.t * spin_rate + t.t1 * spin;
        const Vec<T> push = (acceleration - g + cross(turning_rate, offset) + cross(turning, cross(turning, offset))) * p[MASS];
        const Vec<T> moment = turning_rate * p[TRANSVERSE] + (t.t * spin_rate + t.t1 * spin) * (p[AXIAL] - p[TRANSVERSE]) + cross(offset, push);
        const Vec<T> bend = cross(moment, t.t) / t.n;
        r[0] = push.x; r[1] = push.y; r[2] = push.z; r[3] = bend.x; r[4] = bend.y; r[5] = bend.z;
        r[6] = dot(moment, t.t);
    }
};

// Force and moment at the node, in global axes or (SECTION = 1) in (tangent, director 2, director 3); SLOPE: dead force on the slope.
struct Load : VertexKernel {
    DP_ENUM(Parameter,
        FORCE, MOMENT = FORCE + 3, SLOPE = MOMENT + 3,    // 3 each: [N], [N m], [N m]
        SECTION = SLOPE + 3,                              // 1: along the section's axes
        REFERENCE, SECOND = REFERENCE + 3,                // 3 each: the node's frame
        FACTOR = SECOND + 3,                              // of all components, over time
        NP)

    template <class T, class S>
    static void force(int, const T* x, const T*, const T*, const S* p, void*, T* r) {
        const Vec<T> v = vec(x + 3);
        const T n = norm(v);
        const Vec<T> t = v / n;
        const double k = p[FACTOR];
        Vec<T> F = {T(k * p[FORCE]), T(k * p[FORCE + 1]), T(k * p[FORCE + 2])}, M = {T(k * p[MOMENT]), T(k * p[MOMENT + 1]), T(k * p[MOMENT + 2])};
        if (p[SECTION] != 0) {
            Vec<T> d2, d3;
            directors(vec(p + REFERENCE), vec(p + SECOND), t, x[6], d2, d3);
            F = t * F.x + d2 * F.y + d3 * F.z;
            M = t * M.x + d2 * M.y + d3 * M.z;
        }
        const Vec<T> bend = cross(M, t) / n;
        r[0] = -F.x; r[1] = -F.y; r[2] = -F.z;
        r[3] = -bend.x - k * p[SLOPE]; r[4] = -bend.y - k * p[SLOPE + 1]; r[5] = -bend.z - k * p[SLOPE + 2];
        r[6] = -dot(M, t);
    }
};

// Rotary drive: spring and damper to a prescribed rotation, with the inertia of its rotor.
struct Drive : VertexKernel {
    DP_ENUM(Parameter, STIFFNESS, DAMPING, INERTIA, ANGLE, SPEED, NP)  // [N m/rad], [N m s/rad], [kg m2], [rad], [rad/s]

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void*, T* r) {
        for (int i = 0; i < 6; ++i) r[i] = T(0.0);
        r[6] = a[6] * p[INERTIA] + (x[6] - p[ANGLE]) * p[STIFFNESS] + (y[6] - p[SPEED]) * p[DAMPING];
    }
};

}  // namespace dp
