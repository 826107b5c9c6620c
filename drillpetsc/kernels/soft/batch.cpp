// Many soft strings on the steps of one hole, with what their tables show; the columns are those of analysis/loads/torque_drag/batch.py.
#include "soft/step.hpp"

using namespace dp::soft;

// Every step from its own force t (rows, columns) at the lower end; above (rows, columns), results (RESULTS, rows, columns).
extern "C" void soft_string_steps(int rows, int columns, const Geometry* hole, const Values* values, const double* h,
                                  const double* t, double* above, double* out) {
    const long count = long(rows) * columns;
    for (long n = 0; n < count; ++n) above[n] = step(hole[n / columns], values[n], h[n], t[n], out + n, count);
}

// The steps in turn from the last row up, from the forces in the last row of tension (rows + 1, columns).
// A string whose force is beyond `largest` is broken: it stops at that edge, and above it nothing is added.
extern "C" void soft_string_march(int rows, int columns, const Geometry* hole, const Values* values, const double* h,
                                  const double* edges, double largest, double* tension, double* out, double* stop) {
    const long count = long(rows) * columns;
    for (int c = 0; c < columns; ++c) {
        bool broken = false;
        for (long i = rows - 1; i >= 0; --i) {
            const long n = i * columns + c;
            double t = step(hole[i], values[n], broken ? 0.0 : h[n], tension[n + columns], out + n, count);
            if (!broken && !(std::abs(t) < largest)) {
                broken = true;
                stop[c] = edges[i + 1];
            }
            tension[n] = broken ? -largest : t;
        }
    }
}
