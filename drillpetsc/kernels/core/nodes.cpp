// Node-wise kinematics: rates of a condensed step and the derivative of the spin rate by the tangent.
#include "core/frame.hpp"

using namespace dp;

// y = sigma x + v0 and a = sigma y + v1 for n unknowns (v1 only where a rate is an unknown); then, at each of k nodes with a spin
// angle, omega = phi' + c(v).w replaces the rate of the angle.  where: (k, 2) positions of phi and v; reference: (k, 3).
extern "C" void condensed_rates(int n, const double* x, double sigma, double second, const double* v0, const double* v1, int k,
                                const int* where, const double* reference, double* y, double* a) {
    for (int i = 0; i < n; ++i) y[i] = sigma * x[i] + v0[i];
    for (int j = 0; j < k; ++j) {
        const int phi = where[2 * j], v = where[2 * j + 1];
        y[phi] += dot(spin_potential(vec(reference + 3 * j), vec(x + v)), vec(y + v));
    }
    for (int i = 0; i < n; ++i) a[i] = second * y[i] + v1[i];
}

// c(v).w at each node: what omega has beyond the rate of the angle
extern "C" void spin_transport(int k, const int* where, const double* reference, const double* x, const double* y, double* out) {
    for (int j = 0; j < k; ++j) out[j] = dot(spin_potential(vec(reference + 3 * j), vec(x + where[2 * j + 1])), vec(y + where[2 * j + 1]));
}

// spin (k, 3): d(c(v).w)/dv for w = y plus sigma c(v), each divided by sigma0: what a kernel's seed needs (core/element.hpp).
extern "C" void spin_gradient(int k, const int* where, const double* reference, const double* x, const double* y, double sigma, double scale,
                              double* spin) {
    typedef Dual<4> T;
    for (int j = 0; j < k; ++j) {
        const int v = where[2 * j + 1];
        Vec<T> q = {T(x[v]), T(x[v + 1]), T(x[v + 2])};
        q.x.set(0, 1.0); q.y.set(1, 1.0); q.z.set(2, 1.0);
        const Vec<double> w = vec(y + v);
        const Vec<T> c = spin_potential(vec(reference + 3 * j), q);
        const T cw = dot(c, w);
        spin[3 * j] = scale * (cw.d(0) + sigma * c.x.v);
        spin[3 * j + 1] = scale * (cw.d(1) + sigma * c.y.v);
        spin[3 * j + 2] = scale * (cw.d(2) + sigma * c.z.v);
    }
}

// Rows of v get c(v) times the row of the spin angle (manual: eq-beam-quasi-rows).  index (n, width): unknowns of each matrix K (n, width,
// width); number: of the node whose spin angle an unknown is, or -1; c: (k, 3).  The slope stands in the three slots before its spin angle.
extern "C" void quasi_rows(int n, int width, const int* index, const int* number, const double* c, double* K) {
    for (int e = 0; e < n; ++e, index += width, K += long(width) * width)
        for (int s = 3; s < width; ++s) {
            const int node = number[index[s]];
            if (node < 0) continue;
            for (int k = 0; k < 3; ++k)
                for (int j = 0; j < width; ++j) K[(s - 3 + k) * width + j] += c[3 * node + k] * K[s * width + j];
        }
}

// Number of nodes whose slope v is so far from the reference direction a that a.v < limit |v|; arguments as for spin_transport.
extern "C" int far_slopes(int k, const int* where, const double* reference, const double* x, double limit) {
    int found = 0;
    for (int j = 0; j < k; ++j) {
        const Vec<double> v = vec(x + where[2 * j + 1]);
        found += dot(vec(reference + 3 * j), v) < limit * norm(v);
    }
    return found;
}
