// Contact of a circular section with the wall of the hole: normal force with exact-restitution damping, Coulomb friction.
#pragma once
#include "core/element.hpp"
#include "core/frame.hpp"
#include "core/pack_math.hpp"
#include "contact/well.hpp"
#include "bit/face_friction.hpp"

namespace dp {

constexpr double RAMP = 1e-5;  // half width of the smooth onset of the penetration [m]
constexpr double NOT_IMPOSED = -3;  // in place of a direction of turning that is given: it follows from the motion
constexpr double CLIP = 1e-2;  // rounds off the clipping of an adhesive damping force [-]

// Laws and the hole, shared by all contact elements; filled by the contact component.
DP_RECORD(ContactLaw,
    const double* well;
    double stiffness, exponent;   // force = stiffness * penetration^exponent (per length, or per point)
    double damping;               // c of the factor 1 + c * penetration rate [s/m]
    double slip;                  // velocity that rounds off Coulomb friction [m/s]
    double extra, decay;          // Stribeck: mu_s/mu_k - 1 and velocity [m/s]
    double imposed;               // 1: sliding direction given (statics), 0: from the motion
    double axial, spin;           // imposed motion of the pipe: velocity along [m/s], spin [rad/s]; only the direction counts.  Not
                                  // imposed: axial velocity of the pipe along a hole that passes by
    double side;                  // imposed: share of the friction across the pipe that pushes it sideways (its torque always acts)
    int per_point, points;        // hertz_point; points per element
    const double* at;             // (points, 2) place in the element 0..1 and weight
    double* normal;               // (elements, points) normal force of the last evaluation [N]
    int* segment;                 // (elements, points) where the projection was found
    signed char* touching;        // (elements, points) contact open or closed
    OwnLaw* own;                  // law of the user for the friction coefficient, null without one
    double* free;                 // (elements, points, 5) place and radius of a section that was last found off the wall, and the square of the
                                  // distance within which the section is so too
)

// Law of the user for the friction coefficient [-]: normal force of a contact point [N], slip speed and its parts along and round the hole [m/s],
// coefficient of the wall or the item [-], measured depth [m].
struct OwnFriction {
    DP_ENUM(State, NORMAL, SLIP_SPEED, AXIAL, AROUND, GIVEN, DEPTH, STATES);
    DP_ENUM(Result, COEFFICIENT, RESULTS);
};
constexpr double STATICS_SLIP = 1.0;  // slip speed at which a law of the user counts if only the direction of sliding is given [m/s]

template <class T>
__attribute__((noinline)) T own_friction_at(const ContactLaw& law, const T& normal, const T& axial, const T& around, const T& given, const T& depth) {
    const T state[OwnFriction::STATES] = {normal, sqrt(axial * axial + around * around), axial, around, given, depth};
    T found[OwnFriction::RESULTS];
    own_results(*law.own, state, found);
    return found[OwnFriction::COEFFICIENT];
}

// Penetration with a smooth onset: 0, (d + e)^2 / 4e, d
template <class T>
inline T onset(const T& d) {
    return choose(val(d) > RAMP, [&] { return d; }, [&] { return (d + RAMP) * (d + RAMP) * (0.25 / RAMP); });
}

template <class T>
inline T power_law(const T& d, double exponent) {
    return exponent == 1.0 ? d : d * sqrt(d);
}

template <class T>
struct Touch {
    Vec<T> force, couple;  // on the string, couple about the axis point
    T normal;
};

template <class S>
struct PointResultsOf {
    S normal, stored, damping_power, friction_power, penetration;
    Vec<S> push, along;
};
typedef PointResultsOf<double> PointResults;

// Sums over the points of an element: normal force [N], stored energy [J], damping and friction power [W]; largest penetration [m];
// force along the axis [N], torque about it [N m]; vector sums: forces without and with friction [N], of a rigid item the couple about its
// middle [N m]; tangents of the hole, weighted with the normal forces [N].
DP_RECORD(ContactResults, double normal, stored, damping_power, friction_power, penetration, axial, torque; Vec<double> push, force, couple, along;)

// Adds a contact point to the sums.  axial, torque: of the load on the string along and about its axis.
inline void add_point(const PointResults& now, const Vec<double>& force, double axial, double torque, ContactResults& sum) {
    sum.normal += now.normal; sum.stored += now.stored;
    sum.damping_power += now.damping_power; sum.friction_power += now.friction_power;
    if (now.penetration > sum.penetration) sum.penetration = now.penetration;
    sum.axial += axial; sum.torque += torque;
    sum.push += now.push; sum.force += force; sum.along += now.along;
}

// The clearance of a section changes by at most 1 + r'/(1 - e.kappa) per distance, r' the slope of the hole's radius: near a place that was found
// off the wall nothing needs to be projected.  1 - e.kappa is above 1/2 in any hole that is not bent to a knee.
// free: the five numbers of the contact point in the law.
inline bool is_known_off_wall(const double* free, const Vec<double>& x, double R) {
    const Vec<double> way = x - vec(free);
    return R == free[3] && dot(way, way) < free[4];
}

// Whether the section of radius R about the axis point x is in contact; rho, radius, ds_dx: of the hole's closest point.
inline bool is_at_wall(const Well& well, const Vec<double>& x, double R, double rho, double radius, double ds_dx, double* free) {
    free[4] = 0.0;
    const double bound = radius <= R ? R : radius;  // no clearance: a centring spring
    if (!(rho + R - bound <= -RAMP)) return true;  // what is not a number touches, and is found in the rows
    const double distance = 0.999 * (bound - R - rho - RAMP) / (1.0 + 2.0 * well.steepest);
    free[0] = x.x; free[1] = x.y; free[2] = x.z; free[3] = R;
    if (distance > 0.0 && ds_dx < 2.0) free[4] = distance * distance;
    return false;
}

// Whether point q of element e, with the axis at `place`, is in contact; h: the hole's closest point, if so.
template <class T>
inline bool touches(const ContactLaw& law, const Well& well, int e, int q, const Vec<T>& place, double R, HolePoint<T>& h) {
    const long k = (long)e * law.points + q;
    const Vec<double> x = values(place);
    law.touching[k] = 0;
    law.normal[k] = 0.0;
    if (is_known_off_wall(law.free + 5 * k, x, R)) return false;
    const Foot foot = locate(well, x, law.segment[k]);
    const HolePoint<double> at = hole_point(well, foot, x);
    law.touching[k] = is_at_wall(well, x, R, at.rho, at.radius, at.ds_dx, law.free + 5 * k);
    if (!law.touching[k]) return false;
    if constexpr (std::is_same_v<T, double>) h = at;
    else h = hole_point(well, foot, place);
    return true;
}

// The same of elements side by side.
template <class T>
inline I4 touches(const ContactLaw& law, const Well& well, const Lanes& elements, int q, const Vec<T>& place, const Pack& R, HolePoint<T>& h) {
    constexpr int N = sizeof(Foot) / sizeof(double);
    static_assert(sizeof(FootOf<Pack>) == N * sizeof(Pack));
    Foot feet[4];
    const Vec<Pack> x = values(place);
    bool near[4];
    int one = -1;
    for (int l = 0; l < 4; ++l) {
        const long k = (long)elements.at[l] * law.points + q;
        law.touching[k] = 0;
        law.normal[k] = 0.0;
        near[l] = l < elements.count && !is_known_off_wall(law.free + 5 * k, lane(x, l), R.v[l]);
        if (near[l]) feet[one = l] = locate(well, lane(x, l), law.segment[k]);
    }
    I4 touching = {0, 0, 0, 0};
    if (one < 0) return touching;
    for (int l = 0; l < 4; ++l)
        if (!near[l]) feet[l] = feet[one];  // numbers that nobody reads, but finite
    FootOf<Pack> foot;
    const double* numbers[4] = {&feet[0].u, &feet[1].u, &feet[2].u, &feet[3].u};
    for (int i = 0; i < N; ++i) (&foot.u)[i] = Pack(V4{numbers[0][i], numbers[1][i], numbers[2][i], numbers[3][i]});
    const HolePoint<Pack> at = hole_point(well, foot, x);
    for (int l = 0; l < 4; ++l) {
        if (!near[l]) continue;
        const long k = (long)elements.at[l] * law.points + q;
        law.touching[k] = is_at_wall(well, lane(x, l), R.v[l], at.rho.v[l], at.radius.v[l], at.ds_dx.v[l], law.free + 5 * k);
        touching[l] = -(long long)law.touching[k];
    }
    if constexpr (std::is_same_v<T, Pack>) h = at;
    else if (any(touching)) h = hole_point(well, foot, place);
    return touching;
}

// Touching point of the axis with velocity u, section turning with `turning`, radius R; h: the hole's closest point; weight: length it stands for,
// times its hardness.
// guided: friction has a torque and a force along the hole, none round it.  So has that of a part without clearance, which friction and the
// spring of the wall would otherwise drive to a whirl whose force the stiffness of the wall decides.
template <bool OWN, class T, class S>
inline void touch_by(const ContactLaw& law, const HolePoint<T>& h, const Vec<T>& u, const Vec<T>& turning, const S& R, const S& own_friction, const S& weight,
                     Touch<T>& out, PointResultsOf<S>* results, bool is_guided) {
    const auto clearance = no(val(h.radius) <= R);  // so that a radius that is not a number is no centring spring
    const std::decay_t<decltype(clearance)> guided = no(clearance) | -(long long)is_guided;
    const T depth = choose(clearance, [&] { return h.rho + R - h.radius; }, [&] { return h.rho; });
    const Vec<T> gradient = choose(clearance, [&] { return h.n - h.t * (h.radius_slope * h.ds_dx); }, [&] { return h.n; });
    // a centring spring has no onset: at the axis the onset's force, stiffness x RAMP/4, would jump in direction
    const T d = choose(clearance, [&] { return onset(depth); }, [&] { return depth; });
    const T elastic = power_law(d, law.exponent) * (law.stiffness * (law.per_point ? S(1.0) : weight));
    T factor = T(1.0);
    const T rate = dot(u, gradient);
    if (law.damping != 0 && !law.imposed) {
        const T a = 1.0 + rate * law.damping;
        const T root = sqrt(a * a + CLIP * CLIP);
        // (a + root)/2 without cancellation
        factor = choose(val(a) > S(0.0), [&] { return 0.5 * (a + root); }, [&] { return (0.5 * CLIP * CLIP) / (root - a); });
    }
    const T N = elastic * factor, load = choose(clearance, [&] { return N; }, [&] { return N * offset_share(h.e, h.rho); });
    const Vec<T> around = cross(h.t, h.n);
    T mu0 = choose(S(0.0) > own_friction, [&] { return h.friction; }, [&] { return T(own_friction); });
    Vec<T> drag, push = {T(0.0), T(0.0), T(0.0)};
    if (law.imposed) {
        const S va = S(law.axial), vb = law.spin * R, speed = sqrt(va * va + vb * vb);
        const S share = choose(speed > S(0.0), [&] { return 1.0 / speed; }, [] { return S(0.0); });
        if constexpr (OWN) mu0 = own_friction_at<T>(law, load, T(STATICS_SLIP * va * share), T(STATICS_SLIP * vb * share), mu0, h.s);
        drag = (h.t * (va * share) + around * (vb * share)) * (-(mu0 * load));
        const S across = choose(guided, [] { return S(0.0); }, [&] { return vb * share * law.side; });
        push = (h.t * (va * share) + around * across) * (-(mu0 * load));
        if (results) results->friction_power = S(0.0);
    } else {
        const Vec<T> rim = cross(turning, h.n) * R, surface = u + rim;
        const T va = dot(surface, h.t) + law.axial, vb = dot(choose(guided, [&] { return rim; }, [&] { return surface; }), around), v2 = va * va + vb * vb;
        const T speed = sqrt(v2 + law.slip * law.slip);
        T mu = mu0;
        if constexpr (OWN) mu = own_friction_at<T>(law, load, va, vb, mu0, h.s);
        else if (law.extra != 0) mu = mu0 * (1.0 + law.extra * exp(-v2 / (law.decay * law.decay)));
        const T grip = -(mu * load) / speed;
        drag = (h.t * va + around * vb) * grip;
        push = choose(guided, [&] { return h.t * (va * grip); }, [&] { return drag; });
        if (results) results->friction_power = val(mu * load * v2 / speed);
    }
    out.force = push - gradient * N;
    out.couple = cross(h.n, drag) * R;
    out.normal = N;
    if (results) {
        const S dv = val(d), e = val(elastic);
        results->normal = val(load);
        results->stored = e * dv / (law.exponent + 1);
        results->damping_power = (val(N) - e) * val(rate);
        results->penetration = val(depth);
        results->push = values(gradient) * -val(N);
        results->along = values(h.t) * val(N);
    }
}

// With a law of the user the code stands apart, so that the other is as fast, and rounds as it does, without one.
template <class T>
__attribute__((noinline)) void touch_by_own_law(const ContactLaw& law, const HolePoint<T>& h, const Vec<T>& u, const Vec<T>& turning, double R, double own_friction,
                                                double weight, Touch<T>& out, PointResults* results, bool guided) {
    touch_by<true>(law, h, u, turning, R, own_friction, weight, out, results, guided);
}

template <class T, class S>
inline void touch(const ContactLaw& law, const HolePoint<T>& h, const Vec<T>& u, const Vec<T>& turning, const S& R, const S& own_friction, const S& weight,
                  Touch<T>& out, PointResultsOf<S>* results, bool guided) {
    if constexpr (!std::is_same_v<S, Pack>)  // which such a law is not asked for
        if (law.own) return touch_by_own_law(law, h, u, turning, R, own_friction, weight, out, results, guided);
    touch_by<false>(law, h, u, turning, R, own_friction, weight, out, results, guided);
}

// Load of a contact point of the axis on the centre line: force, and couple as bending (on r') and torque.
template <class T>
struct PointLoad { Vec<T> force, bend; T torque, normal; Vec<T> tangent; };

template <class T, class S>
inline PointLoad<T> point_load(const ContactLaw& law, const HolePoint<T>& h, const Vec<T>& speed, const Vec<T>& slope, const Vec<T>& slope_rate, const T& spin,
                               const S& R, const S& own_friction, const S& weight, PointResultsOf<S>* results) {
    const T n = norm(slope);
    const Vec<T> t = slope / n, t1 = (slope_rate - t * dot(t, slope_rate)) / n;
    Touch<T> c;
    touch(law, h, speed, cross(t, t1) + t * spin, R, own_friction, weight, c, results, false);
    return {c.force, cross(c.couple, t) / n, dot(c.couple, t), c.normal, t};
}

// Notes the normal forces of point q, and leaves no load elsewhere than where elements touch.
template <class T> inline void finish(const ContactLaw& law, int e, int q, bool, PointLoad<T>& c) { law.normal[(long)e * law.points + q] = val(c.normal); }
template <class T> inline void finish(const ContactLaw& law, const Lanes& elements, int q, const I4& touching, PointLoad<T>& c) {
    const Vec<T> none = {0.0, 0.0, 0.0};
    c.force = blend(touching, c.force, none); c.bend = blend(touching, c.bend, none); c.torque = blend(touching, c.torque, T(0.0));
    const Pack normal = val(c.normal);
    for (int l = 0; l < elements.count; ++l)
        if (touching[l]) law.normal[(long)elements.at[l] * law.points + q] = normal.v[l];
}

// Adds a contact point to the sums of its element, or of the touching ones of those side by side.
inline void add_points(bool, const PointResults& now, const Vec<double>& force, double axial, double torque, ContactResults* sums) {
    add_point(now, force, axial, torque, *sums);
}
inline void add_points(const I4& touching, const PointResultsOf<Pack>& now, const Vec<Pack>& force, const Pack& axial, const Pack& torque, ContactResults* sums) {
    for (int l = 0; l < 4; ++l)
        if (touching[l])
            add_point({now.normal.v[l], now.stored.v[l], now.damping_power.v[l], now.friction_power.v[l], now.penetration.v[l], lane(now.push, l), lane(now.along, l)},
                      lane(force, l), axial.v[l], torque.v[l], sums[l]);
}

// Cubic interpolation at the place s (0..1) of an element: shares of r1, v1, r2, v2 in r and in r'.
template <class S>
struct Interpolation {
    S r[4], slope[4];
    Interpolation(double s, const S& L) {
        const double h = 1 - 3 * s * s + 2 * s * s * s;
        const S b = 6 * s * (1 - s) / L;
        r[0] = h; r[1] = L * (s - 2 * s * s + s * s * s); r[2] = 1 - h; r[3] = L * (s * s * s - s * s);
        slope[0] = -b; slope[1] = 1 - 4 * s + 3 * s * s; slope[2] = b; slope[3] = 3 * s * s - 2 * s;
    }
    template <class T> static Vec<T> sum(const S* c, const Vec<T>& r1, const Vec<T>& v1, const Vec<T>& r2, const Vec<T>& v2) {
        return r1 * c[0] + v1 * c[1] + r2 * c[2] + v2 * c[3];
    }
};

// Contact points spread along a beam element.
template <bool JUNCTION>
struct BeamContact {
    static constexpr int D = JUNCTION ? 15 : 14, NSPIN = 2;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[2][2] = {{6, 3}, {13, 10}};
    static OwnLaw* own_law(void* context) { return static_cast<ContactLaw*>(context)->own; }
    DP_ENUM(Parameter,
        LENGTH, RIGID,  // of the element and of the rigid item above it [m]
        RADIUS,         // of the section [m]
        FRICTION,       // coefficient; negative: that of the wall
        HARDNESS,       // stiffness of the wall over that of the law
        NP)

    template <class T, class S>
    static void force(int e, const T* x, const T* y, const T*, const S* p, void* context, T* r) {
        evaluate<T>(e, x, y, p, *static_cast<ContactLaw*>(context), r, nullptr);
    }

    // e: an element, or those side by side; results: of the first
    template <class T, class E, class S>
    static void evaluate(const E& e, const T* x, const T* y, const S* p, const ContactLaw& law, T* r, ContactResults* results) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        const S L = p[LENGTH];
        Vec<T> r1 = vec(x), v1 = vec(x + 3), u1 = vec(y), w1 = vec(y + 3);
        const Vec<T> r2 = vec(x + 7), v2 = vec(x + 10), u2 = vec(y + 7), w2 = vec(y + 10);
        const Vec<T> v0 = v1;
        T n0;
        if constexpr (JUNCTION) {
            const Tangent<T> t(v1, w1, w1);
            n0 = t.n;
            r1 += t.t * p[RIGID]; u1 += t.t1 * p[RIGID];
            w1 = v1 * y[14] + w1 * x[14];
            v1 = v1 * x[14];
        }
        const Vec<T> zero = {T(0.0), T(0.0), T(0.0)};
        Vec<T> F1 = zero, F2 = zero, G1 = zero, G2 = zero;
        T theta1 = T(0.0), theta2 = T(0.0);
        const Well well(law.well);
        for (int q = 0; q < law.points; ++q) {
            const double s = law.at[2 * q];
            const S w = law.at[2 * q + 1] * L * p[HARDNESS];
            const Interpolation<S> at(s, L);
            HolePoint<T> h;
            const auto touching = touches(law, well, e, q, at.sum(at.r, r1, v1, r2, v2), p[RADIUS], h);
            if (!any(touching)) continue;
            PointResultsOf<S> now;
            PointLoad<T> c = point_load(law, h, at.sum(at.r, u1, w1, u2, w2), at.sum(at.slope, r1, v1, r2, v2), at.sum(at.slope, u1, w1, u2, w2),
                                        y[6] * (1 - s) + y[13] * s, p[RADIUS], p[FRICTION], w, results ? &now : nullptr);
            finish(law, e, q, touching, c);
            F1 -= c.force * at.r[0] + c.bend * at.slope[0];
            G1 -= c.force * at.r[1] + c.bend * at.slope[1];
            F2 -= c.force * at.r[2] + c.bend * at.slope[2];
            G2 -= c.force * at.r[3] + c.bend * at.slope[3];
            theta1 -= c.torque * (1 - s);
            theta2 -= c.torque * s;
            if (results) add_points(touching, now, values(c.force), val(dot(c.force, c.tangent)), val(c.torque), results);
        }
        if constexpr (JUNCTION) {
            const Vec<T> t = v0 / n0;
            r[14] = dot(v0, G1);
            G1 = G1 * x[14] + (F1 - t * dot(t, F1)) * (p[RIGID] / n0);
        }
        r[0] = F1.x; r[1] = F1.y; r[2] = F1.z; r[3] = G1.x; r[4] = G1.y; r[5] = G1.z; r[6] = theta1;
        r[7] = F2.x; r[8] = F2.y; r[9] = F2.z; r[10] = G2.x; r[11] = G2.y; r[12] = G2.z; r[13] = theta2;
    }
};

// Contact points on a rigid item, at distances along the tangent of its node.
struct BodyContact {
    static constexpr int D = 7, NSPIN = 1;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{6, 3}};
    static OwnLaw* own_law(void* context) { return static_cast<ContactLaw*>(context)->own; }
    DP_ENUM(Parameter,
        ABOVE, LENGTH,  // distance from the node to the upper end, along the tangent; length [m]
        SPAN,           // length over which the wall pushes [m]
        RADIUS,         // [m]
        FRICTION,       // coefficient; negative: that of the wall
        GUIDED,         // 1: friction does not push it round the hole
        HARDNESS,       // stiffness of the wall over that of the law
        NP)

    template <class T, class S>
    static void force(int e, const T* x, const T* y, const T*, const S* p, void* context, T* r) {
        evaluate<T>(e, x, y, p, *static_cast<ContactLaw*>(context), r, nullptr);
    }

    template <class T>
    static void evaluate(int e, const T* x, const T* y, const double* p, const ContactLaw& law, T* r, ContactResults* results) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        const Tangent<T> t(vec(x + 3), vec(y + 3), vec(y + 3));
        const Vec<T> turning = cross(t.t, t.t1) + t.t * y[6];
        const Well well(law.well);
        for (int q = 0; q < law.points; ++q) {
            const double distance = p[ABOVE] + law.at[2 * q] * p[LENGTH], w = law.at[2 * q + 1] * p[SPAN] * p[HARDNESS];
            HolePoint<T> h;
            if (!touches(law, well, e, q, vec(x) + t.t * distance, p[RADIUS], h)) continue;
            Touch<T> c;
            PointResults now;
            touch(law, h, vec(y) + t.t1 * distance, turning, p[RADIUS], p[FRICTION], w, c, results ? &now : nullptr, p[GUIDED] != 0);
            law.normal[(long)e * law.points + q] = val(c.normal);
            const Vec<T> push = c.force * distance + cross(c.couple, t.t);
            const Vec<T> row = (push - t.t * dot(t.t, push)) / t.n;
            r[0] -= c.force.x; r[1] -= c.force.y; r[2] -= c.force.z;
            r[3] -= row.x; r[4] -= row.y; r[5] -= row.z;
            const T spin = dot(c.couple, t.t);
            r[6] -= spin;
            if (results) {
                const Vec<double> force = values(c.force), arm = values(t.t) * (distance - p[ABOVE] - 0.5 * p[LENGTH]);
                add_point(now, force, val(dot(c.force, t.t)), val(spin), *results);
                results->couple += cross(arm, force) + values(c.couple);
            }
        }
    }
};

// Weight on bit [N], torque on bit [N m], power into heat [W].
DP_RECORD(BitContactResults, double weight, torque, power;)

// The bit's face on the end of the hole: normal force along the hole's axis, friction of a disc of even pressure against turning and sliding.
struct BitContact {
    static constexpr int D = 7, NSPIN = 1;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[1][2] = {{6, 3}};
    DP_ENUM(Parameter,
        FACE, RADIUS,           // distance of the face from the node, radius [m]
        STIFFNESS, FRICTION,    // [N/m], coefficient
        END, AXIS = END + 3,    // 3 each: centre of the hole's end [m], direction of the hole
        SLIP = AXIS + 3,        // velocity that rounds off Coulomb friction [m/s]
        IMPOSED,                // statics: direction of turning, -1, 0 or 1; else NOT_IMPOSED
        NP)

    template <class T, class S>
    static void force(int, const T* x, const T* y, const T*, const S* p, void*, T* r) {
        evaluate<T>(x, y, p, r, nullptr);
    }

    template <class T>
    static void evaluate(const T* x, const T* y, const double* p, T* r, BitContactResults* results) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        const Tangent<T> t(vec(x + 3), vec(y + 3), vec(y + 3));
        const Vec<double> axis = vec(p + AXIS), end = vec(p + END);
        const T depth = dot(vec(x) + t.t * p[FACE] - end, axis);
        if (val(depth) <= -RAMP) return;  // not so where depth is not a number: it goes on into the rows
        const T weight = onset(depth) * p[STIFFNESS], friction = weight * p[FRICTION];
        const double arm = p[RADIUS] * (2.0 / 3);
        T torque = friction * (arm * p[IMPOSED]);
        Vec<T> push = {weight * axis.x, weight * axis.y, weight * axis.z};  // force of the bit on the rock; the rows are minus the force on the bit
        if (!(p[IMPOSED] > NOT_IMPOSED)) {
            const Vec<T> speed = vec(y) + t.t1 * p[FACE], across = speed - axis * dot(speed, axis);
            const T v = y[6] * arm;
            const FaceFriction<T> face(across, y[6], p[RADIUS], 1.5 * p[SLIP]);
            torque = friction * arm * (v / sqrt(v * v + p[SLIP] * p[SLIP])) * face.share;
            push += face.slide * friction;
            if (results) results->power = val(torque * y[6] + dot(face.slide, across) * friction);
        }
        r[0] = push.x; r[1] = push.y; r[2] = push.z;
        const Vec<T> lever = push * p[FACE];
        const Vec<T> row = (lever - t.t * dot(t.t, lever)) / t.n;
        r[3] = row.x; r[4] = row.y; r[5] = row.z;
        r[6] = torque;
        if (results) { results->weight = val(weight); results->torque = val(torque); }
    }
};

}  // namespace dp
