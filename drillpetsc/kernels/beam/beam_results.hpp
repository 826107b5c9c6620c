// Columns of the results of a string's element, whichever beam it is.
#pragma once
#include "core/names.hpp"

namespace dp {

DP_ENUM(BeamResult,
    KINETIC, STRAIN, POTENTIAL,                 // energies [J]
    AXIAL_UPPER, AXIAL_MIDDLE, AXIAL_LOWER,     // axial force [N]
    TORQUE, BENDING_UPPER, BENDING_LOWER,       // [N m]
    BEAM_RESULTS)

// What the energy balance needs of an element after every step: energies [J], and the power that its material turns into heat [W].
DP_ENUM(BeamBalance, STORED_KINETIC, STORED_STRAIN, STORED_POTENTIAL, DISSIPATED, BEAM_BALANCE)

}  // namespace dp
