// Hook loads and torques of many soft strings, each integrated from the bit up along its own steps
// (manual: sec-soft-string, sec-soft-string-helical). The equations are those of analysis/loads/torque_drag/batch.py.
#include <cmath>

#include "core/names.hpp"

namespace {

// Columns of ``rows``: length of the step, then at its lower and upper Gauss point cos I, curvature squared, its part across
// gravity, sin^2 I; then weight per length, contact radius, EI, clearance, friction of the item (nan: of the hole), 1 in a vertical hole.
enum Row { H, DOWN, KK = 3, KZ = 5, ZZ = 7, WEIGHT = 9, RADIUS, STIFFNESS, CLEARANCE, OWN, UPRIGHT, ROW_SIZE };

// first (strings + 1): first step of each string; rows (steps, ROW_SIZE), section (steps); end (strings, 2): weight below the
// last step, cos I there. placed, factor, wob, moment, velocity, rotation, weight, thrust (count): loads of the strings that are
// integrated; friction (count, sections); lift: force per length of all points, lift_at (count): where that of a string starts, -1: none.
// tension, torque (count): at the top; nan for a string that cannot bear its weight on bit.
// sinusoidal, helical (count): largest compression over the load at which the string buckles so.
DP_RECORD(SoftStringCall,
    const int* first; const double* rows; const int* section; const double* end;
    const int* placed; const double* friction; const double* factor; const double* wob; const double* moment;
    const double* velocity; const double* rotation; const double* weight; const double* thrust;
    const double* lift; const int* lift_at; double* tension; double* torque; double* sinusoidal; double* helical;
    double largest;
    int count, sections;
)

constexpr double ROOT = 0.28867513459481287;  // sqrt(3)/6
constexpr double A11 = 0.25, A12 = 0.25 - ROOT, A21 = 0.25 + ROOT, A22 = 0.25;
const double SINUSOIDAL = 2.0, HELICAL = 2.0 * std::sqrt(2.0), UPRIGHT_SINUSOIDAL = 1.94, UPRIGHT_HELICAL = 3.75;  // as in batch.py

double side_force(double t, double k, double c, double w) { return std::sqrt(std::fmax((t * k + c) * t + w, 0.0)); }

void integrate(const SoftStringCall& s, int c) {
    const int p = s.placed[c], top = s.first[p], bottom = s.first[p + 1];
    const double* friction = s.friction + static_cast<long>(c) * s.sections;
    double t = s.end[2 * p] * s.weight[c] * s.end[2 * p + 1] - s.wob[c] - s.thrust[c], turned = s.moment[c];
    s.sinusoidal[c] = s.helical[c] = 0.0;
    for (int i = bottom - 1; i >= top; --i) {
        const double* r = s.rows + static_cast<long>(i) * ROW_SIZE;
        const double step = r[H], w = r[WEIGHT] * s.weight[c], around = s.rotation[c] * r[RADIUS];
        const double speed = std::hypot(s.velocity[c], around), scale = speed > 0 ? 1.0 / speed : 0.0;
        const double mu = std::isnan(r[OWN]) ? friction[s.section[i]] : r[OWN] * s.factor[c];
        const double drag = s.velocity[c] * scale * mu, hoop = around * scale;
        const double lift = s.lift_at[c] < 0 ? 0.0 : s.lift[s.lift_at[c] + i - top];
        const double k1 = r[KK], k2 = r[KK + 1], g1 = w * r[DOWN] - lift, g2 = w * r[DOWN + 1] - lift;
        const double c1 = 2 * w * r[KZ], c2 = 2 * w * r[KZ + 1], w1 = w * w * r[ZZ], w2 = w * w * r[ZZ + 1];
        const double push = std::fmax(-t, 0.0);
        double bends = 0.0;
        if (push > 0) {
            const double load = std::sqrt(r[STIFFNESS] / r[CLEARANCE] * side_force(t, k2, c2, w2));
            const double hanging = r[UPRIGHT] ? std::cbrt(w * w * r[STIFFNESS]) : 0.0;
            const double coils = std::fmax(HELICAL * load, UPRIGHT_HELICAL * hanging);
            if (push > coils) bends = r[CLEARANCE] / (4 * r[STIFFNESS]);
            s.sinusoidal[c] = std::fmax(s.sinusoidal[c], push / std::fmax(SINUSOIDAL * load, UPRIGHT_SINUSOIDAL * hanging));
            s.helical[c] = std::fmax(s.helical[c], push / coils);
        }
        double upper = t, lower = t, n1 = 0, n2 = 0, f1 = 0, f2 = 0;
        for (int k = 0; k < 50; ++k) {
            n2 = side_force(lower, k2, c2, w2) + bends * lower * lower;
            n1 = side_force(upper, k1, c1, w1) + bends * upper * upper;
            f2 = g2 + drag * n2, f1 = g1 + drag * n1;
            const double next_lower = t + step * (A11 * f2 + A12 * f1), next_upper = t + step * (A21 * f2 + A22 * f1);
            const double change = std::fabs(next_lower - lower) + std::fabs(next_upper - upper);
            lower = next_lower, upper = next_upper;
            if (change <= 1e-12 * (std::fabs(t) + step * (std::fabs(f1) + std::fabs(f2))) + 1e-300) break;
        }
        t += 0.5 * step * (f1 + f2);
        turned += step * hoop * r[RADIUS] * mu * 0.5 * (n1 + n2);
        if (!(std::fabs(t) < s.largest)) {  // the compression grows without bound
            s.tension[c] = s.torque[c] = NAN;
            return;
        }
    }
    s.tension[c] = t, s.torque[c] = turned;
}

}  // namespace

DP_EXPORT_RECORD(soft_string_call, SoftStringCall)

extern "C" void soft_string_ends(const SoftStringCall* call) {
    for (int c = 0; c < call->count; ++c) integrate(*call, c);
}
