"""Outputs that need more than one component: a module for each file or measurement.

Plain descriptions, like ``drillpetsc.physics.quantities``: no PETSc and no compiled kernels.  A value is a function of
the source that declares it (a class of ``drillpetsc.output``) and of the sample.  Signs: manual, sec-conventions-signs.
"""

from drillpetsc.output.quantities.along_string import (
    AXIAL_FORCE,
    BENDING,
    BENDING_MOMENT,
    EFFECTIVE_TENSION,
    HOLE_RADIUS,
    INCLINATION,
    MD,
    OFFSET_X,
    OFFSET_Y,
    STRING_FIELDS,
    TORQUE,
)
from drillpetsc.output.quantities.energy import ENERGY, POWERS
from drillpetsc.output.quantities.history import (
    HOLE,
    HOOK_LOAD_TOTAL,
    LOWER_END,
    NEWTON,
    ROW_END,
    ROW_START,
    STEP,
    TIME,
    TOP_END,
    TOP_TRAVEL,
)
from drillpetsc.output.quantities.modes import MODE_KINDS, MODE_SHARES, MODES
from drillpetsc.output.quantities.mud import (
    BORE_ONLY,
    CUTTINGS_FLOW,
    MUD,
    MUD_CONTENT,
    MUD_FIELDS,
    OUTLET_FLOW,
    PUMP_FLOW,
    SIDE_FLOW,
)
from drillpetsc.output.quantities.probes import PROBES
from drillpetsc.output.quantities.rigid_items import SIDE_FORCES, WALL_NUMBERS
from drillpetsc.output.quantities.statics import (
    BENDING_STRESS,
    BUCKLING_LOAD,
    BUCKLING_RATIO,
    CURVATURE,
    ECD,
    ITEM_SIDE_FORCE,
    STATIC_SUMMARY,
    STRETCH,
    TWIST,
    TWIST_ANGLE,
)
from drillpetsc.output.quantities.trajectory import TRAJECTORY

__all__ = [
    "AXIAL_FORCE",
    "BENDING",
    "BENDING_MOMENT",
    "BENDING_STRESS",
    "BORE_ONLY",
    "BUCKLING_LOAD",
    "BUCKLING_RATIO",
    "CURVATURE",
    "CUTTINGS_FLOW",
    "ECD",
    "EFFECTIVE_TENSION",
    "ENERGY",
    "HOLE",
    "HOLE_RADIUS",
    "HOOK_LOAD_TOTAL",
    "INCLINATION",
    "ITEM_SIDE_FORCE",
    "LOWER_END",
    "MD",
    "MODES",
    "MODE_KINDS",
    "MODE_SHARES",
    "MUD",
    "MUD_CONTENT",
    "MUD_FIELDS",
    "NEWTON",
    "OFFSET_X",
    "OFFSET_Y",
    "OUTLET_FLOW",
    "POWERS",
    "PROBES",
    "PUMP_FLOW",
    "ROW_END",
    "ROW_START",
    "SIDE_FLOW",
    "SIDE_FORCES",
    "STATIC_SUMMARY",
    "STEP",
    "STRETCH",
    "STRING_FIELDS",
    "TIME",
    "TOP_END",
    "TOP_TRAVEL",
    "TORQUE",
    "TRAJECTORY",
    "TWIST",
    "TWIST_ANGLE",
    "WALL_NUMBERS",
]
