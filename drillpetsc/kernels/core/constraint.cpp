// Prescribed components of a vertex: D (m, 7) orthonormal rows over (r, v, phi) at `rows` (7) of an array.

extern "C" {

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
