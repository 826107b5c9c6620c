// Joints between two parts of the string: constraints with multipliers.
//
// A joint couples the frame at the end of a rigid arm below one node ("above") with the next node's frame ("below").  A constraint is
// either c = A.B with A fixed in the frame above, B in the one below, or c = E.D with E above and D the way from the arm's end to the
// node below.  With virtual rotations psi, dc = (psi_above - psi_below).(A x B), and dc = E.(dr_below - dr_arm) + psi_above.(E x D).
// Multipliers are in units of SCALE newton (newton metre), constraint rows are multiplied by SCALE: the matrix stays symmetric in statics and
// its pivots are of one size.  A direction that the joint leaves free has the row -SCALE lambda = 0, so each joint adds exactly six
// negative eigenvalues to the tangent whatever its kind.
#pragma once
#include "core/element.hpp"
#include "core/frame.hpp"

namespace dp {

struct JointKind { DP_ENUM(Kind, FIXED, REVOLUTE, UNIVERSAL, SLIDER, TORSION_SLIDER, KINDS) };
struct JointParameters {
    DP_ENUM(Parameter,
        KIND, RIGID,                              // JointKind; length of the rigid item between the node above and the joint [m]
        REFERENCE1, SECOND1 = REFERENCE1 + 3, REFERENCE2 = SECOND1 + 3, SECOND2 = REFERENCE2 + 3,  // 3 each: frames of both nodes
        AXES = SECOND2 + 3,                       // 9, rows: the joint's axes in (tangent, director 2, director 3)
        SPRING = AXES + 9, DAMPER,                // along a slider [N/m], [N s/m]
        PRELOAD,                                  // force of a slider's spring at zero travel, positive where it pushes the parts apart [N]
        STOP_IN, STOP_OUT, STOP_STIFFNESS, STOP_ROUNDING,  // ends of a slider's travel [m], [N/m], [m]
        TORSION,                                  // stiffness of a TORSION_SLIDER, whose parts turn about its axis [N m/rad]
        SCALE,                                    // [N], [N m]
        NP)
};
constexpr double SOFT = 1e-12;  // share of SCALE by which a correction of velocity gives way: makes statics, where it has no row, regular

// Frame of a node with its angular velocity.
template <class T>
struct Section {
    Vec<T> t, d2, d3, turning;
    T n;
    Section(const T* x, const T* y, const Vec<double>& reference, const Vec<double>& second) {
        const Vec<T> v = vec(x + 3), w = vec(y + 3);
        n = norm(v);
        t = v / n;
        directors(reference, second, t, x[6], d2, d3);
        turning = cross(t, w) / n + t * y[6];
    }
    Vec<T> axis(const double* c) const { return t * c[0] + d2 * c[1] + d3 * c[2]; }
};

template <class T>
struct JointState : JointParameters {
    Section<T> above, below;
    Vec<T> E[3], G[3];    // the joint's axes in either frame
    Vec<T> way, way_rate; // from the arm's end to the node below, and its rate
    template <class S>
    JointState(const T* x, const T* y, const S* p)
        : above(x, y, vec(p + REFERENCE1), vec(p + SECOND1)), below(x + 7, y + 7, vec(p + REFERENCE2), vec(p + SECOND2)) {
        for (int i = 0; i < 3; ++i) { E[i] = above.axis(p + AXES + 3 * i); G[i] = below.axis(p + AXES + 3 * i); }
        way = vec(x + 7) - vec(x) - above.t * p[RIGID];
        way_rate = vec(y + 7) - vec(y) - cross(above.turning, above.t) * p[RIGID];
    }
};

inline bool slides(int kind) { return kind == JointKind::SLIDER || kind == JointKind::TORSION_SLIDER; }

// Of the six constraints: which are there.  0-2 position (along the axes for a slider, else in space), 3-5 rotation: E1.G2, E1.G3, E2.G3.
inline bool constrains(int kind, int i) {
    if (i == 0) return !slides(kind);
    if (i == 4) return kind != JointKind::UNIVERSAL;
    if (i == 5) return kind == JointKind::FIXED || kind == JointKind::SLIDER;
    return true;
}
constexpr int PAIR[3][2] = {{0, 1}, {0, 2}, {1, 2}};

// Force of a slider's spring, damper and stops, positive where they pull its parts together; energy without the damper.
// Stops: k/2 (q + sqrt(q^2 + e^2)), q the way beyond them: smooth, so that a part that hangs free still finds its stop in statics.
template <class T, class S>
inline T slider_stops(const T& travel, const S* p) {
    typedef JointParameters P;
    if (!(p[P::STOP_STIFFNESS] > 0)) return T(0.0);
    const double e = p[P::STOP_ROUNDING], k = 0.5 * p[P::STOP_STIFFNESS];
    const T out = travel - p[P::STOP_OUT], in = p[P::STOP_IN] - travel;
    return (out + sqrt(out * out + e * e)) * k - (in + sqrt(in * in + e * e)) * k;
}

template <class T, class S>
inline T slider_force(const T& travel, const T& speed, const S* p) {
    typedef JointParameters P;
    return travel * p[P::SPRING] + speed * p[P::DAMPER] - p[P::PRELOAD] + slider_stops(travel, p);
}

inline double slider_energy(double travel, const double* p) {
    typedef JointParameters P;
    double u = (0.5 * p[P::SPRING] * travel - p[P::PRELOAD]) * travel;
    if (p[P::STOP_STIFFNESS] > 0)
        for (int end = 0; end < 2; ++end) {
            const double q = end ? p[P::STOP_IN] - travel : travel - p[P::STOP_OUT];
            const double e = p[P::STOP_ROUNDING], s = std::sqrt(q * q + e * e);
            u += 0.25 * p[P::STOP_STIFFNESS] * (q * q + q * s + e * e * std::asinh(q / e));
        }
    return u;
}

// Angle by which the part below has turned about the axis of a slider, with its sine and cosine.
template <class T>
struct Twist {
    T s, c, angle;
    Twist(const JointState<T>& j) : s(dot(j.E[2], j.G[1])), c(dot(j.E[1], j.G[1])), angle(atan2(s, c)) {}
};

// Moment of the spring of a TORSION_SLIDER, in the sense of that of the multipliers.
template <class T, class S>
inline Vec<T> twist_moment(const JointState<T>& j, const S* p) {
    const Twist<T> q(j);
    return (cross(j.E[2], j.G[1]) * q.c - cross(j.E[1], j.G[1]) * q.s) * (q.angle * p[JointParameters::TORSION] / (q.s * q.s + q.c * q.c));
}

// STABILISED (Gear, Gupta and Leimkuhler, J. Comp. Appl. Math. 12/13:77-90, 1985): the constraints hold for the velocities as well, with six
// more multipliers that correct the velocities of the node above (see joint_directions).
template <bool STABILISED>
struct Joint : JointParameters {
    static constexpr int D = STABILISED ? 26 : 20, NSPIN = 2;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[2][2] = {{6, 3}, {13, 10}};

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T*, const S* p, void*, T* r) {
        const JointState<T> j(x, y, p);
        const int kind = static_cast<int>(p[KIND]);
        const double scale = p[SCALE];
        Vec<T> F = {T(0.0), T(0.0), T(0.0)}, lever = F, moment = F;  // on the part below; moment of F on the one above; moment above
        for (int i = 0; i < 6; ++i) {
            r[14 + i] = x[14 + i] * -scale;
            if constexpr (STABILISED) r[20 + i] = x[20 + i] * (constrains(kind, i) ? -SOFT * scale : -scale);
            if (!constrains(kind, i)) continue;
            const T lambda = x[14 + i] * scale;
            T error, rate;
            if (i < 3) {
                if (slides(kind)) {
                    const Vec<T> turn = cross(j.E[i], j.way);
                    error = dot(j.E[i], j.way);
                    if constexpr (STABILISED) rate = dot(j.E[i], j.way_rate) + dot(turn, j.above.turning);
                    F += j.E[i] * lambda;
                    lever += turn * lambda;
                } else {
                    const Vec<double> e = {i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0};
                    error = dot(j.way, e);
                    if constexpr (STABILISED) rate = dot(j.way_rate, e);
                    F += Vec<T>{lambda * e.x, lambda * e.y, lambda * e.z};
                }
            } else {
                const Vec<T> &A = j.E[PAIR[i - 3][0]], &B = j.G[PAIR[i - 3][1]], turn = cross(A, B);
                error = dot(A, B);
                if constexpr (STABILISED) rate = dot(turn, j.above.turning - j.below.turning);
                moment += turn * lambda;
            }
            r[14 + i] = error * scale;
            if constexpr (STABILISED) r[20 + i] += rate * scale;
        }
        if (kind == JointKind::TORSION_SLIDER) moment += twist_moment(j, p);
        if (slides(kind)) {
            const Vec<T> turn = cross(j.above.t, j.way);
            const T f = slider_force(dot(j.above.t, j.way), dot(j.above.t, j.way_rate) + dot(turn, j.above.turning), p);
            F += j.above.t * f;
            lever += turn * f;
        }
        const Vec<T> up = moment + lever - cross(j.above.t, F) * p[RIGID];
        const Vec<T> bend1 = cross(up, j.above.t) / j.above.n, bend2 = cross(moment, j.below.t) / j.below.n;
        r[0] = -F.x; r[1] = -F.y; r[2] = -F.z; r[3] = bend1.x; r[4] = bend1.y; r[5] = bend1.z; r[6] = dot(up, j.above.t);
        r[7] = F.x; r[8] = F.y; r[9] = F.z; r[10] = -bend2.x; r[11] = -bend2.y; r[12] = -bend2.z; r[13] = -dot(moment, j.below.t);
    }
};

// A node that no element reaches from above, or none at all: its slope has length one.
struct UnitSlope {
    static constexpr int D = 7, NSPIN = 1;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{6, 3}};
    DP_ENUM(Parameter, STIFFNESS, NP)  // against a slope of another length [N m]

    template <class T, class S>
    static void force(int, const T* x, const T*, const T*, const S* p, void*, T* r) {
        const Vec<T> v = vec(x + 3);
        const T n = norm(v);
        const Vec<T> f = v * ((n - 1.0) / n * p[STIFFNESS]);
        r[0] = r[1] = r[2] = r[6] = T(0.0);
        r[3] = f.x; r[4] = f.y; r[5] = f.z;
    }
};

}  // namespace dp
