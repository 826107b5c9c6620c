// Wall shear stress of four elements side by side: Herschel-Bulkley fluids as in fluid/rheology.cpp, same formulas and names; the others lane by
// lane.
#pragma once
#include "core/pack_math.hpp"
#include "fluid/rheology.hpp"

namespace dp {

struct WallShears { Pack stress, slope, by_density; };  // as WallShear

// Herschel-Bulkley fluids under the laws blend and exact.
inline bool is_packed(const double* p) {
    const bool exact = p[RHEO_YIELD] > 0.0 && p[RHEO_LAW] == FrictionLaw::EXACT;
    return p[RHEO_KIND] == HERSCHEL_BULKLEY && p[RHEO_LAW] != FrictionLaw::API && p[RHEO_LIMIT] > 10.0 &&
           (p[RHEO_CONSISTENCY] > 0.0 || (!exact && p[RHEO_YIELD] > 0.0));
}

struct Laminars { Pack drag, order; };  // stress / speed, d ln(stress) / d ln(speed)

inline Laminars explicit_laminars(const double* p, const Pack& shear, const Pack& g2, const Pack& ge2, bool slot) {
    const double n = p[RHEO_INDEX], yield = p[slot ? RHEO_YIELD_SLOT : RHEO_YIELD_PIPE];
    const Pack viscous = n == 1.0 ? Pack(p[RHEO_CONSISTENCY]) : p[RHEO_CONSISTENCY] * exp(0.5 * (n - 1.0) * log(ge2));
    const Pack plastic = yield > 0.0 ? yield / sqrt(ge2) : Pack(0.0), viscosity = plastic + viscous;
    return {viscosity * shear, 1.0 + g2 * ((n - 1.0) * viscous - plastic) / (ge2 * viscosity)};
}

// exact_herschel_bulkley of fluid/rheology.cpp.
inline Laminars exact_laminars(const double* p, const Pack& shear, const Pack& g2, const Pack& ge2, bool slot) {
    const double Y = p[RHEO_YIELD], n = p[RHEO_INDEX], m = 1.0 / n, G = p[slot ? RHEO_SHEAR_SLOT : RHEO_SHEAR_PIPE] / 8.0;
    const double k = slot ? 2.0 : 3.0, c = (slot ? 2.0 : 4.0) * G, q1 = Y / (m + 1.0), q2 = 1.0 / (m + 2.0), q3 = 1.0 / (m + 3.0);
    const Pack L0 = p[RHEO_LOG_K] + 0.5 * n * log(ge2), L1 = (m * L0 - std::log(c / ((m + 1.0) * Y))) * (1.0 / (m + 1.0));
    Pack L = Pack(L0.v > L1.v ? L0.v : L1.v), X, T, slope = Pack(1.0);
    I4 open = {-1, -1, -1, -1};  // elements whose iteration goes on
    for (int i = 0; i < 50 && (open[0] | open[1] | open[2] | open[3]); ++i) {
        X = exp(L);
        T = Y + X;
        const Pack P = slot ? X * q2 + q1 : X * (X * q3 + 2.0 * Y * q2) + Y * q1, dP = slot ? Pack(q2) : 2.0 * (X * q3 + Y * q2);
        slope = Pack(open ? (m + 1.0 + X * dP / P - k * X / T).v : slope.v);
        const Pack step = ((m + 1.0) * L - m * L0 + log(c * P / (slot ? T * T : T * T * T))) / slope;
        L = Pack(open ? (L - step).v : L.v);
        open &= (step.v < 0.0 ? -step.v : step.v) >= 1e-7;
    }
    X = exp(L);
    T = Y + X;
    return {T * shear / sqrt(ge2), 1.0 + g2 / ge2 * (X / (T * slope) - 1.0)};
}

inline WallShears packed_wall_shear(const double* p, const Pack& w, const Pack& diameter, bool slot, const Pack& density) {
    const double b = p[RHEO_B], limit = p[RHEO_LIMIT];
    const Pack shear = p[slot ? RHEO_SHEAR_SLOT : RHEO_SHEAR_PIPE] / diameter, g = shear * w, g2 = g * g, ge2 = g2 + p[RHEO_GAMMA] * p[RHEO_GAMMA];
    const bool exact = p[RHEO_YIELD] > 0.0 && p[RHEO_LAW] == FrictionLaw::EXACT;
    const Laminars laminar = exact ? exact_laminars(p, shear, g2, ge2, slot) : explicit_laminars(p, shear, g2, ge2, slot);
    const Pack drag = laminar.drag, order = laminar.order;
    // transition and turbulence: outside 0.2 .. 1000 limits one term of the blend is below rounding
    const V4 speed = w.v < 0.0 ? -w.v : w.v, raw = (8.0 * density * Pack(speed) / drag).v;
    const Pack Re = Pack(raw < 0.1 * limit ? splat(0.1 * limit) : raw > 1e100 ? splat(1e100) : raw);
    const Pack y = p[RHEO_A] * (1.0 / 16) * (b == 0.25 ? Re / sqrt(sqrt(Re)) : exp((1.0 - b) * log(Re)));
    const V4 ratio = Re.v * (1.0 / limit);
    const I4 turbulent = ratio > 1000.0;
    const Pack r = Pack(turbulent ? splat(1000.0) : ratio), r2 = r * r, r4 = r2 * r2, r8 = r4 * r4, v = r2 / y, v2 = v * v, v4 = v2 * v2, q = v4 * v4;
    const Pack z = r8 * r8 * r8 / ((1.0 + q) * sqrt(1.0 + q)), F = exp(log(1.0 + z) * (1.0 / 12));
    const Pack F_order = z * (2.0 + (1.0 - b) * q) / ((1.0 + z) * (1.0 + q));
    const Pack factor = Pack(turbulent ? y.v : F.v), factor_order = Pack(turbulent ? splat(1.0 - b) : ratio < 0.2 ? splat(0.0) : F_order.v);
    const Pack whole = drag * factor, stress = whole * w;
    return {stress, whole * (order + (2.0 - order) * factor_order), stress * factor_order / density};
}

inline WallShears wall_shears(const double* p, const Pack& w, const Pack& diameter, double alpha, const Pack& density) {
    if (is_packed(p)) return packed_wall_shear(p, w, diameter, alpha > 0.5, density);
    WallShears all;
    for (int l = 0; l < 4; ++l) {
        const WallShear one = wall_shear_and_slope(p, w.v[l], diameter.v[l], alpha, density.v[l]);
        all.stress.v[l] = one.stress; all.slope.v[l] = one.slope; all.by_density.v[l] = one.by_density;
    }
    return all;
}

}  // namespace dp
