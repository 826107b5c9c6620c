// Sums and norms over vectors of unknowns that a step needs several times, each in one pass.
#include <cmath>

// Largest |step| relative to the larger of scale and spacing |x|; not a number where any entry is not.
extern "C" double scaled_size(int n, const double* step, const double* scale, double spacing, const double* x) {
    double largest = 0.0;
    bool number = true;
    for (int i = 0; i < n; ++i) {
        const double floor = spacing * std::fabs(x[i]), size = std::fabs(step[i]) / (scale[i] > floor ? scale[i] : floor);
        largest = size > largest ? size : largest;
        number &= size == size;
    }
    return number ? largest : NAN;
}

// Sum of a[i[k]] b[j[k]] over n pairs.
extern "C" double gathered_product(int n, const int* i, const double* a, const int* j, const double* b) {
    double sum = 0.0;
    for (int k = 0; k < n; ++k) sum += a[i[k]] * b[j[k]];
    return sum;
}

// e = sum of weights[m] states[m] over m states (n,), added to net; |e| added to total, and kept in largest where it is larger.
extern "C" void add_local_error(int n, int m, const double* const* states, const double* weights, double* net, double* total, double* largest) {
    for (int i = 0; i < n; ++i) {
        double e = 0.0;
        for (int k = 0; k < m; ++k) e += weights[k] * states[k][i];
        const double size = std::fabs(e);
        net[i] += e;
        total[i] += size;
        largest[i] = size > largest[i] ? size : largest[i];
    }
}
