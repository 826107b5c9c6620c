"""Stick-slip of one torsional mode under a torque that decreases with speed (manual:
verif-stick-slip-one-mode)."""

from __future__ import annotations

import numpy as np
import pytest
import yaml

from drillpetsc import run
from drillpetsc.output import read_table
from tests.helpers.bit_models import RADIUS
from tests.helpers.motion import beam, sampled, straight
from tests.helpers.wells import simple_well

INERTIA, STIFFNESS, TURNING, STATIC, DYNAMIC = 374.0, 473.0, 50 * 2 * np.pi / 60, 10e3, 5e3


def case() -> dict:
    """A massless torsion spring of 1 m with the inertia in the bit, pressed with 10 kN on rock that cannot be
    drilled."""
    pipe = beam(1.0, 1, 1e8, 1e9, STIFFNESS, 1e-3, 1e-6, od=2 * RADIUS)
    bit = {
        "kind": "bit",
        "length": 0.1,
        "od": 2 * RADIUS,
        "mass": 100.0,
        "inertia": {"axial": INERTIA, "transverse": 10.0},
    }
    well = simple_well(1.1, 2 * RADIUS, friction=0.0)
    law = {"kind": "velocity_weakening", "static": STATIC, "dynamic": DYNAMIC, "speed": 0.02}
    return {
        "string": [pipe, bit],
        "well": well,
        "contact": "none",
        "top": {"kind": "top_drive", "rotation": float(TURNING)},
        "bottom": {"kind": "bit", "stiffness": 1e8, "friction": 0.0},
        "formation": {"drillability": 0, "bit_law": law},
        "gravity": 0.0,
        "initial": {"from": "straight"},
        "loads": [{"at": 1.0, "force": [0, 0, 10e3]}],
    }


def closed_form() -> tuple[float, float, float]:
    """Slip and stick times [s] and largest speed [rad/s] of the limit of instantaneous weakening.

    Released at a twist of STATIC/k, the bit oscillates about DYNAMIC/k: with w = sqrt(k/J) and x0 = (STATIC -
    DYNAMIC)/k its speed is Omega (1 - cos wt) + x0 w sin wt, zero again at tan(wt/2) = -x0 w/Omega. The twist
    is then x0 below the middle, 2 x0 below the release.
    """
    w, x0 = np.sqrt(STIFFNESS / INERTIA), (STATIC - DYNAMIC) / STIFFNESS
    slip = 2 * (np.pi - np.arctan(x0 * w / TURNING)) / w
    return slip, 2 * x0 / TURNING, TURNING + np.hypot(x0 * w, TURNING)


def phases(t: np.ndarray, speed: np.ndarray) -> tuple[float, float, float]:
    """Slip time, stick time and largest speed of the last complete cycle."""
    moving = speed > 0.1
    starts, stops = (t[1:][a & ~b] for a, b in ((moving[1:], moving[:-1]), (moving[:-1], moving[1:])))
    start = starts[-2]
    stop = stops[stops > start][0]
    return float(stop - start), float(starts[-1] - stop), float(speed[(t > start) & (t < stop)].max())


def test_published_numbers():
    slip, stick, top = closed_form()
    assert [slip + stick, slip, stick, top] == pytest.approx([7.56914, 3.53138, 4.03776, 18.2259], rel=1e-5)


def test_period_and_speed():
    """From rest, untwisted: period, slip and stick times and largest speed within 2 % (manual:
    verif-stick-slip-one-mode).  At a finite speed of the law the stick time is 4.11 s; at the default tolerance it scatters from 4.10 to 4.14 s
    with the steps."""
    model = straight(**case())
    model.system.set_field("string.spin", np.array([[TURNING], [0.0]]), "y")
    rows = sampled(model.system, 20.0, lambda m: m.field("string.spin", "y")[-1, 0], ts_rtol=1e-5)
    assert phases(rows[:, 0], rows[:, 1]) == pytest.approx(closed_form(), rel=0.02)
    first = rows[rows[:, 1] > 0.1, 0][0]
    assert first == pytest.approx(STATIC / STIFFNESS / TURNING, rel=0.02)  # wound up from nothing
    assert rows[:, 1].min() > -0.01  # it does not run backward


def test_through_a_case_file(tmp_path):
    """The same limit cycle from a case file, with the whole string rotating like its top at the start.  See `test_period_and_speed` for the tolerance."""
    path = tmp_path / "stick-slip.yaml"
    path.write_text(
        yaml.safe_dump(
            case()
            | {
                "time": {"end": 18.0},
                "output": {"history_every": 0.01, "field_every": 9.0},
                "petsc": {"ts_rtol": 1e-5},
            }
        )
    )
    table = read_table(run(path, out=tmp_path / "run", progress="silent").folder / "history.csv")
    assert phases(table["time [s]"], table["bit_speed [rad/s]"]) == pytest.approx(closed_form(), rel=0.02)
