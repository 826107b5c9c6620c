// Block tridiagonal LU of one piece of a chain (block Thomas, partial pivoting inside the pivot block).
//
// Storage.  A block (i, j) of b_i rows and b_j columns is column-major, each column padded with zeros to ld_i = 4 ceil(b_i / 4)
// doubles, so that a column is V = ld_i / 4 vectors of 4 and every inner loop runs over whole vectors.  Rows are not moved during an
// elimination: the pivot row of step k is remembered (pivot[k]) and a lane mask says which rows are still active.  After a factorisation of
// D = P^T L U the columns of L (unit diagonal left out) and of U (each divided by its pivot, which is left out) stand in two blocks, row k
// being the pivot row of step k; so do the rows of A(i,i-1).  A solve then takes step k's number from a place that is known when compiled.
//
// table: (n, COLUMNS) int64, one line per node of the piece, offsets into `store` [doubles].
//   SIZE b_i;  LD;  DIAG A(i,i) -> U;  UPPER A(i,i+1) -> W_i = D_i^-1 A(i,i+1);  LOWER A(i,i-1);  LFAC L of D_i (these four in a row);
//   LEFT  fill F_i = coupling of node i to node 0 -> V_i = D_i^-1 F_i    (only pieces that keep node 0)
//   TOP   fill G_i = coupling of node 0 to node i                        (only pieces that keep node 0)
//   VEC   offset of the node in a padded vector; also in `inverse` and `pivot`, which has the numbers of the rows in the padding.
// keep: bit 0 node 0 is not eliminated, bit 1 the last node is not eliminated.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <type_traits>
#include <vector>

#include "core/names.hpp"

namespace {

DP_ENUM(TableColumn, SIZE, LD, DIAG, UPPER, LOWER, LFAC, LEFT, TOP, VEC, COLUMNS)
DP_ENUM(StatsEntry, FAILED_COLUMN, SMALLEST, LARGEST, SMALLEST_NODE, ENTRIES)

using d4 = double __attribute__((vector_size(32), aligned(8), may_alias));
using i4 = std::int64_t __attribute__((vector_size(32), aligned(8), may_alias));
using Row = const std::int64_t*;
constexpr int LARGEST_BLOCK = 32;  // unknowns per node, padded

inline d4 load(const double* p) { return *reinterpret_cast<const d4*>(p); }
inline void store4(double* p, d4 v) { *reinterpret_cast<d4*>(p) = v; }
inline d4 masked(d4 v, i4 m) { return reinterpret_cast<d4>(reinterpret_cast<i4>(v) & m); }

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

// D -> L, U with pivots; R (m columns) -> L^-1 P R on the way.  Returns -1, or the column without a usable pivot.
template <int V, int B>
int eliminate(int b_, double* D, double* L, double* R, int m, int* pivot, double* inverse, const double* scale,
              double tolerance, double* stats) {
    const int b = B ? B : b_;
    constexpr int ld = 4 * V;
    i4 active[V], number[V];
    for (int v = 0; v < V; v++) {
        number[v] = i4{4 * v, 4 * v + 1, 4 * v + 2, 4 * v + 3};
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
            store4(D + ld * k + 4 * v, masked(c[v] * r, ~active[v]));  // U: rows that were pivots before
            active[v] &= number[v] != p;
            l[v] = masked(c[v] / value, active[v]);
            store4(L + ld * k + 4 * v, l[v]);
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

// X = U^-1 R, rows of X in natural order; R is destroyed.
template <int V, int B>
inline void back_substitute(int b_, const double* U, double* R, double* X, int m, const int* pivot, const double* inverse) {
    const int b = B ? B : b_;
    constexpr int ld = 4 * V;
    for (int k = b - 1; k >= 0; k--) {
        const int p = pivot[k];
        const double r = inverse[k];
        d4 u[V];
        for (int v = 0; v < V; v++) u[v] = load(U + ld * k + 4 * v);
        for (int j = 0; j < m; j++) {
            const double f = R[ld * j + p];
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
template <int V, int k>
inline void subtract_column(d4* y, const double* A, d4 f) {
    for (int v = 0; v < V; v++) y[v] -= load(A + 4 * V * k + 4 * v) * f;
}
template <int V, int NC, int... k>
inline void solve_lower(d4 (*y)[V], const double* L, std::integer_sequence<int, k...>) {
    const auto step = [&](auto at) {
        for (int c = 0; c < NC; c++) subtract_column<V, at()>(y[c], L, spread<at()>(y[c]));
    };
    (step(std::integral_constant<int, k>{}), ...);
}
template <int V, int B, int NC, int... k>
inline void solve_upper(d4 (*y)[V], const double* U, double* x, const double* inverse, std::integer_sequence<int, k...>) {
    const auto step = [&](auto at) {
        for (int c = 0; c < NC; c++) {
            const d4 f = spread<at()>(y[c]);
            subtract_column<V, at()>(y[c], U, f);
            x[4 * V * c + at()] = f[0] * inverse[at()];
        }
    };
    (step(std::integral_constant<int, B - 1 - k>{}), ...);
}

// X = D^-1 X for NC columns whose rows are in their own order.
template <int V, int B, int NC>
inline void solve_columns(const Order<V>& order, const double* U, const double* L, double* X, const double* inverse) {
    d4 now[NC][V];
    for (int c = 0; c < NC; c++) {
        for (int v = 0; v < V; v++) now[c][v] = load(X + 4 * V * c + 4 * v);
        order.apply(now[c]);
    }
    solve_lower<V, NC>(now, L, std::make_integer_sequence<int, B - 1>{});
    solve_upper<V, B, NC>(now, U, X, inverse, std::make_integer_sequence<int, B>{});
}

// x = D^-1 y for one vector, y (4V) in the order of the pivots; y is destroyed.
template <int V, int B>
inline void solve_block(int b_, const double* U, const double* L, double* y, double* x, const double* inverse) {
    constexpr int ld = 4 * V;
    d4 one[1][V], (&now)[V] = one[0];
    for (int v = 0; v < V; v++) now[v] = load(y + 4 * v);
    if constexpr (B > 0) {
        solve_lower<V, 1>(one, L, std::make_integer_sequence<int, B - 1>{});
        solve_upper<V, B, 1>(one, U, x, inverse, std::make_integer_sequence<int, B>{});
    } else {
        const int b = b_;
        for (int k = 0; k < b - 1; k++) {
            const double f = y[k];
            for (int v = 0; v < V; v++) store4(y + 4 * v, now[v] -= load(L + ld * k + 4 * v) * f);
        }
        for (int k = b - 1; k >= 0; k--) {
            const double f = y[k];
            for (int v = 0; v < V; v++) store4(y + 4 * v, now[v] -= load(U + ld * k + 4 * v) * f);
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

// Eliminate node t, with the m1 columns of `right` and the m2 columns of `left` as right-hand sides (either may be null); lower: columns of
// A(i,i-1), whose rows are put into the order of the pivots.
int eliminate_node(Row t, double* store, double* right, int m1, double* left, int m2, int lower, double* inverse, int* pivot,
                   const double* scale, double tolerance, double* stats) {
    return dispatch(t[SIZE], [&](auto V, auto B) {
        const int b = t[SIZE], ld = t[LD];
        double *D = store + t[DIAG], *L = store + t[LFAC], *r = inverse + t[VEC];
        int* p = pivot + t[VEC];
        const auto put_in_order = [&] {
            const Order<V()> order(p);
            order.apply(D, b);
            order.apply(L, b);
            order.apply(store + t[LOWER], lower);
            return order;
        };
        if constexpr (B() > 0) {
            const int bad = eliminate<V(), B()>(b, D, L, nullptr, 0, p, r, scale, tolerance, stats);
            if (bad >= 0) return bad;
            const Order<V()> order = put_in_order();
            const auto solve = [&](double* X, int m) {
                constexpr int NC = V() <= 2 ? 4 : 2;
                int j = 0;
                for (; j + NC <= m; j += NC) solve_columns<V(), B(), NC>(order, D, L, X + ld * j, r);
                if (NC == 4 && j + 3 == m) return solve_columns<V(), B(), 3>(order, D, L, X + ld * j, r);
                for (; j < m; j++) solve_columns<V(), B(), 1>(order, D, L, X + ld * j, r);
            };
            if (m1) solve(right, m1);
            if (m2) solve(left, m2);
        } else {
            alignas(64) double work[2 * LARGEST_BLOCK * LARGEST_BLOCK];
            if (m1) std::memcpy(work, right, sizeof(double) * ld * m1);
            if (m2) std::memcpy(work + ld * m1, left, sizeof(double) * ld * m2);
            const int bad = eliminate<V(), B()>(b, D, L, work, m1 + m2, p, r, scale, tolerance, stats);
            if (bad >= 0) return bad;
            if (m1) back_substitute<V(), B()>(b, D, work, right, m1, p, r);
            if (m2) back_substitute<V(), B()>(b, D, work + ld * m1, left, m2, p, r);
            put_in_order();
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
        solve_block<V(), B()>(b, store + t[DIAG], store + t[LFAC], y, x, inverse + t[VEC]);
    });
}

// Number of negative eigenvalues of the symmetric matrix S (b, b), column-major with columns of length b; S is destroyed.
// LDL^T with complete pivoting (Bunch and Parlett 1971, SIAM J. Numer. Anal. 8(4):639-655): the signs of D are those of the
// eigenvalues (Sylvester), and entries of L stay below 2.781.
int negative_eigenvalues(int b, double* S) {
    const double alpha = (1 + std::sqrt(17.0)) / 8;
    const auto at = [&](int i, int j) -> double& { return S[b * j + i]; };
    int count = 0;
    for (int k = 0; k < b;) {
        int d = k, p = k, q = k;  // largest diagonal entry, largest entry off the diagonal
        double diagonal = -1, off = -1;
        for (int j = k; j < b; j++) {
            if (std::fabs(at(j, j)) > diagonal) diagonal = std::fabs(at(j, j)), d = j;
            for (int i = j + 1; i < b; i++)
                if (std::fabs(at(i, j)) > off) off = std::fabs(at(i, j)), p = j, q = i;
        }
        if (!(diagonal > 0) && !(off > 0)) break;  // what is left is zero
        const auto exchange = [&](int i, int j) {
            if (i == j) return;
            for (int m = 0; m < b; m++) std::swap(at(m, i), at(m, j));
            for (int m = 0; m < b; m++) std::swap(at(i, m), at(j, m));
        };
        if (diagonal >= alpha * off) {
            exchange(k, d);
            const double pivot = at(k, k);
            count += pivot < 0;
            for (int j = k + 1; j < b; j++) {
                const double l = at(j, k) / pivot;
                for (int i = j; i < b; i++) at(i, j) -= at(i, k) * l;
            }
            for (int j = k + 1; j < b; j++)
                for (int i = k + 1; i < j; i++) at(i, j) = at(j, i);
            k += 1;
        } else {
            exchange(k, p);
            exchange(k + 1, q);
            const double e = at(k, k), f = at(k + 1, k + 1), g = at(k + 1, k), det = e * f - g * g;
            count += det < 0 ? 1 : e < 0 ? 2 : 0;
            for (int j = k + 2; j < b; j++) {
                const double u = at(j, k), v = at(j, k + 1);
                const double lu = (f * u - g * v) / det, lv = (e * v - g * u) / det;
                for (int i = j; i < b; i++) at(i, j) -= at(i, k) * lu + at(i, k + 1) * lv;
            }
            for (int j = k + 2; j < b; j++)
                for (int i = k + 2; i < j; i++) at(i, j) = at(j, i);
            k += 2;
        }
    }
    return count;
}

// A tile of a run: four neighbouring entries of up to four rows of an element matrix (by rows) are added to four columns of blocks (by
// columns).  tile: places of the rows' first entries in the run, -1 from the first row that is missing on; places in the blocks of the
// columns' first entries, -1 where another tile adds the column.  Missing rows add zero.
constexpr int TILE = 8;

inline void add_tile(const int* tile, const double* v, double* to) {
    const d4 zero = {0, 0, 0, 0};
    const d4 a = load(v + tile[0]), b = tile[1] < 0 ? zero : load(v + tile[1]), c = tile[2] < 0 ? zero : load(v + tile[2]),
             d = tile[3] < 0 ? zero : load(v + tile[3]);
    // transposed by shuffles: number by number it would be read again from memory
    const d4 p = __builtin_shufflevector(a, b, 0, 4, 2, 6), q = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    const d4 r = __builtin_shufflevector(c, d, 0, 4, 2, 6), s = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    const d4 columns[4] = {__builtin_shufflevector(p, r, 0, 1, 4, 5), __builtin_shufflevector(q, s, 0, 1, 4, 5),
                           __builtin_shufflevector(p, r, 2, 3, 6, 7), __builtin_shufflevector(q, s, 2, 3, 6, 7)};
    for (int j = 0; j < 4; j++)
        if (tile[4 + j] >= 0) store4(to + tile[4 + j], load(to + tile[4 + j]) + columns[j]);
}

// Tiles of a pattern whose run is a matrix of rows of `width` entries, slot of (i, j) = slots[i width] + slots[j] - slots[0]; returns
// their number, -1 where it is no such matrix.  tiles: null, or receives them.
int tiles_of_width(int count, const int* slots, int width, int* tiles) {
    const int rows = count / width;
    for (int i = 1; i < rows; i++)
        for (int j = 1; j < width; j++)
            if (slots[i * width + j] - slots[i * width] != slots[j] - slots[0]) return -1;
    std::vector<std::pair<int, int>> order;  // place in the blocks and number of each row
    for (int i = 0; i < rows; i++) order.push_back({slots[i * width], i});
    std::sort(order.begin(), order.end());
    int found = 0;
    for (int i = 0, n; i < rows; i += n) {
        for (n = 1; n < 4 && i + n < rows && order[i + n].first == order[i].first + n;) n++;
        for (int j = 0; j < width; j += 4, found++) {
            if (!tiles) continue;
            int* tile = tiles + TILE * found;
            const int from = j + 4 <= width ? j : width - 4;  // the last columns: the tile overlaps the one before
            for (int k = 0; k < 4; k++) {
                tile[k] = k < n ? order[i + k].second * width + from : -1;
                tile[4 + k] = from + k < j ? -1 : order[i].first + slots[from + k] - slots[0];
            }
        }
    }
    return found;
}

}  // namespace

DP_EXPORT(chain_table, TableColumnText)
DP_EXPORT(chain_stats, StatsEntryText)
DP_CONSTANT(largest_block, LARGEST_BLOCK)
DP_CONSTANT(tile, TILE)

extern "C" {

// target[index[k]] += values[k]; index < 0 is left out.
void chain_scatter_add(int n, const int* index, const double* values, double* target) {
    for (int k = 0; k < n; k++)
        if (index[k] >= 0) target[index[k]] += values[k];
}

// Assemble and eliminate, a node at a time so that its blocks stay in the cache.  Run r of a node adds the entries from
// values[first[r]] on to the node's blocks, which begin at store[DIAG], by the tiles and single entries of its pattern (chain_tiles);
// start (n+1): where each node's runs begin.  saved: null, or receives the assembled blocks; blocks: null, or receives the pivot blocks S_i = A(i,i) - A(i,i-1) S_(i-1)^-1 A(i-1,i) before their LU,
// one after the other.
// tolerance: a pivot must exceed tolerance x the largest entry of its column of A(i,i).  Returns -1 or the node without a pivot
// (stats[FAILED_COLUMN]: its column).
// from: above 0 (not with a kept node 0, `saved` or `blocks`) the nodes before it keep the factors of the last call: their entries and
// those that couple them to node `from` must not have changed but in node `from` itself.  The same operations follow as in a whole
// elimination, so the factors are those to the last bit.
int chain_factor(int from, int n, int keep, const std::int64_t* table, double* store, const int* start, const int* first_entry,
                 const int* pattern, const int* tile_begin, const int* tiles, const int* single_begin, const int* singles,
                 const double* values, double* inverse, int* pivot, double tolerance, double* stats, double* saved, double* blocks) {
    int assembled = from;
    const auto assemble_up_to = [&](int node) {
        for (; assembled <= node && assembled < n; assembled++) {
            const Row t = table + assembled * COLUMNS;
            const std::size_t bytes = sizeof(double) * (t[LFAC] - t[DIAG]);
            std::memset(store + t[DIAG], 0, bytes);
            double* to = store + t[DIAG];
            for (int r = start[assembled]; r < start[assembled + 1]; r++) {
                const double* v = values + first_entry[r];
                const int p = pattern[r];
                for (const int *tile = tiles + TILE * tile_begin[p], *end = tiles + TILE * tile_begin[p + 1]; tile < end; tile += TILE)
                    add_tile(tile, v, to);
                for (const int *one = singles + 2 * single_begin[p], *end = singles + 2 * single_begin[p + 1]; one < end; one += 2)
                    to[one[1]] += v[one[0]];
            }
            if (saved) std::memcpy(saved + t[DIAG], store + t[DIAG], bytes);
        }
    };
    stats[FAILED_COLUMN] = -1;
    if (from == 0) stats[SMALLEST] = INFINITY, stats[LARGEST] = 0, stats[SMALLEST_NODE] = -1;
    const int first = keep & 1 ? 1 : 0, last = keep & 2 ? n - 1 : n, begin_at = from > first ? from : first;
    const Row top = table;
    double scale[LARGEST_BLOCK];
    assemble_up_to(begin_at);
    if (begin_at < last) scales(table + begin_at * COLUMNS, store + table[begin_at * COLUMNS + DIAG], scale);
    if (from > 0) {
        const Row t = table + from * COLUMNS, above = t - COLUMNS;
        subtract(t, store + t[DIAG], store + t[LOWER], store + above[UPPER], above, t[SIZE]);
    }
    for (int i = begin_at; i < last; i++) {
        const Row t = table + i * COLUMNS, next = i + 1 < n ? t + COLUMNS : nullptr;
        const double smallest = stats[SMALLEST];
        assemble_up_to(i + 1);
        double* W = next ? store + t[UPPER] : nullptr;
        double* fill = first ? store + t[LEFT] : nullptr;
        if (blocks) {
            std::memcpy(blocks, store + t[DIAG], sizeof(double) * t[LD] * t[SIZE]);
            blocks += t[LD] * t[SIZE];
        }
        const int bad = eliminate_node(t, store, W, next ? next[SIZE] : 0, fill, first ? top[SIZE] : 0, i > first ? (t - COLUMNS)[SIZE] : 0,
                                       inverse, pivot, scale, tolerance, stats);
        if (bad >= 0) {
            stats[FAILED_COLUMN] = bad;
            return i;
        }
        if (stats[SMALLEST] < smallest) stats[SMALLEST_NODE] = i;
        if (next) {
            double *D = store + next[DIAG], *lower = store + next[LOWER];
            if (i + 1 < last) scales(next, D, scale);
            subtract(next, D, lower, W, t, next[SIZE]);
            if (first) {
                const double* G = store + t[TOP];
                subtract(next, store + next[LEFT], lower, fill, t, top[SIZE], false);
                subtract(top, store + next[TOP], G, W, t, next[SIZE], false);
                subtract(top, store + top[DIAG], G, fill, t, top[SIZE]);
            }
        }
    }
    assemble_up_to(n - 1);
    return -1;
}

// Runs of matrix entries for chain_factor: entries that follow each other in `values` and have their rows at one node.  Where they go,
// relative to the node's first block, is the same for many runs (all elements of one kind between nodes of one size), so a run is the
// number of its first entry and that of a pattern.
//
// rows, columns: (m) unknowns of each entry, negative where it is left out; source: (m) its place in `values`, null for 0 to m - 1;
// node, component: of each unknown.

// start (n + 1): where the runs of each node begin.  Returns -1, or the entry that couples nodes that are no neighbours.
int chain_count_runs(int m, const int* rows, const int* columns, const int* source, const int* node, int n, int* start) {
    for (int i = 0; i <= n; i++) start[i] = 0;
    for (int k = 0, last = -1; k < m; k++) {
        const int i = rows[k] < 0 || columns[k] < 0 ? -1 : node[rows[k]];
        if (i >= 0) {
            const int step = node[columns[k]] - i;
            if (step < -1 || step > 1) return k;
            if (i != last || (source && source[k] != source[k - 1] + 1)) start[i + 1]++;
        }
        last = i;
    }
    for (int i = 0; i < n; i++) start[i + 1] += start[i];
    return -1;
}

// The runs in the order of their nodes, those of a node as they come: first entry and pattern of each, slots of pattern p from begin[p]
// to begin[p + 1].  Returns the number of patterns, -1 where `capacity` slots are too few.
int chain_runs(int m, const int* rows, const int* columns, const int* source, const int* node, const int* component, int n,
               const std::int64_t* table, int* start, int* first_entry, int* pattern, int capacity, int* begin, int* slots) {
    std::unordered_map<std::uint64_t, std::vector<int>> known;  // patterns by a digest of their slots
    int patterns = 0;
    begin[0] = 0;
    for (int k = 0; k < m;) {
        if (rows[k] < 0 || columns[k] < 0) {
            k++;
            continue;
        }
        const int i = node[rows[k]], from = k, at = begin[patterns];
        const Row t = table + i * COLUMNS;
        int count = 0;
        std::uint64_t digest = 1469598103934665603ull;
        for (; k < m && rows[k] >= 0 && columns[k] >= 0 && node[rows[k]] == i && (k == from || !source || source[k] == source[k - 1] + 1); k++) {
            if (at + count >= capacity) return -1;
            const int j = node[columns[k]];
            const std::int64_t block = t[j < i ? LOWER : j > i ? UPPER : DIAG] - t[DIAG];
            const int slot = static_cast<int>(block + component[columns[k]] * t[LD] + component[rows[k]]);
            slots[at + count++] = slot;
            digest = (digest ^ static_cast<std::uint64_t>(slot)) * 1099511628211ull;
        }
        int found = -1;
        for (int p : known[digest])
            if (begin[p + 1] - begin[p] == count && !std::memcmp(slots + begin[p], slots + at, sizeof(int) * count)) found = p;
        if (found < 0) {
            known[digest].push_back(found = patterns++);
            begin[patterns] = at + count;
        }
        const int r = start[i]++;
        first_entry[r] = source ? source[from] : from;
        pattern[r] = found;
    }
    for (int i = n; i > 0; i--) start[i] = start[i - 1];
    start[0] = 0;
    return patterns;
}

// Tiles of the patterns of chain_runs, TILE numbers each, those of pattern p from tile_begin[p] to tile_begin[p + 1]; the entries of
// patterns that are not made of matrices are single: (place in the run, slot).  Both are no more than there are slots.  Where a slot comes
// again, another matrix begins: two neighbouring elements have rows at one node.  Sums keep their order.
void chain_tiles(int patterns, const int* begin, const int* slots, int* tile_begin, int* tiles, int* single_begin, int* singles) {
    tile_begin[0] = single_begin[0] = 0;
    for (int p = 0; p < patterns; p++) {
        const int count = begin[p + 1] - begin[p], *own = slots + begin[p];
        int made = 0;
        for (int from = 0, to; from < count && made >= 0; from = to) {
            std::unordered_set<int> seen;
            for (to = from; to < count && seen.insert(own[to]).second;) to++;
            int best = -1, least = to - from;  // a tile of a single entry is none
            for (int width = 4; width <= to - from; width++) {
                const int found = (to - from) % width ? -1 : tiles_of_width(to - from, own + from, width, nullptr);
                if (found >= 0 && found < least) least = found, best = width;
            }
            int* tile = tiles + TILE * (tile_begin[p] + made);
            made = best < 0 ? -1 : made + tiles_of_width(to - from, own + from, best, tile);
            for (; best >= 0 && tile < tiles + TILE * (tile_begin[p] + made); tile += TILE)
                for (int k = 0; k < 4; k++)
                    if (tile[k] >= 0) tile[k] += from;
        }
        tile_begin[p + 1] = tile_begin[p] + (made < 0 ? 0 : made);
        single_begin[p + 1] = single_begin[p] + (made < 0 ? count : 0);
        for (int k = 0; made < 0 && k < count; k++) singles[2 * (single_begin[p] + k)] = k, singles[2 * (single_begin[p] + k) + 1] = own[k];
    }
}

// Number of negative eigenvalues of the symmetric parts of the pivot blocks `blocks` of the eliminated nodes.
int chain_negative(int n, int keep, const std::int64_t* table, const double* blocks) {
    const int first = keep & 1 ? 1 : 0, last = keep & 2 ? n - 1 : n;
    double S[LARGEST_BLOCK * LARGEST_BLOCK], scale[LARGEST_BLOCK];
    int count = 0;
    for (int i = first; i < last; i++) {
        const Row t = table + i * COLUMNS;
        const int b = t[SIZE], ld = t[LD];
        const double* D = blocks;
        blocks += ld * b;
        for (int k = 0; k < b; k++) {
            double size = 0;
            for (int m = 0; m < b; m++) size = std::fmax(size, std::fabs(D[ld * k + m] + D[ld * m + k]));
            // scaling both sides is a congruence, which preserves the signs of the eigenvalues
            scale[k] = size > 0 && size < INFINITY ? std::exp2(-std::round(0.5 * std::log2(size))) : 1.0;
        }
        for (int k = 0; k < b; k++)
            for (int m = 0; m < b; m++) S[b * k + m] = scale[k] * scale[m] * (D[ld * k + m] + D[ld * m + k]);
        count += negative_eigenvalues(b, S);
    }
    return count;
}

// vec[k] = b[index[k]], 0 where index < 0.
void chain_gather(int n, const int* index, const double* b, double* vec) {
    for (int k = 0; k < n; k++) vec[k] = index[k] >= 0 ? b[index[k]] : 0.0;
}

// x[index[k]] = vec[k]; index < 0 is left out.
void chain_scatter(int n, const int* index, const double* vec, double* x) {
    for (int k = 0; k < n; k++)
        if (index[k] >= 0) x[index[k]] = vec[k];
}

// Forward sweep in place on a padded vector: eliminated nodes get D_i^-1 (...), kept nodes their reduced right-hand side.
void chain_forward(int n, int keep, const std::int64_t* table, const double* store, const double* inverse, const int* pivot,
                   double* vec) {
    const int first = keep & 1 ? 1 : 0, last = keep & 2 ? n - 1 : n;
    for (int i = first; i < n; i++) {
        const Row t = table + i * COLUMNS, previous = t - COLUMNS;
        double* y = vec + t[VEC];
        if (i == last) {  // a kept node: rows of A(i,i-1) in their own order
            if (i > first) subtract_vector(t, y, store + t[LOWER], previous, vec + previous[VEC]);
            break;
        }
        solve_node(t, store, y, i > first ? previous : nullptr, i > first ? vec + previous[VEC] : nullptr, inverse, pivot);
        if (first) subtract_vector(table, vec + table[VEC], store + t[TOP], t, y);
    }
}

// Backward sweep: x_i = y_i - W_i x_(i+1) - V_i x_0; kept nodes hold their solution already.
void chain_backward(int n, int keep, const std::int64_t* table, const double* store, double* vec) {
    const int first = keep & 1 ? 1 : 0, last = keep & 2 ? n - 1 : n;
    for (int i = last - 1; i >= first; i--) {
        const Row t = table + i * COLUMNS, next = t + COLUMNS;
        if (i + 1 < n) subtract_vector(t, vec + t[VEC], store + t[UPPER], next, vec + next[VEC]);
        if (first) subtract_vector(t, vec + t[VEC], store + t[LEFT], table, vec + table[VEC]);
    }
}

// All at once for a piece without joints: x = A^-1 b, with source and target as in chain_gather and chain_scatter.
void chain_solve(int n, const std::int64_t* table, const double* store, const double* inverse, const int* pivot, int length,
                 const int* source, const double* b, double* vec, const int* target, double* x) {
    chain_gather(length, source, b, vec);
    chain_forward(n, 0, table, store, inverse, pivot, vec);
    chain_backward(n, 0, table, store, vec);
    chain_scatter(length, target, vec, x);
}

// r -= A x with the assembled blocks kept by chain_factor.
void chain_residual(int n, const std::int64_t* table, const double* saved, const double* x, double* r) {
    for (int i = 0; i < n; i++) {
        const Row t = table + i * COLUMNS, next = t + COLUMNS, previous = t - COLUMNS;
        subtract_vector(t, r + t[VEC], saved + t[DIAG], t, x + t[VEC]);
        if (i > 0) subtract_vector(t, r + t[VEC], saved + t[LOWER], previous, x + previous[VEC]);
        if (i + 1 < n) subtract_vector(t, r + t[VEC], saved + t[UPPER], next, x + next[VEC]);
    }
}
}
