"""The string of the checks of hoisting: drill pipe that only stretches, on a bit that drills."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from drillpetsc import Case, run
from drillpetsc.output import read_table

YOUNG, DENSITY = 206e9, 7850.0
AREA = np.pi / 4 * (0.127**2 - 0.1086**2)  # [m2]
EA, SPEED = YOUNG * AREA, float(np.sqrt(YOUNG / DENSITY))  # [N], of axial waves [m/s]
DRILLABILITY = 2.8e-8  # [m/(s N)]
MATERIAL = {"young": YOUNG, "poisson": 0.3, "density": DENSITY}
LINE = {"axial_stiffness": 5.0e7}
HOIST = {"block_mass": 25e3, "lines": 10, "line": LINE, "height": 20.0}
LINE_STIFFNESS = 100 * 5.0e7 / 275  # [N/m] of HOIST


def pipe(length: float, elements: int) -> dict:
    """Drill pipe."""
    return {"kind": "pipe", "length": length, "od": 0.127, "id": 0.1086, "element_length": length / elements}


def drilling(top: dict, length: float = 2000.0, wob: float = 0.0, lying: bool = False, **more) -> dict:
    """Pipe on a bit that drills, without gravity and wall contact; or lying in a frictionless hole, which keeps it from buckling."""
    axis = [np.pi / 2] * 2 if lying else [0.0, 0.0]
    case = {
        "well": {
            "survey": {"md": [0, length], "inclination": axis, "azimuth": [0, 0]},
            "sections": [{"to": length, "kind": "open_hole", "diameter": 0.2159, "friction": 0.0}],
        },
        "string": [pipe(length, 50 if lying else 40)],
        "material": MATERIAL,
        "bottom": {"kind": "bit", "stiffness": 1e8, "friction": 0.0},
        "formation": {"drillability": DRILLABILITY, "rotary_exponent": 0.0, "bit_law": {"kind": "rop"}},
        "top": {"kind": "top_drive", **top},
        "initial": {"wob": wob},
    }
    return case | ({} if lying else {"gravity": 0.0, "contact": "none"}) | more


def history(case: dict, folder: Path, **options) -> tuple[dict[str, np.ndarray], dict]:
    """Columns of history.csv without units, and the summary."""
    result = run(Case(**case), folder, progress="silent", **options)
    table = read_table(result.folder / "history.csv")
    return {title.split(" ")[0]: column for title, column in table.items()}, result.summary
