// Hook loads and torques of many soft strings, each integrated from the bit up along its own steps
// (manual: sec-soft-string, sec-soft-string-helical).
#include <cmath>

#include "core/names.hpp"
#include "soft/step.hpp"

namespace {

using namespace dp::soft;

// Columns of ``rows``: length of the step, then at its lower and upper Gauss point cos I, curvature squared, its part across
// gravity, sin^2 I; then weight per length, contact radius, EI, clearance, friction of the item (nan: of the hole), 1 in a vertical hole.
enum Row { H, DOWN, KK = 3, KZ = 5, ZZ = 7, WEIGHT = 9, RADIUS, STIFFNESS, CLEARANCE, OWN, UPRIGHT_HOLE, ROW_SIZE };

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

void integrate(const SoftStringCall& s, int c) {
    const int p = s.placed[c], top = s.first[p], bottom = s.first[p + 1];
    const double* friction = s.friction + static_cast<long>(c) * s.sections;
    double t = s.end[2 * p] * s.weight[c] * s.end[2 * p + 1] - s.wob[c] - s.thrust[c], turned = s.moment[c];
    s.sinusoidal[c] = s.helical[c] = 0.0;
    for (int i = bottom - 1; i >= top; --i) {
        const double* r = s.rows + static_cast<long>(i) * ROW_SIZE;
        const double h = r[H], w = r[WEIGHT] * s.weight[c], around = s.rotation[c] * r[RADIUS];
        const double speed = std::hypot(s.velocity[c], around), scale = speed > 0 ? 1.0 / speed : 0.0;
        const double mu = std::isnan(r[OWN]) ? friction[s.section[i]] : r[OWN] * s.factor[c];
        const double drag = s.velocity[c] * scale * mu, hoop = around * scale;
        const double lift = s.lift_at[c] < 0 ? 0.0 : s.lift[s.lift_at[c] + i - top];
        const Geometry hole = {{r[DOWN], r[DOWN + 1]}, {r[KK], r[KK + 1]}, {r[KZ], r[KZ + 1]}, {r[ZZ], r[ZZ + 1]}};
        const double hanging = r[UPRIGHT_HOLE] ? std::cbrt(w * w * r[STIFFNESS]) : 0.0;
        const Values values = {w, lift, drag, r[CLEARANCE] / (4 * r[STIFFNESS]), std::sqrt(r[STIFFNESS] / r[CLEARANCE]), hanging};
        double found[RESULTS];
        t = step(hole, values, h, t, found, 1);
        s.sinusoidal[c] = std::fmax(s.sinusoidal[c], found[RATIOS]);
        s.helical[c] = std::fmax(s.helical[c], found[RATIOS + 1]);
        turned += h * hoop * r[RADIUS] * mu * found[CONTACT];
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
