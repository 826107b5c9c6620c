// Kernels that live on one node: rigid body or unbalance, load, rotary drive.  Unknowns r, v, phi.
#include "core/element.hpp"
#include "core/frame.hpp"
#include "quaternion/on_quaternion.hpp"

namespace dp {

struct VertexKernel {
    static constexpr int D = 7, NSPIN = 1;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{6, 3}};
};

// Rigid body carried by the node's frame.
struct Body : VertexKernel {
    enum { MASS, CENTER, OFFSET2, OFFSET3, AXIAL, TRANSVERSE, GRAVITY, GAUGE = GRAVITY + 3, SECOND = GAUGE + 3, NP = SECOND + 3 };

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void*, T* r) {
        const Vec<T> v = vec(x + 3), acceleration = vec(a);
        const T spin = y[6], spin_rate = a[6];
        const Tangent<T> t(v, vec(y + 3), vec(a + 3));
        const Vec<double> g = vec(p + GRAVITY);
        Vec<T> offset = t.t * p[CENTER];
        if (p[OFFSET2] != 0 || p[OFFSET3] != 0) {
            Vec<T> d2, d3;
            directors(vec(p + GAUGE), vec(p + SECOND), t.t, x[6], d2, d3);
            offset += d2 * p[OFFSET2] + d3 * p[OFFSET3];
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
    enum { FORCE, MOMENT = FORCE + 3, SLOPE = MOMENT + 3, SECTION = SLOPE + 3, GAUGE, SECOND = GAUGE + 3, FACTOR = SECOND + 3, NP };

    template <class T, class S>
    static void force(int, const T* x, const T*, const T*, const S* p, void*, T* r) {
        const Vec<T> v = vec(x + 3);
        const T n = norm(v);
        const Vec<T> t = v / n;
        const double k = p[FACTOR];
        Vec<T> F = {T(k * p[FORCE]), T(k * p[FORCE + 1]), T(k * p[FORCE + 2])}, M = {T(k * p[MOMENT]), T(k * p[MOMENT + 1]), T(k * p[MOMENT + 2])};
        if (p[SECTION] != 0) {
            Vec<T> d2, d3;
            directors(vec(p + GAUGE), vec(p + SECOND), t, x[6], d2, d3);
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
    enum { STIFFNESS, DAMPING, INERTIA, ANGLE, SPEED, NP };

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void*, T* r) {
        for (int i = 0; i < 6; ++i) r[i] = T(0.0);
        r[6] = a[6] * p[INERTIA] + (x[6] - p[ANGLE]) * p[STIFFNESS] + (y[6] - p[SPEED]) * p[DAMPING];
    }
};

}  // namespace dp

DP_ENTRY(body, dp::Body)
DP_ENTRY(load, dp::Load)
DP_ENTRY(drive, dp::Drive)
DP_ON_QUATERNION(body, dp::Body, 1)

// kinetic and potential energy of n bodies: out (n, 2) [J]
extern "C" void body_energy(int n, const int* idx, const double* par, const double* x, const double* y, double* out) {
    using namespace dp;
    for (int e = 0; e < n; ++e) {
        const double* p = par + e * Body::NP;
        double X[7], Y[7];
        for (int i = 0; i < 7; ++i) { X[i] = x[idx[7 * e + i]]; Y[i] = y[idx[7 * e + i]]; }
        const Vec<double> v = vec(X + 3), zero = {0, 0, 0};
        const Tangent<double> t(v, vec(Y + 3), zero);
        Vec<double> d2, d3;
        directors(vec(p + Body::GAUGE), vec(p + Body::SECOND), t.t, X[6], d2, d3);
        const Vec<double> offset = t.t * p[Body::CENTER] + d2 * p[Body::OFFSET2] + d3 * p[Body::OFFSET3];
        const Vec<double> turning = cross(t.t, t.t1) + t.t * Y[6], speed = vec(Y) + cross(turning, offset);
        out[2 * e] = 0.5 * (p[Body::MASS] * dot(speed, speed) + p[Body::TRANSVERSE] * dot(t.t1, t.t1) + p[Body::AXIAL] * Y[6] * Y[6]);
        out[2 * e + 1] = -p[Body::MASS] * dot(vec(p + Body::GRAVITY), vec(X) + offset);
    }
}
