// Mud beside a short rigid item, pushed aside across the hole and leaking past its ends; relative to mud that swirls with the string, as in
// fluid/annulus_flow.hpp, lumped at the item's middle.  Manual: eq-mud-item.
#pragma once
#include "beam/rigid_body.hpp"
#include "fluid/annulus_flow.hpp"

namespace dp {

// Energies [J], power turned into heat and power that the stored swirl gives [W].
DP_RECORD(MudItemResults, double kinetic, dissipated, left_out;)

struct MudItem : VertexKernel {
    DP_ENUM(Parameter,
        ARM,                    // from the node down to the item's middle [m]
        MASS, DAMPING,          // of the mud [kg], [N s/m]
        SHARE, SWIRL, SWIRL_RATE, SPIN_RATE,  // as in fluid/annulus_flow.hpp
        AXIS, TANGENT = AXIS + 3,             // 3 each: point [m] and direction of the hole's axis beside the middle
        NP = TANGENT + 3)

    // Offset of the middle from the hole's axis, and its velocity across the hole
    template <class T> struct Middle {
        Tangent<T> t;
        Vec<T> y, V, turned;
        Middle(const T* x, const T* rate, const T* a, const double* p) : t(vec(x + 3), vec(rate + 3), vec(a + 3)) {
            const Vec<double> tw = vec(p + TANGENT);
            const auto cut = [&tw](const Vec<T>& u) -> Vec<T> { return u - tw * dot(u, tw); };
            y = cut(vec(x) + t.t * p[ARM] - vec(p + AXIS));
            V = cut(vec(rate) + t.t1 * p[ARM]);
            turned = cross(tw, y);
        }
    };

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T* a, const S* p, void*, T* r) {
        const Middle<T> m(x, y, a, p);
        const Vec<double> tw = vec(p + TANGENT);
        const Vec<T> A = vec(a) + m.t.t2 * p[ARM], across = A - tw * dot(A, tw);
        const S swirl = p[SWIRL];
        const Vec<T> F = (across - cross(tw, m.V) * (2.0 * swirl) - m.turned * p[SWIRL_RATE] - m.y * (swirl * swirl)) * p[MASS] +
                         (m.V - m.turned * swirl) * p[DAMPING];
        const Vec<T> bend = (F - m.t.t * dot(m.t.t, F)) * (p[ARM] / m.t.n);
        r[0] = F.x; r[1] = F.y; r[2] = F.z; r[3] = bend.x; r[4] = bend.y; r[5] = bend.z;
        r[6] = dot(m.turned, F) * -p[SHARE];
    }

    static void results(const double* x, const double* y, const double* p, MudItemResults* out) {
        const double zero[7] = {};
        const Middle<double> m(x, y, zero, p);
        const double spin = y[6] * p[SHARE];
        const Vec<double> passed = m.V - m.turned * p[SWIRL];
        const double relative = dot(m.turned, passed) * p[MASS];
        out->kinetic = 0.5 * p[MASS] * dot(passed, passed) + (p[SWIRL] - spin) * relative;
        out->dissipated = p[DAMPING] * dot(m.V - m.turned * spin, passed);
        out->left_out = relative * (p[SWIRL_RATE] - p[SHARE] * p[SPIN_RATE]);
    }
};

}  // namespace dp
