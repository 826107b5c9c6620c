#include "tools/steering.hpp"
#include "core/formulations.hpp"

DP_ENTRY(push_pads, dp::PushPads)
DP_ENTRY(point_tilt, dp::PointTilt)
DP_OTHER_FORMULATIONS(push_pads, dp::PushPads, 1)
DP_OTHER_FORMULATIONS(point_tilt, dp::PointTilt, 2)
DP_CONSTANT(pad_window, dp::PAD_WINDOW)
DP_CONSTANT(pad_overlap, dp::PAD_OVERLAP)
