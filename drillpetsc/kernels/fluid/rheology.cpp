// Friction laws: laminar stress, transition and turbulence; value and derivative in plain doubles.
//
// Every law is  stress = drag w F(Re)  with the laminar drag(w) = stress / w and F = friction factor / laminar friction factor.  With
// order = d ln(laminar stress) / d ln w and Re ~ density w^2 / laminar stress the derivative is  drag F (order + (2 - order) d ln F / d ln Re),
// that by the density  stress / density d ln F / d ln Re.
#include "fluid/rheology.hpp"

#include <algorithm>
#include <cstring>

using namespace dp;

namespace {

struct Laminar {
    double drag;   // stress / speed [Pa s/m]
    double order;  // d ln(stress) / d ln(speed) [-]
};
struct Factor {
    double value;  // F
    double order;  // d ln F / d ln Re
};
struct Point {
    double value, slope;
};

// ---------------------------------------------------------------- laminar flow
// The nominal shear rate g = (8 G / d) w is replaced in the viscosity by g_e = sqrt(g^2 + gamma^2): smooth through zero.
// Explicit Herschel-Bulkley: stress = (c_y / g_e + K g_e^(n-1)) g, exact without a yield stress (Rabinowitsch-Mooney).
Laminar explicit_laminar(const double* p, double shear, double g, double ge2, double yield) {
    const double n = p[RHEO_INDEX], viscous = n == 1.0 ? p[RHEO_CONSISTENCY] : p[RHEO_CONSISTENCY] * std::pow(ge2, 0.5 * (n - 1.0));
    const double plastic = yield > 0.0 ? yield / std::sqrt(ge2) : 0.0, viscosity = plastic + viscous;
    if (!(viscosity > 0.0)) return {0.0, 1.0};
    return {viscosity * shear, 1.0 + g * g / ge2 * ((n - 1.0) * viscous - plastic) / viscosity};
}

// Root of a concave, increasing g(L) by Newton from a point left of it; Eval returns value and slope.
template <class Eval>
double newton(double L, Eval eval) {
    for (int i = 0; i < 50; ++i) {
        const Point g = eval(L);
        const double step = g.value / g.slope;
        L -= step;
        if (std::fabs(step) < 1e-7) break;  // quadratic: the next step would be below rounding
    }
    return L;
}

// Excess X = stress at the wall - yield stress of a Herschel-Bulkley fluid from the exact profile.  With m = 1/n:
//   pipe  8 w/D = (4 / T^3) int t^2 gamma(t) dt = 4 K^-m X^(m+1) [X^2/(m+3) + 2 Y X/(m+2) + Y^2/(m+1)] / T^3
//   slot  8 w/d = (2 / T^2) int t gamma(t) dt   = 2 K^-m X^(m+1) [X/(m+2) + Y/(m+1)] / T^2
// (Y yield stress, T = Y + X), solved for L = ln X, where both sides are nearly straight lines.
Point exact_herschel_bulkley(const double* p, bool slot, double G, double ge) {
    const double Y = p[RHEO_YIELD], n = p[RHEO_INDEX], m = 1.0 / n;
    const double L0 = p[RHEO_LOG_K] + n * std::log(ge);  // no yield stress: a lower bound
    const double k = slot ? 2.0 : 3.0, c = (slot ? 2.0 : 4.0) * G;
    const double L1 = (m * L0 - std::log(c / ((m + 1.0) * Y))) / (m + 1.0);  // X << Y: the other lower bound
    double X = 0.0, T = 0.0, slope = 1.0;
    const auto eval = [&](double L) -> Point {
        X = std::exp(L);
        T = Y + X;
        const double q2 = 1.0 / (m + 2.0), q1 = Y / (m + 1.0);
        const double P = slot ? X * q2 + q1 : X * (X / (m + 3.0) + 2.0 * Y * q2) + Y * q1;
        const double dP = slot ? q2 : 2.0 * (X / (m + 3.0) + Y * q2);
        slope = m + 1.0 + X * dP / P - k * X / T;
        return {(m + 1.0) * L - m * L0 + std::log(c * P / (slot ? T * T : T * T * T)), slope};
    };
    X = std::exp(newton(std::max(L0, L1), eval));
    T = Y + X;
    return {T, X / (T * slope)};  // stress, d ln(stress) / d ln(shear rate)
}

// The same for a Casson fluid, sqrt(T) = s + u with s = sqrt(Y): gamma = u^2 / eta and t = (s + u)^2 make the integrals polynomials
// without cancellation,  int t^(k-1) gamma(t) dt = (2 / eta) sum_j binomial(2k-1, j) s^(2k-1-j) u^(j+3) / (j+3),  k = 3 pipe, 2 slot.
Point exact_casson(const double* p, bool slot, double G, double ge) {
    static const double BINOMIAL[2][6] = {{1, 5, 10, 10, 5, 1}, {1, 3, 3, 1, 0, 0}};
    const double s = std::sqrt(p[RHEO_YIELD]), newtonian = p[RHEO_CONSISTENCY] * ge;
    const int N = slot ? 3 : 5;
    const double k = slot ? 2.0 : 3.0, c = (slot ? 4.0 : 8.0) * G, target = std::log(newtonian);
    double slope = 1.0;
    const auto eval = [&](double L) -> Point {
        const double u = std::exp(L), root = s + u;
        double Q = 0.0, dQ = 0.0, power = 1.0;  // Horner in s: sum_j b_j s^(N-j) u^j / (j+3)
        for (int j = 0; j <= N; ++j) {
            const double term = BINOMIAL[slot][j] * power / (j + 3);
            Q = Q * s + term;
            dQ = dQ * s + j * term;  // u dQ/du
            power *= u;
        }
        const double T = root * root;
        slope = 3.0 + dQ / Q - 2.0 * k * u / root;
        return {std::log(c * u * u * u * Q / (slot ? T * T : T * T * T)) - target, slope};
    };
    const double start = std::max(std::sqrt(newtonian), std::cbrt(3.0 * s * newtonian / c));  // both bounds from below
    const double u = std::exp(newton(std::log(start), eval)), root = s + u;
    return {root * root, 2.0 * u / (root * slope)};
}

// Wall stress at the nominal rate 8 w/d by the rows of a flow curve of the user: cubics between them, power laws beyond.
Point own_curve(const double* p, bool slot, double rate) {
    const double* table;
    std::memcpy(&table, p + RHEO_TABLE, sizeof table);
    typedef OwnCurve C;
    const int count = int(table[0]);
    const double* rows = table + 1 + (slot ? (long)count * C::COLUMNS : 0);
    const double x = std::log(rate);
    int low = 0, high = count - 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        (rows[middle * C::COLUMNS + C::LOG_RATE] <= x ? low : high) = middle;
    }
    const double *a = rows + low * C::COLUMNS, *b = rows + high * C::COLUMNS, h = b[C::LOG_RATE] - a[C::LOG_RATE], t = (x - a[C::LOG_RATE]) / h;
    if (t < 0.0) return {std::exp(a[C::LOG_STRESS] + a[C::SLOPE] * t * h), a[C::SLOPE]};
    if (t > 1.0) return {std::exp(b[C::LOG_STRESS] + b[C::SLOPE] * (t - 1.0) * h), b[C::SLOPE]};
    const double rise = b[C::LOG_STRESS] - a[C::LOG_STRESS], left = a[C::SLOPE] * h, right = b[C::SLOPE] * h;
    const double c2 = 3.0 * rise - 2.0 * left - right, c3 = left + right - 2.0 * rise;
    return {std::exp(a[C::LOG_STRESS] + t * (left + t * (c2 + t * c3))), (left + t * (2.0 * c2 + 3.0 * t * c3)) / h};
}

Laminar laminar(const double* p, double w, double d, bool slot) {
    const double G = p[slot ? RHEO_SHEAR_SLOT : RHEO_SHEAR_PIPE] / 8.0, shear = 8.0 * G / d, g = shear * w;
    const double ge2 = g * g + p[RHEO_GAMMA] * p[RHEO_GAMMA];
    const bool casson = p[RHEO_KIND] == CASSON, implicit = casson || p[RHEO_LAW] == FrictionLaw::EXACT;
    if (!implicit || p[RHEO_YIELD] == 0.0)
        return explicit_laminar(p, shear, g, ge2, p[slot ? RHEO_YIELD_SLOT : RHEO_YIELD_PIPE]);
    const double ge = std::sqrt(ge2);
    Point wall = {p[RHEO_YIELD], 0.0};  // no viscosity: the stress stays at its yield value
    if (p[RHEO_CONSISTENCY] > 0.0) wall = casson ? exact_casson(p, slot, G, ge) : exact_herschel_bulkley(p, slot, G, ge);
    return {wall.value / ge * shear, 1.0 + g * g / ge2 * (wall.slope - 1.0)};
}

// The same of a flow curve of the user.
__attribute__((noinline)) Laminar own_laminar(const double* p, double w, double d, bool slot) {
    const double G = p[slot ? RHEO_SHEAR_SLOT : RHEO_SHEAR_PIPE] / 8.0, shear = 8.0 * G / d, g = shear * w;
    const double ge2 = g * g + p[RHEO_GAMMA] * p[RHEO_GAMMA], ge = std::sqrt(ge2);
    const Point wall = own_curve(p, slot, ge / G);
    return {wall.value / ge * shear, 1.0 + g * g / ge2 * (wall.slope - 1.0)};
}

// ---------------------------------------------------------------- transition and turbulence
// F^12 = 1 + (x^-8 + y^-8)^(-12/8), x = f_tr/f_lam = (Re/limit)^2, y = f_tu/f_lam = a Re^(1-b) / 16.  With q = (x/y)^8 the second
// term is z = x^12 (1 + q)^(-3/2).  Outside 0.2 .. 1000 limits one term is below rounding.
Factor blend_factor(const double* p, double Re) {
    const double r = Re / p[RHEO_LIMIT], b = p[RHEO_B];
    if (r < 0.2) return {1.0, 0.0};
    const double power = b == 0.25 ? std::sqrt(std::sqrt(Re)) : std::pow(Re, b), y = p[RHEO_A] * Re / (16.0 * power);
    if (r > 1000.0) return {y, 1.0 - b};
    const double r2 = r * r, r4 = r2 * r2, r8 = r4 * r4, v = r2 / y, v2 = v * v, v4 = v2 * v2, q = v4 * v4;
    const double z = r8 * r8 * r8 / ((1.0 + q) * std::sqrt(1.0 + q));
    const double order = z / (1.0 + z) * (2.0 - (1.0 + b) * q / (1.0 + q));
    return {std::cbrt(std::sqrt(std::sqrt(1.0 + z))), order};
}

// Cubic through value and slope at both ends of the rounding around the kink at R0.
Point rounded(const Point& left, const Point& right, double R0, double Re) {
    const double h = 2.0 * API_ROUNDING, t = (Re - R0 + API_ROUNDING) / h, rise = right.value - left.value;
    const double c2 = 3.0 * rise - h * (2.0 * left.slope + right.slope), c3 = h * (left.slope + right.slope) - 2.0 * rise;
    return {left.value + t * (h * left.slope + t * (c2 + t * c3)), left.slope + t * (2.0 * c2 + 3.0 * t * c3) / h};
}

// API form: f = lam/Re (lam 16 pipe, 24 annulus), linear in Re between limit and limit + 800, then a/Re^b; kinks rounded.
Factor api_factor(const double* p, double Re, double lam) {
    const double R1 = p[RHEO_LIMIT], R2 = R1 + 800.0, a = p[RHEO_A], b = p[RHEO_B];
    if (Re <= R1 - API_ROUNDING) return {1.0, 0.0};
    if (Re >= R2 + API_ROUNDING) return {a * Re / (lam * std::pow(Re, b)), 1.0 - b};
    const double k = (p[RHEO_F_TURBULENT] - lam / R1) / 800.0;
    const auto straight = [&](double R) { return Point{lam / R1 + k * (R - R1), k}; };
    Point f = straight(Re);
    if (Re < R1 + API_ROUNDING) {
        const double R = R1 - API_ROUNDING;
        f = rounded({lam / R, -lam / (R * R)}, straight(R1 + API_ROUNDING), R1, Re);
    } else if (Re > R2 - API_ROUNDING) {
        const double R = R2 + API_ROUNDING, turbulent = a * std::pow(R, -b);
        f = rounded(straight(R2 - API_ROUNDING), {turbulent, -b * turbulent / R}, R2, Re);
    }
    return {f.value * Re / lam, 1.0 + Re * f.slope / f.value};
}

}  // namespace

namespace dp {

WallShear wall_shear_and_slope(const double* p, double w, double d, double alpha, double density) {
    const bool slot = alpha > 0.5;
    const Laminar l = p[RHEO_KIND] == OWN ? own_laminar(p, w, d, slot) : laminar(p, w, d, slot);
    if (!(l.drag > 0.0)) return {0.0, 0.0, 0.0};  // an inviscid fluid has no wall friction, turbulent or not
    const double Re = std::min(8.0 * density * std::fabs(w) / l.drag, 1e100);
    const Factor F = p[RHEO_LAW] == FrictionLaw::API ? api_factor(p, slot ? 1.5 * Re : Re, slot ? 24.0 : 16.0) : blend_factor(p, Re);
    const double drag = l.drag * F.value;
    return {drag * w, drag * (l.order + (2.0 - l.order) * F.order), drag * w * F.order / density};
}

}  // namespace dp

DP_EXPORT(rheology_kind, RheologyKindText)
DP_EXPORT(friction_law, FrictionLaw::KindText)

DP_EXPORT(own_curve, OwnCurve::ColumnText)

extern "C" int rheology_size() { return RHEOLOGY_SIZE; }

// The law p has a flow curve of the user, whose table the caller keeps alive.  Its stress is not explicit in the speed, as if it had a yield stress.
extern "C" void rheology_own_curve(double* p, const double* table) {
    std::memcpy(p + RHEO_TABLE, &table, sizeof table);
    p[RHEO_LAW] = FrictionLaw::EXACT;
    p[RHEO_YIELD] = 1.0;
}

// Fills the law p (RHEOLOGY_SIZE).  kind, law as in fluid/rheology.hpp; consistency [Pa s^n], yield [Pa], gamma [1/s].
extern "C" void rheology_pack(int kind, int law, double consistency, double n, double yield, double gamma, double* p) {
    const double turbulent = std::max(n, 0.05);  // below, a and b lose their meaning (turbulent would be less than laminar)
    const double pipe = (3.0 * n + 1.0) / (4.0 * n), slot = 1.5 * (2.0 * n + 1.0) / (3.0 * n);
    p[RHEO_KIND] = kind;
    p[RHEO_TABLE] = 0.0;
    p[RHEO_LAW] = law;
    p[RHEO_YIELD] = yield;
    p[RHEO_CONSISTENCY] = consistency;
    p[RHEO_INDEX] = n;
    p[RHEO_GAMMA] = gamma;
    p[RHEO_LOG_K] = consistency > 0.0 ? std::log(consistency) : 0.0;
    p[RHEO_A] = (std::log10(turbulent) + 3.93) / 50.0;
    p[RHEO_B] = (1.75 - std::log10(turbulent)) / 7.0;
    p[RHEO_LIMIT] = 3470.0 - 1370.0 * n;
    p[RHEO_F_TURBULENT] = p[RHEO_A] * std::pow(p[RHEO_LIMIT] + 800.0, -p[RHEO_B]);
    p[RHEO_SHEAR_PIPE] = 8.0 * pipe;
    p[RHEO_SHEAR_SLOT] = 8.0 * slot;
    p[RHEO_YIELD_PIPE] = std::pow(4.0 / 3.0, n) * yield;
    p[RHEO_YIELD_SLOT] = std::pow(1.5, n) * yield;
}

// Stress [Pa] and its derivative by the speed [Pa s/m], n values each of w, diameter, alpha and density.
extern "C" void rheology_wall_shear(const double* p, int n, const double* w, const double* d, const double* alpha, const double* density,
                                    double* stress, double* slope) {
    for (int i = 0; i < n; ++i) {
        const WallShear r = wall_shear_and_slope(p, w[i], d[i], alpha[i], density[i]);
        stress[i] = r.stress;
        slope[i] = r.slope;
    }
}

// For tests: the same through the template with the four derivatives of w as given, seed (n, 4); out (n, 5): value, derivatives.
extern "C" void rheology_wall_shear_dual(const double* p, int n, const double* w, const double* seed, double d, double alpha,
                                         double density, double* out) {
    for (int i = 0; i < n; ++i) {
        Dual<4> x(w[i]);
        for (int k = 0; k < 4; ++k) x.set(k, seed[4 * i + k]);
        const Dual<4> r = wall_shear(p, x, d, alpha, density);
        out[5 * i] = r.v;
        for (int k = 0; k < 4; ++k) out[5 * i + 1 + k] = r.d(k);
    }
}
