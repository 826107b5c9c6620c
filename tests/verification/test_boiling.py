"""A pump that stops draws a vacuum that no mud bears: Joukowsky's pressure, with a warning."""

from __future__ import annotations

import json

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.output import read_table
from tests.helpers.wells import newtonian, simple_well

DENSITY, MODULUS, AREA = 1200.0, 2.2e9, np.pi / 4 * 0.1086**2
SPEED = np.sqrt(MODULUS / DENSITY)  # of sound between rigid walls [m/s]
FLOW = 0.008  # [m3/s]


def stopped(folder, outlet: float, units: str = "metric", **keywords):
    """A frictionless pump stop after 50 ms in a held level pipe of 600 m, from the pressure ``outlet`` [Pa]."""
    case = Case(
        well=simple_well(700, 0.2159, 1.5707963, kind="casing", friction=0),
        string=[{"kind": "pipe", "length": 600, "od": 0.127, "id": 0.1086, "element_length": 10}],
        hold_string=True,
        fluid=newtonian(
            DENSITY,
            0,
            bulk_modulus=MODULUS,
            elastic_walls=False,
            outlet_pressure=outlet,
            flow_rate={"time": [0, 0.05, 0.15], "value": [FLOW, FLOW, 0]},
        ),
        time={"end": keywords.pop("end", 0.3)},
        output={"history_every": 0.01, "units": units},
    )
    return run(case, folder, progress="silent", **keywords)


def test_a_pressure_below_the_vapour_pressure_is_a_warning(tmp_path):
    """The stop lowers the pump pressure by rho a q/A (Joukowsky) = 1.40 MPa, here from 0.5 MPa; the warning names
    channel, time of the first such pressure (during the stop of 100 ms) and the depth."""
    summary = stopped(tmp_path / "run", 0.5e6).summary
    pressure = read_table(tmp_path / "run" / "history.csv")["pump_pressure [Pa]"]
    expected = 0.5e6 - DENSITY * SPEED * FLOW / AREA
    assert pressure.min() == pytest.approx(expected, rel=0.03)
    (warning,) = (w for w in summary["warnings"] if "boil" in w)
    assert "in the bore" in warning and "vapour pressure" in warning and " at MD " in warning
    first = float(warning.split("vapour pressure at ")[1].split(" s")[0])
    assert 0.05 < first < 0.15
    assert warning in json.loads((tmp_path / "run" / "summary.json").read_text())["warnings"]


def test_the_warning_has_the_units_of_the_case(tmp_path):
    texts = [
        next(w for w in stopped(tmp_path / units, 0.5e6, units).summary["warnings"] if "boil" in w)
        for units in ("metric", "field")
    ]
    bar, psi = (float(text.split(" falls to ")[1].split()[0]) for text in texts)
    assert " bar gauge" in texts[0] and " psi gauge" in texts[1]
    assert psi * 0.0689476 == pytest.approx(bar, rel=0.01)
    m, ft = (float(text.split(" at MD ")[1].split()[0]) for text in texts)
    assert ft * 0.3048 == pytest.approx(m, abs=0.01)


def test_without_such_a_pressure_there_is_no_warning(tmp_path):
    summary = stopped(tmp_path / "run", 3e6).summary
    assert not [w for w in summary["warnings"] if "boil" in w]


def test_a_continued_run_remembers_it(tmp_path):
    """At 200 ms the pressure has fallen; the run goes on to 210 ms, and the warning keeps its first time."""
    first = stopped(tmp_path / "run", 0.5e6, end=0.2).summary["warnings"]
    after = stopped(tmp_path / "run", 0.5e6, end=0.21, restart=True).summary["warnings"]
    part = "first below"
    assert [w.split(part)[1] for w in first if "boil" in w] == [
        w.split(part)[1] for w in after if "boil" in w
    ]
