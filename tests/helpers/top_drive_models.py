"""The string of the checks of top-drive control: 2000 m of drill pipe with 300 kg m2 at its lower end, that only twists."""

from __future__ import annotations

import numpy as np

from tests.helpers.motion import beam
from tests.helpers.wells import simple_well

LENGTH, BODY, INERTIA = 2000.0, 300.0, 2900.0  # [m], [kg m2], [kg m2] of the drive
YOUNG, DENSITY = 206e9, 7850.0
SHEAR = YOUNG / 2.6
POLAR = np.pi / 32 * (0.127**4 - 0.1086**4)  # [m4]
GJ, SPEED = SHEAR * POLAR, float(np.sqrt(SHEAR / DENSITY))  # [N m2], of torsional waves [m/s]
ZETA = POLAR * np.sqrt(SHEAR * DENSITY)  # [N m s/rad]
WEAKENING = {"kind": "velocity_weakening", "static": 6e3, "dynamic": 4e3, "speed": 6.0}
RPM = 2 * np.pi / 60

STIFF = {"kind": "stiff"}
SOFT = {"kind": "soft_torque", "damping": 4, "frequency": 0.2}
COMPENSATED = {**SOFT, "inertia_compensation": 0.75}
Z_TORQUE = {"kind": "z_torque", "factor": 0.25, "low_pass": 0}
Z_TORQUE_1 = {**Z_TORQUE, "factor": 1}


def top(control, speed, **motor) -> dict:
    """A top drive of 2900 kg m2 with a controller."""
    return {
        "kind": "top_drive",
        "rotation": speed,
        "motor": {"inertia": INERTIA, **motor},
        "control": control,
    }


def twisting(control, speed: float = 10.0, elements: int = 40, **more) -> dict:
    """The case without a bit.  Bending and stretching are stiff, so that only twist is slow."""
    pipe = beam(LENGTH, elements, 1e12, 1e15, GJ, 27.0, DENSITY * POLAR, od=0.127)
    body = {"kind": "body", "length": 0.1, "mass": 10.0, "inertia": {"axial": BODY, "transverse": 10.0}}
    held = {"kind": "top_drive", "rotation": speed}
    return {
        "string": [pipe, body],
        "top": held if control is None else top(control, speed),
        "gravity": 0.0,
        "initial": {"from": "straight"},
        **more,
    }


def on_bottom(control, speed, elements: int = 40, bit_law=None, **more) -> dict:
    """The same string with a bit of 300 kg m2 on rock that cannot be drilled, under 100 kN."""
    case = twisting(control, speed, elements)
    case["string"][1] |= {"kind": "bit", "od": 0.216}
    depth = LENGTH + 0.1
    return case | {
        "well": simple_well(depth, 0.216, friction=0.0),
        # the bit's law is shifted by its rounding, here by 0.014 rad/s (manual: eq-bit-torque-weakening)
        "contact": {"slip_velocity": 1e-3},
        "bottom": {"kind": "bit", "stiffness": 1e8, "friction": 0.0},
        "formation": {"drillability": 0, "rotary_exponent": 0, "bit_law": bit_law or WEAKENING},
        "loads": [{"at": LENGTH, "force": [0, 0, 100e3]}],
        **more,
    }
