// Energies and section forces of the elements, in double, for histories and fields.
#include "beam.hpp"

using namespace dp;

namespace {

enum Report { KINETIC, STRAIN, POTENTIAL, AXIAL1, AXIAL_MIDDLE, AXIAL2, TORQUE, BENDING1, BENDING2, REPORTS };

struct ElementState {
    Vec<double> d, v1, v2, r1, r2, u1, u2, w1, w2;
    double phi1, phi2, o1, o2;
};

ElementState gather(const int* idx, int D, const double* p, const double* x, const double* y) {
    const auto at = [&](const double* q, int i) { return Vec<double>{q[idx[i]], q[idx[i + 1]], q[idx[i + 2]]}; };
    ElementState s;
    s.r1 = at(x, 0); s.v1 = at(x, 3); s.phi1 = x[idx[6]]; s.r2 = at(x, 7); s.v2 = at(x, 10); s.phi2 = x[idx[13]];
    s.u1 = at(y, 0); s.w1 = at(y, 3); s.o1 = y[idx[6]]; s.u2 = at(y, 7); s.w2 = at(y, 10); s.o2 = y[idx[13]];
    if (D == 15) {
        const Tangent<double> t(s.v1, s.w1, s.w1);
        s.r1 += t.t * p[OFFSET]; s.u1 += t.t1 * p[OFFSET];
        s.w1 = s.v1 * y[idx[14]] + s.w1 * x[idx[14]];
        s.v1 = s.v1 * x[idx[14]];
    }
    s.d = s.r2 - s.r1;
    return s;
}

// 1/2 q M q and q M q2 share the consistent mass matrix of the cubic interpolation
double mass_form(double L, const Vec<double>& a1, const Vec<double>& a2, const Vec<double>& b1, const Vec<double>& b2) {
    return (156 * (dot(a1, a1) + dot(b1, b1)) + 4 * L * L * (dot(a2, a2) + dot(b2, b2)) + 108 * dot(a1, b1) + 44 * L * (dot(a1, a2) - dot(b1, b2)) +
            26 * L * (dot(b1, a2) - dot(a1, b2)) - 6 * L * L * dot(a2, b2)) / 420;
}

double strain_energy(const ElementState& s, const double* p, double* N, double* torque, double* M) {
    const double L = p[LENGTH], il = 1 / L, n1 = norm(s.v1), n2 = norm(s.v2), e1 = n1 - 1, e2 = n2 - 1;
    double em = -1, bend = 0;
    for (int g = 0; g < 3; ++g) {
        const Shape<double, double> S(XI3[g], il);
        const Vec<double> r1 = S.slope(s.d, s.v1, s.v2), r2 = S.second(s.d, s.v1, s.v2);
        const double A = dot(r1, r1), B = dot(r1, r2), C = dot(r2, r2);
        em += W3[g] * std::sqrt(A);
        bend += W3[g] * (C / A - B * B / (A * A));
    }
    N[0] = p[EA] * e1; N[2] = p[EA] * e2; N[1] = p[EA] * (1.5 * em - 0.25 * (e1 + e2));
    for (int end = 0; end < 2; ++end) {
        const Shape<double, double> S(end, il);
        const Vec<double> v = end ? s.v2 : s.v1;
        M[end] = p[EI] * norm(cross(v, S.second(s.d, s.v1, s.v2))) / dot(v, v);
    }
    const double angle = twist(s.d, s.v1, s.v2, n1, n2, s.phi1, s.phi2, p).value;
    *torque = p[GJ] * angle / L;
    const double axial = 2.0 / 15 * (e1 * e1 + e2 * e2) - e1 * e2 / 15 - 0.2 * (e1 + e2) * em + 1.2 * em * em;
    return 0.5 * L * (p[EA] * axial + p[EI] * bend) + 0.5 * *torque * angle;
}

double dissipation(const ElementState& s, const double* p) {
    if (p[BETA] == 0 && p[ALPHA] == 0) return 0;
    const Vec<double> ud = s.u2 - s.u1;
    const Work<double> a = stiffness_forces<double, double, true>(s.d, s.v1, s.v2, s.phi1, s.phi2, ud, s.w1, s.w2, s.o1, s.o2, p);
    const Work<double> b = stiffness_forces<double, double, false>(s.d, s.v1, s.v2, s.phi1, s.phi2, ud, s.w1, s.w2, s.o1, s.o2, p);
    const double L = p[LENGTH];
    const double external = p[MASS] * L * mass_form(L, s.u1, s.w1, s.u2, s.w2) + p[POLAR] * L / 12 * (5 * s.o1 * s.o1 + 2 * s.o1 * s.o2 + 5 * s.o2 * s.o2);
    return dot(a.d - b.d, ud) + dot(a.v1 - b.v1, s.w1) + dot(a.v2 - b.v2, s.w2) + (a.theta1 - b.theta1) * s.o1 + (a.theta2 - b.theta2) * s.o2 +
           p[ALPHA] * external;
}

}  // namespace

// out: (n, REPORTS)
extern "C" void beam_report(int n, int D, const int* idx, const double* par, const double* x, const double* y, double* out) {
    for (int e = 0; e < n; ++e) {
        const double* p = par + e * BEAM_PARAMETERS;
        const ElementState s = gather(idx + e * D, D, p, x, y);
        double* q = out + e * REPORTS;
        const double L = p[LENGTH], m = p[MASS] * L;
        const Vec<double> g = {p[GRAVITY], p[GRAVITY + 1], p[GRAVITY + 2]};
        q[KINETIC] = 0.5 * m * mass_form(L, s.u1, s.w1, s.u2, s.w2) + p[POLAR] * L / 24 * (5 * s.o1 * s.o1 + 2 * s.o1 * s.o2 + 5 * s.o2 * s.o2);
        q[STRAIN] = strain_energy(s, p, q + AXIAL1, q + TORQUE, q + BENDING1);
        q[POTENTIAL] = -m * dot(g, (s.r1 + s.r2) * 0.5 + (s.v1 - s.v2) * (L / 12));
    }
}

// power turned into heat by material and mass damping, summed over n elements of D unknowns [W]
extern "C" double beam_dissipation(int n, int D, const int* idx, const double* par, const double* x, const double* y) {
    double total = 0;
    for (int e = 0; e < n; ++e) {
        const double* p = par + e * BEAM_PARAMETERS;
        total += dissipation(gather(idx + e * D, D, p, x, y), p);
    }
    return total;
}
