// What the channels of the drilling fluid share: the fluid, the motion of the string's element that they ride on, Hermite matrices.
//
// Both channels count flow positive towards the bit.  Unknowns of an element: those of the string's element (0-13 as in beam/beam.hpp, the
// stretch ratio of its upper node in place 14 where JUNCTION), then pressure at both nodes [Pa, gauge pressure] and the flow rate q = G/rho0 [m3/s] of
// the element, G the mass flow relative to the string's nodes.  With HELD the string stands still and has no unknowns: only the last three.
#pragma once
#include "core/element.hpp"
#include "core/frame.hpp"
#include "beam/beam.hpp"
#include "fluid/friction_pack.hpp"

#include <type_traits>

namespace dp {

// The fluid, shared by all elements; filled by the components.
DP_RECORD(Fluid,
    double density, compressibility;  // at zero gauge pressure [kg/m3], 1/bulk modulus [1/Pa]
    double gravity[3];                // [m/s2]
    double clinging;                  // share of the pipe's speed that drags mud along in the annulus [-]
    const double* rheology;           // see fluid/rheology.hpp
)

//! scale of rows of mass [N s/m3-like] and of momentum [m2], so that rows of all components have sizes of force
constexpr double MASS_ROW = 1e6, MOMENTUM_ROW = 1e-2;
constexpr double GIVEN_PRESSURE = 1e-7;  // weight of a row of mass that gives the pressure instead [m3/s/Pa]

// wall shear stress of mud of a density
inline double shear(const Fluid& f, double w, double density, double d, double alpha) { return wall_shear(f.rheology, w, d, alpha, density); }
template <int N> inline Dual<N> shear(const Fluid& f, const Dual<N>& w, const Dual<N>& density, double d, double alpha) { return wall_shear(f.rheology, w, d, alpha, density); }
inline Pack shear(const Fluid& f, const Pack& w, const Pack& density, const Pack& d, double alpha) { return wall_shears(f.rheology, w, d, alpha, density).stress; }

// whether tool joints have a share of an element's length, or of that of one of several
inline bool has_joints(double share) { return share > 0.0; }
inline bool has_joints(const Pack& share) { return share.v[0] > 0.0 || share.v[1] > 0.0 || share.v[2] > 0.0 || share.v[3] > 0.0; }

// Bore with tool joints over a share of its length: the stress that, times 4/d of the tube, is the loss of tube and tool joints in series.
// w: speed in the mean area; tube_speed, joint_speed: mean area over that of tube and joint.
template <class T, class S>
inline T bore_shear(const Fluid& f, const T& w, const T& density, const S& d, const S& share, const S& tube_speed, const S& joint_d, const S& joint_speed) {
    if (!has_joints(share)) return shear(f, w, density, d, 0.0);
    return shear(f, T(w * tube_speed), density, d, 0.0) * (S(1.0) - share) + shear(f, T(w * joint_speed), density, joint_d, 0.0) * (share * d / joint_d);
}

// The same with its derivatives by w and by the density.
inline WallShears bore_shears(const Fluid& f, const Pack& w, const Pack& density, const Pack& d, const Pack& share, const Pack& tube_speed, const Pack& joint_d,
                              const Pack& joint_speed) {
    if (!has_joints(share)) return wall_shears(f.rheology, w, d, 0.0, density);
    const WallShears tube = wall_shears(f.rheology, w * tube_speed, d, 0.0, density), joint = wall_shears(f.rheology, w * joint_speed, joint_d, 0.0, density);
    const Pack by_tube = 1.0 - share, by_joint = share * d / joint_d;
    return {tube.stress * by_tube + joint.stress * by_joint, tube.slope * (by_tube * tube_speed) + joint.slope * (by_joint * joint_speed),
            tube.by_density * by_tube + joint.by_density * by_joint};
}

template <class T> struct Four { Vec<T> r1, v1, r2, v2; };  // nodal vectors, or rows on them

// int N x ds / (L/420): the consistent matrix of the cubic shapes
template <class T, class S>
inline Four<T> consistent(const Four<T>& x, const S& L) {
    return {x.r1 * 156.0 + x.v1 * (L * 22.0) + x.r2 * 54.0 - x.v2 * (L * 13.0),
            (x.r1 * 22.0 + x.v1 * (L * 4.0) + x.r2 * 13.0 - x.v2 * (L * 3.0)) * L,
            x.r1 * 54.0 + x.v1 * (L * 13.0) + x.r2 * 156.0 - x.v2 * (L * 22.0),
            (x.r2 * -22.0 - x.r1 * 13.0 - x.v1 * (L * 3.0) + x.v2 * (L * 4.0)) * L};
}
// int N x' ds
template <class T, class S>
inline Four<T> slopes(const Vec<T>& d, const Vec<T>& v1, const Vec<T>& v2, const S& L) {
    const Vec<T> q = (v1 - v2) * (L * 0.1), b = d * 0.5;
    return {b + q, (d - v2 * (L * (1.0 / 6))) * (L * 0.1), b - q, (v1 * (L * (1.0 / 6)) - d) * (L * 0.1)};
}
// int N' x' ds
template <class T, class S>
inline Four<T> stiffness(const Vec<T>& d, const Vec<T>& v1, const Vec<T>& v2, const S& L) {
    const S il = S(1.0 / 30) / L;
    const Vec<T> q = (v1 + v2) * (L * 3.0) - d * 36.0;
    return {q * il, (v1 * (L * 4.0) - v2 * L - d * 3.0) * (1.0 / 30), q * (-il), (v2 * (L * 4.0) - v1 * L - d * 3.0) * (1.0 / 30)};
}
template <class T, class U>
inline void accumulate(Four<T>& to, const Four<T>& x, const U& s) {
    to.r1 += x.r1 * s; to.v1 += x.v1 * s; to.r2 += x.r2 * s; to.v2 += x.v2 * s;
}

// Motion of a string's element, and the way of its rows back to the unknowns.  JUNCTION: the element's upper end is at r1 + offset v1/|v1|,
// its slope there is ratio * v1 (beam/junction.hpp).
template <class T, bool JUNCTION>
struct Ride {
    Four<T> x, y, a;
    Vec<T> above, t0;  // upper node; its tangent
    T n0, ratio;
    template <class S>
    Ride(const T* X, const T* Y, const T* A, const S& offset) {
        x = {vec(X), vec(X + 3), vec(X + 7), vec(X + 10)};
        y = {vec(Y), vec(Y + 3), vec(Y + 7), vec(Y + 10)};
        a = {vec(A), vec(A + 3), vec(A + 7), vec(A + 10)};
        above = x.r1;
        if constexpr (JUNCTION) {
            const Tangent<T> t(x.v1, y.v1, a.v1);
            n0 = t.n; t0 = t.t; ratio = X[14];
            x.r1 += t.t * offset; y.r1 += t.t1 * offset; a.r1 += t.t2 * offset;
            a.v1 = x.v1 * A[14] + y.v1 * (2.0 * Y[14]) + a.v1 * X[14];
            y.v1 = x.v1 * Y[14] + y.v1 * X[14];
            x.v1 = x.v1 * X[14];
        }
    }
    template <class S>
    void store(Four<T> F, const S& offset, T* r) const {
        if constexpr (JUNCTION) {
            r[14] = n0 * dot(t0, F.v1);
            F.v1 = F.v1 * ratio + (F.r1 - t0 * dot(t0, F.r1)) * (offset / n0);
        }
        r[0] = F.r1.x; r[1] = F.r1.y; r[2] = F.r1.z; r[3] = F.v1.x; r[4] = F.v1.y; r[5] = F.v1.z;
        r[7] = F.r2.x; r[8] = F.r2.y; r[9] = F.r2.z; r[10] = F.v2.x; r[11] = F.v2.y; r[12] = F.v2.z;
        r[6] = r[13] = T(0.0);
    }
};

// Content of a channel under pressure, relative to its content at zero pressure: (density, area) of it.
template <class T>
struct Compressed {
    T theta, by_p, density;
    template <class S>
    Compressed(const Fluid& f, const T& p, const S& wall) {
        const T e = exp(p * f.compressibility), open = 1.0 + p * wall;
        density = e * f.density;
        theta = e * open;
        by_p = theta * f.compressibility + e * wall;
    }
};

// Energy that pressure p has stored in a channel of volume V at zero pressure [J]: in the fluid rho/rho0 int p d(-rho0/rho) =
// rho/rho0 (1 - exp(-x)(1 + x))/beta, x = beta p; in the walls c p^2/2.
inline double stored_energy(const Fluid& f, double p, double wall, double volume) {
    const double x = p * f.compressibility;  // below 1e-3 by its series, which the difference would lose
    const double share = std::fabs(x) < 1e-3 ? p * x * (0.5 - x * (1.0 / 3 - x / 8)) : (1 - std::exp(-x) * (1 + x)) / f.compressibility;
    return volume * (std::exp(x) * (1 + p * wall) * share + 0.5 * wall * p * p);
}
inline Pack stored_energy(const Fluid& f, const Pack& p, const Pack& wall, const Pack& volume) {
    const Pack x = p * f.compressibility, e = exp(x);
    const Pack series = p * x * (0.5 - x * (1.0 / 3 - x * (1.0 / 8))), closed = (1.0 - (1.0 + x) / e) / f.compressibility;
    const V4 size = x.v < 0.0 ? -x.v : x.v;
    const Pack share = Pack(size < 1e-3 ? series.v : closed.v);
    return volume * (e * (1.0 + p * wall) * share + 0.5 * wall * p * p);
}

// Energies [J], power turned into heat [W], content at zero pressure [m3], its change at both ends [m3/s], speed [m/s], density [kg/m3],
// power of the forces that the give of the walls leaves out [W].
// The walls' give holds mud, which the flow lifts and compresses; the string does not carry its weight, nor the force by which pressure in
// the give would stretch the string (fluid/bore_flow.hpp).  The work of both stands in `left_out` as supplied, so that energies add up.
DP_RECORD(FlowResults, double kinetic, stored, potential, dissipated, content, storage_upper, storage_lower, speed, density, left_out;)

// The same of one element, or of four side by side, in the same order.
template <class T> struct FlowResultsPack { T kinetic, stored, potential, dissipated, content, storage_upper, storage_lower, speed, density, left_out; };
template <class T> using FlowResultsOf = std::conditional_t<std::is_same_v<T, double>, FlowResults, FlowResultsPack<T>>;
static_assert(sizeof(FlowResultsPack<double>) == sizeof(FlowResults));

// Results of the elements of a flow kernel, a record of type Results each.
template <class Kernel, class Results>
void run_results(int n, const int* idx, const double* par, const void* fluid, const double* x, const double* y, Results* out) {
    constexpr int D = Kernel::D;
    for (int e = 0; e < n; ++e) {
        double X[D], Y[D], A[D], R[D];
        for (int i = 0; i < D; ++i) { X[i] = x[idx[e * D + i]]; Y[i] = y[idx[e * D + i]]; A[i] = 0.0; }
        Kernel::template evaluate<double, double>(X, Y, A, par + e * Kernel::NP, *static_cast<const Fluid*>(fluid), R, out + e);
    }
}

// Results of the elements of a channel, four side by side.  With everything inlined (flatten) the rows, which nobody reads, are not computed.
template <class Kernel>
__attribute__((flatten)) void run_channel_results(int n, const int* idx, const double* par, const void* fluid, const double* x, const double* y, double* out) {
    constexpr int D = Kernel::D, NP = Kernel::NP, N = sizeof(FlowResults) / sizeof(double);
    for (int e = 0; e < n; e += 4) {
        Pack X[D], Y[D], A[D], P[NP], R[D];
        FlowResultsPack<Pack> results;
        const Lanes lanes(e, n);
        lanes.gather(D, idx, x, X);
        lanes.gather(D, idx, y, Y);
        for (int i = 0; i < D; ++i) A[i] = Pack(0.0);
        lanes.rows(NP, par, P);
        Kernel::template evaluate<true, Pack, Pack>(X, Y, A, P, *static_cast<const Fluid*>(fluid), R, &results);
        lanes.store_rows(N, &results.kinetic, out);
    }
}

}  // namespace dp

#define DP_CHANNEL_RESULTS(name, Kernel)                                                                                            \
    extern "C" void name##_results(int n, int, const int* idx, const double* par, const void* fluid, const double* x, const double* y, \
                                   double* out) {                                                                                   \
        dp::run_channel_results<Kernel>(n, idx, par, fluid, x, y, out);                                                             \
    }
#define DP_FLOW_RESULTS(name, Kernel, Results)                                                                                      \
    extern "C" void name##_results(int n, int, const int* idx, const double* par, const void* fluid, const double* x, const double* y, \
                                   double* out) {                                                                                   \
        dp::run_results<Kernel>(n, idx, par, fluid, x, y, reinterpret_cast<dp::Results*>(out));                                     \
    }
