// Positive displacement motor between the two nodes of a joint that leaves rotation about the string free: stator above, rotor below
// (manual: sec-motor).  Unknowns: those of both nodes, the torque of the motor [N m]; FLOWING: the pressures and the flow rate of the bore.
#pragma once
#include "beam/rigid_body.hpp"
#include "fluid/flow.hpp"
#include "tools/motor_law.hpp"

extern "C" void body_energy(int n, int width, const int* idx, const double* par, const void* record, const double* x, const double* y, double* out);

namespace dp {

struct MudMotorParameters {
    DP_ENUM(Parameter,
        LAW,                                   // as MotorLaw
        HELD = LAW + 6,                        // 1: statics, the joint holds the rotor; 0: in motion
        LOAD,                                  // torque in the state before, by which the mud loses pressure in statics [N m]
        FLOW,                                  // flow rate where no mud is modelled [m3/s]
        COMPRESSIBILITY,                       // of the mud [1/Pa]
        LOBES,                                 // of the rotor
        ROTOR_MASS, ECCENTRICITY, ROTOR_INERTIA,  // [kg], [m], [kg m2]
        BALANCED,                              // 1: the turning force of the rotor's orbit is left out
        GRAVITY,                               // 3: [m/s2]
        REFERENCE1 = GRAVITY + 3, SECOND1 = REFERENCE1 + 3, REFERENCE2 = SECOND1 + 3, SECOND2 = REFERENCE2 + 3,  // 3 each: frames of both nodes
        NP = SECOND2 + 3)
    DP_ENUM(Result, TORQUE, SPEED, PRESSURE, STALLED, ORBIT_SPEED, LEAK, FLOW_RATE, KINETIC, POTENTIAL, RESULTS)
};

template <bool FLOWING>
struct MudMotor : MudMotorParameters {
    static constexpr int D = FLOWING ? 18 : 15, NSPIN = 2;
    static constexpr bool PACKED = false;
    static constexpr int SPINS[2][2] = {{6, 3}, {13, 10}};
    enum Slot { ABOVE = 6, BELOW = 13, MOTOR = 14, PRESSURE1, PRESSURE2, RATE };
    static constexpr double LAW_ROW = 1e4;  // scale of the law's row [N m s/rad]

    // The orbit: spin of a body at the stator whose angle is (1 + lobes) stator - lobes rotor, counted from the same reference.  The rotor's
    // mass is at the node above the joint, and not in the pipe.
    template <class T>
    static T orbit(const T* u, const double* p) { return u[ABOVE] * (1.0 + p[LOBES]) - u[BELOW] * p[LOBES]; }

    static void orbiting_body(const double* p, double* b) {
        const bool balanced = p[BALANCED] != 0;
        for (int i = 0; i < Body::NP; ++i) b[i] = 0.0;
        b[Body::MASS] = p[ROTOR_MASS];
        b[Body::OFFSET] = balanced ? 0.0 : p[ECCENTRICITY];
        b[Body::AXIAL] = balanced ? p[ROTOR_MASS] * p[ECCENTRICITY] * p[ECCENTRICITY] : 0.0;
        for (int i = 0; i < 3; ++i) {
            b[Body::GRAVITY + i] = p[GRAVITY + i];
            b[Body::REFERENCE + i] = p[REFERENCE1 + i];
            b[Body::SECOND + i] = p[SECOND1 + i];
        }
    }

    static void rotor(const double* p, double* b) {
        for (int i = 0; i < Body::NP; ++i) b[i] = 0.0;
        b[Body::AXIAL] = p[ROTOR_INERTIA];
        for (int i = 0; i < 3; ++i) { b[Body::REFERENCE + i] = p[REFERENCE2 + i]; b[Body::SECOND + i] = p[SECOND2 + i]; }
    }

    template <class T>
    struct Values { T torque, flow; MotorPoint<T> law; };

    template <class T>
    static Values<T> evaluate(const T* x, const double* p, const MotorTable* table) {
        Values<T> q;
        q.torque = p[HELD] > 0 ? T(p[LOAD]) : x[MOTOR] * 1.0;
        if constexpr (FLOWING) q.flow = x[RATE] * exp((x[PRESSURE1] + x[PRESSURE2]) * (-0.5 * p[COMPRESSIBILITY]));
        else q.flow = T(p[FLOW]);
        q.law = motor_point(p + LAW, table, q.flow, q.torque);
        return q;
    }

    template <class T, class S>
    static void force(int e, const T* x, const T* y, const T* a, const S* p, void* context, T* r) {
        for (int i = 0; i < D; ++i) r[i] = T(0.0);
        double body[Body::NP];
        if (p[ROTOR_MASS] > 0) {
            T X[7], Y[7], A[7], R[7];
            for (int i = 0; i < 6; ++i) { X[i] = x[i]; Y[i] = y[i]; A[i] = a[i]; }
            X[6] = orbit(x, p); Y[6] = orbit(y, p); A[6] = orbit(a, p);
            orbiting_body(p, body);
            Body::force(e, X, Y, A, body, nullptr, R);
            for (int i = 0; i < 6; ++i) r[i] += R[i];
            r[ABOVE] += R[6] * (1.0 + p[LOBES]);
            r[BELOW] -= R[6] * p[LOBES];
        }
        if (p[ROTOR_INERTIA] > 0) {
            T R[7];
            rotor(p, body);
            Body::force(e, x + 7, y + 7, a + 7, body, nullptr, R);
            for (int i = 0; i < 7; ++i) r[7 + i] += R[i];
        }
        const Values<T> q = evaluate(x, p, static_cast<const MotorTable*>(context));
        if (p[HELD] > 0) {
            r[MOTOR] = x[MOTOR] * 1.0;
        } else {
            r[ABOVE] += q.torque;
            r[BELOW] -= q.torque;
            r[MOTOR] = (q.law.speed - (y[BELOW] - y[ABOVE])) * LAW_ROW;
        }
        if constexpr (FLOWING) r[RATE] = q.law.pressure * MOMENTUM_ROW;
    }

    // kinetic: of the rotor's own and of its orbiting motion
    static void results(const double* x, const double* y, const double* p, void* table, double* out) {
        const Values<double> q = evaluate(x, p, static_cast<const MotorTable*>(table));
        out[TORQUE] = q.torque;
        out[SPEED] = p[HELD] > 0 ? q.law.speed : y[BELOW] - y[ABOVE];
        out[PRESSURE] = q.law.pressure;
        out[STALLED] = q.law.share > 1.0 - 0.5 * MOTOR_CORNER ? 1.0 : 0.0;
        out[ORBIT_SPEED] = p[HELD] > 0 ? y[ABOVE] - p[LOBES] * out[SPEED] : orbit(y, p);
        out[LEAK] = q.law.leak;
        out[FLOW_RATE] = q.flow;
        constexpr int own[7] = {0, 1, 2, 3, 4, 5, 6};
        double body[Body::NP], U[7], W[7], found[2];
        rotor(p, body);
        body_energy(1, 7, own, body, nullptr, x + 7, y + 7, found);
        out[KINETIC] = found[0];
        out[POTENTIAL] = 0.0;
        if (p[ROTOR_MASS] > 0) {
            for (int i = 0; i < 6; ++i) { U[i] = x[i]; W[i] = y[i]; }
            U[6] = orbit(x, p); W[6] = orbit(y, p);
            orbiting_body(p, body);
            body_energy(1, 7, own, body, nullptr, U, W, found);
            out[KINETIC] += found[0];
            out[POTENTIAL] += found[1];
        }
    }
};

}  // namespace dp
