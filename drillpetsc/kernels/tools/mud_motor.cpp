#include "tools/mud_motor.hpp"

using namespace dp;
DP_ENTRY(mud_motor, MudMotor<false>)
DP_ENTRY(mud_motor_flowing, MudMotor<true>)
DP_EXPORT(motor_law_parameters, MotorLaw::ParameterText)
DP_EXPORT(mud_motor_results, MudMotorParameters::ResultText)
DP_EXPORT_RECORD(motor_table, MotorTable)
DP_CONSTANT(motor_slip, MOTOR_SLIP)

// n points of the law: flow (n) [m3/s], torque (n) [N m]; out (n, 4): speed [rad/s], pressure [Pa], leak [m3/s], share of the stall torque
extern "C" void motor_law_points(int n, const double* par, const void* table, const double* flow, const double* torque, double* out) {
    for (int i = 0; i < n; ++i) {
        const MotorPoint<double> q = motor_point(par, static_cast<const MotorTable*>(table), flow[i], torque[i]);
        out[4 * i] = q.speed; out[4 * i + 1] = q.pressure; out[4 * i + 2] = q.leak; out[4 * i + 3] = q.share;
    }
}

// Results of n motors (columns mud_motor_results); width: unknowns of a motor in idx.
extern "C" void mud_motor_values(int n, int width, const int* idx, const double* par, const void* table, const double* x, const double* y, double* out) {
    for (int e = 0; e < n; ++e) {
        double X[18], Y[18];
        for (int i = 0; i < width; ++i) { X[i] = x[idx[width * e + i]]; Y[i] = y[idx[width * e + i]]; }
        const double* p = par + e * MudMotorParameters::NP;
        double* o = out + e * MudMotorParameters::RESULTS;
        if (width == 18) MudMotor<true>::results(X, Y, p, static_cast<const MotorTable*>(table), o);
        else MudMotor<false>::results(X, Y, p, static_cast<const MotorTable*>(table), o);
    }
}

// Energies of n motors: kinetic of the rotor's own and orbiting motion, potential (n, 2) [J]
extern "C" void body_energy(int n, int width, const int* idx, const double* par, const void* record, const double* x, const double* y, double* out);

extern "C" void mud_motor_energies(int n, int width, const int* idx, const double* par, const double* x, const double* y, double* out) {
    typedef MudMotor<false> M;
    const int own[7] = {0, 1, 2, 3, 4, 5, 6};
    for (int e = 0; e < n; ++e) {
        const double* p = par + e * M::NP;
        double X[14], Y[14], U[7], W[7], body[Body::NP], found[2], *o = out + 2 * e;
        for (int i = 0; i < 14; ++i) { X[i] = x[idx[width * e + i]]; Y[i] = y[idx[width * e + i]]; }
        M::rotor(p, body);
        body_energy(1, 7, own, body, nullptr, X + 7, Y + 7, found);
        o[0] = found[0];
        o[1] = 0.0;
        if (p[M::ROTOR_MASS] > 0) {
            for (int i = 0; i < 6; ++i) { U[i] = X[i]; W[i] = Y[i]; }
            U[6] = M::orbit(X, p); W[6] = M::orbit(Y, p);
            M::orbiting_body(p, body);
            body_energy(1, 7, own, body, nullptr, U, W, found);
            o[0] += found[0];
            o[1] += found[1];
        }
    }
}
