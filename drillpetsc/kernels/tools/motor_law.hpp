// Law of a positive displacement motor: speed, differential pressure and leak by torque and flow rate (manual: eq-motor-speed to
// eq-motor-leak).  Corners are rounded over 1 % of the stall torque, so that the law has continuous derivatives.
#pragma once
#include "core/ad.hpp"
#include "core/names.hpp"

namespace dp {

// Measured performance of a motor, bicubic between flow rates and shares of the stall torque; filled by physics/tools/motor_law.py.
// Rows are flow rates, columns equal steps of torque over stall torque; by_flow, by_share: derivatives.
DP_RECORD(MotorTable,
    const double* flow; const double* stall; const double* stall_by_flow;                            // (flows,) [m3/s], [N m]
    const double* speed; const double* speed_by_share; const double* speed_by_flow;                 // (flows, shares) [rad/s]
    const double* pressure; const double* pressure_by_share; const double* pressure_by_flow;        // (flows, shares) [Pa]
    int flows; int shares;
)

struct MotorLaw {
    DP_ENUM(Parameter,
        TURN,                   // 2 pi times revolutions per volume [rad/m3]
        EFFICIENCY, NO_LOAD,    // [-], differential pressure without load [Pa]
        STALL, DROOP,           // [N m], exponent [-]
        BYPASS,                 // flow rate past the rotor [m3/s]
        NP)
};

constexpr double MOTOR_CORNER = 0.01;    // share of the stall torque over which a corner is rounded [-]
constexpr double MOTOR_SLIP = 1e-4;      // loss of speed under the stall torque that keeps the law invertible [rad/s]
constexpr double MOTOR_LEAST_FLOW = 1e-4;  // flow rate over which pressure and speed set in: below it the mud leaks [m3/s]

// 0 for q < 0, q for q > d, between them a cubic with the slopes 0 and 1
template <class T>
inline T rounded_up(const T& q, double d) {
    if (q <= 0.0) return q * 0.0;
    if (q >= d) return q * 1.0;
    const T s = q / d;
    return s * s * (2.0 - s) * d;
}

// q within 0 and 1, exact outside the corners
template <class T>
inline T rounded_share(const T& q) {
    if (q > 0.5) return 1.0 - rounded_up(T(1.0 - q), MOTOR_CORNER);
    return rounded_up(q, MOTOR_CORNER);
}

template <class T>
struct MotorPoint { T speed, pressure, leak, share; };  // [rad/s], [Pa], [m3/s]; torque over stall torque, not limited

// value and slope at both ends of an interval of length h; s: place in it from 0 to 1
template <class T>
inline T hermite(const T& a, const T& da, const T& b, const T& db, double h, const T& s) {
    const T u = 1.0 - s;
    return u * u * (a * (s * 2.0 + 1.0) + da * s * h) + s * s * (b * (u * 2.0 + 1.0) - db * u * h);
}

template <class T>
inline T of_table(const MotorTable& m, const double* f, const double* by_share, const double* by_flow, int k, const T& sq, int j, const T& su) {
    const double h = m.flow[k + 1] - m.flow[k], step = 1.0 / (m.shares - 1);
    const int a = k * m.shares + j, b = a + m.shares;
    const T zero = sq * 0.0;
    const T low = hermite(T(f[a]), T(by_flow[a]), T(f[b]), T(by_flow[b]), h, sq);
    const T high = hermite(T(f[a + 1]), T(by_flow[a + 1]), T(f[b + 1]), T(by_flow[b + 1]), h, sq);
    const T at_low = hermite(T(by_share[a]), zero, T(by_share[b]), zero, h, sq), at_high = hermite(T(by_share[a + 1]), zero, T(by_share[b + 1]), zero, h, sq);
    return hermite(low, at_low, high, at_high, step, su);
}

// Mud that flows up turns the rotor backwards: the law of a positive flow rate with speed, torque and pressure of the other sign.
// Without flow speed and pressure are zero under any torque, so that the power that the mud loses is never below that of the rotor.
template <class T>
inline MotorPoint<T> motor_point(const double* p, const MotorTable* table, const T& flow, const T& torque) {
    constexpr double least = MOTOR_LEAST_FLOW;
    const double down = val(flow) < 0 ? -1.0 : 1.0;
    const T passing = flow * down, load = torque * down, q = rounded_up(T(passing - p[MotorLaw::BYPASS]), least);
    const T runs = q / sqrt(q * q + least * least), flows = flow / sqrt(flow * flow + least * least);
    MotorPoint<T> out;
    if (table == nullptr) {
        out.share = load / p[MotorLaw::STALL];
        const T s = rounded_share(out.share), used = q * runs * (1.0 - pow(s, p[MotorLaw::DROOP]));
        out.leak = (q - used) * down;
        out.speed = used * (p[MotorLaw::TURN] * down);
        out.pressure = flows * p[MotorLaw::NO_LOAD] + runs * s * (down * p[MotorLaw::STALL] * p[MotorLaw::TURN] / p[MotorLaw::EFFICIENCY]);
    } else {
        const MotorTable& m = *table;
        const double most = m.flow[m.flows - 1];
        const bool beyond = val(q) > most;
        const T inside = beyond ? T(most) : q;
        int k = 0;
        while (k < m.flows - 2 && val(inside) > m.flow[k + 1]) ++k;
        const double h = m.flow[k + 1] - m.flow[k];
        const T sq = (inside - m.flow[k]) / h;
        const T stall = hermite(T(m.stall[k]), T(m.stall_by_flow[k]), T(m.stall[k + 1]), T(m.stall_by_flow[k + 1]), h, sq);
        out.share = load / stall;
        const T s = rounded_share(out.share), place = s * static_cast<double>(m.shares - 1);
        int j = static_cast<int>(val(place));
        if (j > m.shares - 2) j = m.shares - 2;
        const T su = place - static_cast<double>(j);
        const T speed = of_table(m, m.speed, m.speed_by_share, m.speed_by_flow, k, sq, j, su);
        const T free = of_table(m, m.speed, m.speed_by_share, m.speed_by_flow, k, sq, 0, T(0.0));
        const T loaded = of_table(m, m.pressure, m.pressure_by_share, m.pressure_by_flow, k, sq, j, su);
        const T idle = of_table(m, m.pressure, m.pressure_by_share, m.pressure_by_flow, k, sq, 0, T(0.0));
        out.pressure = flows * idle + runs * (loaded - idle) * down;
        out.leak = val(free) > 0 ? q * (1.0 - runs * speed / free) * down : q * down;
        out.speed = speed * runs * down;
        if (beyond) out.speed = out.speed * (q / most);  // displacement: as the flow rate
    }
    out.speed = out.speed - out.share * (MOTOR_SLIP * down);
    return out;
}

}  // namespace dp
