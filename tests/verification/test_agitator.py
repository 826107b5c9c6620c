"""Agitator: force and frequency of its pulses, answer of a mass on its spring (manual: verif-agitator)."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table

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


def test_mud_is_refused_in_words():
    values = case(flow_rate=None) | {
        "fluid": {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.02}}
    }
    with pytest.raises(CaseError) as error:
        Case(**values)
    assert "not with a fluid yet" in error.value.want


@pytest.mark.parametrize(
    ("changes", "text"),
    [({"spring": 0}, "above 0"), ({"flow_rate": "-1 l/s"}, "at least 0"), ({"pulse": "saw"}, "square")],
)
def test_bad_input_is_refused(changes, text):
    with pytest.raises(CaseError) as error:
        Case(**case(**changes))
    assert text in error.value.want
