// Energies and section forces of the elements, and the power lost in the material, four elements side by side.  Everything is inlined
// (flatten): what an entry does not return is not computed.
#include "beam/beam.hpp"
#include "beam/beam_results.hpp"

using namespace dp;

namespace {

typedef Vec<Pack> PackVec;

struct ElementState {
    PackVec d, v1, v2, r1, r2, u1, u2, w1, w2;
    Pack phi1, phi2, o1, o2;
};

ElementState gather(const Lanes& lanes, int D, const int* idx, const Pack* p, const double* x, const double* y) {
    Pack X[15], Y[15];
    lanes.gather(D, idx, x, X);
    lanes.gather(D, idx, y, Y);
    ElementState s = {vec(X), vec(X + 3), vec(X + 10), vec(X), vec(X + 7), vec(Y), vec(Y + 7), vec(Y + 3), vec(Y + 10), X[6], X[13], Y[6], Y[13]};
    if (D == 15) {
        const Tangent<Pack> t(s.v1, s.w1, s.w1);
        s.r1 += t.t * p[RIGID]; s.u1 += t.t1 * p[RIGID];
        s.w1 = s.v1 * Y[14] + s.w1 * X[14];
        s.v1 = s.v1 * X[14];
    }
    s.d = s.r2 - s.r1;
    return s;
}

// q M q of the consistent mass matrix of the cubic interpolation, over the mass
Pack mass_form(const Pack& L, const PackVec& a1, const PackVec& a2, const PackVec& b1, const PackVec& b2) {
    return (156 * (dot(a1, a1) + dot(b1, b1)) + 4 * L * L * (dot(a2, a2) + dot(b2, b2)) + 108 * dot(a1, b1) + 44 * L * (dot(a1, a2) - dot(b1, b2)) +
            26 * L * (dot(b1, a2) - dot(a1, b2)) - 6 * L * L * dot(a2, b2)) * (1.0 / 420);
}
// the same of the spin inertia, over jp L
Pack spin_form(const Pack& o1, const Pack& o2) { return (5 * o1 * o1 + 2 * o1 * o2 + 5 * o2 * o2) * (1.0 / 12); }

// 2 U / (EA L) of the end strains and the mean strain, or of their rates
Pack axial_form(const Pack& e1, const Pack& e2, const Pack& em) {
    return 2.0 / 15 * (e1 * e1 + e2 * e2) - 1.0 / 15 * e1 * e2 - 0.2 * (e1 + e2) * em + 1.2 * em * em;
}

Pack strain_energy(const ElementState& s, const Pack* p, Pack* N, Pack* torque, Pack* M) {
    const Pack L = p[LENGTH], il = 1.0 / L, n1 = norm(s.v1), n2 = norm(s.v2), e1 = n1 - 1.0, e2 = n2 - 1.0;
    Pack em = -1.0, bend = 0.0;
    for (int g = 0; g < 3; ++g) {
        const Shape<Pack, Pack> S(XI3[g], il);
        const PackVec r1 = S.slope(s.d, s.v1, s.v2);
        const Pack n = norm(r1), in = 1.0 / n;
        const Bend<Pack> b(r1 * in, in, S.second(s.d, s.v1, s.v2));
        em += W3[g] * n;
        bend += W3[g] * dot(b.k, b.k);
    }
    N[0] = p[EA] * e1; N[2] = p[EA] * e2; N[1] = p[EA] * (1.5 * em - 0.25 * (e1 + e2));
    for (int end = 0; end < 2; ++end) {
        const Shape<Pack, Pack> S(end, il);
        const PackVec v = end ? s.v2 : s.v1;
        M[end] = p[EI] * norm(cross(v, S.second(s.d, s.v1, s.v2))) / dot(v, v);
    }
    const Pack angle = twist(s.d, s.v1, s.v2, n1, n2, s.phi1, s.phi2, p).value;
    *torque = p[GJ] * angle * il;
    return 0.5 * L * (p[EA] * axial_form(e1, e2, em) + p[EI] * bend) + 0.5 * *torque * angle;
}

// Kinetic energies of the velocities and of the spin over half of the length.
struct Motion { Pack velocity, spin; };
Motion motion(const ElementState& s, const Pack* p) {
    const Pack L = p[LENGTH];
    return {p[MASS] * mass_form(L, s.u1, s.w1, s.u2, s.w2), p[POLAR] * spin_form(s.o1, s.o2)};
}

// Strain energy, and power turned into heat: beta times the energy form of the strain rates twice over, alpha times that of the velocities.
struct Balance { Pack strain, dissipated; };
Balance balance(const ElementState& s, const Pack* p, const Motion& moving) {
    const Pack L = p[LENGTH], il = 1.0 / L, n1 = norm(s.v1), n2 = norm(s.v2), e1 = n1 - 1.0, e2 = n2 - 1.0;
    const PackVec ud = s.u2 - s.u1;
    Pack em = -1.0, bend = 0.0, em_rate = 0.0, bend_rate = 0.0;
    for (int g = 0; g < 3; ++g) {
        const Shape<Pack, Pack> S(XI3[g], il);
        const PackVec r1 = S.slope(s.d, s.v1, s.v2), q1 = S.slope(ud, s.w1, s.w2), q2 = S.second(ud, s.w1, s.w2);
        const Pack n = norm(r1), in = 1.0 / n;
        const PackVec t = r1 * in;
        const Bend<Pack> b(t, in, S.second(s.d, s.v1, s.v2));
        const PackVec rate = b.rate(t, in, q1, q2, s.o1 * (1 - XI3[g]) + s.o2 * XI3[g]);
        em += W3[g] * n;
        bend += W3[g] * dot(b.k, b.k);
        em_rate += W3[g] * dot(t, q1);
        bend_rate += W3[g] * dot(rate, rate);
    }
    const Twist<Pack> q = twist(s.d, s.v1, s.v2, n1, n2, s.phi1, s.phi2, p);
    const Pack turn = s.o2 - s.o1 + dot(q.d, ud) + dot(q.v1, s.w1) + dot(q.v2, s.w2);
    const Pack material = L * (p[EA] * axial_form(dot(s.v1, s.w1) / n1, dot(s.v2, s.w2) / n2, em_rate) + p[EI] * bend_rate) + p[GJ] * il * turn * turn;
    return {0.5 * L * (p[EA] * axial_form(e1, e2, em) + p[EI] * bend) + 0.5 * p[GJ] * il * q.value * q.value,
            p[BETA] * material + p[ALPHA] * L * (moving.velocity + moving.spin)};
}

Pack potential(const ElementState& s, const Pack* p) {
    const Pack L = p[LENGTH];
    return -(p[MASS] * L) * dot(vec(p + GRAVITY), (s.r1 + s.r2) * 0.5 + (s.v1 - s.v2) * (L * (1.0 / 12)));
}

}  // namespace

DP_EXPORT(beam_results, BeamResultText)
DP_EXPORT(beam_balance, BeamBalanceText)

// out: (n, BEAM_RESULTS)
extern "C" __attribute__((flatten)) void beam_results(int n, int D, const int* idx, const double* par, const void*, const double* x, const double* y, double* out) {
    for (int e = 0; e < n; e += 4) {
        Pack p[BEAM_PARAMETERS], q[BEAM_RESULTS];
        const Lanes lanes(e, n);
        lanes.rows(BEAM_PARAMETERS, par, p);
        const ElementState s = gather(lanes, D, idx, p, x, y);
        const Motion moving = motion(s, p);
        q[KINETIC] = 0.5 * p[LENGTH] * (moving.velocity + moving.spin);
        q[STRAIN] = strain_energy(s, p, q + AXIAL_UPPER, q + TORQUE, q + BENDING_UPPER);
        q[POTENTIAL] = potential(s, p);
        for (int l = 0; l < lanes.count; ++l)
            for (int i = 0; i < BEAM_RESULTS; ++i) out[(e + l) * BEAM_RESULTS + i] = q[i].v[l];
    }
}

// out: (n, BEAM_BALANCE)
extern "C" __attribute__((flatten)) void beam_balance(int n, int D, const int* idx, const double* par, const void*, const double* x, const double* y,
                                                      double* out) {
    for (int e = 0; e < n; e += 4) {
        Pack p[BEAM_PARAMETERS], q[BEAM_BALANCE];
        const Lanes lanes(e, n);
        lanes.rows(BEAM_PARAMETERS, par, p);
        const ElementState s = gather(lanes, D, idx, p, x, y);
        const Motion moving = motion(s, p);
        const Balance b = balance(s, p, moving);
        q[STORED_KINETIC] = 0.5 * p[LENGTH] * (moving.velocity + moving.spin);
        q[STORED_STRAIN] = b.strain;
        q[STORED_POTENTIAL] = potential(s, p);
        q[DISSIPATED] = b.dissipated;
        lanes.store_rows(BEAM_BALANCE, q, out);
    }
}
