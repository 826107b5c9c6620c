#include "tools/reamer.hpp"
#include "core/formulations.hpp"

using namespace dp;
typedef Reamer<0> SteadyReamer;
typedef Reamer<CHIPS> ProfileReamer;
DP_ENTRY(reamer, SteadyReamer)
DP_ENTRY(reamer_profile, ProfileReamer)
DP_OTHER_FORMULATIONS(reamer, SteadyReamer, 1)
DP_OTHER_FORMULATIONS(reamer_profile, ProfileReamer, 1)
DP_RESULTS(reamer, SteadyReamer)
DP_RESULTS(reamer_profile, ProfileReamer)
DP_EXPORT(reamer_results, ReamerResultsText)
