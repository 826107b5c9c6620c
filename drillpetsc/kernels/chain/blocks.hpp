// Blocks of a chain in packed storage (chain.cpp): elimination of a pivot block, its solves and products.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "core/names.hpp"

namespace {

DP_ENUM(TableColumn, SIZE, LD, DIAG, UPPER, LOWER, LEFT, TOP, VEC, COLUMNS)
DP_ENUM(StatsEntry, FAILED_COLUMN, SMALLEST, LARGEST, SMALLEST_NODE, ENTRIES)

using d4 = double __attribute__((vector_size(32), aligned(8), may_alias));
using i4 = std::int64_t __attribute__((vector_size(32), aligned(8), may_alias));
using Row = const std::int64_t*;
constexpr int LARGEST_BLOCK = 32;  // unknowns per node, padded

inline d4 load(const double* p) { return *reinterpret_cast<const d4*>(p); }
inline void store4(double* p, d4 v) { *reinterpret_cast<d4*>(p) = v; }
inline d4 masked(d4 v, i4 m) { return reinterpret_cast<d4>(reinterpret_cast<i4>(v) & m); }
inline i4 rows_of(int v) { return i4{4 * v, 4 * v + 1, 4 * v + 2, 4 * v + 3}; }

// Row of the largest |entry| among the active rows: the row number replaces the last four (beyond 16 rows five) bits of the entry, and the
// largest 64-bit pattern wins (for positive doubles the order of the patterns is the order of the numbers; NaN is largest).
template <int V>
inline int largest_row(const d4* column, const i4* active) {
    constexpr std::int64_t NUMBER = V <= 4 ? 15 : 31;
    i4 best = {0, 0, 0, 0};
    for (int v = 0; v < V; v++) {
        const i4 rows = {4 * v, 4 * v + 1, 4 * v + 2, 4 * v + 3};
        const i4 key = ((reinterpret_cast<i4>(column[v]) & (0x7FFFFFFFFFFFFFFF - NUMBER)) | rows) & active[v];
        best = key > best ? key : best;
    }
    const std::int64_t a = best[0] > best[1] ? best[0] : best[1], b = best[2] > best[3] ? best[2] : best[3];
    return static_cast<int>((a > b ? a : b) & NUMBER);
}

// scale[k] = max |D(:, k)|
template <int V>
inline void column_scales(int b, const double* D, double* scale) {
    const i4 sign_off = i4{} + 0x7FFFFFFFFFFFFFFF;
    for (int k = 0; k < b; k++) {
        d4 m = masked(load(D + 4 * V * k), sign_off);
        for (int v = 1; v < V; v++) {
            const d4 c = masked(load(D + 4 * V * k + 4 * v), sign_off);
            m = c > m ? c : m;
        }
        const double p = m[0] > m[1] ? m[0] : m[1], q = m[2] > m[3] ? m[2] : m[3];
        scale[k] = p > q ? p : q;
    }
}

// D -> L and U with pivots, rows still in their own order; R (m columns) -> L^-1 P R on the way.  Returns -1, or the column without a usable pivot.
template <int V, int B>
int eliminate(int b_, double* D, double* R, int m, int* pivot, double* inverse, const double* scale, double tolerance, double* stats) {
    const int b = B ? B : b_;
    constexpr int ld = 4 * V;
    i4 active[V], number[V];
    for (int v = 0; v < V; v++) {
        number[v] = rows_of(v);
        active[v] = number[v] < b;
    }
    double smallest = stats[SMALLEST], largest = stats[LARGEST];
    d4 c[V], l[V];
    for (int v = 0; v < V; v++) c[v] = load(D + 4 * v);
    for (int k = 0; k < b; k++) {
        const int p = largest_row<V>(c, active);
        const double value = D[ld * k + p], size = std::fabs(value);
        if (!(size > tolerance * scale[k] && size < INFINITY)) return k;
        const double ratio = size / scale[k], r = 1 / value;  // scale 0 (a column of pure fill) gives inf: not counted
        smallest = ratio < smallest ? ratio : smallest;
        largest = ratio > largest && ratio < INFINITY ? ratio : largest;
        pivot[k] = p;
        inverse[k] = r;
        for (int v = 0; v < V; v++) {
            const d4 u = masked(c[v] * r, ~active[v]);  // rows that were pivots before
            active[v] &= number[v] != p;
            l[v] = masked(c[v] / value, active[v]);
            store4(D + ld * k + 4 * v, reinterpret_cast<d4>(reinterpret_cast<i4>(u) | reinterpret_cast<i4>(l[v])));
        }
        if (k + 1 < b) {  // the next pivot column stays in registers
            const double f = D[ld * (k + 1) + p];
            for (int v = 0; v < V; v++) c[v] = load(D + ld * (k + 1) + 4 * v) - l[v] * f;
            for (int v = 0; v < V; v++) store4(D + ld * (k + 1) + 4 * v, c[v]);
        }
        for (int j = k + 2; j < b; j++) {
            const double f = D[ld * j + p];
            for (int v = 0; v < V; v++) store4(D + ld * j + 4 * v, load(D + ld * j + 4 * v) - l[v] * f);
        }
        for (int j = 0; j < m; j++) {
            const double f = R[ld * j + p];
            for (int v = 0; v < V; v++) store4(R + ld * j + 4 * v, load(R + ld * j + 4 * v) - l[v] * f);
        }
    }
    stats[SMALLEST] = smallest;
    stats[LARGEST] = largest;
    return -1;
}

// X = U^-1 R, rows of U and R in the order of the pivots; R is destroyed.
template <int V>
inline void back_substitute(int b, const double* U, double* R, double* X, int m, const double* inverse) {
    constexpr int ld = 4 * V;
    for (int k = b - 1; k >= 0; k--) {
        const double r = inverse[k];
        d4 u[V];
        for (int v = 0; v < V; v++) u[v] = masked(load(U + ld * k + 4 * v), rows_of(v) < k);
        for (int j = 0; j < m; j++) {
            const double f = R[ld * j + k];
            for (int v = 0; v < V; v++) store4(R + ld * j + 4 * v, load(R + ld * j + 4 * v) - u[v] * f);
            X[ld * j + k] = f * r;
        }
    }
}

// The order of the pivots, for vectors of 4V rows; pivot (4V) has their own places in the rows of padding.
template <int V>
struct Order {
    i4 row[V];
    explicit Order(const int* pivot) {
        using Four = int __attribute__((vector_size(16), aligned(4), may_alias));
        for (int v = 0; v < V; v++) row[v] = __builtin_convertvector(*reinterpret_cast<const Four*>(pivot + 4 * v), i4);
    }
    void apply(d4* a) const {
        if constexpr (V == 1) {
            a[0] = __builtin_shuffle(a[0], row[0]);
        } else if constexpr (V == 2) {
            const d4 p = a[0], q = a[1];
            for (int v = 0; v < V; v++) a[v] = __builtin_shuffle(p, q, row[v]);
        } else if constexpr (V == 3) {
            const d4 p = a[0], q = a[1], r = a[2];
            for (int v = 0; v < V; v++) a[v] = row[v] < 8 ? __builtin_shuffle(p, q, row[v]) : __builtin_shuffle(r, row[v]);
        } else {
            double all[4 * V];
            for (int v = 0; v < V; v++) store4(all + 4 * v, a[v]);
            for (int i = 0; i < 4 * V; i++) a[i / 4][i % 4] = all[row[i / 4][i % 4]];
        }
    }
    // m columns, in place
    void apply(double* A, int m) const {
        for (int j = 0; j < m; j++, A += 4 * V) {
            d4 a[V];
            for (int v = 0; v < V; v++) a[v] = load(A + 4 * v);
            apply(a);
            for (int v = 0; v < V; v++) store4(A + 4 * v, a[v]);
        }
    }
};

// Entry k of a vector in all places.
template <int k>
inline d4 spread(const d4* y) {
    return __builtin_shufflevector(y[k / 4], y[k / 4], k % 4, k % 4, k % 4, k % 4);
}
// y -= f times rows below (above) k of column k of A; the other rows of the column belong to the other factor.
template <int V, int k>
inline void subtract_below(d4* y, const double* A, d4 f) {
    for (int v = k / 4; v < V; v++) {
        const d4 a = load(A + 4 * V * k + 4 * v);
        if (4 * v > k) y[v] -= a * f;
        else if (4 * v + 3 > k) y[v] -= masked(a, rows_of(v) > k) * f;
    }
}
template <int V, int k>
inline void subtract_above(d4* y, const double* A, d4 f) {
    for (int v = 0; v <= k / 4; v++) {
        const d4 a = load(A + 4 * V * k + 4 * v);
        if (4 * v + 3 < k) y[v] -= a * f;
        else if (4 * v < k) y[v] -= masked(a, rows_of(v) < k) * f;
    }
}
template <int V, int NC, int... k>
inline void solve_lower(d4 (*y)[V], const double* L, std::integer_sequence<int, k...>) {
    const auto step = [&](auto at) {
        for (int c = 0; c < NC; c++) subtract_below<V, at()>(y[c], L, spread<at()>(y[c]));
    };
    (step(std::integral_constant<int, k>{}), ...);
}
template <int V, int B, int NC, int... k>
inline void solve_upper(d4 (*y)[V], const double* U, double* x, const double* inverse, std::integer_sequence<int, k...>) {
    const auto step = [&](auto at) {
        for (int c = 0; c < NC; c++) {
            const d4 f = spread<at()>(y[c]);
            subtract_above<V, at()>(y[c], U, f);
            x[4 * V * c + at()] = f[0] * inverse[at()];
        }
    };
    (step(std::integral_constant<int, B - 1 - k>{}), ...);
}

// X = D^-1 X for NC columns whose rows are in their own order.
template <int V, int B, int NC>
inline void solve_columns(const Order<V>& order, const double* LU, double* X, const double* inverse) {
    d4 now[NC][V];
    for (int c = 0; c < NC; c++) {
        for (int v = 0; v < V; v++) now[c][v] = load(X + 4 * V * c + 4 * v);
        order.apply(now[c]);
    }
    solve_lower<V, NC>(now, LU, std::make_integer_sequence<int, B - 1>{});
    solve_upper<V, B, NC>(now, LU, X, inverse, std::make_integer_sequence<int, B>{});
}

// x = D^-1 y for one vector, y (4V) in the order of the pivots; y is destroyed.
template <int V, int B>
inline void solve_block(int b_, const double* LU, double* y, double* x, const double* inverse) {
    constexpr int ld = 4 * V;
    d4 one[1][V], (&now)[V] = one[0];
    for (int v = 0; v < V; v++) now[v] = load(y + 4 * v);
    if constexpr (B > 0) {
        solve_lower<V, 1>(one, LU, std::make_integer_sequence<int, B - 1>{});
        solve_upper<V, B, 1>(one, LU, x, inverse, std::make_integer_sequence<int, B>{});
    } else {
        const int b = b_;
        for (int k = 0; k < b - 1; k++) {
            const double f = y[k];
            for (int v = 0; v < V; v++) store4(y + 4 * v, now[v] -= masked(load(LU + ld * k + 4 * v), rows_of(v) > k) * f);
        }
        for (int k = b - 1; k >= 0; k--) {
            const double f = y[k];
            for (int v = 0; v < V; v++) store4(y + 4 * v, now[v] -= masked(load(LU + ld * k + 4 * v), rows_of(v) < k) * f);
            x[k] = f * inverse[k];
        }
    }
}

// NJ columns of C (-)= A B; K inner size.
template <int V, int NJ>
inline void strip(double* C, const double* A, const double* B, int ldb, int K, bool add) {
    constexpr int ld = 4 * V;
    d4 acc[NJ][V];
    for (int j = 0; j < NJ; j++)
        for (int v = 0; v < V; v++) acc[j][v] = add ? load(C + ld * j + 4 * v) : d4{0, 0, 0, 0};
    for (int k = 0; k < K; k++) {
        d4 a[V];
        for (int v = 0; v < V; v++) a[v] = load(A + ld * k + 4 * v);
        for (int j = 0; j < NJ; j++)
            for (int v = 0; v < V; v++) acc[j][v] -= a[v] * B[ldb * j + k];
    }
    for (int j = 0; j < NJ; j++)
        for (int v = 0; v < V; v++) store4(C + ld * j + 4 * v, acc[j][v]);
}

// C = [C] - A B:  C (4V, m), A (4V, K), B (ldb, m).
template <int V>
void subtract_product(double* C, const double* A, const double* B, int ldb, int K, int m, bool add) {
    constexpr int NJ = V <= 2 ? 4 : 2, ld = 4 * V;
    int j = 0;
    for (; j + NJ <= m; j += NJ) strip<V, NJ>(C + ld * j, A, B + ldb * j, ldb, K, add);
    if (NJ == 4 && j + 3 == m) return strip<V, 3>(C + ld * j, A, B + ldb * j, ldb, K, add);
    for (; j < m; j++) strip<V, 1>(C + ld * j, A, B + ldb * j, ldb, K, add);
}

// y -= A x, two chains of sums to hide the latency of the multiply-add.
template <int V>
inline void subtract_matvec(double* y, const double* A, const double* x, int K) {
    constexpr int ld = 4 * V;
    d4 even[V], odd[V];
    for (int v = 0; v < V; v++) even[v] = load(y + 4 * v), odd[v] = d4{0, 0, 0, 0};
    int k = 0;
    for (; k + 2 <= K; k += 2)
        for (int v = 0; v < V; v++) {
            even[v] -= load(A + ld * k + 4 * v) * x[k];
            odd[v] -= load(A + ld * (k + 1) + 4 * v) * x[k + 1];
        }
    if (k < K)
        for (int v = 0; v < V; v++) even[v] -= load(A + ld * k + 4 * v) * x[k];
    for (int v = 0; v < V; v++) store4(y + 4 * v, even[v] + odd[v]);
}

// Call f(V, B) with constants that fit a block: sizes 7, 8 (dry) and 11 (with mud) are fixed (B), else B = 0 and the size rounded up to vectors.
template <class F>
inline auto dispatch(std::int64_t size, F&& f) {
    using std::integral_constant;
    using Any = integral_constant<int, 0>;
    if (size == 7) return f(integral_constant<int, 2>{}, integral_constant<int, 7>{});
    if (size == 8) return f(integral_constant<int, 2>{}, integral_constant<int, 8>{});
    if (size == 11) return f(integral_constant<int, 3>{}, integral_constant<int, 11>{});
    switch ((size + 3) / 4) {
        case 1: return f(integral_constant<int, 1>{}, Any{});
        case 2: return f(integral_constant<int, 2>{}, Any{});
        case 3: return f(integral_constant<int, 3>{}, Any{});
        case 4: return f(integral_constant<int, 4>{}, Any{});
        case 5: return f(integral_constant<int, 5>{}, Any{});
        case 6: return f(integral_constant<int, 6>{}, Any{});
        case 7: return f(integral_constant<int, 7>{}, Any{});
        default: return f(integral_constant<int, 8>{}, Any{});
    }
}

// C (rows of node `c`) = [C] - A B, inner size K, m columns, B with columns of length ldb.
inline void subtract(Row c, double* C, const double* A, const double* B, Row inner, std::int64_t m, bool add = true) {
    const int K = inner[SIZE], ldb = inner[LD];
    switch (c[LD] / 4) {
        case 1: return subtract_product<1>(C, A, B, ldb, K, m, add);
        case 2: return subtract_product<2>(C, A, B, ldb, K, m, add);
        case 3: return subtract_product<3>(C, A, B, ldb, K, m, add);
        case 4: return subtract_product<4>(C, A, B, ldb, K, m, add);
        case 5: return subtract_product<5>(C, A, B, ldb, K, m, add);
        case 6: return subtract_product<6>(C, A, B, ldb, K, m, add);
        case 7: return subtract_product<7>(C, A, B, ldb, K, m, add);
        default: return subtract_product<8>(C, A, B, ldb, K, m, add);
    }
}

// y (node `row`) -= A x (node `column`)
inline void subtract_vector(Row row, double* y, const double* A, Row column, const double* x) {
    const int K = column[SIZE];
    switch (row[LD] / 4) {
        case 1: return subtract_matvec<1>(y, A, x, K);
        case 2: return subtract_matvec<2>(y, A, x, K);
        case 3: return subtract_matvec<3>(y, A, x, K);
        case 4: return subtract_matvec<4>(y, A, x, K);
        case 5: return subtract_matvec<5>(y, A, x, K);
        case 6: return subtract_matvec<6>(y, A, x, K);
        case 7: return subtract_matvec<7>(y, A, x, K);
        default: return subtract_matvec<8>(y, A, x, K);
    }
}

// Eliminate node t, whose pivot block D becomes L and U, with the m1 columns of `right` and the m2 columns of `left` as right-hand sides
// (either may be null); lower: `count` columns of A(i,i-1), whose rows are put into the order of the pivots.
int eliminate_node(Row t, double* D, double* right, int m1, double* left, int m2, double* lower, int count, double* inverse, int* pivot,
                   const double* scale, double tolerance, double* stats) {
    return dispatch(t[SIZE], [&](auto V, auto B) {
        const int b = t[SIZE], ld = t[LD];
        double* r = inverse + t[VEC];
        int* p = pivot + t[VEC];
        if constexpr (B() > 0) {
            const int bad = eliminate<V(), B()>(b, D, nullptr, 0, p, r, scale, tolerance, stats);
            if (bad >= 0) return bad;
            const Order<V()> order(p);
            order.apply(D, b);
            order.apply(lower, count);
            const auto solve = [&](double* X, int m) {
                constexpr int NC = V() <= 2 ? 4 : 2;
                int j = 0;
                for (; j + NC <= m; j += NC) solve_columns<V(), B(), NC>(order, D, X + ld * j, r);
                if (NC == 4 && j + 3 == m) return solve_columns<V(), B(), 3>(order, D, X + ld * j, r);
                for (; j < m; j++) solve_columns<V(), B(), 1>(order, D, X + ld * j, r);
            };
            if (m1) solve(right, m1);
            if (m2) solve(left, m2);
        } else {
            alignas(64) double work[2 * LARGEST_BLOCK * LARGEST_BLOCK];
            if (m1) std::memcpy(work, right, sizeof(double) * ld * m1);
            if (m2) std::memcpy(work + ld * m1, left, sizeof(double) * ld * m2);
            const int bad = eliminate<V(), B()>(b, D, work, m1 + m2, p, r, scale, tolerance, stats);
            if (bad >= 0) return bad;
            const Order<V()> order(p);
            order.apply(D, b);
            order.apply(work, m1 + m2);
            order.apply(lower, count);
            if (m1) back_substitute<V()>(b, D, work, right, m1, r);
            if (m2) back_substitute<V()>(b, D, work + ld * m1, left, m2, r);
        }
        return -1;
    });
}

inline void scales(Row t, const double* D, double* scale) {
    dispatch(t[SIZE], [&](auto V, auto) { column_scales<V()>(t[SIZE], D, scale); });
}

// x = D^-1 (x - A(i,i-1) x_(i-1)) of an eliminated node; before: the node before it and its vector, null without one.
inline void solve_node(Row t, const double* store, double* x, Row before, const double* x_before, const double* inverse, const int* pivot) {
    dispatch(t[SIZE], [&](auto V, auto B) {
        alignas(32) double y[4 * V()];
        const int b = B() ? B() : static_cast<int>(t[SIZE]);
        d4 ordered[V()];
        for (int v = 0; v < V(); v++) ordered[v] = load(x + 4 * v);
        Order<V()>(pivot + t[VEC]).apply(ordered);
        for (int v = 0; v < V(); v++) store4(y + 4 * v, ordered[v]);
        if (before) subtract_matvec<V()>(y, store + t[LOWER], x_before, before[SIZE]);
        solve_block<V(), B()>(b, store + t[DIAG], y, x, inverse + t[VEC]);
    });
}

}  // namespace
