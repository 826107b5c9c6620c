"""Equivalent densities of `statics`: still mud of one density has that density everywhere, wherever the string has moved to.

p = rho g h below the flow line, so p/(g h) = rho (hydrostatics); nothing is reported where h is below 1 m.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import drillpetsc as dp
from tests.helpers.wells import newtonian, simple_well

DENSITY = 1260.0


def case(**more) -> dp.Case:
    keys = {
        "well": simple_well(2000, 0.2159, friction=0.0),
        "string": [
            {"kind": "pipe", "length": 1999.5, "od": 0.127, "id": 0.1086},
            {"kind": "bit", "length": 0.5, "od": 0.2159, "nozzle_area": 4e-4},
        ],
        "top": {"kind": "top_drive"},
        "fluid": newtonian(DENSITY, 1e-3, bulk_modulus=1e14, elastic_walls=False, flow_line=5.0),
    }
    return dp.Case(**(keys | more))


@pytest.mark.parametrize(
    "more", [{"bottom": "bit", "initial": {"wob": 20e3}}, {"bottom": "free"}], ids=["on bottom", "hanging"]
)
def test_still_mud_has_its_own_density(more: dict, tmp_path: Path) -> None:
    """On bottom the stretch of the string lifts its top by metres; hanging it takes the bit down."""
    result = dp.statics(case(**more), tmp_path / "out")
    table = result.statics
    density = np.asarray(table["ecd"])
    md = np.asarray(table["md"])
    known = np.isfinite(density)
    assert density[known] == pytest.approx(DENSITY, rel=1e-6) and not known[0]
    assert known[md > 10.0].all() and not known[md < 4.0].any()
    assert result.summary["ecd"] == pytest.approx(DENSITY, rel=1e-6)
    assert float(np.asarray(table["annulus_pressure"])[0]) < 0
