// Anderson's acceleration of Newton's iteration with a kept factorisation (manual: sec-time-secants).
//
// Increments that old factors give differ from those of new ones along few directions: of a contact that has opened, of a shift that has moved.
// Pairs of a step and of the change of the increment along it show what the matrix does there.
#pragma once

#include <cstring>

#include "core/names.hpp"

namespace dp {

// pairs that are kept
constexpr int SECANTS = 2;
// products of the pairs with each other and with an increment
constexpr int SECANT_PRODUCTS = SECANTS * (SECANTS + 3) / 2;

// memory (3 + 2 SECANTS, n): last increment of the factors; what the pairs leave of it; steps; changes of the increment; unknowns at the beginning.
// weights (n): of the squares of what is left.  count: increments of this factorisation; used: pairs have changed an increment of this solve.
DP_RECORD(SecantCall, double* memory; const double* weights; int n, count, used;)

class Secants {
public:
    explicit Secants(SecantCall& call) : call(call), n(call.n), last(call.memory), steps(call.memory + 2 * n), changes(steps + SECANTS * n) {}

    double* left() { return call.memory + n; }
    double* start() { return changes + SECANTS * n; }

    // Notes where a solve begins.
    void begin(const double* unknowns) {
        call.count = call.used = 0;
        std::memcpy(start(), unknowns, n * sizeof(double));
    }

    // Takes an increment of the factors, which is to be subtracted.  Fills the products of the pairs, to be summed over the ranks; returns their
    // number: none at the first increment of a factorisation.
    int take(const double* increment, double* products) {
        if (call.count > 0) {
            double* change = at(changes, call.count - 1);
            for (int i = 0; i < n; ++i) change[i] = increment[i] - last[i];
        }
        std::memcpy(last, increment, n * sizeof(double));
        std::memcpy(left(), increment, n * sizeof(double));
        int k = 0;
        for (int a = 0; a < pairs(); ++a) {
            products[k++] = product(a, last);
            for (int b = 0; b <= a; ++b) products[k++] = product(a, at(changes, b));
        }
        call.count++;
        return k;
    }

    // The increment from the summed products: the point along the steps at which least is left, and then what is left there
    // (manual: eq-time-secants).
    void accelerate(const double* products, double* increment) {
        call.used = 1;
        double share[SECANTS];
        shares(products, share);
        for (int a = 0; a < SECANTS && a < call.count - 1; ++a) {
            const double *step = at(steps, a), *change = at(changes, a), f = share[a];
            double* rest = left();
            for (int i = 0; i < n; ++i) rest[i] -= f * change[i];
            for (int i = 0; i < n; ++i) increment[i] += f * (step[i] - change[i]);
        }
    }

    // Keeps the step that was taken.
    void keep(const double* step) { std::memcpy(at(steps, call.count - 1), step, n * sizeof(double)); }

private:
    double* at(double* rows, int pair) { return rows + (std::size_t)(pair % SECANTS) * n; }
    int pairs() const { return call.count < SECANTS ? call.count : SECANTS; }

    double product(int pair, const double* b) {
        const double *a = at(changes, pair), *w = call.weights;
        double sum[4] = {0.0, 0.0, 0.0, 0.0};  // four sums hide the latency of an addition
        int i = 0;
        for (; i + 4 <= n; i += 4)
            for (int l = 0; l < 4; ++l) sum[l] += w[i + l] * a[i + l] * b[i + l];
        for (; i < n; ++i) sum[0] += w[i] * a[i] * b[i];
        return (sum[0] + sum[1]) + (sum[2] + sum[3]);
    }

    // Least squares of two pairs; of the newest alone where they are nearly parallel or where there is one.
    void shares(const double* p, double* share) const {
        static_assert(SECANTS == 2, "the system of equations is written out for two pairs");
        const int newest = (call.count - 2) % SECANTS, used = call.count - 1 < SECANTS ? call.count - 1 : SECANTS;
        const double b0 = p[0], a00 = p[1], b1 = used > 1 ? p[2] : 0.0, a01 = used > 1 ? p[3] : 0.0, a11 = used > 1 ? p[4] : 0.0;
        const double determinant = a00 * a11 - a01 * a01;
        share[0] = share[1] = 0.0;
        if (used > 1 && determinant > PARALLEL * a00 * a11) {
            share[0] = (b0 * a11 - b1 * a01) / determinant;
            share[1] = (b1 * a00 - b0 * a01) / determinant;
        } else if (const double square = newest ? a11 : a00; square > 0.0) {
            share[newest] = (newest ? b1 : b0) / square;
        }
    }

    // square of the sine of the angle below which two changes are parallel
    static constexpr double PARALLEL = 1e-8;

    SecantCall& call;
    const int n;
    double *last, *steps, *changes;
};

}  // namespace dp
