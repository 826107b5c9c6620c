#include "joints/joints.hpp"

using namespace dp;
DP_ENTRY(joint, Joint<false>)
DP_ENTRY(joint_stabilised, Joint<true>)
DP_ENTRY(unit_slope, UnitSlope)
DP_ENTRY(rolling, Rolling)

// Figures of n joints, out (n, 10): tension, side force [N], torque, bending moment [N m] that the part above puts on the part below;
// angle between the tangents [rad], travel along the tangent [m]; largest error of the place [m] and of the angles [rad]; energy in
// spring and stops [J]; power of the damper [W].  width: unknowns of a joint in idx.
extern "C" void joint_report(int n, int width, const int* idx, const double* par, const double* x, const double* y, double* out) {
    for (int e = 0; e < n; ++e) {
        const double* p = par + e * JOINT_PARAMETERS;
        double X[20], Y[14];
        for (int i = 0; i < 20; ++i) X[i] = x[idx[width * e + i]];
        for (int i = 0; i < 14; ++i) Y[i] = y[idx[width * e + i]];
        const JointState<double> j(X, Y, p);
        const int kind = static_cast<int>(p[KIND]);
        double R[20], place = 0, angle = 0;
        Joint<false>::force(e, X, Y, Y, p, nullptr, R);
        Vec<double> F = vec(R + 7), moment = {0, 0, 0};  // F: what the part below needs, the part above pulls with -F
        for (int i = 0; i < 6; ++i) {
            if (!constrains(kind, i)) continue;
            double& worst = i < 3 ? place : angle;
            worst = std::fmax(worst, std::fabs(R[14 + i]) / p[SCALE]);
            if (i >= 3) moment += cross(j.E[PAIR[i - 3][0]], j.G[PAIR[i - 3][1]]) * (X[14 + i] * p[SCALE]);
        }
        const double tension = dot(F, j.above.t), torque = dot(moment, j.above.t), travel = dot(j.way, j.above.t);
        const double speed = dot(j.above.t, j.way_rate) + dot(cross(j.above.t, j.way), j.above.turning);
        const Vec<double> bent = cross(j.above.t, j.below.t);
        const double row[10] = {tension, norm(F - j.above.t * tension), torque, norm(moment - j.above.t * torque),
                                std::atan2(norm(bent), dot(j.above.t, j.below.t)), travel, place, angle,
                                kind == JOINT_SLIDER ? slider_energy(travel, p) : 0.0, kind == JOINT_SLIDER ? p[DAMPER] * speed * speed : 0.0};
        for (int i = 0; i < 10; ++i) out[10 * e + i] = row[i];
    }
}

// Directions (7, 6) in which the six corrections move the rates of the node above: its position along the joint's axes (in space unless it
// is a slider), its frame about the axes that a constraint holds.  They depend on that node alone, so that every rank that holds it
// can apply them; with them the constraints' rates can be met unless a universal joint is bent by 90 degrees.
// par: kind, reference (3), second (3), axes (9)
extern "C" void joint_directions(int n, const int* rows, const double* par, const double* x, double* out) {
    for (int e = 0; e < n; ++e) {
        const double* p = par + 16 * e;
        double X[7], Y[7] = {0, 0, 0, 0, 0, 0, 0}, *B = out + 42 * e;
        for (int i = 0; i < 7; ++i) X[i] = x[rows[7 * e + i]];
        const Section<double> s(X, Y, vec(p + 1), vec(p + 4));
        const int kind = static_cast<int>(p[0]);
        for (int i = 0; i < 42; ++i) B[i] = 0.0;
        const Vec<double> E[3] = {s.axis(p + 7), s.axis(p + 10), s.axis(p + 13)}, about[3] = {E[2], -E[1], E[0]};
        for (int i = 0; i < 6; ++i) {
            if (!constrains(kind, i)) continue;
            const auto put = [&](int row, const Vec<double>& q) { B[6 * row + i] = q.x; B[6 * (row + 1) + i] = q.y; B[6 * (row + 2) + i] = q.z; };
            if (i < 3) {
                const Vec<double> e3 = {i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0};
                put(0, kind == JOINT_SLIDER ? E[i] : e3);
            } else {
                put(3, cross(about[i - 3], s.t) * s.n);
                B[36 + i] = dot(about[i - 3], s.t);
            }
        }
    }
}
