"""Agitator: force and frequency of its pulses, answer of a mass on its spring (manual: verif-agitator)."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.case.plausible.plausibility import plausibility
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from tests.helpers.wells import simple_well

SECTION = {
    "rev_per_volume": "0.5 rev/l",
    "pressure_amplitude": "250 psi",
    "piston_area": "25 cm2",
    "spring": "2 MN/m",
    "flow_rate": "30 l/s",
}
PIPE = {"od": 0.127, "id": 0.1086}


def case(mass: float = 1000.0, **changes: Any) -> dict:
    """A short stiff pipe held at the top, the agitator, and a free body of ``mass`` [kg] below it."""
    section = {key: value for key, value in (SECTION | changes).items() if value is not None}
    return {
        "string": [
            {
                "kind": "agitator",
                "length": 2.0,
                **PIPE,
                "element_length": 1.0,
                "agitator": section,
                "mass": 2.0,
            },
            {"kind": "body", "length": 0.5, "mass": mass},
        ],
        "top": "clamped",
        "gravity": 0,
        "time": {"end": 1.0},
        "petsc": {"ts_rtol": 1e-6},
        "output": {"history_every": 2e-3},
    }


def history(values: dict, out: Path) -> dict[str, np.ndarray]:
    run(Case(**values), out, progress="silent")
    return {name.split(" [")[0]: q for name, q in read_table(out / "history.csv").items()}


@pytest.mark.parametrize(
    ("changes", "force", "frequency"),
    [
        ({}, 4309.2, 15.0),
        ({"flow_rate": "20 l/s", "piston_area": "40 cm2", "rev_per_volume": "0.9 rev/l"}, 6894.757, 18.0),
    ],
)
def test_pulses(changes, force, frequency, tmp_path):
    """C34: 250 psi on 25 cm2 at 30 l/s and 0.5 rev/l: 4309.2 N at 15.000 Hz; 1e-3.

    The body hangs on the spring and answers from rest: x = F/m (sin wt - w/w0 sin w0 t)/(w0^2 - w^2).
    """
    got = history(case(**changes), tmp_path / "run")
    t = got["time"]
    w = 2 * math.pi * frequency
    assert np.abs(got["agitator_force"] - force * np.sin(w * t)).max() < 1e-3 * force
    assert np.abs(got["agitator_force"]).max() == pytest.approx(force, rel=1e-3)
    spring = 1 / (1 / 2e6 + 2.0 / (206e9 * math.pi / 4 * (0.127**2 - 0.1086**2)))  # and the pipe
    own = math.sqrt(spring / 1001.0)
    stiff = spring / 2e6  # the force acts on the spring only
    x = force * stiff / 1001.0 * (np.sin(w * t) - w / own * np.sin(own * t)) / (own**2 - w**2)
    travel = next(q for name, q in got.items() if name.endswith("travel") and name.startswith("joint"))
    assert np.abs(travel - x).max() < 0.05 * np.abs(x).max()


def test_square_pulses_and_no_flow(tmp_path):
    got = history(case(pulse="square"), tmp_path / "square")
    inside = np.abs(np.sin(2 * math.pi * 15 * got["time"])) > 0.3
    assert np.abs(got["agitator_force"][inside]) == pytest.approx(4309.2, rel=2e-2)
    still = history(case(flow_rate=None), tmp_path / "still")
    assert not still["agitator_force"].any()


@pytest.mark.parametrize(
    ("loss", "flow", "mean"),
    [
        (None, "30 l/s", "0 bar"),
        ({"value": "100 psi", "at": "30 l/s", "density": 1200}, "30 l/s", "6.895 bar"),
        ({"value": "250 psi", "at": "30 l/s", "density": 1200}, "15 l/s", "4.309 bar"),
    ],
)
def test_a_valve_that_would_drive_the_mud_is_doubted(loss, flow, mean):
    """Mean loss below the amplitude of the pulses, 250 psi: not given, too small, or at a flow rate that is too small."""
    values = with_mud(flow)
    if loss is None:
        del values["string"][1]["pressure_loss"]
    else:
        values["string"][1]["pressure_loss"] = loss
    (said,) = (line for line in plausibility(Case(**values)) if "pressure_amplitude" in line)
    assert f"string[1].pressure_loss is {mean}" in said
    assert not any("pressure_amplitude" in line for line in plausibility(Case(**with_mud())))
    assert not any("pressure_amplitude" in line for line in plausibility(Case(**with_mud(0.0))))


def with_mud(flow: object = "30 l/s", rtol: float = 1e-5, **changes: Any) -> dict:
    """The agitator at the end of a vertical pipe with mud in and around it, a body below it; its weight keeps it straight."""
    values = case(flow_rate=None, **changes)
    tool, _ = values["string"]
    # the slider's loss: as large as the amplitude of the pulses, at 30 l/s
    tool["pressure_loss"] = {"value": "250 psi", "at": "30 l/s", "density": 1200}
    tool["mass"] = 100.0
    return values | {
        "string": [{"kind": "pipe", "length": 98.0, **PIPE, "element_length": 2.0}, tool],
        "well": simple_well(110, 0.2159, kind="casing", friction=0.0),
        "fluid": {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.02}, "flow_rate": flow},
        "bottom": "free",
        "gravity": 9.81,
        "time": {"end": 0.4},
        "petsc": {"ts_rtol": rtol},
    }


def test_mud_turns_the_valve_and_pulses(tmp_path):
    """C34 with mud: frequency Q n, force A_p dp, amplitude 250 psi; the standpipe pulses with it, the energy closes.

    In a short bore with the flow given at its top the mud passes the valve at q = Q + dq; a pulse dp at the lower end of
    pipe of impedance rho c/A meets that above it alone, |dq| < dp A/(rho c), 10 % of Q.
    """
    run_case = with_mud()
    summary = run(Case(**run_case), tmp_path / "run", progress="silent").summary
    got = {k.split(" [")[0]: q for k, q in read_table(tmp_path / "run" / "history.csv").items()}
    force, t = got["agitator_force"], got["time"]
    assert np.abs(force).max() == pytest.approx(4309.2, rel=1e-2)
    assert force == pytest.approx(got["agitator_pressure"] * 25e-4, rel=1e-9, abs=1e-6)
    ups = t[:-1][(force[:-1] < 0) & (force[1:] >= 0)]
    assert len(ups) >= 4
    assert 1 / np.diff(ups).mean() == pytest.approx(15.0, rel=0.03)
    late = got["pump_pressure"][t > 0.15]
    assert 0.2 * 250 * 6894.757 < np.ptp(late) < 6 * 250 * 6894.757
    assert abs(summary["energy"]["error_share"]) < 1e-3


def test_mud_gives_the_flow_rate():
    values = with_mud()
    values["string"][1]["agitator"]["flow_rate"] = "30 l/s"
    with pytest.raises(CaseError) as error:
        Case(**values)
    assert "no flow_rate with a fluid" in error.value.want


@pytest.mark.parametrize(
    ("changes", "text"),
    [({"spring": 0}, "above 0"), ({"flow_rate": "-1 l/s"}, "at least 0"), ({"pulse": "saw"}, "square")],
)
def test_bad_input_is_refused(changes, text):
    with pytest.raises(CaseError) as error:
        Case(**case(**changes))
    assert text in error.value.want


def test_pulses_in_mud_are_of_second_order_in_time(tmp_path):
    """Pressure of the valve and travel after 30 ms at fixed steps: halving the step divides its change by 4 (BDF, order 2).

    The standpipe pressure rings with sound between elements, which these steps do not resolve.
    """
    last = []
    for step in (5e-4, 2.5e-4, 1.25e-4):
        values = with_mud() | {"contact": "none"}  # an impact is not smooth
        values["petsc"] = {"ts_adapt_type": "none", "ts_dt": step}
        values["time"], values["output"] = {"end": 0.03}, {"history_every": 0.01}
        got = history(values, tmp_path / f"{step:g}")
        travel = next(q for name, q in got.items() if name.endswith("travel") and name.startswith("joint"))
        last.append([got["agitator_pressure"][-1], travel[-1]])
    coarse, fine = np.diff(last, axis=0)
    assert np.abs(coarse / fine - 4.0).max() < 0.8
