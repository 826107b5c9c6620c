#include "core/own_law.hpp"

using namespace dp;

DP_EXPORT_RECORD(own_law, OwnLaw)
