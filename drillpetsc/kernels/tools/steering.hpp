// Rotary steerable tools: pads that push the pipe, and a shaft that is tilted in a direction fixed in space.
//
//   push    force F on the node, fixed in space, and (rotating pads) P w(alpha_k) d_k of three pads that turn with the pipe; alpha_k is the
//           angle from the tool face to the pad k, and w the window in which it acts
//   point   the element is free of stress with the curvature kappa0 e, e fixed in space: of EI/2 int |t' - kappa0 e|^2 ds the cross term is
//           -EI kappa0 e.(t2 - t1), the couple M = EI kappa0 on both ends; e is taken across the element, so the couples balance
#pragma once
#include "beam/rigid_body.hpp"

namespace dp {

constexpr double PAD_WINDOW = M_PI / 3;       // half the window of each of three pads [rad]
constexpr double PAD_OVERLAP = M_PI / 36;     // half the angle over which one pad takes over from the other [rad]

// Share of its force with which a pad acts at the angle alpha; those of three pads add up to 1.
template <class T>
inline T pad_share(const T& alpha) {
    const T u = (PAD_WINDOW + PAD_OVERLAP - (val(alpha) < 0 ? -1.0 * alpha : alpha)) * (0.5 / PAD_OVERLAP);
    if (val(u) <= 0) return T(0.0);
    return val(u) >= 1 ? T(1.0) : u * u * (3.0 - 2.0 * u);
}

struct PushPads : VertexKernel {
    DP_ENUM(Parameter,
        FORCE, PAD = FORCE + 3,      // 3: dead force [N]; force of one pad [N]
        TOWARDS,                     // 3: unit vector of the tool face
        REFERENCE = TOWARDS + 3, SECOND = REFERENCE + 3,  // 3 each: the node's frame
        NP = SECOND + 3)

    template <class T, class S>
    static void force(int, const T* x, const T*, const T*, const S* p, void*, T* r) {
        Vec<T> F = {T(p[FORCE]), T(p[FORCE + 1]), T(p[FORCE + 2])};
        if (p[PAD] != 0) {
            const Vec<T> v = vec(x + 3), t = v / norm(v);
            const Vec<double> e = vec(p + TOWARDS);
            Vec<T> d2, d3;
            directors(vec(p + REFERENCE), vec(p + SECOND), t, x[6], d2, d3);
            const T angle = atan2(dot(d3, e), dot(d2, e));  // of the tool face in the section
            for (int k = -1; k <= 1; ++k) {
                const T from = k * (2 * M_PI / 3) - angle, alpha = from - 2 * M_PI * std::round(val(from) / (2 * M_PI));
                const T share = pad_share(alpha) * p[PAD];
                F += d2 * (share * std::cos(k * (2 * M_PI / 3))) + d3 * (share * std::sin(k * (2 * M_PI / 3)));
            }
        }
        for (int i = 3; i < 7; ++i) r[i] = T(0.0);
        r[0] = -F.x; r[1] = -F.y; r[2] = -F.z;
    }
};

struct PointTilt {
    static constexpr int D = 14, NSPIN = 2;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[2][2] = {{6, 3}, {13, 10}};
    DP_ENUM(Parameter,
        COUPLE,                      // EI kappa0 [N m]
        TOWARDS,                     // 3: unit vector of the tool face
        NP = TOWARDS + 3)

    // V = -M e.(t2 - t1)/s, s^2 = 1 - c^2, c = e.(t1 + t2)/|t1 + t2|: e counts by its part across the element
    template <class T, class S>
    static void force(int, const T* x, const T*, const T*, const S* p, void*, T* r) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        const Vec<double> e = vec(p + TOWARDS);
        const Vec<T> v[2] = {vec(x + 3), vec(x + 10)};
        const T n[2] = {norm(v[0]), norm(v[1])};
        const Vec<T> t[2] = {v[0] / n[0], v[1] / n[1]}, sum = t[0] + t[1];
        const T m = norm(sum), c = dot(sum, e) / m, s = sqrt(1.0 - c * c);
        const T turn = (dot(t[1], e) - dot(t[0], e)) * c / (s * s * s);
        const Vec<T> common = (e * (1.0 / m) - sum * (c / (m * m))) * turn;
        for (int end = 0; end < 2; ++end) {
            const double sign = end ? 1.0 : -1.0;
            const Vec<T> g = (e * (sign / s) + common) * (-1.0 * p[COUPLE]);
            const Vec<T> q = (g - t[end] * dot(g, t[end])) / n[end];
            r[7 * end + 3] = q.x; r[7 * end + 4] = q.y; r[7 * end + 5] = q.z;
        }
    }
};

}  // namespace dp
