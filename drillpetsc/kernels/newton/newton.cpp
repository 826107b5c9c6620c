// Newton's iteration of a condensed step in one call, collective (manual: sec-time-newton).  Between ranks go messages to neighbours inside the
// residual, the factorisation and the solution, which Python has, and five numbers an iteration.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <ctime>

#include "core/step.hpp"
#include "newton/secants.hpp"

using namespace dp;

namespace {

// A factorisation of kernels/chain/chain.cpp and its entries; index (length): of each place of a padded vector, -1 for padding.
DP_RECORD(ChainCall,
    const void* table; double* store; const int* start; const int* first_entry; const int* pattern; const int* tile_begin; const int* tiles;
    const int* single_begin; const int* singles; double* inverse; int* pivot; double* stats; const int* index; double* vec; double tolerance; int n, length;
)

// A block of contacts: number of its MatrixCall; first (elements): first node along the chain of an element or of any after it; before: copy of
// its entries.  touching, touched (elements, points): flags now and at the factorisation; an element all of whose flags are zero has no entries.
// Null where entries do not depend on them.
DP_RECORD(ContactCall, const int* first; double* before; const signed char* touching; const signed char* touched; int block, points;)

// Bytes that change where contacts open or close; wall: any that is not zero is a closed contact at the wall.
DP_RECORD(FlagCall, const void* bytes; int size, wall;)

// How a solve ends, as PETSc counts its reasons; raised: a part in Python has raised an exception.
DP_RECORD(ReasonCall, int converged, not_a_number, no_pivot, too_many, diverging, raised;)

// Parts that Python has, null for those that are compiled.  rows(): residual at q.  entries(): of the matrix.  factor(first): from this rank's
// node `first` on.  solve(): increment of the rows.  They return 0, 1 without a pivot, -1 after an exception.  sum(values, n), largest(values, n):
// over all ranks, in place; null on one rank.
DP_RECORD(PartsCall, const void* rows; const void* entries; const void* factor; const void* solve; const void* sum; const void* largest;)

// q, rows, increment, scale (n): unknowns, residual, increment, usual sizes.  forces (force_count): rows that do work along an increment, null
// for all.  replaced: elements of contacts at each prescribed motion.  power_rows, power_rates (power_count): rows and rates of the remaining
// power.  contacts, flags, flags_before: see above; the last are those of the factorisation.  lag_shift: shift of the factorisation.
// switching: contacts of any rank may open or close.  secants: null without acceleration.  first, last: sizes of the first and the last step of this
// solve; last_left: of what the pairs left of the last increment; theta: contraction of the steps; slowest: of the error, as estimated.
// renewed: iteration that renewed the contacts last.  astray: a solve has failed with secants, and is repeated without them.
// kept (3, length of x): null, or gets x, y, a of each whole matrix, which serves after the solve if it goes on from there by the fraction `near`
// of its first increment at most; beyond: size of the first increment after it, infinite if it is of another
// solve or was renewed in its contacts.
// good, factored: there is one, and the chain has it; current: of the present entries.  work_limit: 0 without a limit.  seconds: of phases,
// added up.
DP_RECORD(NewtonCall,
    const StepCall* step; const JacobianCall* jacobian; const ChainCall* chain; const ContactCall* contacts; const PrescribedMatrix* replaced;
    const FlagCall* flags; const ReasonCall* reasons; const PartsCall* parts; SecantCall* secants;
    double* q; double* rows; double* increment; const double* scale; const int* forces; const int* power_rows; const int* power_rates; signed char* flags_before; double* kept;
    double lag_shift, shift_change, contraction, tolerance, spacing, rounding, finest, work_limit, overshoot, shortest, eta, last, slowest, last_left, first, theta, beyond, near, seconds[4];
    int n, nodes, force_count, power_count, contact_count, flag_count, line_search, max_iterations, lag_iterations, contact_iterations;
    int good, factored, current, contacts_apart, rows_known, switching, astray, iterations, renewed, evaluations, jacobians, contact_updates, factorisations;
)

enum Phase { RESIDUAL, JACOBIAN, FACTOR, SOLVE };

class Timer {
public:
    Timer(NewtonCall& call, Phase phase) : seconds(call.seconds[phase]), begun(now()) {}
    ~Timer() { seconds += now() - begun; }

private:
    static double now() {
        timespec t;
        clock_gettime(CLOCK_MONOTONIC, &t);
        return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    }
    double& seconds;
    double begun;
};

}  // namespace

DP_EXPORT_RECORD(chain_call, ChainCall)
DP_EXPORT_RECORD(contact_call, ContactCall)
DP_EXPORT_RECORD(flag_call, FlagCall)
DP_EXPORT_RECORD(reason_call, ReasonCall)
DP_EXPORT_RECORD(parts_call, PartsCall)
DP_EXPORT_RECORD(secant_call, SecantCall)
DP_EXPORT_RECORD(newton_call, NewtonCall)
DP_CONSTANT(secant_vectors, 3 + 2 * SECANTS)

extern "C" {
int chain_factor(int, int, int, const void*, double*, const int*, const int*, const int*, const int*, const int*, const int*, const int*,
                 const double*, double*, int*, double, double*, double*, double*);
void chain_solve(int, const void*, const double*, const double*, const int*, int, const int*, const double*, double*, const int*, double*);
void chain_solve_columns(int, const void*, const double*, const double*, const int*, int, const int*, int, int, const double*, double*, double*);
double scaled_size(int, const double*, const double*, double, const double*);

// Sum of rows[i] step[i] over all n rows, or over the chosen ones.
double work_along_step(int n, const int* chosen, const double* rows, const double* step) {
    double sum[4] = {0.0, 0.0, 0.0, 0.0};  // four sums hide the latency of an addition
    int k = 0;
    if (chosen) {
        for (; k + 4 <= n; k += 4)
            for (int l = 0; l < 4; ++l) sum[l] += rows[chosen[k + l]] * step[chosen[k + l]];
        for (; k < n; ++k) sum[0] += rows[chosen[k]] * step[chosen[k]];
    } else {
        for (; k + 4 <= n; k += 4)
            for (int l = 0; l < 4; ++l) sum[l] += rows[k + l] * step[k + l];
        for (; k < n; ++k) sum[0] += rows[k] * step[k];
    }
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

// Whether the sum of n numbers is finite: no number is infinite or none.
int finite_sum(int n, const double* rows) {
    double sum[4] = {0.0, 0.0, 0.0, 0.0};
    int i = 0;
    for (; i + 4 <= n; i += 4)
        for (int l = 0; l < 4; ++l) sum[l] += rows[i + l];
    for (; i < n; ++i) sum[0] += rows[i];
    return std::isfinite((sum[0] + sum[1]) + (sum[2] + sum[3]));
}

// The increment, negative, is taken.
void take_step(int n, double* step, double* q) {
    for (int i = 0; i < n; ++i) step[i] = -step[i];
    for (int i = 0; i < n; ++i) q[i] += step[i];
}

// A step that was taken is shortened to a fraction.
void shorten_step(int n, double fraction, double* step, double* q) {
    for (int i = 0; i < n; ++i) q[i] += (fraction - 1.0) * step[i];
    for (int i = 0; i < n; ++i) step[i] *= fraction;
}
}

namespace {

// Why a solve cannot go on: its rows, or its matrix, failed in Python, or the matrix has no pivot.
enum Outcome { DONE, NO_PIVOT, RAISED };

Outcome outcome(int code) { return code == 0 ? DONE : code > 0 ? NO_PIVOT : RAISED; }

template <class... Arguments>
Outcome python(const void* part, Arguments... arguments) {
    return outcome(reinterpret_cast<int (*)(Arguments...)>(const_cast<void*>(part))(arguments...));
}

void over_ranks(const void* reduction, double* values, int n) {
    if (reduction) reinterpret_cast<int (*)(double*, int)>(const_cast<void*>(reduction))(values, n);
}

// Whether it is true on any rank.
bool anywhere(const NewtonCall& c, bool here) {
    double one = here;
    over_ranks(c.parts->largest, &one, 1);
    return one > 0.0;
}

Outcome residual(NewtonCall& c) {
    if (c.parts->rows) return python(c.parts->rows);
    const Timer timer(c, RESIDUAL);
    c.evaluations++;
    step_rows(c.step, c.q, c.rows);
    return DONE;
}

double work(const NewtonCall& c) { return work_along_step(c.forces ? c.force_count : c.n, c.forces, c.rows, c.increment); }

bool flags_changed(const NewtonCall& c) {
    const signed char* before = c.flags_before;
    for (int k = 0; k < c.flag_count; before += c.flags[k++].size)
        if (std::memcmp(before, c.flags[k].bytes, c.flags[k].size)) return true;
    return false;
}

void keep_flags(NewtonCall& c) {
    signed char* before = c.flags_before;
    for (int k = 0; k < c.flag_count; before += c.flags[k++].size) std::memcpy(before, c.flags[k].bytes, c.flags[k].size);
}

bool touches_wall(const NewtonCall& c) {
    for (int k = 0; k < c.flag_count; ++k)
        for (int i = 0; c.flags[k].wall && i < c.flags[k].size; ++i)
            if (static_cast<const signed char*>(c.flags[k].bytes)[i]) return true;
    return false;
}

bool shift_fits(const NewtonCall& c) { return std::fabs(c.step->sigma / c.lag_shift - 1.0) <= c.shift_change; }

// Whether what is left of the solve will be so small that a matrix of now serves after it, and the last one will not.
bool is_due(const NewtonCall& c) {
    return c.kept && c.iterations > 1 && c.theta * c.last <= c.near * c.first && c.beyond > c.near * c.first;
}

bool reusable(const NewtonCall& c) {
    if (!(c.good && c.factored && shift_fits(c) && c.theta <= c.contraction && c.iterations - c.renewed < c.lag_iterations) || is_due(c)) return false;
    return !c.switching || !anywhere(c, flags_changed(c));
}

// Factors from node `from` on.
Outcome factor(NewtonCall& c, int from) {
    if (c.parts->factor) return python(c.parts->factor, from);
    const Timer timer(c, FACTOR);
    const ChainCall& h = *c.chain;
    c.factorisations++;
    return outcome(chain_factor(from, h.n, 0, h.table, h.store, h.start, h.first_entry, h.pattern, h.tile_begin, h.tiles, h.single_begin, h.singles,
                                c.jacobian->values, h.inverse, h.pivot, h.tolerance, h.stats, nullptr, nullptr) >= 0);
}

Outcome solve(NewtonCall& c) {
    if (c.parts->solve) return python(c.parts->solve);
    const Timer timer(c, SOLVE);
    const ChainCall& h = *c.chain;
    chain_solve(h.n, h.table, h.store, h.inverse, h.pivot, h.length, h.index, c.rows, h.vec, h.index, c.increment);
    return DONE;
}

// Whether an element has entries, or had some at the factorisation.
bool has_entries(const ContactCall& contact, int e) {
    if (!contact.touching) return true;
    const signed char *now = contact.touching + (long)e * contact.points, *before = contact.touched + (long)e * contact.points;
    int any = 0;
    for (int q = 0; q < contact.points; ++q) any |= now[q] | before[q];
    return any;
}

}  // namespace

// The entries of `count` blocks of contacts are computed anew, those of the `prescriptions` that replace rows in them with them; first of this
// rank's `nodes` along the chain that has a changed one, `nodes` where there is none.
extern "C" int renew_contact_entries(const JacobianCall* jacobian, int count, const ContactCall* contacts, int prescriptions,
                                     const PrescribedMatrix* replaced, int nodes) {
    weigh_entries(jacobian);
    for (int k = 0; k < count; ++k) {
        const ContactCall& contact = contacts[k];
        const MatrixCall& b = jacobian->blocks[contact.block];
        const std::size_t each = (std::size_t)b.width * b.width;
        for (int e = 0; e < b.count; ++e)
            if (has_entries(contact, e)) std::memcpy(contact.before + e * each, b.values + e * each, each * sizeof(double));
        block_entries(jacobian, &b);
    }
    // rows of prescribed motion in other blocks stay with their entries: it has not turned
    for (int k = 0; k < prescriptions; ++k) replace_rows(jacobian, replaced + k);
    int first = nodes;
    for (int k = 0; k < count; ++k) {
        const ContactCall& contact = contacts[k];
        const MatrixCall& b = jacobian->blocks[contact.block];
        const std::size_t each = (std::size_t)b.width * b.width;
        for (int e = 0; e < b.count && contact.first[e] < first; ++e)
            if (has_entries(contact, e) && std::memcmp(contact.before + e * each, b.values + e * each, each * sizeof(double))) {
                first = contact.first[e];
                break;
            }
    }
    return first;
}

namespace {

// Whether a prescribed motion has turned since the last entries.
bool motion_turned(const NewtonCall& c) {
    for (int k = 0; k < c.step->prescriptions; ++k) {
        const PrescribedMatrix& m = c.jacobian->prescribed[k];
        if (std::memcmp(m.applied, m.keep, 49 * sizeof(double))) return true;
    }
    return false;
}

// Whether contacts can be renewed apart and are the likely cause of slow convergence: they have switched, or the contraction is poor.  A good
// contraction that takes many iterations is that of the other entries, which are old.  A bit alone, without contact at the wall, has another cause.
bool contacts_suffice(const NewtonCall& c) {
    if (!c.contacts_apart || c.iterations >= c.contact_iterations || !(c.good && c.factored && c.current) || !shift_fits(c)) return false;
    double found[3] = {double(flags_changed(c)), double(c.contact_count && touches_wall(c)), double(motion_turned(c))};
    over_ranks(c.parts->sum, found, 3);
    return found[1] > 0.0 && found[2] == 0.0 && (c.theta > c.contraction || found[0] > 0.0);
}

// The contacts alone are renewed in the last factorisation (manual: sec-time-contact-entries).
Outcome renew_contacts(NewtonCall& c) {
    int first;
    {
        const Timer timer(c, JACOBIAN);
        first = renew_contact_entries(c.jacobian, c.contact_count, c.contacts, c.step->prescriptions, c.replaced, c.nodes);
    }
    const Outcome factored = first < c.nodes || c.parts->factor ? factor(c, first) : DONE;
    if (factored != DONE) return factored;
    keep_flags(c);
    c.slowest = 0.0;
    c.beyond = INFINITY;
    c.contact_updates++;
    c.renewed = c.iterations;
    return DONE;
}

// Takes the present entries as those of the next factorisation.
void begin_factorisation(NewtonCall& c) {
    c.jacobians++;
    c.lag_shift = c.step->sigma;
    c.good = c.current = 1;
    c.slowest = 0.0;
    keep_flags(c);
    c.eta = c.eta > 1.0 ? 1.0 : std::pow(c.eta > 1e-10 ? c.eta : 1e-10, 0.8);
}

constexpr double UNKNOWN = -1.0;

Outcome jacobian(NewtonCall& c) {
    if (c.parts->entries) {
        const Outcome computed = python(c.parts->entries);
        if (computed != DONE) return computed;
    } else {
        const Timer timer(c, JACOBIAN);
        weigh_entries(c.jacobian);
        for (int k = 0; k < c.jacobian->count; ++k) block_entries(c.jacobian, c.jacobian->blocks + k);
        prescribed_entries(c.jacobian, 1.0);
    }
    begin_factorisation(c);
    c.beyond = UNKNOWN;
    const std::size_t length = c.step->length;
    const double* const state[3] = {c.step->x, c.step->y, c.step->a};
    for (int i = 0; c.kept && i < 3; ++i) std::memcpy(c.kept + i * length, state[i], length * sizeof(double));
    if (c.kept) c.renewed = c.iterations;
    return DONE;
}

// A factorisation that fits.
Outcome prepare(NewtonCall& c) {
    if (reusable(c)) return DONE;
    if (c.secants) c.secants->count = 0;
    Outcome reached;
    if (contacts_suffice(c)) {
        reached = renew_contacts(c);
    } else {
        reached = jacobian(c);
        if (reached == DONE) reached = factor(c, 0);
        c.factored = reached == DONE;
    }
    if (reached != DONE) c.good = c.factored = 0;
    return reached;
}

bool leaves_work(const NewtonCall& c, double size) {
    if (c.work_limit <= 0.0 || size <= c.finest) return false;
    double power = residual_power(c.step, c.power_count, c.power_rows, c.rows, c.power_rates);
    over_ranks(c.parts->sum, &power, 1);
    return std::fabs(power) > c.work_limit;
}

// Whether steps of this solve are accelerated.
bool secants_help(const NewtonCall& c) { return c.secants && !c.astray; }

// least ratio of two estimates of the contraction of the same factors
constexpr double FALL = 0.3;

double size_of(const NewtonCall& c, const double* increment) { return scaled_size(c.n, increment, c.scale, c.spacing, c.q); }

// Reason to end after a step, 0 to go on (manual: eq-time-increment, eq-time-convergence, eq-time-work).  plain: the increment of the factors, for
// the step; left: what pairs leave of it.  A step that was shortened has reduced neither.
int judge(NewtonCall& c, const double* plain, const double* left) {
    const ReasonCall& r = *c.reasons;
    double found[4] = {double(!finite_sum(c.n, c.rows)), size_of(c, c.increment), 0.0, 0.0};
    found[2] = plain == c.increment ? found[1] : size_of(c, plain);
    found[3] = left == plain ? found[2] : size_of(c, left);
    over_ranks(c.parts->largest, found, 4);
    const double size = found[1];
    double eta = c.eta;
    if (found[0] > 0.0) return r.not_a_number;
    if (c.iterations > 1 && c.last > 0.0) {
        c.theta = size / c.last;
        const double of_factors = c.last_left > 0.0 ? found[2] / c.last_left : c.theta;
        if (c.theta >= 2.0 && c.iterations > 4 && size > c.first) return r.diverging;
        if (c.theta > 0.5 && of_factors > 0.5 && size < c.rounding) return r.converged;
        // two steps alone look converged where secants take the whole increment for known: the factors must reduce what was left, too
        double worst = of_factors > c.theta ? of_factors : c.theta;
        // one fast direction may hide slow ones: the estimate falls no faster than this (as in CVODE)
        if (worst < FALL * c.slowest) worst = FALL * c.slowest;
        c.slowest = worst;
        eta = worst < 1.0 ? worst / (1.0 - worst) : 10.0;
        // the next solve begins without secants, and with factors that are as old as those of this one's first two steps
        if (!secants_help(c) || (c.iterations == 2 && c.secants->count == 2)) c.eta = eta;
    }
    if (c.iterations == 1) c.first = size;
    if (c.beyond == UNKNOWN) c.beyond = size;
    c.last = size;
    c.last_left = found[3];
    const double error = eta * (size > c.last_left ? size : c.last_left);
    if (error <= c.tolerance && (c.iterations >= c.max_iterations || !leaves_work(c, error))) return r.converged;
    return c.iterations >= c.max_iterations ? r.too_many : 0;
}

int reason_of(const NewtonCall& c, Outcome ended) { return ended == NO_PIVOT ? c.reasons->no_pivot : c.reasons->raised; }

// One secant step back where the increment overshoots (manual: eq-time-line-search); before: this rank's work along it before it was taken.
Outcome shorten(NewtonCall& c, double before) {
    double both[2] = {before, work(c)};
    over_ranks(c.parts->sum, both, 2);
    if (!(both[0] < 0.0 && both[1] > -c.overshoot * both[0])) return DONE;
    const double fraction = both[0] / (both[0] - both[1]);
    shorten_step(c.n, fraction > c.shortest ? fraction : c.shortest, c.increment, c.q);
    return residual(c);
}

// The increment of the factors becomes that of the pairs.
void accelerate(NewtonCall& c) {
    Secants secants(*c.secants);
    double products[SECANT_PRODUCTS];
    const int count = secants.take(c.increment, products);
    if (!count) return;
    over_ranks(c.parts->sum, products, count);
    secants.accelerate(products, c.increment);
}

// A step from the increment of the factors, and the rows after it.
Outcome advance(NewtonCall& c) {
    if (secants_help(c)) accelerate(c);
    // along the negative step: the solution of the factors is subtracted
    take_step(c.n, c.increment, c.q);
    const double before = c.line_search ? work(c) : 0.0;
    Outcome reached = residual(c);
    if (reached == DONE && c.line_search) reached = shorten(c, before);
    if (secants_help(c)) Secants(*c.secants).keep(c.increment);
    return reached;
}

}  // namespace

extern "C" {
// Solves for `columns` right sides b (n each), at once since the factors are read from memory; work: as many padded vectors.
void newton_columns(const NewtonCall* call, int columns, const double* b, double* work, double* x) {
    const ChainCall& h = *call->chain;
    chain_solve_columns(h.n, h.table, h.store, h.inverse, h.pivot, h.length, h.index, columns, call->n, b, work, x);
}

// The tests of the iteration for another solver: after its increment, its rows and its unknowns in the record; reason to end, 0 to go on.
int newton_judge(NewtonCall* call, int iteration) {
    call->iterations = iteration;
    if (iteration) {
        call->astray = 1;  // its steps have no secants
        return judge(*call, call->increment, call->increment);
    }
    call->theta = 0.0;
    call->slowest = call->eta / (1.0 + call->eta);
    call->astray = 0;
    call->renewed = 0;
    return anywhere(*call, !finite_sum(call->n, call->rows)) ? call->reasons->not_a_number : 0;
}

// Whether another solver may use its last factorisation in an iteration; where it may not, it computes entries and calls newton_new_entries.
int newton_reusable(NewtonCall* call, int iteration) {
    call->iterations = iteration;
    return reusable(*call);
}

void newton_new_entries(NewtonCall* call) { begin_factorisation(*call); }

// Computes and factors the matrix at the present state; 0, 1 without a pivot, -1 after an exception in Python.
int newton_renew(NewtonCall* call) {
    NewtonCall& c = *call;
    c.factorisations = 0;
    c.evaluations = 0;
    const Outcome computed = jacobian(c), factored = computed == DONE ? factor(c, 0) : computed;
    c.factored = factored == DONE;
    if (factored != DONE) c.good = 0;
    return factored == DONE ? 0 : factored == NO_PIVOT ? 1 : -1;
}

// Whether the matrix serves after the solve.
int newton_is_near(NewtonCall* call) {
    NewtonCall& c = *call;
    const bool near = c.good && c.factored && c.beyond != UNKNOWN && c.beyond <= c.near * c.first && !motion_turned(c);
    return !anywhere(c, !near || flags_changed(c));
}

}

namespace {

// Iterates from the unknowns and their rows; reason to end.
int iterate(NewtonCall& c) {
    for (;;) {
        Outcome ended = prepare(c);
        if (ended == DONE) ended = solve(c);
        if (ended == DONE) ended = advance(c);
        if (ended != DONE) return reason_of(c, ended);
        c.iterations++;
        const double *plain = secants_help(c) ? c.secants->memory : c.increment, *left = secants_help(c) ? plain + c.n : plain;
        if (const int reason = judge(c, plain, left)) return reason;
    }
}

}  // namespace

extern "C" {
// Iterates from the unknowns in the assembly's x; returns the reason to end.
int newton_solve(NewtonCall* call) {
    NewtonCall& c = *call;
    const StepCall& s = *c.step;
    c.iterations = c.evaluations = c.jacobians = c.contact_updates = c.factorisations = 0;
    c.beyond = INFINITY;
    Outcome ended = DONE;
    if (!c.rows_known) {
        for (int i = 0; i < c.n; ++i) c.q[i] = s.x[s.owned[i]];
        ended = residual(c);
    }
    if (ended != DONE) return reason_of(c, ended);
    if (const int reason = newton_judge(call, 0)) return reason;
    if (c.secants) Secants(*c.secants).begin(c.q);
    const int reason = iterate(c);
    if ((reason != c.reasons->diverging && reason != c.reasons->too_many) || !c.secants || !c.secants->used) return reason;
    // secants may lead astray: once more without them
    std::memcpy(c.q, Secants(*c.secants).start(), c.n * sizeof(double));
    ended = residual(c);
    if (ended != DONE) return reason_of(c, ended);
    newton_judge(call, 0);
    c.iterations = c.good = 0;
    c.astray = 1;
    return iterate(c);
}
}
