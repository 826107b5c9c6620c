// Kernels on one node of the quaternion element: unit length of its parameters, prescribed motion, loads.
#include "quaternion/quaternion_node.hpp"

namespace dp {

// |q| = 1 with its multiplier; LEVEL 3: on positions (index 3), 2: on velocities (index 2).  Unknowns q, multiplier.
struct UnitLength {
    static constexpr int D = 5, NSPIN = 0;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter, LEVEL, SCALE, NP)  // factor of the constraint's row

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T*, const S* p, void*, T* r) {
        const Quat<T> q = quat(x), row = q * (2.0 * x[4]);
        r[0] = row.w; r[1] = row.x; r[2] = row.y; r[3] = row.z;
        r[4] = (p[LEVEL] == 3 ? dot(q, q) - 1.0 : 2.0 * dot(q, quat(y))) * p[SCALE];
    }
};

// Motion given along PLACES unit vectors and of TURNS axes (1: spin about the tangent; 3: the whole section).
// Unknowns r, q, multipliers: the force on the string along each vector [N], and its torque about each axis [N m].
// The orientation g(t) is met where (g* q)_k = 0, k = 1..TURNS, taken twice so that the multiplier is a moment.
template <int PLACES, int TURNS>
struct Guided {
    static constexpr int D = 7 + PLACES + TURNS, NSPIN = 0;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter,
        LEVEL, SCALE,                  // as of UnitLength
        AXES,                          // 9, rows: the unit vectors
        VALUE = AXES + 9, RATE = VALUE + 3,  // 3 each: place along them and its rate [m], [m/s]
        GOAL = RATE + 3, GOAL_RATE = GOAL + 4,  // 4 each: orientation and its rate
        NP = GOAL_RATE + 4)

    static Quat<double> axis(const Quat<double>& g, int k) { return k == 0 ? times_e1(g) : k == 1 ? times_e2(g) : times_e3(g); }
    template <class T> static T along(const Quat<double>& a, const T* q) { return q[0] * a.w + q[1] * a.x + q[2] * a.y + q[3] * a.z; }

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T*, const S* p, void*, T* r) {
        const bool positions = p[LEVEL] == 3;
        for (int i = 0; i < 7; ++i) r[i] = T(0.0);
        for (int k = 0; k < PLACES; ++k) {
            const Vec<double> e = vec(p + AXES + 3 * k);
            const T& push = x[7 + k];
            r[0] -= push * e.x; r[1] -= push * e.y; r[2] -= push * e.z;
            r[7 + k] = (positions ? dot(vec(x), e) - p[VALUE + k] : dot(vec(y), e) - p[RATE + k]) * p[SCALE];
        }
        const Quat<double> goal = quat(p + GOAL), goal_rate = quat(p + GOAL_RATE);
        for (int k = 0; k < TURNS; ++k) {
            const Quat<double> e = axis(goal, k), e1 = axis(goal_rate, k);
            const T moment = x[7 + PLACES + k] * 2.0;
            r[3] -= moment * e.w; r[4] -= moment * e.x; r[5] -= moment * e.y; r[6] -= moment * e.z;
            r[7 + PLACES + k] = (positions ? along(e, x + 3) : along(e, y + 3) + along(e1, x + 3)) * (2.0 * p[SCALE]);
        }
    }
};

// Force and moment on the node, in space or (SECTION = 1) in the section's axes; SLOPE: dead force on the slope.  Unknowns r, eps, q.
struct QuaternionLoad {
    static constexpr int D = 8, NSPIN = 0;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    DP_ENUM(Parameter, FORCE, MOMENT = FORCE + 3, SLOPE = MOMENT + 3, SECTION = SLOPE + 3, FACTOR, NP)  // as of Load in beam/rigid_body.hpp

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void*, T* r) {
        const Node<T> n(x, y, a);
        const double k = -p[FACTOR];
        Vec<T> F = {T(k * p[FORCE]), T(k * p[FORCE + 1]), T(k * p[FORCE + 2])}, M = {T(k * p[MOMENT]), T(k * p[MOMENT + 1]), T(k * p[MOMENT + 2])};
        const Vec<T> G = {T(k * p[SLOPE]), T(k * p[SLOPE + 1]), T(k * p[SLOPE + 2])};
        if (p[SECTION] != 0) {
            const Vec<T> d2 = vector_of(times_e2(n.unit), n.unit), d3 = vector_of(times_e3(n.unit), n.unit);
            F = n.t * F.x + d2 * F.y + d3 * F.z;
            M = n.t * M.x + d2 * M.y + d3 * M.z;
        }
        n.rows(F, G, M, Quat<T>{T(0.0), T(0.0), T(0.0), T(0.0)}, r);
    }
};

}  // namespace dp

typedef dp::Guided<3, 0> Guided30;
typedef dp::Guided<3, 1> Guided31;
typedef dp::Guided<3, 3> Guided33;
typedef dp::Guided<2, 3> Guided23;
DP_ENTRY(unit_length, dp::UnitLength)
DP_ENTRY(guided_30, Guided30)
DP_ENTRY(guided_31, Guided31)
DP_ENTRY(guided_33, Guided33)
DP_ENTRY(guided_23, Guided23)
DP_ENTRY(quaternion_load, dp::QuaternionLoad)
