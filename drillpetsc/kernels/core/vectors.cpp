// Sums and norms over vectors that a step or a row of output needs, each in one pass.
#include "core/ad.hpp"

// Largest |step| relative to the larger of scale and spacing |x|; not a number where any entry is not.
extern "C" double scaled_size(int n, const double* step, const double* scale, double spacing, const double* x) {
    using dp::V4;
    typedef double Unaligned __attribute__((vector_size(32), aligned(8), may_alias));
    const auto load = [](const double* p) { return static_cast<V4>(*reinterpret_cast<const Unaligned*>(p)); };
    const auto size_of = [](double s) { return s < 0.0 ? -s : s; };
    V4 most = dp::splat(0.0), sum = dp::splat(0.0);  // the sum is not a number where any entry is not
    int i = 0;
    for (; i + 4 <= n; i += 4) {
        V4 a = load(step + i), b = load(x + i);
        const V4 usual = load(scale + i);
        a = a < 0.0 ? -a : a;
        b = (b < 0.0 ? -b : b) * spacing;
        const V4 size = a / (usual > b ? usual : b);
        most = size > most ? size : most;
        sum += size;
    }
    double largest = 0.0, all = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    for (int l = 0; l < 4; ++l) largest = most[l] > largest ? most[l] : largest;
    for (; i < n; ++i) {
        const double floor = spacing * size_of(x[i]), size = size_of(step[i]) / (scale[i] > floor ? scale[i] : floor);
        largest = size > largest ? size : largest;
        all += size;
    }
    return all == all ? largest : NAN;
}

// Sum of a[i[k]] b[j[k]] over n pairs.
extern "C" double gathered_product(int n, const int* i, const double* a, const int* j, const double* b) {
    double sum = 0.0;
    for (int k = 0; k < n; ++k) sum += a[i[k]] * b[j[k]];
    return sum;
}

// Whether any of the numbers of x at n places is below the limit.
extern "C" int any_below(int n, const int* places, const double* x, double limit) {
    bool below = false;
    for (int k = 0; k < n; ++k) below |= x[places[k]] < limit;
    return below;
}

namespace {
// A function of its own, so that the last bit of a point does not depend on how many points there are.
__attribute__((noinline)) void high_side_offset(const double* tangent, const double* offset, double* out) {
    using namespace dp;
    const Vec<double> t = vec(tangent), d = vec(offset);
    Vec<double> across = {t.x * t.z, t.y * t.z, t.z * t.z - 1.0};
    if (norm(across) < 1e-6) across = {1.0 - t.x * t.x, -t.y * t.x, -t.z * t.x};
    const Vec<double> high = across / norm(across);
    out[0] = dot(d, high);
    out[1] = dot(d, cross(t, high));
}
}  // namespace

// Components (n, 2) of offsets (n, 3) from the hole's axis with directions `tangent` (n, 3): towards the high side, which is north
// where the hole is vertical, and to the right of it looking down (manual: eq-conv-high-side).
extern "C" void high_side_offsets(int n, const double* tangent, const double* offset, double* out) {
    for (int i = 0; i < n; ++i) high_side_offset(tangent + 3 * i, offset + 3 * i, out + 2 * i);
}

// For tests: sines and cosines of n angles (a multiple of four), four side by side.
extern "C" void sines_of_packs(int n, const double* angle, double* sine, double* cosine) {
    using namespace dp;
    for (int i = 0; i < n; i += 4) {
        const Pack a(V4{angle[i], angle[i + 1], angle[i + 2], angle[i + 3]}), s = sin(a), c = cos(a);
        for (int l = 0; l < 4; ++l) { sine[i + l] = s.v[l]; cosine[i + l] = c.v[l]; }
    }
}
