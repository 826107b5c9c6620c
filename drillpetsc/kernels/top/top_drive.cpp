#include "top/top_drive.hpp"

DP_ENTRY(top_motor, dp::TopMotor)
DP_EXPORT(top_motor_results, dp::TopMotor::ResultText)

// torque of the motor [N m], torque on the pipe [N m], error of the controller [rad/s], torque before the limits [N m], 1 at a limit
extern "C" void top_motor_results(int n, const int* idx, const double* par, const double* x, const double* y, const double* a, double* out) {
    using namespace dp;
    constexpr int D = TopMotor::D;
    for (int e = 0; e < n; ++e) {
        const double* p = par + e * TopMotor::NP;
        double X[D], Y[D], A[D], *o = out + e * TopMotor::RESULTS;
        for (int i = 0; i < D; ++i) { X[i] = x[idx[D * e + i]]; Y[i] = y[idx[D * e + i]]; A[i] = a[idx[D * e + i]]; }
        if (p[TopMotor::HELD] > 0) {
            const double torque = (p[TopMotor::ANGLE] - X[TopMotor::SPIN]) * p[TopMotor::HELD];
            o[TopMotor::TORQUE] = o[TopMotor::COMMAND] = torque;
            o[TopMotor::PIPE] = torque - p[TopMotor::INERTIA] * A[TopMotor::SPIN];
            o[TopMotor::ERROR] = o[TopMotor::LIMITED] = 0;
            continue;
        }
        const TopMotor::Values<double> q = TopMotor::evaluate(X, Y, A, p);
        const double margin = TopMotor::ROUNDED * p[TopMotor::MAX_TORQUE];
        o[TopMotor::TORQUE] = q.torque;
        o[TopMotor::PIPE] = q.pipe;
        o[TopMotor::ERROR] = q.error;
        o[TopMotor::COMMAND] = q.output;
        o[TopMotor::LIMITED] = p[TopMotor::MAX_TORQUE] > 0 && (q.output - q.raw > margin || q.raw - q.output > margin) ? 1 : 0;
    }
}
