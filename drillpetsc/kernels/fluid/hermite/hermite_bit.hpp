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
        TRAVEL,                     // way that the bit can go on below the hole's end, as rock gives way [m]; VOLUME is left there
        WAITS,                      // as in fluid/hermite/hermite_bore.hpp
        PASSED,                     // 3: as PASSED2 of the annulus' lowest element
        NP = PASSED + 3)

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        evaluate<T, S>(x, y, a, p, *static_cast<const Fluid*>(context), r, nullptr);
    }

    template <class T, class S>
    static void evaluate(const T* x, const T* y, const T* a, const S* p, const Fluid& f, T* r, BitFlowResults* results) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        Vec<T> F = {T(0.0), T(0.0), T(0.0)};
        const Vec<double> g = vec(f.gravity);
        T beside = T(p[B::AMBIENT]), outside = beside;  // pressure at the height of the node
        if constexpr (ANNULUS) {
            const Vec<double> end = vec(p + B::END), axis = vec(p + B::AXIS);
            T gap = T(p[B::HELD_GAP]);  // along the axis of the hole, however the bit leans: pressure all around does not turn it
            if constexpr (!HELD) gap = dot(end - vec(x), axis) - p[B::FACE];
            const double wall = p[B::ELASTIC] - f.compressibility;
            const auto size = [p](const T& below) -> T { return p[B::VOLUME] + p[B::HOLE] * GAP_ROUNDING * softplus((below + p[TRAVEL]) * (1.0 / GAP_ROUNDING)); };
            const T volume = size(gap), open = logistic((gap + p[TRAVEL]) * (1.0 / GAP_ROUNDING)) * p[B::HOLE];
            T excess = x[VA] - (volume - size(T(p[B::HELD_GAP])));
            if constexpr (PIPE) excess += x[VI];
            const T under = pressure_of(f, excess, volume, volume * wall);
            const double down = dot(axis, g);
            const T middle = gap * gap * (0.5 * p[B::HOLE]) / volume, q = y[VA] - p[REFERENCE_FLOW];  // middle: of the mud over the hole's end
            beside = log1p((flow_work(f, under) + (middle - gap) * (down * f.density)) * -f.compressibility) * (-1.0 / f.compressibility);
            const T row = flow_work(f, T(beside + heads(f, q, beside, p[HEADS_ANNULUS])));
            r[VA] = row * MOMENTUM_ROW;
            outside = x[PA];
            if constexpr (!HELD) {
                const Vec<double> tw = vec(p + B::TANGENT);
                const T thick = exp(outside * f.compressibility), density = thick * f.density, rate = q / (thick * p[B::OPEN]), M = density * p[B::ADDED] * rate;
                const Vec<T> carried = (vec(y) + vec(x + 3) * rate) * M;
                F += carried - tw * dot(carried, tw) + g * (density * p[B::BUOYANT]);
                // the chamber gives way by the gap: by its stored energy and height, less the volume that the node passes (hermite_annulus.hpp)
                const bool waits = is_waiting(p[WAITS]);  // then with the pressure beside the node; with the heads, which the hole there has, too
                const T pressure = waits ? outside : under + heads(f, q, under, p[HEADS_ANNULUS]), weight = waits ? T(0.0) : (volume + excess) * ((gap * p[B::HOLE] - middle * open) / volume) * (down * f.density);
                const T face = (pressure + pressure * pressure * (0.5 * wall)) * open - weight;
                F += axis * face - vec(p + PASSED) * (waits ? flow_work(f, outside) : row);
            }
            if (results) {
                results->stored = stored_energy(f, val(under), wall, val(volume));
                results->content = val(volume + excess);
                results->bottom = 0.0;
                const double low = dot(end, g) - (p[B::FACE] + val(middle)) * down;
                results->potential = -f.density * results->content * low;
                if constexpr (!HELD) results->potential += f.density * p[B::BUOYANT] * val(dot(vec(x), g));
            }
        }
        if constexpr (PIPE) {
            const T q = y[VI] + p[REFERENCE_FLOW], thin = exp(beside * (-f.compressibility));
            const T loss = nozzle_drop(q, thin, f.density, p[B::LOSS], p[B::SHUT]), surge = (a[VI] + p[SURGE]) * p[B::INERTANCE];
            r[VI] = (surge + flow_work(f, T(beside + loss + heads(f, q, T(beside + loss), p[HEADS_PIPE])))) * MOMENTUM_ROW;
            if constexpr (!HELD) {
                const Tangent<T> t(vec(x + 3), vec(y + 3), vec(y + 3));
                F += (vec(y) + t.t * (q * exp(outside * (-f.compressibility)) / p[B::NOZZLE])) * (q * f.density);
            }
            if (results) { results->lost = val((flow_work(f, T(beside + loss)) - flow_work(f, beside)) * q); results->flow = val(q); results->kinetic = 0.5 * p[B::INERTANCE] * val(q) * val(q); }
        }
        if constexpr (!HELD) { r[0] += F.x; r[1] += F.y; r[2] += F.z; }
    }
};

}  // namespace dp
