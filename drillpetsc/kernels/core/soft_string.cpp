// Many soft strings, each integrated from the bit up along its own steps (manual: sec-soft-string, sec-soft-string-helical).
#include <cmath>

#include "core/names.hpp"

namespace {

// Columns of ``rows``: length of the step, then at its lower and upper Gauss point cos I, curvature squared, its part across
// gravity, sin^2 I; then weight per length, contact radius, EI, clearance, friction of the item (nan: of the hole), 1 in a vertical hole.
enum Row { H, DOWN, KK = 3, KZ = 5, ZZ = 7, WEIGHT = 9, RADIUS, STIFFNESS, CLEARANCE, OWN, UPRIGHT, ROW_SIZE };

// Columns of ``steps``: mean wall force per length, mean force, compression over both buckling loads, growth of a change of the force.
DP_ENUM(Step, CONTACT, MEAN, SINUSOIDAL_RATIO, HELICAL_RATIO, GROWTH, STEP_SIZE)

// first (strings + 1): first step of each string; rows (steps, ROW_SIZE), section (steps); end (strings, 2): weight below the
// last step, cos I there. placed, item_factor, wob, moment, axial_velocity, rotation, weight_factor, thrust (count): loads of the strings that are
// integrated; friction (count, sections); lift: force per length of all points, lift_at (count): where that of a string starts, -1: none.
// tension, torque (count): at the top; nan for a string that cannot bear its weight on bit.
// sinusoidal, helical (count): largest compression over the load at which the string buckles so.
// edges (count, most + 1, 2): force and torque at the edges of the steps, steps (count, most, STEP_SIZE): null, or filled as far up as a
// string bears its forces.
DP_RECORD(SoftStringCall,
    const int* first; const double* rows; const int* section; const double* end;
    const int* placed; const double* friction; const double* item_factor; const double* wob; const double* moment;
    const double* axial_velocity; const double* rotation; const double* weight_factor; const double* thrust;
    const double* lift; const int* lift_at; double* tension; double* torque; double* sinusoidal; double* helical;
    double* edges; double* steps;
    double largest;
    int count, sections, most;
)

constexpr double ROOT = 0.28867513459481287;  // sqrt(3)/6
constexpr double A11 = 0.25, A12 = 0.25 - ROOT, A21 = 0.25 + ROOT, A22 = 0.25;
// Loads of a string in a hole with side load over sqrt(EI q/r): Dawson and Paslay (SPE 11167), Chen, Lin and Cheatham; in a vertical
// hole over (w^2 EI)^(1/3), Lubinski (1950), taken where they are larger.
const double SINUSOIDAL = 2.0, HELICAL = 2.0 * std::sqrt(2.0), UPRIGHT_SINUSOIDAL = 1.94, UPRIGHT_HELICAL = 3.75;

double side_force(double t, double k, double c, double w) { return std::sqrt(std::fmax((t * k + c) * t + w, 0.0)); }

void integrate(const SoftStringCall& s, int c) {
    const int p = s.placed[c], top = s.first[p], bottom = s.first[p + 1];
    const double* friction = s.friction + static_cast<long>(c) * s.sections;
    double t = s.end[2 * p] * s.weight_factor[c] * s.end[2 * p + 1] - s.wob[c] - s.thrust[c], turned = s.moment[c];
    double* edge = s.edges ? s.edges + 2L * c * (s.most + 1) : nullptr;
    s.sinusoidal[c] = s.helical[c] = 0.0;
    if (edge) edge[2 * (bottom - top)] = t, edge[2 * (bottom - top) + 1] = turned;
    for (int i = bottom - 1; i >= top; --i) {
        const double* r = s.rows + static_cast<long>(i) * ROW_SIZE;
        const double step = r[H], w = r[WEIGHT] * s.weight_factor[c], around = s.rotation[c] * r[RADIUS];
        const double speed = std::hypot(s.axial_velocity[c], around), scale = speed > 0 ? 1.0 / speed : 0.0;
        const double mu = std::isnan(r[OWN]) ? friction[s.section[i]] : r[OWN] * s.item_factor[c];
        const double drag = s.axial_velocity[c] * scale * mu, hoop = around * scale;
        const double lift = s.lift_at[c] < 0 ? 0.0 : s.lift[s.lift_at[c] + i - top];
        const double k1 = r[KK], k2 = r[KK + 1], g1 = w * r[DOWN] - lift, g2 = w * r[DOWN + 1] - lift;
        const double c1 = 2 * w * r[KZ], c2 = 2 * w * r[KZ + 1], w1 = w * w * r[ZZ], w2 = w * w * r[ZZ + 1];
        const double push = std::fmax(-t, 0.0), below = t;
        double bends = 0.0, ratios[2] = {0.0, 0.0};
        if (push > 0) {
            const double load = std::sqrt(r[STIFFNESS] / r[CLEARANCE] * side_force(t, k2, c2, w2));
            const double hanging = r[UPRIGHT] ? std::cbrt(w * w * r[STIFFNESS]) : 0.0;
            const double coils = std::fmax(HELICAL * load, UPRIGHT_HELICAL * hanging);
            if (push > coils) bends = r[CLEARANCE] / (4 * r[STIFFNESS]);
            ratios[0] = push / std::fmax(SINUSOIDAL * load, UPRIGHT_SINUSOIDAL * hanging), ratios[1] = push / coils;
            s.sinusoidal[c] = std::fmax(s.sinusoidal[c], ratios[0]);
            s.helical[c] = std::fmax(s.helical[c], ratios[1]);
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
        if (!edge) continue;
        edge[2 * (i - top)] = t, edge[2 * (i - top) + 1] = turned;
        const double mean = 0.5 * (lower + upper), side = side_force(below, k2, c2, w2);
        const double slope = side > 1e-9 ? (mean * k2 + 0.5 * c2) / side : 0.0;  // dN/dT without the helix
        double* row = s.steps + STEP_SIZE * (static_cast<long>(c) * s.most + i - top);
        row[CONTACT] = 0.5 * (n1 + n2), row[MEAN] = mean, row[GROWTH] = step * drag * (slope + 2 * bends * mean);
        row[SINUSOIDAL_RATIO] = ratios[0], row[HELICAL_RATIO] = ratios[1];
    }
    s.tension[c] = t, s.torque[c] = turned;
}

}  // namespace

DP_EXPORT(soft_string_step, StepText)
DP_EXPORT_RECORD(soft_string_call, SoftStringCall)

extern "C" void soft_strings(const SoftStringCall* call) {
    for (int c = 0; c < call->count; ++c) integrate(*call, c);
}
