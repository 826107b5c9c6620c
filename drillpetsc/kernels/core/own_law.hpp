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
// 1 + states): values, and with `derivatives` also the derivatives by each state.  state (capacity, states), results: storage for them.
DP_RECORD(OwnLaw,
    const void* call; const void* context; double* state; double* results; int states, result_count, capacity, count, noting;
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
    law.noting = 1;
    law.count = 0;
    run(scratch);
    law.noting = 0;
    law.count = std::min(law.count, law.capacity);
    if (law.count) reinterpret_cast<OwnLawCall*>(const_cast<void*>(law.call))(law.context, law.count, derivatives, law.state, law.results);
    law.count = 0;
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

// Law of a plug-in, in C++: values and exact derivatives of Law::results(state, parameters, results) at n points.
template <class Law, int STATES, int RESULTS>
inline void plug_in_law(const void* context, int n, int derivatives, const double* state, double* out) {
    const double* parameters = static_cast<const double*>(context);
    typedef Dual<(STATES + 3) / 4 * 4> T;
    for (int k = 0; k < n; ++k, state += STATES) {
        T s[STATES], r[RESULTS];
        for (int i = 0; i < STATES; ++i) {
            s[i] = T(state[i]);
            if (derivatives) s[i].set(i, 1.0);
        }
        for (int j = 0; j < RESULTS; ++j) r[j] = T(0.0);
        Law::results(s, parameters, r);
        for (int j = 0; j < RESULTS; ++j, out += 1 + STATES) {
            out[0] = r[j].v;
            for (int i = 0; i < STATES; ++i) out[1 + i] = r[j].d(i);
        }
    }
}

}  // namespace dp
