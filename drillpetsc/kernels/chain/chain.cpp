// Block tridiagonal LU of one piece of a chain (block Thomas, partial pivoting inside the pivot block).
//
// Storage.  A block (i, j) of b_i rows and b_j columns is column-major, each column padded with zeros to ld_i = 4 ceil(b_i / 4)
// doubles, so that a column is V = ld_i / 4 vectors of 4 and every inner loop runs over whole vectors.  Rows are not moved during an
// elimination: the pivot row of step k is remembered (pivot[k]) and a lane mask says which rows are still active.  After a factorisation of
// D = P^T L U one block has the columns of L (unit diagonal left out) below and of U (each divided by its pivot, which is left out) above a
// zero diagonal, row k being the pivot row of step k; so are the rows of A(i,i-1).  A solve then takes step k's number from a place that is
// known when compiled.
//
// A node is assembled and eliminated in a work array that stays in the cache.  `store` gets what sweeps read, in two runs, because they wait
// for memory in long chains: L, U and A(i,i-1) of all nodes for the forward sweep, then W of all nodes for the backward sweep.
//
// table: (n, COLUMNS) int64, one line per node of the piece, offsets into `store` [doubles].
//   SIZE b_i;  LD;  DIAG A(i,i) -> L, U;  UPPER A(i,i+1) -> W_i = D_i^-1 A(i,i+1);  LOWER A(i,i-1), after DIAG;
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

#include "chain/blocks.hpp"

namespace {

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
// ahead: how far from there the entries are that are fetched for later tiles.
constexpr int TILE = 8;

// In long chains the matrix and its factors are read from memory: what is needed AHEAD doubles later, about a node of 11 unknowns, is fetched in
// time.  Addresses beyond the end of an array do no harm.
constexpr int AHEAD = 512;

inline void fetch(const double* from, std::int64_t count) {
    for (std::int64_t k = 0; k < count; k += 8) __builtin_prefetch(from + k);
}

inline void add_tile(const int* tile, const double* v, double* to, int ahead) {
    for (int k = 0; k < 4; k++) __builtin_prefetch(v + tile[k] + ahead);
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

// Blocks of a node in the work array, one after the other: D = A(i,i), A(i,i+1) and A(i,i-1).
struct Node {
    Row t;
    double* D;
    int after, before;  // unknowns of the neighbours
    Node(const std::int64_t* table, int n, int i, double* work)
        : t(table + i * COLUMNS), D(work), after(i + 1 < n ? (t + COLUMNS)[SIZE] : 0), before(i > 0 ? (t - COLUMNS)[SIZE] : 0) {}
    double* upper() const { return D + t[LD] * t[SIZE]; }
    double* lower() const { return upper() + t[LD] * after; }
    std::size_t bytes(std::int64_t columns) const { return sizeof(double) * t[LD] * columns; }
    void clear() const { std::memset(D, 0, bytes(t[SIZE] + after + before)); }
    void copy_to(double* store) const {
        std::memcpy(store + t[DIAG], D, bytes(t[SIZE]));
        if (after) std::memcpy(store + t[UPPER], upper(), bytes(after));
        if (before) std::memcpy(store + t[LOWER], lower(), bytes(before));
    }
};

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
// values[first[r]] on to the node's blocks, which stand in a row as in Node, by the tiles and single entries of its pattern (chain_tiles);
// start (n+1): where each node's runs begin.  saved: null, or receives the assembled blocks; blocks: null, or receives the pivot blocks
// S_i = A(i,i) - A(i,i-1) S_(i-1)^-1 A(i-1,i) before their LU, one after the other.
// tolerance: a pivot must exceed tolerance x the largest entry of its column of A(i,i).  Returns -1 or the node without a pivot
// (stats[FAILED_COLUMN]: its column).
// from: above 0 (not with a kept node 0, `saved` or `blocks`) the nodes before it keep the factors of the last call: their entries and
// those that couple them to node `from` must not have changed but in node `from` itself.  The same operations follow as in a whole
// elimination, so the factors are those to the last bit.
int chain_factor(int from, int n, int keep, const std::int64_t* table, double* store, const int* start, const int* first_entry,
                 const int* pattern, const int* tile_begin, const int* tiles, const int* single_begin, const int* singles,
                 const double* values, double* inverse, int* pivot, double tolerance, double* stats, double* saved, double* blocks) {
    alignas(64) double work[2][3 * LARGEST_BLOCK * LARGEST_BLOCK];
    const auto node = [&](int i) { return Node(table, n, i, work[i % 2]); };
    // the last rank counts its nodes against the order of the entries
    const int early = start[n / 3], late = start[2 * n / 3];
    const int ahead = late < start[n] && first_entry[late] < first_entry[early] ? -AHEAD : AHEAD;
    const auto assemble = [&](int i) {
        const Node a = node(i);
        a.clear();
        for (int r = start[i]; r < start[i + 1]; r++) {
            const double* v = values + first_entry[r];
            const int p = pattern[r];
            for (const int *tile = tiles + TILE * tile_begin[p], *end = tiles + TILE * tile_begin[p + 1]; tile < end; tile += TILE)
                add_tile(tile, v, a.D, ahead);
            for (const int *one = singles + 2 * single_begin[p], *end = singles + 2 * single_begin[p + 1]; one < end; one += 2)
                a.D[one[1]] += v[one[0]];
        }
        if (saved) a.copy_to(saved);
    };
    stats[FAILED_COLUMN] = -1;
    if (from == 0) stats[SMALLEST] = INFINITY, stats[LARGEST] = 0, stats[SMALLEST_NODE] = -1;
    const int first = keep & 1 ? 1 : 0, last = keep & 2 ? n - 1 : n, begin_at = from > first ? from : first;
    const Row top = table;
    double scale[LARGEST_BLOCK];
    if (first && n > 0) {
        assemble(0);
        node(0).copy_to(store);
    }
    if (begin_at < n) assemble(begin_at);
    if (begin_at < last) scales(table + begin_at * COLUMNS, node(begin_at).D, scale);
    if (from > 0) {
        const Node a = node(from);
        const Row above = a.t - COLUMNS;
        subtract(a.t, a.D, a.lower(), store + above[UPPER], above, a.t[SIZE]);
    }
    for (int i = begin_at; i < last; i++) {
        const Node a = node(i);
        const Row t = a.t, next = i + 1 < n ? t + COLUMNS : nullptr;
        const double smallest = stats[SMALLEST];
        if (next) assemble(i + 1);
        // the fill of node 1 is its matrix block A(1,0)
        double* fill = first ? i == 1 ? a.lower() : store + t[LEFT] : nullptr;
        if (blocks) {
            std::memcpy(blocks, a.D, a.bytes(t[SIZE]));
            blocks += t[LD] * t[SIZE];
        }
        const int bad = eliminate_node(t, a.D, a.upper(), a.after, fill, first ? top[SIZE] : 0, a.lower(), i > first ? a.before : 0,
                                       inverse, pivot, scale, tolerance, stats);
        if (bad >= 0) {
            stats[FAILED_COLUMN] = bad;
            return i;
        }
        a.copy_to(store);
        if (stats[SMALLEST] < smallest) stats[SMALLEST_NODE] = i;
        if (next) {
            const Node b = node(i + 1);
            if (i + 1 < last) scales(next, b.D, scale);
            subtract(next, b.D, b.lower(), a.upper(), t, next[SIZE]);
            if (first) {
                const double* G = store + t[TOP];
                subtract(next, store + next[LEFT], b.lower(), fill, t, top[SIZE], false);
                subtract(top, store + next[TOP], G, a.upper(), t, next[SIZE], false);
                subtract(top, store + top[DIAG], G, fill, t, top[SIZE]);
            }
        }
    }
    if (keep & 2 && last >= first) node(last).copy_to(store);
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
            const Node a(table, n, i, nullptr);
            const std::int64_t block = j < i ? t[LD] * (t[SIZE] + a.after) : j > i ? t[LD] * t[SIZE] : 0;
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
        fetch(store + t[DIAG] + AHEAD, 2 * t[LD] * t[SIZE]);
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
        fetch(store + t[UPPER] - AHEAD, t[LD] * t[SIZE]);
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

// The same for `columns` right sides b (size each): a node's factors serve all of them before those of the next are read.
void chain_solve_columns(int n, const std::int64_t* table, const double* store, const double* inverse, const int* pivot, int length, const int* index,
                         int columns, int size, const double* b, double* work, double* x) {
    for (int c = 0; c < columns; c++) chain_gather(length, index, b + static_cast<long>(c) * size, work + static_cast<long>(c) * length);
    for (int i = 0; i < n; i++) {
        const Row t = table + i * COLUMNS, previous = t - COLUMNS;
        fetch(store + t[DIAG] + AHEAD, 2 * t[LD] * t[SIZE]);
        for (int c = 0; c < columns; c++) {
            double* vec = work + static_cast<long>(c) * length;
            solve_node(t, store, vec + t[VEC], i ? previous : nullptr, i ? vec + previous[VEC] : nullptr, inverse, pivot);
        }
    }
    for (int i = n - 2; i >= 0; i--) {
        const Row t = table + i * COLUMNS, next = t + COLUMNS;
        fetch(store + t[UPPER] - AHEAD, t[LD] * t[SIZE]);
        for (int c = 0; c < columns; c++) {
            double* vec = work + static_cast<long>(c) * length;
            subtract_vector(t, vec + t[VEC], store + t[UPPER], next, vec + next[VEC]);
        }
    }
    for (int c = 0; c < columns; c++) chain_scatter(length, index, work + static_cast<long>(c) * length, x + static_cast<long>(c) * size);
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
