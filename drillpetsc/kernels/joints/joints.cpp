#include "core/formulations.hpp"
#include "joints/joints.hpp"

using namespace dp;
DP_ENTRY(joint, Joint<false>)
DP_ENTRY(joint_stabilised, Joint<true>)
DP_ENTRY(unit_slope, UnitSlope)
DP_OTHER_FORMULATIONS(joint, Joint<false>, 2)
DP_OTHER_FORMULATIONS(unit_slope, UnitSlope, 1)

// Results of a joint: tension, side force [N], torque, bending moment [N m] that the part above exerts on the part below; angle between the
// tangents [rad], travel along the tangent [m]; largest error of the position [m] and of the angles [rad]; energy in spring and stops [J];
// power of the damper [W]; speed of the travel [m/s]; force of the stops, positive at the outer one [N].
DP_RECORD(JointResults, double tension, side_force, torque, bending, angle, travel, place_error, angle_error, stored, damping_power, speed, stop;)
DP_EXPORT(joint_results, JointResultsText)
DP_EXPORT(joint_kind, JointKind::KindText)

// Results of n joints; width: unknowns of a joint in idx.
extern "C" void joint_results(int n, int width, const int* idx, const double* par, void*, const double* x, const double* y, double* results) {
    typedef JointParameters P;
    JointResults* out = reinterpret_cast<JointResults*>(results);
    for (int e = 0; e < n; ++e) {
        const double* p = par + e * P::NP;
        double X[20], Y[14];
        for (int i = 0; i < 20; ++i) X[i] = x[idx[width * e + i]];
        for (int i = 0; i < 14; ++i) Y[i] = y[idx[width * e + i]];
        const JointState<double> j(X, Y, p);
        const int kind = static_cast<int>(p[P::KIND]);
        double R[20], place = 0, angle = 0;
        Joint<false>::force(e, X, Y, Y, p, nullptr, R);
        Vec<double> F = vec(R + 7), moment = {0, 0, 0};  // F: what the part below needs, the part above pulls with -F
        for (int i = 0; i < 6; ++i) {
            if (!constrains(kind, i)) continue;
            double& worst = i < 3 ? place : angle;
            worst = std::fmax(worst, std::fabs(R[14 + i]) / p[P::SCALE]);
            if (i >= 3) moment += cross(j.E[PAIR[i - 3][0]], j.G[PAIR[i - 3][1]]) * (X[14 + i] * p[P::SCALE]);
        }
        double stored = 0.0;
        if (kind == JointKind::TORSION_SLIDER) {
            const double turned = Twist<double>(j).angle;
            moment += twist_moment(j, p);
            stored = 0.5 * p[P::TORSION] * turned * turned;
        }
        const double tension = dot(F, j.above.t), torque = dot(moment, j.above.t), travel = dot(j.way, j.above.t);
        const double speed = dot(j.above.t, j.way_rate) + dot(cross(j.above.t, j.way), j.above.turning);
        const Vec<double> bent = cross(j.above.t, j.below.t);
        out[e] = {tension, norm(F - j.above.t * tension), torque, norm(moment - j.above.t * torque),
                                std::atan2(norm(bent), dot(j.above.t, j.below.t)), travel, place, angle,
                                slides(kind) ? stored + slider_energy(travel, p) : 0.0, slides(kind) ? p[P::DAMPER] * speed * speed : 0.0, speed,
                                slides(kind) ? slider_stops(travel, p) : 0.0};
    }
}

// Directions (7, 6) in which the six corrections move the rates of the node above: its position along the joint's axes (in space unless it
// is a slider), its frame about the axes that a constraint holds.  They depend on that node alone, so that every rank that holds it
// can apply them; with them the constraints' rates can be met unless a universal joint is bent by 90 degrees.
struct JointDirections { DP_ENUM(Parameter, KIND, REFERENCE, SECOND = REFERENCE + 3, AXES = SECOND + 3, NP = AXES + 9) };
DP_EXPORT(joint_directions_parameters, JointDirections::ParameterText)

extern "C" void joint_directions(int n, const int* rows, const double* par, const double* x, double* out) {
    for (int e = 0; e < n; ++e) {
        typedef JointDirections P;
        const double* p = par + P::NP * e;
        double X[7], Y[7] = {0, 0, 0, 0, 0, 0, 0}, *B = out + 42 * e;
        for (int i = 0; i < 7; ++i) X[i] = x[rows[7 * e + i]];
        const Section<double> s(X, Y, vec(p + P::REFERENCE), vec(p + P::SECOND));
        const int kind = static_cast<int>(p[P::KIND]);
        for (int i = 0; i < 42; ++i) B[i] = 0.0;
        const Vec<double> E[3] = {s.axis(p + P::AXES), s.axis(p + P::AXES + 3), s.axis(p + P::AXES + 6)}, about[3] = {E[2], -E[1], E[0]};
        for (int i = 0; i < 6; ++i) {
            if (!constrains(kind, i)) continue;
            const auto put = [&](int row, const Vec<double>& q) { B[6 * row + i] = q.x; B[6 * (row + 1) + i] = q.y; B[6 * (row + 2) + i] = q.z; };
            if (i < 3) {
                const Vec<double> e3 = {i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0};
                put(0, slides(kind) ? E[i] : e3);
            } else {
                put(3, cross(about[i - 3], s.t) * s.n);
                B[36 + i] = dot(about[i - 3], s.t);
            }
        }
    }
}
