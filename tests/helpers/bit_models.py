"""Short strings with a bit that cuts rock, for the verification of its laws."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.bit.rock_bit import RockBit
from tests.helpers.motion import beam, straight
from tests.helpers.wells import simple_well

RADIUS = 0.108  # of the bit and the hole [m]
TURNING = 4 * np.pi  # 120 rpm [rad/s]
DRAG = {
    "kind": "drag_bit",
    "blades": 4,
    "specific_energy": 60e6,
    "inclination_ratio": 0.6,
    "contact_stress": 60e6,
    "wear_flat": 1.2e-3,
    "friction": 0.6,
}


def drilling(
    formation: dict[str, Any],
    top: Any,
    *,
    length: float = 1.0,
    elements: int = 1,
    axial: float = 1e10,
    bending: float = 1e9,
    torsional: float = 1e9,
    mass: float = 10.0,
    polar: float = 1.0,
    inclination: float = 0.0,
    azimuth: float = 0.0,
    damping: float = 0.0,
    stiffness: float = 1e8,
    friction: float = 0.3,
    clearance: float = 0.0,
    **more,
) -> DrillingModel:
    """A straight string in a straight hole of its own length, with the bit (radius RADIUS) on bottom, without
    gravity.

    length [m]; stiffnesses EA [N], EI, GJ [N m2]; mass [kg/m]; polar [kg m]; damping: Kelvin-Voigt [s];
    stiffness of the bottom [N/m] and its friction; clearance: radial clearance of the hole [m].
    """
    item = beam(
        length,
        elements,
        axial,
        bending,
        torsional,
        mass,
        polar,
        od=2 * RADIUS,
        damping={"stiffness": damping},
    )
    well = simple_well(length, 2 * (RADIUS + clearance), inclination, azimuth=azimuth, friction=0.0)
    case = {
        "string": [item],
        "well": well,
        "contact": None,
        "top": top,
        "bottom": {"kind": "bit", "stiffness": stiffness, "friction": friction},
        "formation": formation,
        "gravity": 0.0,
        "initial": {"from": "straight"},
    }
    return straight(**{**case, **more})


def lowered(speed: float, turning: float = TURNING) -> dict[str, Any]:
    """A top drive with constant lowering and rotation."""
    return {"kind": "top_drive", "rotation": turning, "lowering": speed}


def bit_of(model: DrillingModel) -> RockBit:
    assert model.drilling is not None
    return model.drilling


def rock_bit(**formation: Any) -> RockBit:
    """The bit of a case with this formation."""
    return bit_of(drilling(formation, lowered(0.0)))


def unknowns(model: DrillingModel, name: str) -> np.ndarray:
    """Values of a field at the last node."""
    return model.system.field(name)[-1]
