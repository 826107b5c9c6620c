"""Groups of sections with one friction factor: `ff_group` in roadmap and calibration (manual: sec-guide-friction-groups)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import roadmap
from drillpetsc.analysis.loads.torque_drag.readings.calibrate import run_calibrate
from drillpetsc.analysis.loads.torque_drag.roadmap import run_roadmap
from drillpetsc.case.case import Case
from drillpetsc.case.options.measured_option import fit_option
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from tests.helpers.tables import each_row
from tests.verification.test_roadmap_command import PIPE, case

LENGTHS = (400.0, 500.0, 600.0)  # of casing, liner and open hole [m]
WEIGHT, SINE, COSINE = 242.0, np.sin(np.radians(60)), 0.5


def well(**plan) -> Case:
    """A straight hole of 60 deg: casing, a liner in a group of its own, open hole."""
    first, second, last = np.cumsum(LENGTHS)
    sections = [
        {"to": first, "kind": "casing", "diameter": "224 mm", "friction": 0.1},
        {"to": second, "kind": "casing", "diameter": "220 mm", "friction": 0.2, "ff_group": "liner"},
        {"to": last, "kind": "open_hole", "diameter": "215.9 mm", "friction": 0.3},
    ]
    plan = {"operations": ["trip_out", "rotate_off_bottom"], "bit_depth": [float(last)], **plan}
    return case([0, last], [60, 60], sections=sections, roadmap=plan)


def drag(*factors: float) -> float:
    return WEIGHT * SINE * float(np.dot(factors, LENGTHS))


def hook_loads(made: Case, folder) -> dict[str, float]:
    result = run_roadmap(Job(made, folder, overwrite=True))
    table = read_table(result.folder / "roadmap.csv")
    return {
        text: float(load)
        for text, load, operation in zip(
            table["ff_groups [-]"], table["hook_load [N]"], table["operation [-]"], strict=True
        )
        if operation == "trip_out"
    }


def test_roadmap(tmp_path):
    """Hook load w (L cos I + sin I sum mu_i L_i); the liner's factors are those of its group, other sections keep theirs."""
    factors = {"groups": {"liner": [0.15, 0.25]}, "open_hole": [0.4]}
    found = hook_loads(well(friction_factor=factors), tmp_path / "r")
    along = WEIGHT * sum(LENGTHS) * COSINE
    assert list(found) == ["liner 0.15", "liner 0.25"]
    for text, value in found.items():
        assert value == pytest.approx(along + drag(0.1, float(text.split()[1]), 0.4), rel=1e-6)
    own = hook_loads(well(), tmp_path / "r")
    assert own["liner 0.2"] == pytest.approx(along + drag(0.1, 0.2, 0.3), rel=1e-6)
    assert list(own) == ["liner 0.15", "liner 0.2", "liner 0.25"]


def test_every_combination(tmp_path):
    factors = {
        "cased": [0.1, 0.2],
        "groups": {"liner": [0.1, 0.3]},
        "open_hole": [0.3, 0.4],
        "combine": "all",
    }
    result = roadmap(well(friction_factor=factors), tmp_path / "r")
    assert result.summary["rows"] == 2 * 8


def test_calibration(tmp_path):
    """Readings of the closed form at three bit depths give the three factors back within 1e-3."""
    mu, (first, second, last) = (0.17, 0.23, 0.36), np.cumsum(LENGTHS)
    points = []
    for depth in (350.0, 800.0, float(last)):
        inside = np.clip(depth - np.array([0.0, first, second]), 0.0, LENGTHS)
        along, friction = WEIGHT * depth * COSINE, WEIGHT * SINE * float(np.dot(mu, inside))
        for operation, sign in (("trip_out", 1.0), ("trip_in", -1.0)):
            points.append({"bit_depth": depth, "operation": operation, "hook_load": along + sign * friction})
    made = well(measured=points)
    result = run_calibrate(Job(made, tmp_path / "c"), None)
    fit = {name: entry["value"] for name, entry in result.summary["fit"].items()}
    assert list(fit) == ["cased", "open_hole", "liner"]
    assert [fit[name] for name in ("cased", "liner", "open_hole")] == pytest.approx(mu, abs=1e-3)
    assert any("friction, liner" in line for line in result.lines)
    assert fit_option("liner,block_weight", made) == ("liner", "block_weight")


@each_row(
    ("factors", "at"),
    [
        ({"groups": {"window": [0.2]}}, "roadmap.friction_factor.groups.window"),
        ({"groups": {"liner": []}}, "roadmap.friction_factor.groups.liner"),
        ({"groups": {"liner": [0.1, 0.2]}, "cased": [0.1, 0.2, 0.3]}, "roadmap.friction_factor.groups.liner"),
        ({"groups": {"cased": [0.1]}}, "roadmap.friction_factor.groups.cased"),
    ],
)
def test_refused(factors, at, tmp_path):
    with pytest.raises(CaseError) as error:
        run_roadmap(Job(well(friction_factor=factors), tmp_path / "r"))
    assert error.value.at == at
    with pytest.raises(CaseError, match="--fit"):
        fit_option("window", well())


def test_a_group_may_not_be_called_as_another_parameter():
    section = {"kind": "open_hole", "diameter": "215.9 mm", "ff_group": "block_weight"}
    with pytest.raises(CaseError, match="ff_group"):
        case([0, 100], [0, 0], sections=[section], item=PIPE)
