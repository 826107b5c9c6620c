#include "tools/agitator.hpp"

using namespace dp;
DP_ENTRY(agitator, Agitator<false>)
DP_ENTRY(agitator_flowing, Agitator<true>)
DP_RESULTS(agitator, Agitator<false>)
DP_RESULTS(agitator_flowing, Agitator<true>)
DP_EXPORT(agitator_results, AgitatorParameters::ResultText)
