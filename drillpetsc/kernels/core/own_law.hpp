// A law of the user (manual: sec-own-physics): results and their derivatives at many points in one call, of a function in Python or of a plug-in.
//
// A kernel that has such a law is run twice over its elements.  The first run notes the state at each point and adds nothing, then the law is
// called once, and the second run reads results and derivatives in the same order.  So a kernel is written as if the law were called in place.
#pragma once
#include <algorithm>
#include <type_traits>
#include <vector>

#include "core/ad.hpp"
#include "core/names.hpp"

namespace dp {

// call: void (const void* context, int points, int derivatives, const double* state, double* results), which fills results (points, results,
// 1 + states): values, and with `derivatives` also the derivatives by each state.  state (capacity, states), results: storage for them.  next:
// another law of the same kernel, or null.
DP_RECORD(OwnLaw,
    const void* call; const void* context; double* state; double* results; void* next; int states, result_count, capacity, count, noting, unused;
)

typedef void OwnLawCall(const void*, int, int, const double*, double*);

// Results of the law at a state, with their derivatives by the unknowns.
template <class T, int STATES, int RESULTS>
inline void own_results(OwnLaw& law, const T (&state)[STATES], T (&results)[RESULTS]) {
    const int k = std::min(law.count++, law.capacity - 1);
    if (law.noting) {
        for (int i = 0; i < STATES; ++i) law.state[(long)k * STATES + i] = val(state[i]);
        for (int j = 0; j < RESULTS; ++j) results[j] = T(0.0);
        return;
    }
    const double* found = law.results + (long)k * RESULTS * (1 + STATES);
    for (int j = 0; j < RESULTS; ++j, found += 1 + STATES) {
        results[j] = T(found[0]);
        if constexpr (!std::is_same_v<T, double>)
            for (int i = 0; i < STATES; ++i) results[j] += (state[i] - val(state[i])) * found[1 + i];
    }
}

// Runs a kernel with its law; out: what the second run gets; scratch: what the first run writes to instead.
template <class Run>
__attribute__((noinline)) void run_own_law(OwnLaw& law, bool derivatives, double* out, double* scratch, const Run& run) {
    const auto next = [](OwnLaw* q) { return static_cast<OwnLaw*>(q->next); };
    for (OwnLaw* q = &law; q; q = next(q)) {
        q->noting = 1;
        q->count = 0;
    }
    run(scratch);
    for (OwnLaw* q = &law; q; q = next(q)) {
        const int n = std::min(q->count, q->capacity);
        if (n) reinterpret_cast<OwnLawCall*>(const_cast<void*>(q->call))(q->context, n, derivatives, q->state, q->results);
        q->noting = q->count = 0;
    }
    run(out);
}

// The law of a kernel's record, null without one; Kernel::own_law says where it is.
template <class Kernel, class = void>
struct OwnLawOf {
    static OwnLaw* at(void*) { return nullptr; }
};
template <class Kernel>
struct OwnLawOf<Kernel, std::void_t<decltype(Kernel::own_law(nullptr))>> {
    static OwnLaw* at(void* context) { return Kernel::own_law(context); }
};

// Rows are added to those that are there, so the first run adds to others.
template <class Kernel, class Run>
inline void rows_by_law(void* context, int n, const int* idx, double* r, const Run& run) {
    OwnLaw* law = OwnLawOf<Kernel>::at(context);
    if (!law) return run(r);
    std::vector<double> other(n ? 1 + *std::max_element(idx, idx + (long)n * Kernel::D) : 0);
    run_own_law(*law, false, r, other.data(), run);
}

// Entries and results are overwritten.
template <class Kernel, class Run>
inline void entries_by_law(void* context, bool derivatives, double* out, const Run& run) {
    OwnLaw* law = OwnLawOf<Kernel>::at(context);
    if (!law) return run(out);
    run_own_law(*law, derivatives, out, out, run);
}

}  // namespace dp
