// Derivatives of a step by parameters: right sides, rates, and the states of systems beside the run (manual: sec-sensitivities-steps).
#include <cstring>

#include "core/ad.hpp"
#include "core/frame.hpp"
#include "core/step.hpp"

using namespace dp;

DP_EXPORT_RECORD(part_call, PartCall)
DP_EXPORT_RECORD(beside_call, BesideCall)
DP_EXPORT_RECORD(given_call, GivenCall)
DP_EXPORT_RECORD(formula_sums, FormulaSums)
DP_EXPORT_RECORD(tangent_call, TangentCall)

namespace {
typedef void (*Residual)(int, const int*, const double*, void*, const double*, const double*, const double*, double*);
typedef void (*Jacobian)(int, const int*, const int*, const double*, void*, const double*, const double*, const double*, const double*, const double*, double*);
typedef void (*Product)(int, const int*, const double*, void*, const double*, const double*, const double*, int, int, const signed char*, const double*, const double*, const double*, double*);

typedef V4 Unaligned __attribute__((aligned(8)));

void add_parts(int n, const PartCall* parts, const double* x, const double* y, const double* a, double* r) {
    for (int k = 0; k < n; ++k) {
        const PartCall& p = parts[k];
        reinterpret_cast<Residual>(const_cast<void*>(p.residual))(p.count, p.index, p.parameters, const_cast<void*>(p.record), x, y, a, r);
    }
}

// y = keep y over the seven unknowns of a node
void keep_rates(const double* keep, double* y) {
    double out[7];
    for (int i = 0; i < 7; ++i) {
        out[i] = 0.0;
        for (int j = 0; j < 7; ++j) out[i] += keep[7 * i + j] * y[j];
    }
    std::memcpy(y, out, sizeof out);
}

// Rates of a node whose motion is prescribed: `free` ones across it, given ones along it; with an axis the spin rate gets c(v).v'.
void prescribe(const PrescribedCall& p, const double* projector, const double* rate, const double* lean, double* y) {
    double along[7];
    for (int i = 0; i < 7; ++i) {
        along[i] = 0.0;
        for (int j = 0; j < 7; ++j) along[i] += projector[7 * i + j] * y[j];
    }
    for (int i = 0; i < 7; ++i) y[i] += rate[i] - along[i];
    if (p.axis)
        for (int i = 0; i < 3; ++i) y[6] += lean[i] * y[3 + i];
}

// Rows of a block get its derivatives by positions, rates or accelerations (weights) times directions d (keys, length); of the chosen keys only.
void add_product(const TangentCall& c, const MatrixCall& b, const double* weights, const double* no_spin, const double* d, const signed char* chosen) {
    reinterpret_cast<Jacobian>(const_cast<void*>(b.jacobian))(b.count, b.index, b.nodes, b.parameters, const_cast<void*>(b.record), weights, no_spin,
                                                              c.x, c.y, c.a, c.element);
    const int w = b.width;
    Unaligned* along = reinterpret_cast<Unaligned*>(c.element + (long)b.count * w * w);
    for (int e = 0; e < b.count; ++e) {
        const int* at = b.index + (long)e * w;
        const double* K = c.element + (long)e * w * w;
        for (int k = 0; k < c.keys; k += 4) {  // four keys side by side
            double* rows[4];
            const double* q[4];
            const int here = c.keys - k < 4 ? c.keys - k : 4;
            bool any = false;
            for (int l = 0; l < 4; ++l) {
                const long of = (long)(k + (l < here ? l : 0)) * c.length;
                q[l] = d + of;
                rows[l] = l < here && (!chosen || chosen[k + l]) ? c.rows + of : nullptr;
                any |= rows[l] != nullptr;
            }
            if (!any) continue;
            for (int j = 0; j < w; ++j) along[j] = V4{q[0][at[j]], q[1][at[j]], q[2][at[j]], q[3][at[j]]};
            for (int i = 0; i < w; i += 4) {  // and four rows, whose sums do not wait for each other
                const double* row[4];
                for (int m = 0; m < 4; ++m) row[m] = K + (i + m < w ? i + m : w - 1) * w;
                V4 sum[4] = {splat(0.0), splat(0.0), splat(0.0), splat(0.0)};
                for (int j = 0; j < w; ++j) {
                    const V4 v = along[j];
                    for (int m = 0; m < 4; ++m) sum[m] += splat(row[m][j]) * v;
                }
                for (int m = 0; m < 4 && i + m < w; ++m)
                    for (int l = 0; l < here; ++l)
                        if (rows[l]) rows[l][at[i + m]] += sum[m][l];
            }
        }
    }
}

// Position and rate along prescribed directions that all systems have in common, of the keys that move them otherwise than the run.
void take_given(const TangentCall& c) {
    for (int m = 0; m < c.step->prescriptions; ++m) {
        const GivenCall& given = c.given[m];
        for (int b = 0; !given.turning && b < c.besides; ++b) {
            const BesideCall& q = c.beside[b];
            if (q.follows) continue;
            const PrescribedCall& p = q.step->prescribed[m];
            double *position = given.position + 7 * q.key, *rate = given.rate + 7 * q.key;
            const bool first = b == 0 || c.beside[b - 1].key != q.key;
            for (int i = 0; i < 7; ++i) {
                double value = first ? 0.0 : position[i], speed = first ? 0.0 : rate[i];
                for (int j = 0; j < p.count; ++j) {
                    value += q.weight * p.directions[7 * j + i] * p.value[j];
                    speed += q.weight * p.directions[7 * j + i] * p.rate[j];
                }
                position[i] = value;
                rate[i] = speed;
            }
        }
    }
}

// v0 and v1 of a multistep formula: sums of the unknowns and rates at its nodes.
void take_sums(const TangentCall& c) {
    const FormulaSums& f = *c.sums;
    for (int k = 0; k < c.keys; ++k) {
        const long at = (long)k * c.length;
        double *v0 = c.by_rate + at, *v1 = c.by_second + at;
        for (int j = 0; j < f.count; ++j) {
            const double w = f.weights[j], *x = static_cast<const double* const*>(f.x)[j] + at, *y = static_cast<const double* const*>(f.y)[j] + at;
#pragma GCC ivdep  // no array overlaps another
            for (int i = 0; i < c.length; ++i) {
                v0[i] = w * x[i] + (j ? v0[i] : 0.0);
                v1[i] = w * y[i] + (j ? v1[i] : 0.0);
            }
        }
#pragma GCC ivdep
        for (int i = 0; i < c.length; ++i) v1[i] = c.with_rate[i] ? v1[i] : 0.0;
    }
}

// The number of a node's spin angle, -1 without one.
int spin_of(const StepCall& s, const PrescribedCall& p) {
    for (int j = 0; j < s.spins; ++j)
        if (s.where[2 * j] == p.rows[6]) return j;
    return -1;
}

// The directions by rates and accelerations from the constants of the formula: the motion without what the matrix multiplies.
void take_rates(const TangentCall& c) {
    const StepCall& s = *c.step;
    for (int k = 0; k < c.keys; ++k) {
        double *dy = c.by_rate + (long)k * c.length, *da = c.by_second + (long)k * c.length;
        for (int m = 0; m < s.prescriptions; ++m) {
            double* free = c.given[m].free + 7 * k;
            for (int i = 0; i < 7; ++i) {
                free[i] = dy[s.prescribed[m].rows[i]];
                free[7 * c.keys + i] = da[s.prescribed[m].rows[i]];
            }
        }
        for (int j = 0; j < s.spins; ++j) dy[s.where[2 * j]] += dot(vec(c.lean + 3 * j), vec(dy + s.where[2 * j + 1]));
        for (int m = 0; m < s.prescriptions; ++m) {
            const PrescribedCall& p = s.prescribed[m];
            const double* position = c.given[m].position + 7 * k;
            const int j = spin_of(s, p);
            double by_matrix[7], y[7];
            for (int i = 0; i < 7; ++i) by_matrix[i] = s.sigma * position[i];
            for (int i = 0; j >= 0 && i < 3; ++i) by_matrix[6] += s.sigma * c.jacobian->spin[3 * j + i] * position[3 + i];
            for (int i = 0; i < 7; ++i) y[i] = by_matrix[i] + dy[p.rows[i]];
            prescribe(p, c.jacobian->prescribed[m].projector, c.given[m].rate + 7 * k, c.lean + 3 * j, y);
            for (int i = 0; i < 7; ++i) dy[p.rows[i]] = y[i] - by_matrix[i];
        }
        for (int i = 0; i < c.length; ++i) da[i] += c.second * dy[i];
    }
}

// The directions `along`: back along positions that continue the last rates.  The derivative by them is in the rows that are evaluated at moved
// positions, and goes with these directions.  Beyond the unknowns of these blocks they have no meaning.
void take_directions(const TangentCall& c) {
    const StepCall& s = *c.step;
    for (int b = 0; b < c.besides; ++b) {
        const BesideCall& beside = c.beside[b];
        const int k = beside.key;
        if (beside.low == beside.high || (b && c.beside[b - 1].key == k)) continue;
        const long at = (long)k * c.length;
        const double *v0 = c.by_rate + at, *last_x = c.last_x + at, *last_y = c.last_y + at;
        double* along = c.along + at;
        for (int i = beside.low; i < beside.high; ++i) along[i] = c.with_rate[i] ? (v0[i] - last_y[i]) / s.sigma : -last_x[i];
        for (int m = 0; m < s.prescriptions; ++m) {
            const PrescribedCall& p = s.prescribed[m];
            const double *projector = c.jacobian->prescribed[m].projector, *position = c.given[m].position + 7 * k;
            double free[7];
            for (int i = 0; i < 7; ++i) {
                free[i] = along[p.rows[i]];
                for (int j = 0; j < 7; ++j) free[i] -= projector[7 * i + j] * along[p.rows[j]];
            }
            for (int i = 0; i < 7; ++i) along[p.rows[i]] = free[i] - position[i];
        }
    }
}

// The matrix times the prescribed positions.
void add_prescribed(const TangentCall& c) {
    for (int m = 0; m < c.step->prescriptions; ++m) {
        const PrescribedMatrix& q = c.jacobian->prescribed[m];
        for (int e = 0; e < q.count; ++e) {
            const int *at = static_cast<const int* const*>(c.given[m].index)[e], *slots = q.slots + 7 * e, w = q.width[e];
            const double* K = c.jacobian->values + static_cast<const long long*>(q.at)[e];
            for (int k = 0; k < c.keys; ++k) {
                const double* position = c.given[m].position + 7 * k;
                double* rows = c.rows + (long)k * c.length;
                for (int i = 0; i < w; ++i)
                    for (int j = 0; j < 7; ++j) rows[at[i]] += K[(long)i * w + slots[j]] * position[j];
            }
        }
    }
}

// Whether the parameters of a part are the same in all systems of a key, so that their rows have no derivative.
bool same_everywhere(const PartCall& p) {
    for (int i = 0; i < p.other_count; ++i)
        if (std::memcmp(p.parameters, static_cast<const double* const*>(p.others)[i], sizeof(double) * p.size)) return false;
    return p.other_count > 0;
}

void add_besides(const TangentCall& c) {
    const StepCall& s = *c.step;
    for (int b = 0; b < c.besides; ++b) {
        const BesideCall& q = c.beside[b];
        if (!q.part_count) continue;
        double *r = s.r, *rows = c.rows + (long)q.key * c.length, *x = q.step->x;
        for (int i = q.first; i < q.last; ++i) r[i] = 0.0;
        const double* along = c.along + (long)q.key * c.length;
        for (int i = q.low; i < q.high; ++i) x[i] = s.x[i] - q.change * along[i];
        for (int p = 0; p < q.part_count; ++p)
            if (q.parts[p].moved || !same_everywhere(q.parts[p])) add_parts(1, q.parts + p, q.parts[p].moved ? x : s.x, s.y, s.a, r);
        for (int i = q.first; i < q.last; ++i) r[i] *= q.weight;  // by itself: a fused product would not cancel that of an equal system
        for (int i = q.first; i < q.last; ++i) rows[i] += r[i];
    }
}
}  // namespace

extern "C" {
void newton_columns(const void* newton, int columns, const double* b, double* work, double* x);

// Rows of all keys, without what other ranks add.
void tangent_rows(const TangentCall* call) {
    const TangentCall& c = *call;
    const StepCall& s = *c.step;
    const double by_position[3] = {1.0, 0.0, 0.0}, by_rate[3] = {0.0, 1.0, 0.0}, by_second[3] = {0.0, 0.0, 1.0};
    for (int j = 0; j < s.spins; ++j) {
        const Vec<double> lean = spin_potential(vec(s.reference + 3 * j), vec(c.x + s.where[2 * j + 1]));
        c.lean[3 * j] = lean.x; c.lean[3 * j + 1] = lean.y; c.lean[3 * j + 2] = lean.z;
    }
    take_given(c);
    if (c.sums) take_sums(c);
    take_directions(c);
    take_rates(c);
    std::memset(c.rows, 0, sizeof(double) * c.keys * c.length);
    add_prescribed(c);
    const double* no_spin = c.lean + 3L * s.spins;  // zeros follow
    for (int k = 0; k < c.jacobian->count; ++k) {
        const MatrixCall& b = c.jacobian->blocks[k];
        const void* product = static_cast<const void* const*>(c.products)[k];
        const signed char* moved = c.moved + (long)k * c.keys;
        if (!std::memchr(moved, 1, c.keys)) moved = nullptr;
        if (product) {
            reinterpret_cast<Product>(const_cast<void*>(product))(b.count, b.index, b.parameters, const_cast<void*>(b.record), c.x, c.y, c.a, c.keys, c.length,
                                                                  moved, c.along, c.by_rate, c.by_second, c.rows);
            continue;
        }
        if (moved) add_product(c, b, by_position, no_spin, c.along, moved);
        add_product(c, b, by_rate, no_spin, c.by_rate, nullptr);
        add_product(c, b, by_second, no_spin, c.by_second, nullptr);
    }
    add_besides(c);
}

// The owned rows (keys, n); with a rank's own ones summed over ranks, what stands along prescribed directions goes.
void tangent_gather(const TangentCall* call) {
    const TangentCall& c = *call;
    for (int k = 0; k < c.keys; ++k)
        for (int i = 0; i < c.step->n; ++i) c.owned[(long)k * c.step->n + i] = c.rows[(long)k * c.length + c.step->owned[i]];
}

void tangent_prescribed(const TangentCall* call) {
    const TangentCall& c = *call;
    const StepCall& s = *c.step;
    for (int k = 0; k < c.keys; ++k)
        for (int m = 0; m < s.prescriptions; ++m) {
            const PrescribedCall& p = s.prescribed[m];
            if (!p.places) continue;
            double* rows = c.owned + (long)k * s.n;
            double r[7];
            for (int i = 0; i < 7; ++i) r[i] = rows[p.places[i]];
            keep_rates(c.jacobian->prescribed[m].keep, r);
            for (int i = 0; i < 7; ++i) rows[p.places[i]] = r[i] + (c.given[m].turning ? c.given[m].turning[7 * k + i] : 0.0);
        }
}

// Positions from the increments; ghosts are missing.
void tangent_positions(const TangentCall* call) {
    const TangentCall& c = *call;
    const StepCall& s = *c.step;
    for (int k = 0; k < c.keys; ++k) {
        double* x = c.moved_x + (long)k * c.length;
        const double* found = c.found + (long)k * s.n;
        for (int i = s.size; i < c.length; ++i) x[i] = 0.0;
        for (int i = 0; i < s.n; ++i) x[s.owned[i]] = -found[i];
        for (int m = 0; m < s.prescriptions; ++m)
            for (int i = 0; s.prescribed[m].places && i < 7; ++i) x[s.prescribed[m].rows[i]] += c.given[m].position[7 * k + i];
    }
}

// Rates and accelerations from the positions.
void tangent_rates(const TangentCall* call) {
    const TangentCall& c = *call;
    const StepCall& s = *c.step;
    for (int k = 0; k < c.keys; ++k) {
        const long at = (long)k * c.length;
        const double *x = c.moved_x + at, *dy = c.by_rate + at, *da = c.by_second + at;
        double *y = c.moved_y + at, *a = c.moved_a + at;
        for (int i = 0; i < s.size; ++i) {
            const double moved = s.sigma * x[i];
            y[i] = moved + dy[i];
            a[i] = c.second * moved + da[i];
        }
        for (int i = s.size; i < c.length; ++i) y[i] = a[i] = 0.0;
        for (int j = 0; j < s.spins; ++j) {
            const double moved = s.sigma * dot(vec(c.jacobian->spin + 3 * j), vec(x + s.where[2 * j + 1]));
            y[s.where[2 * j]] += moved;
            a[s.where[2 * j]] += c.second * moved;
        }
        for (int m = 0; m < s.prescriptions; ++m) {
            const PrescribedCall& p = s.prescribed[m];
            const double* free = c.given[m].free + 7 * k;
            const int j = spin_of(s, p);
            double rates[7];
            for (int i = 0; i < 7; ++i) rates[i] = s.sigma * x[p.rows[i]] + free[i];
            if (j >= 0) {
                const Vec<double> lean = vec(c.lean + 3 * j), spin = vec(c.jacobian->spin + 3 * j), slope = vec(x + p.rows[3]);
                rates[6] += s.sigma * dot(spin, slope) + dot(lean, vec(free + 3));
                prescribe(p, c.jacobian->prescribed[m].projector, c.given[m].rate + 7 * k, c.lean + 3 * j, rates);
                if (p.axis) rates[6] += s.sigma * dot(spin - lean, slope);  // sigma (spin - c(v)) is the derivative of c(v).v' by v
            } else
                prescribe(p, c.jacobian->prescribed[m].projector, c.given[m].rate + 7 * k, nullptr, rates);
            for (int i = 0; i < 7; ++i) {
                y[p.rows[i]] = rates[i];
                a[p.rows[i]] = c.second * rates[i] + free[7 * c.keys + i];
            }
        }
    }
}

// Derivatives (keys, length) of the rows of `count` blocks at the run's state, along those of x, y, a: of the blocks at prescribed motion.
void tangent_ends(const TangentCall* call, int count, const MatrixCall* blocks, const double* x, const double* y, const double* a, double* rows) {
    TangentCall c = *call;
    const StepCall& s = *c.step;
    const double weights[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    const double* along[3] = {x, y, a};
    c.x = s.x; c.y = s.y; c.a = s.a; c.rows = rows;
    std::memset(rows, 0, sizeof(double) * c.keys * c.length);
    for (int b = 0; b < count; ++b)
        for (int i = 0; i < 3; ++i) add_product(c, blocks[b], weights[i], c.lean + 3L * s.spins, along[i], nullptr);
}

// Systems beside a run go into its state, moved along the derivatives (keys, length) of x, y, a.  some: the number of places, -1 for all unknowns;
// with places the reactions follow.  Of these, ends (keys, length): derivatives of the rows of the blocks that are not evaluated at moved places: a
// strain rounds by 1e-16, which over the change of a key is seen in a force.
void beside_states(int count, const BesideCall* calls, const StepCall* run, int length, const double* x, const double* y, const double* a, int some,
                   const int* places, const double* ends) {
    for (int b = 0; b < count; ++b) {
        const StepCall& c = *calls[b].step;
        const double h = calls[b].change;
        const long at = (long)calls[b].key * length;
        const int n = some < 0 ? c.size : some;
        for (int j = 0; j < n; ++j) {
            const int i = some < 0 ? j : places[j];
            c.x[i] = run->x[i] + h * x[at + i];
            c.y[i] = run->y[i] + h * y[at + i];
            c.a[i] = run->a[i] + h * a[at + i];
        }
        if (some < 0) continue;
        for (int m = 0; calls[b].follows && m < c.prescriptions; ++m)
            std::memcpy(const_cast<double*>(c.prescribed[m].rate), run->prescribed[m].rate, c.prescribed[m].count * sizeof(double));
        for (int m = 0; m < c.prescriptions; ++m)
            for (int i = 0; i < 7; ++i) c.r[c.prescribed[m].rows[i]] = c.dead ? -c.dead[c.prescribed[m].rows[i]] : 0.0;
        for (int p = 0; p < calls[b].end_count; ++p) {
            const PartCall* part = calls[b].ends + p;
            part->moved ? add_parts(1, part, c.x, c.y, c.a, c.r) : add_parts(1, part, run->x, run->y, run->a, c.r);
        }
        for (int m = 0; m < c.prescriptions; ++m)
            for (int i = 0; i < 7; ++i) c.r[c.prescribed[m].rows[i]] += h * ends[at + c.prescribed[m].rows[i]];
        for (int m = 0; m < c.prescriptions; ++m) {
            const PrescribedCall& p = c.prescribed[m];
            for (int j = 0; p.places && j < p.count; ++j) {
                double force = 0.0;
                for (int i = 0; i < 7; ++i) force += p.directions[7 * j + i] * c.r[p.rows[i]];
                p.reaction[j] = force;
            }
        }
    }
}

// All of a step on one rank.
void tangent_step(const TangentCall* call, const void* newton, double* work) {
    tangent_rows(call);
    tangent_gather(call);
    tangent_prescribed(call);
    newton_columns(newton, call->keys, call->owned, work, const_cast<double*>(call->found));
    tangent_positions(call);
    tangent_rates(call);
}
}
