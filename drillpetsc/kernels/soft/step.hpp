// One step of a soft string, from the bit up, with two Gauss points (manual: sec-soft-string, sec-soft-string-helical).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace dp::soft {

// of a step of the hole: the upper Gauss point, then the lower one
struct Geometry {
    double down[2];  // cos I
    double kk[2];    // curvature times curvature [1/m2]
    double kz[2];    // curvature times the direction of the weight across the hole [1/m]
    double zz[2];    // square of that direction
};

// of a string in a step
struct Values {
    double weight;   // buoyed [N/m]
    double lift;     // of the flow [N/m]
    double drag;     // friction along the string
    double extra;    // clearance over 4 EI [1/(N m)]
    double root;     // root of EI over clearance
    double hanging;  // (w^2 EI)^(1/3) in a vertical hole, else 0 [N]
};

constexpr double ROOT_3 = 1.7320508075688772, ROOT_2 = 1.4142135623730951;
// Gauss stages, the first of them the lower one
constexpr double A11 = 0.25, A12 = 0.25 - ROOT_3 / 6, A21 = 0.25 + ROOT_3 / 6, A22 = 0.25;
// sinusoidal and helical load in a hole with side load, over the root of EI q/r: Dawson and Paslay (SPE 11167), Chen, Lin and Cheatham;
// in a vertical hole over (w^2 EI)^(1/3), Lubinski (1950), taken where it is larger
constexpr double BUCKLING[2] = {2.0, 2.0 * ROOT_2}, UPRIGHT[2] = {1.94, 3.75};

enum { CONTACT, MEAN, GROWTH, RATIOS, STATE = RATIOS + 2, RESULTS };

struct Stage {
    double g, k, c, w;  // weight along the hole [N/m]; wall force sqrt(k T^2 + c T + w) [N/m]
    double side(double t) const { return std::sqrt(std::max((t * k + c) * t + w, 0.0)); }
};

inline Stage stage(const Geometry& hole, const Values& v, int at) {
    return {v.weight * hole.down[at] - v.lift, hole.kk[at], 2 * v.weight * hole.kz[at], v.weight * v.weight * hole.zz[at]};
}

// Force [N] at the upper end of a step of h [m] from the force t at its lower end; results are `stride` numbers apart.
inline double step(const Geometry& hole, const Values& v, double h, double t, double* out, long stride) {
    const Stage up = stage(hole, v, 0), low = stage(hole, v, 1);
    const double push = std::max(-t, 0.0), side = low.side(t), load = v.root * std::sqrt(side);
    // whether the string is helical follows from the force at the lower end, so that the stage equations are smooth
    bool beyond[2];
    for (int i = 0; i < 2; ++i) {
        const double limit = std::max(BUCKLING[i] * load, UPRIGHT[i] * v.hanging);
        beyond[i] = push > limit;
        out[(RATIOS + i) * stride] = limit > 0 ? push / limit : push > 0 ? std::numeric_limits<double>::infinity() : 0.0;
    }
    const double e = beyond[1] ? v.extra : 0.0;
    double upper = t, lower = t, n1 = 0, n2 = 0, f1 = 0, f2 = 0;
    for (int n = 0; n < 50; ++n) {
        n2 = low.side(lower) + e * lower * lower;
        n1 = up.side(upper) + e * upper * upper;
        f2 = low.g + v.drag * n2;
        f1 = up.g + v.drag * n1;
        const double newLower = t + h * (A11 * f2 + A12 * f1), newUpper = t + h * (A21 * f2 + A22 * f1);
        const double change = std::abs(newLower - lower) + std::abs(newUpper - upper);
        lower = newLower;
        upper = newUpper;
        if (change <= 1e-12 * (std::abs(t) + h * (std::abs(f1) + std::abs(f2))) + 1e-300) break;
    }
    const double middle = 0.5 * (lower + upper);
    const double dn = side > 1e-9 ? (middle * low.k + 0.5 * low.c) / side : 0.0;  // of the wall force without the helix, by the force
    out[CONTACT * stride] = 0.5 * (n1 + n2);
    out[MEAN * stride] = middle;
    out[GROWTH * stride] = h * v.drag * (dn + 2 * e * middle);
    out[STATE * stride] = beyond[1] ? 2 : beyond[0];
    return t + 0.5 * h * (f1 + f2);
}

}  // namespace dp::soft
