#include "tools/mud_motor.hpp"

using namespace dp;
DP_ENTRY(mud_motor, MudMotor<false>)
DP_ENTRY(mud_motor_flowing, MudMotor<true>)
DP_RESULTS(mud_motor, MudMotor<false>)
DP_RESULTS(mud_motor_flowing, MudMotor<true>)
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
