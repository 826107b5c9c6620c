// Wall shear stress of four elements side by side: the laws of fluid/rheology.cpp that are explicit in the speed, same formulas and names; the
// others lane by lane.
#pragma once
#include "core/pack_math.hpp"
#include "fluid/rheology.hpp"

namespace dp {

struct WallShears { Pack stress, slope, by_density; };  // as WallShear

// Laminar stress explicit in the speed (no profile to solve for), with the blend to turbulence.
inline bool is_explicit(const double* p) {
    const bool profile = p[RHEO_YIELD] > 0.0 && (p[RHEO_KIND] == CASSON || p[RHEO_LAW] == FrictionLaw::EXACT);
    return !profile && p[RHEO_LAW] != FrictionLaw::API && (p[RHEO_CONSISTENCY] > 0.0 || p[RHEO_YIELD] > 0.0) && p[RHEO_LIMIT] > 10.0;
}

inline WallShears explicit_wall_shear(const double* p, const Pack& w, const Pack& diameter, bool slot, const Pack& density) {
    const double n = p[RHEO_INDEX], b = p[RHEO_B], limit = p[RHEO_LIMIT], yield = p[slot ? RHEO_YIELD_SLOT : RHEO_YIELD_PIPE];
    const Pack shear = p[slot ? RHEO_SHEAR_SLOT : RHEO_SHEAR_PIPE] / diameter, g = shear * w, g2 = g * g, ge2 = g2 + p[RHEO_GAMMA] * p[RHEO_GAMMA];
    const Pack viscous = n == 1.0 ? Pack(p[RHEO_CONSISTENCY]) : p[RHEO_CONSISTENCY] * exp(0.5 * (n - 1.0) * log(ge2));
    const Pack plastic = yield > 0.0 ? yield / sqrt(ge2) : Pack(0.0), viscosity = plastic + viscous, drag = viscosity * shear;
    const Pack order = 1.0 + g2 * ((n - 1.0) * viscous - plastic) / (ge2 * viscosity);
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
    if (is_explicit(p)) return explicit_wall_shear(p, w, diameter, alpha > 0.5, density);
    WallShears all;
    for (int l = 0; l < 4; ++l) {
        const WallShear one = wall_shear_and_slope(p, w.v[l], diameter.v[l], alpha, density.v[l]);
        all.stress.v[l] = one.stress; all.slope.v[l] = one.slope; all.by_density.v[l] = one.by_density;
    }
    return all;
}

}  // namespace dp
