// Prescribed components of a vertex: D (m, 7) orthonormal rows over (r, v, phi) at `rows` (7) of an array.
#include "core/ad.hpp"

using namespace dp;

extern "C" {

// c(v) = v x axis / (|v| (|v| + v.axis)) of a slope v: the spin rate is that of the spin angle plus c(v).v' (manual: eq-prescribed-lean).
// It goes to lean (3), as a column of the kept rows keep (7, 7), and negative to the last rate direction (7).
void lean_at(const int* rows, const double* axis, const double* x, double* lean, double* keep, double* direction) {
    const Vec<double> v = {x[rows[3]], x[rows[4]], x[rows[5]]}, a = vec(axis);
    const double n = norm(v), s = n * (n + dot(v, a));
    const Vec<double> c = cross(v, a) / s;
    lean[0] = c.x; lean[1] = c.y; lean[2] = c.z;
    for (int i = 0; i < 3; ++i) { keep[7 * (3 + i) + 6] = lean[i]; direction[3 + i] = -lean[i]; }
}

// derivative (3, 3) of c(v) by v
void lean_derivative(const int* rows, const double* axis, const double* x, double* out) {
    const Vec<double> v = {x[rows[3]], x[rows[4]], x[rows[5]]}, a = vec(axis);
    const double n = norm(v), s = n * (n + dot(v, a));
    const Vec<double> c = cross(v, a) / s, ds = v * ((2.0 + dot(v, a) / n) / s) + a * (n / s);
    const double across[9] = {0.0, a.z, -a.y, -a.z, 0.0, a.x, a.y, -a.x, 0.0}, from[3] = {c.x, c.y, c.z}, by[3] = {ds.x, ds.y, ds.z};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) out[3 * i + j] = across[3 * i + j] / s - from[i] * by[j];
}

// the spin rate gets c(v).v', the spin acceleration follows
void lean_rates(const int* rows, const double* lean, double sigma, const double* v1, double* y, double* a) {
    const int spin = rows[6];
    for (int i = 0; i < 3; ++i) y[spin] += lean[i] * y[rows[3 + i]];
    a[spin] = sigma * y[spin] + v1[spin];
}

// the torque on the spin acts on the slope, too
void lean_rows(const int* places, const double* lean, double torque, double* r) {
    for (int i = 0; i < 3; ++i) r[places[3 + i]] += lean[i] * torque;
}

// y gets the prescribed rate along D, a the acceleration that belongs to it
void constraint_rates(int m, const double* D, const int* rows, const double* rate, double sigma, const double* v1, double* y, double* a) {
    double change[7] = {0, 0, 0, 0, 0, 0, 0};
    for (int k = 0; k < m; ++k) {
        double miss = rate[k];
        for (int i = 0; i < 7; ++i) miss -= D[7 * k + i] * y[rows[i]];
        for (int i = 0; i < 7; ++i) change[i] += D[7 * k + i] * miss;
    }
    for (int i = 0; i < 7; ++i) {
        y[rows[i]] += change[i];
        a[rows[i]] = sigma * y[rows[i]] + v1[rows[i]];
    }
}

// rows of the residual r along D become scale (D x - value); what stood there goes to reaction (m)
void constraint_rows(int m, const double* D, const int* rows, const int* places, const double* x, const double* value, double scale, double* r,
                     double* reaction) {
    double change[7] = {0, 0, 0, 0, 0, 0, 0};
    for (int k = 0; k < m; ++k) {
        double force = 0, error = -value[k];
        for (int i = 0; i < 7; ++i) { force += D[7 * k + i] * r[places[i]]; error += D[7 * k + i] * x[rows[i]]; }
        reaction[k] = force;
        for (int i = 0; i < 7; ++i) change[i] += D[7 * k + i] * (scale * error - force);
    }
    for (int i = 0; i < 7; ++i) r[places[i]] += change[i];
}

// n element matrices: K[slots] = keep K[slots].  at: where each starts in `values`, width: its order, slots: (n, 7)
void constraint_matrix(int n, const double* keep, const long long* at, const int* width, const int* slots, double* values) {
    for (int e = 0; e < n; ++e) {
        double* K = values + at[e];
        const int w = width[e];
        for (int j = 0; j < w; ++j) {
            double column[7];
            for (int i = 0; i < 7; ++i) column[i] = K[slots[7 * e + i] * w + j];
            for (int i = 0; i < 7; ++i) {
                double sum = 0;
                for (int k = 0; k < 7; ++k) sum += keep[7 * i + k] * column[k];
                K[slots[7 * e + i] * w + j] = sum;
            }
        }
    }
}

}
