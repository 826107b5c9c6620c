// Friction of a flat face that turns and slides: a disc of even pressure under Coulomb friction (manual: sec-bit-face).
//
// The mean over the disc of the slip speed |v + Omega x rho| is R G(m), with R^2 = (a Omega)^2 + |v|^2 and m = |v|^2/R^2.  Force and torque
// are its derivatives by v and Omega, so both come from one potential.  (a Omega)^2 + rest^2 in place of (a Omega)^2 rounds off standstill.
#pragma once
#include "core/ad.hpp"

namespace dp {

// G on even steps of m, a cubic spline.
class FaceTable {
public:
    static constexpr int N = 256;  // intervals, even: g is least smooth where the centre moves at the speed of the rim, m = 1/2

    // G and its derivative at m in 0..1
    template <class T>
    void at(const T& m, T& G, T& slope) const {
        int k = int(val(m) * N);
        k = k < 0 ? 0 : k >= N ? N - 1 : k;
        const double* c = coefficient[k];
        const T u = m - double(k) / N;
        G = ((u * c[3] + c[2]) * u + c[1]) * u + c[0];
        slope = (u * (3.0 * c[3]) + 2.0 * c[2]) * u + c[1];
    }

    static const FaceTable& table() {
        static const FaceTable one;
        return one;
    }

private:
    double coefficient[N][4];

    // complete elliptic integrals of the first and the second kind of the parameter k^2, by the arithmetic-geometric mean
    static void elliptic(double square, double& K, double& E) {
        double a = 1.0, b = std::sqrt(1.0 - square), sum = 0.5 * square, power = 0.5;
        while (std::fabs(a - b) > 1e-15) {
            const double c = 0.5 * (a - b), mean = 0.5 * (a + b);
            b = std::sqrt(a * b);
            a = mean;
            power *= 2.0;
            sum += power * c * c;
        }
        K = 0.5 * M_PI / a;
        E = K * (1.0 - sum);
    }

    // mean distance of the points of the unit disc from a point at the distance q from its centre
    static double mean_distance(double q) {
        double K, E;
        if (q < 1.0) {
            elliptic(q * q, K, E);
            return 4.0 / (9.0 * M_PI) * ((q * q + 7.0) * E - 4.0 * (1.0 - q * q) * K);
        }
        if (q == 1.0) return 32.0 / (9.0 * M_PI);
        elliptic(1.0 / (q * q), K, E);
        return 4.0 / (9.0 * M_PI) * (q * (q * q + 7.0) * E - (q * q - 1.0) * (q * q + 3.0) / q * K);
    }

    FaceTable() {
        constexpr double h = 1.0 / N;
        double G[N + 1], slope[N + 1], diagonal[N + 1];
        for (int k = 0; k < N; ++k) {
            const double m = double(k) / N;
            G[k] = std::sqrt(1.0 - m) * mean_distance(std::sqrt(m / (1.0 - m)));
        }
        G[N] = 1.0;
        slope[0] = 1.0 / 6.0;  // G = 2/3 + m/6 ... and 1 - 3/8 (1 - m) ... from the series of the mean distance
        slope[N] = 3.0 / 8.0;
        // slopes of the spline: s_(k-1) + 4 s_k + s_(k+1) = 3 (G_(k+1) - G_(k-1))/h
        diagonal[0] = 1.0;
        for (int k = 1; k < N; ++k) {
            const double below = k == 1 ? 0.0 : 1.0 / diagonal[k - 1];
            diagonal[k] = 4.0 - below;
            slope[k] = 3.0 * (G[k + 1] - G[k - 1]) / h - (k == 1 ? slope[0] : below * slope[k - 1]) - (k == N - 1 ? slope[N] : 0.0);
        }
        slope[N - 1] /= diagonal[N - 1];
        for (int k = N - 2; k > 0; --k) slope[k] = (slope[k] - slope[k + 1]) / diagonal[k];
        for (int k = 0; k < N; ++k) {
            const double rise = (G[k + 1] - G[k]) / h;
            coefficient[k][0] = G[k];
            coefficient[k][1] = slope[k];
            coefficient[k][2] = (3.0 * rise - 2.0 * slope[k] - slope[k + 1]) / h;
            coefficient[k][3] = (slope[k] + slope[k + 1] - 2.0 * rise) / (h * h);
        }
    }
};

// Of a face whose centre moves with v across its axis: `slide`, the force over -mu W, and `share`, the torque over that of a centred face,
// 2/3 mu W a a Omega/sqrt((a Omega)^2 + rest^2).
template <class T>
struct FaceFriction {
    Vec<T> slide;
    T share;

    FaceFriction(const Vec<T>& v, const T& spin, double a, double rest) {
        const T turning = spin * spin * (a * a) + rest * rest, v2 = dot(v, v), square = turning + v2, R = sqrt(square), m = v2 / square;
        T G, slope;
        FaceTable::table().at(m, G, slope);
        slide = v * ((G + slope * (1.0 - m) * 2.0) / R);
        share = (G - slope * m * 2.0) * sqrt(turning / square) * 1.5;
    }
};

}  // namespace dp
