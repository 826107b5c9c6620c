// The fluid at the lower end of the string as in fluid/bit_flow.hpp, for channels by volume: what has passed through the nozzles and the
// annulus' lower end since rest fills the chamber, so its pressure follows from both volumes and is no unknown, nor is the nozzles' flow.
// What the string feels takes the density at the annulus' lowest node (the same but for the scheme's error): it is defined in statics, too,
// where the string moves while the fluid waits.
#pragma once
#include "fluid/hermite/hermite_flow.hpp"

namespace dp {

template <bool PIPE, bool ANNULUS, bool HELD>
struct HermiteBit {
    static constexpr int VI = HELD ? 0 : 7, VA = VI + PIPE, PA = VA + ANNULUS, D = PA + ANNULUS, NSPIN = 0;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{0, 0}};
    typedef BitFlow<PIPE, ANNULUS, HELD> B;  // HELD_GAP is that at rest
    DP_ENUM(Parameter, DP_BIT_FLOW_PARAMETERS,
        REFERENCE_FLOW, SURGE,      // Q and its rate [m3/s], [m3/s2]
        HEADS_PIPE, HEADS_ANNULUS,  // HEADS of the channels' lowest elements [1/m4]
        NP)

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        evaluate<T, S>(x, y, a, p, *static_cast<const Fluid*>(context), r, nullptr);
    }

    template <class T, class S>
    static void evaluate(const T* x, const T* y, const T* a, const S* p, const Fluid& f, T* r, BitFlowResults* results) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        Vec<T> F = {T(0.0), T(0.0), T(0.0)};
        const Vec<double> g = vec(f.gravity);
        T under = T(p[B::AMBIENT]), outside = under;
        if constexpr (ANNULUS) {
            T gap = T(p[B::HELD_GAP]);
            if constexpr (!HELD) {
                const Tangent<T> t(vec(x + 3), vec(y + 3), vec(y + 3));
                gap = dot(vec(p + B::END) - vec(x) - t.t * p[B::FACE], vec(p + B::AXIS));
            }
            const double wall = p[B::ELASTIC] - f.compressibility;
            const double rest = p[B::VOLUME] + p[B::HOLE] * GAP_ROUNDING * softplus(p[B::HELD_GAP] / GAP_ROUNDING);
            const T volume = p[B::VOLUME] + p[B::HOLE] * GAP_ROUNDING * softplus(gap * (1.0 / GAP_ROUNDING));
            T passed = x[VA] - (volume - rest);
            if constexpr (PIPE) passed += x[VI];
            under = pressure_of(f, T(passed / volume), wall);
            const T q = y[VA] - p[REFERENCE_FLOW];
            r[VA] = (under + heads(f, q, under, p[HEADS_ANNULUS])) * MOMENTUM_ROW;
            outside = x[PA];
            if constexpr (!HELD) {
                const Vec<double> tw = vec(p + B::TANGENT);
                const T thick = exp(outside * f.compressibility), density = thick * f.density, rate = q / (thick * p[B::OPEN]), M = density * p[B::ADDED] * rate;
                const Vec<T> carried = (vec(y) + vec(x + 3) * rate) * M;
                F += carried - tw * dot(carried, tw) + g * (density * p[B::BUOYANT]);
            }
            if (results) {
                const Filled<double> at(f, {val(under), 0.0, 0.0}, wall);
                results->stored = 0.5 * val(volume) * at.by_p * val(under) * val(under);
                results->content = val(volume + passed);
                if constexpr (!HELD) {
                    const Tangent<T> t(vec(x + 3), vec(y + 3), vec(y + 3));  // a closed gap displaces no mud (fluid/bit_flow.hpp)
                    const double driven = val(dot(vec(y) + t.t1 * p[B::FACE], vec(p + B::AXIS))) * (1.0 - logistic(val(gap) * (1.0 / GAP_ROUNDING)));
                    results->bottom = -val(under) * p[B::HOLE] * driven;
                    const Vec<double> middle = vec(p + B::END) - vec(p + B::AXIS) * (0.5 * val(gap));
                    results->potential = f.density * (p[B::BUOYANT] * val(dot(vec(x), g)) - results->content * dot(middle, g));
                }
            }
        }
        if constexpr (PIPE) {
            const T q = y[VI] + p[REFERENCE_FLOW], thin = exp(under * (-f.compressibility));
            const T loss = nozzle_drop(q, thin, f.density, p[B::LOSS], p[B::SHUT]), surge = (a[VI] + p[SURGE]) * p[B::INERTANCE];
            r[VI] = (under + loss + surge + heads(f, q, T(under + loss), p[HEADS_PIPE])) * MOMENTUM_ROW;
            if constexpr (!HELD) {
                const Tangent<T> t(vec(x + 3), vec(y + 3), vec(y + 3));
                F += (vec(y) + t.t * (q * exp(outside * (-f.compressibility)) / p[B::NOZZLE])) * (q * f.density);
            }
            if (results) { results->lost = val(loss * q) * std::exp(-f.compressibility * val(under + loss * 0.5)); results->flow = val(q); results->kinetic = 0.5 * p[B::INERTANCE] * val(q) * val(q); }
        }
        if constexpr (!HELD) { r[0] += F.x; r[1] += F.y; r[2] += F.z; }
    }
};

}  // namespace dp
