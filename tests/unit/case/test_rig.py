"""The rig's datum: its height above a reference, for the survey table of reports."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.commands.check import describe
from drillpetsc.errors import CaseError
from drillpetsc.reporting.inputs import survey_table, well_section

PIPE = {"kind": "pipe", "length": 100, "od": 0.127, "id": 0.1086}
WELL = {
    "survey": {"md": [0, 500], "inclination": [0, 0], "azimuth": [0, 0]},
    "sections": [{"to": "end", "kind": "casing", "diameter": 0.2}],
}


def case(**rig) -> Case:
    return Case(string=[PIPE], top="clamped", well=WELL, rig=rig)


def test_depths_below_a_reference():
    """A vertical well of 500 m from a datum 25 m above the sea ends 475 m below it."""
    table = survey_table(case(elevation="25 m"))
    assert table["tvd_below_reference [m]"] == pytest.approx(np.array([-25.0, 475.0]))
    assert "tvd_below_reference [m]" not in survey_table(case(datum="RKB"))
    section = well_section(case(elevation=25, elevation_ref="LAT"), "field", "well")
    assert any("above LAT" in str(grid) for grid in section.grids)
    assert "datum 25 m above MSL" in describe(case(elevation="25 m"))


@pytest.mark.parametrize(
    ("rig", "at"), [({"elevation_ref": "MSL"}, "elevation"), ({"elevation": "1 bar"}, "elevation")]
)
def test_bad_elevations_are_refused(rig, at):
    with pytest.raises(CaseError) as caught:
        case(**rig)
    assert caught.value.at == f"rig.{at}"
